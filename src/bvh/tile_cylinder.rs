use crate::bvh::tile::{TILE_SIZE, Tile};
use crate::math::{Scalar, Vector3, direction, margins};
use crate::memory;
use crate::simd::{Lanes, Mask, Vectors, vector_in_lane};
use crate::triangle::{PointPacket, QueryPoint};

/// A round cylinder around a tile, across its mean normal: a better bound for distances than the box of a tilted tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileCylinder<T: Scalar> {
    /// Of unit length; zero for a tile without a normal, whose cylinder is endless.
    normal: Vector3<T>,
    centre: Vector3<T>,
    /// Between which heights over the centre it lies, along the normal.
    below: T,
    above: T,
    /// How far it reaches across the normal.
    radius: T,
}

/// The cylinders around tiles, where they have been made for the present positions.
#[derive(Clone, Debug)]
pub(crate) struct TileCylinders<T: Scalar> {
    cylinders: Vec<TileCylinder<T>>,
    /// Which of sixteen tiles in a row have a cylinder. Apart from these, so that a look at tiles that have none costs little.
    are_made: Vec<Mask>,
}

impl<T: Scalar> TileCylinders<T> {
    pub(crate) fn new(tile_count: usize) -> Self {
        let are_made = memory::filled(0, tile_count / TILE_SIZE + 2);
        Self { cylinders: memory::filled(TileCylinder::endless(), tile_count), are_made }
    }

    /// To be called where positions have changed.
    pub(crate) fn forget(&mut self) {
        self.are_made.fill(0);
    }

    pub(crate) fn set(&mut self, tile: usize, cylinder: TileCylinder<T>) {
        self.cylinders[tile] = cylinder;
        self.are_made[tile / TILE_SIZE] |= 1 << (tile % TILE_SIZE);
    }

    /// Which of the sixteen tiles from `first` on have a cylinder.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn made_from(&self, first: usize) -> Mask {
        let [here, next] = [0, 1].map(|word| u32::from(self.are_made[first / TILE_SIZE + word]));
        ((here | next << TILE_SIZE) >> (first % TILE_SIZE)) as Mask
    }

    /// The cylinder of a tile that has one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn of(&self, tile: usize) -> &TileCylinder<T> {
        &self.cylinders[tile]
    }
}

impl<T: Scalar> TileCylinder<T> {
    pub(crate) fn endless() -> Self {
        let endless = T::INFINITY;
        Self { normal: Vector3::zeros(), centre: Vector3::zeros(), below: -endless, above: endless, radius: endless }
    }

    /// Around the tile's present positions.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn around<L: Lanes<T>>(tile: &Tile<T>) -> Self {
        let vertices = Vectors::<T, L>::load(&tile.positions);
        let a = vertices.permuted(&tile.corners[0]);
        let normals = vertices.permuted(&tile.corners[1]).sub(a).cross(vertices.permuted(&tile.corners[2]).sub(a));
        let mut rows = [[T::zero(); TILE_SIZE]; 3];
        Vectors::select(tile.present, normals, Vectors::zeros()).store(&mut rows);
        let mut sum = Vector3::zeros();
        for place in 0..TILE_SIZE {
            sum += vector_in_lane(&rows, place);
        }
        let Some(normal) = direction(&sum) else { return Self::endless() };
        let (lower, upper) = (vertices.smallest_lanes(), vertices.greatest_lanes());
        let half = T::of(0.5);
        let centre = lower * half + upper * half;
        let seen = vertices.sub(Vectors::splat(&centre));
        let along = seen.dot(Vectors::splat(&normal));
        let across = seen.sub(Vectors::splat(&normal).scaled(along));
        // More than all is rounded here.
        let slack = (upper - lower).max() * margins::margin(margins::TILE_CYLINDER);
        let radius = across.dot(across).greatest().sqrt() + slack;
        Self { normal, centre, below: along.smallest() - slack, above: along.greatest() + slack, radius }
    }

    /// How far along a row of a rotation something in the cylinder may reach, and a little more.
    pub(crate) fn reach(&self, row: &[f64; 3]) -> f64 {
        let along = |v: &Vector3<T>| row[0] * v.x.to_f64() + row[1] * v.y.to_f64() + row[2] * v.z.to_f64();
        let square: f64 = row.iter().map(|x| x * x).sum();
        let (cosine, middle) = (along(&self.normal), along(&self.centre));
        let (below, above, radius) = (self.below.to_f64(), self.above.to_f64(), self.radius.to_f64());
        let lift = (cosine * below).max(cosine * above);
        let size = radius + below.abs() + above.abs() + self.centre.abs().max().to_f64();
        let slack = margins::margin::<T>(margins::CYLINDER_REACH).to_f64();
        middle + lift + radius * (square - cosine * cosine + slack).max(0.0).sqrt() + slack * size
    }

    /// Squared distances of a packet's points to the cylinder: nothing in it is nearer.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn squares<L: Lanes<T>>(&self, packet: &PointPacket<T>) -> L {
        let factor = packet.centre.factor;
        let normal = Vectors::<T, L>::splat(&self.normal);
        let seen = Vectors::load(&packet.position).sub(Vectors::splat(&(self.centre * factor)));
        let along = seen.dot(normal);
        let across = seen.sub(normal.scaled(along));
        let zero = L::splat(T::zero());
        let above = along.sub(L::splat(self.above * factor));
        let below = L::splat(self.below * factor).sub(along);
        let apart = above.larger(below).larger(zero);
        let beside = across.dot(across).sqrt().sub(L::splat(self.radius * factor)).larger(zero);
        apart.mul(apart).add(beside.mul(beside))
    }

    /// Whether something in the cylinder may be within this squared distance of a point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn is_near(&self, query: &QueryPoint<T>, square_of_cylinders: T) -> bool {
        let seen = query.position - self.centre * query.factor;
        let along = seen.dot(&self.normal);
        let across = seen - self.normal * along;
        let zero = T::zero();
        let apart = (along - self.above * query.factor).max(self.below * query.factor - along).max(zero);
        let beside = (across.norm_squared().sqrt() - self.radius * query.factor).max(zero);
        apart * apart + beside * beside <= square_of_cylinders
    }
}
