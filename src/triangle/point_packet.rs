use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, lanes_of, set_lane, vector_in_lane};
use crate::triangle::query_point::{MeshScale, QueryPoint, margin_per_half_reach};

/// Up to sixteen points side by side, seen in one scale, and for each the nearest triangle so far.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct PointPacket<T: Scalar> {
    /// Scaled.
    pub(crate) position: [[T; LANE_COUNT]; 3],
    /// What the squared distances must not exceed.
    pub(crate) square: [T; LANE_COUNT],
    /// The largest squared distance to a box that may still hold something nearer.
    limit: [T; LANE_COUNT],
    /// The same for tile cylinders.
    pub(crate) cylinder_limit: [T; LANE_COUNT],
    margin: [T; LANE_COUNT],
    /// How far each is from the centre, and a little more.
    from_centre: [T; LANE_COUNT],
    pub(crate) triangle: [u32; LANE_COUNT],
    /// Which lanes hold a point.
    pub(crate) present: Mask,
    /// Which have a triangle.
    pub(crate) found: Mask,
    /// The middle of all of them.
    pub(crate) centre: QueryPoint<T>,
    /// The limit of boxes as seen from the centre; below zero where the points are no neighbours and each is better searched for
    /// by itself.
    pub(crate) centre_limit: T,
    /// The box around all points, and the limit of boxes as seen from it.
    pub(crate) around: Aabb<T>,
    pub(crate) greatest_limit: T,
    /// How many tiles were looked at, and by how many points in all.
    looks: [u32; 2],
    /// Scratch memory: by tile, lower bounds of the squared distances of each point to it.
    pub(crate) tile_bounds: [[T; LANE_COUNT]; LANE_COUNT],
    /// Scratch memory: by point, the squared distances of a tile's triangles.
    pub(crate) squares: [[T; LANE_COUNT]; LANE_COUNT],
}

/// After this many tiles it shows whether points are neighbours: whether at least one of them looks at each on average.
const TILES_TO_TELL: u32 = 64;

impl<T: Scalar> PointPacket<T> {
    pub(crate) fn empty() -> Self {
        let (zero, zeros) = (T::zero(), [T::zero(); LANE_COUNT]);
        let centre = QueryPoint { position: Vector3::zeros(), factor: zero, inverse: zero, margin: zero };
        Self {
            position: [zeros; 3],
            square: zeros,
            limit: zeros,
            cylinder_limit: zeros,
            margin: zeros,
            from_centre: zeros,
            triangle: [0; LANE_COUNT],
            present: 0,
            found: 0,
            centre,
            centre_limit: zero,
            around: Aabb::empty(),
            greatest_limit: zero,
            looks: [0; 2],
            tile_bounds: [zeros; LANE_COUNT],
            squares: [zeros; LANE_COUNT],
        }
    }

    /// Takes up to sixteen points and their bounds. False where they cannot be asked about together: one is far away, or
    /// not finite, or a bound is NaN or negative.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set_lanes<L: Lanes<T>>(
        &mut self,
        points: &[[T; LANE_COUNT]; 3],
        present: Mask,
        bounds: &[T; LANE_COUNT],
        scale: &MeshScale<T>,
    ) -> bool {
        // Lanes that are not asked about repeat the first that is.
        let first = present.trailing_zeros() as usize;
        let one = Vectors::<T, L>::splat(&vector_in_lane(points, first));
        Vectors::select(present, Vectors::load(points), one).store(&mut self.position);
        L::select(present, L::load(bounds), L::splat(bounds[first])).store(&mut self.square);
        self.present = present;
        self.look_from_the_middle::<L>(scale)
    }

    /// The same for the points in some places of a list.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set<L: Lanes<T>>(
        &mut self,
        points: &[Vector3<T>],
        bounds: &[T],
        places: &[u32],
        scale: &MeshScale<T>,
    ) -> bool {
        // Lanes behind the last repeat it.
        let last = places.len() - 1;
        for lane in 0..LANE_COUNT {
            let place = places[lane.min(last)] as usize;
            set_lane(&mut self.position, lane, &points[place]);
            self.square[lane] = bounds[place];
        }
        self.present = ((1u32 << places.len()) - 1) as Mask;
        self.look_from_the_middle::<L>(scale)
    }

    /// Scales the points, and finds their middle and how far they are from it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_from_the_middle<L: Lanes<T>>(&mut self, scale: &MeshScale<T>) -> bool {
        (self.found, self.looks) = (0, [0; 2]);
        let [factor, inverse] = scale.factors;
        let bound = L::load(&self.square);
        let at = Vectors::<T, L>::load(&self.position);
        let half = at.scaled(L::splat(T::of(0.5)));
        let below = Vectors::splat(&scale.half_lower).sub(half).magnitude();
        let above = Vectors::splat(&scale.half_upper).sub(half).magnitude();
        let half_reach = below.larger(above).largest();
        let finite = at.magnitude().are_at_most(Vectors::splat(&Vector3::repeat(T::LARGEST)));
        let near = half_reach.is_at_most(L::splat(scale.half_reach_of_near()));
        if finite & near & L::splat(T::zero()).is_at_most(bound) != Mask::MAX {
            return false;
        }
        let position = at.scaled(L::splat(factor));
        position.store(&mut self.position);
        half_reach.mul(L::splat(margin_per_half_reach(factor))).store(&mut self.margin);
        // As `QueryPoint::square_of_bound`.
        let bound = bound.mul(L::splat(factor));
        let slack = L::splat(T::one() + margins::margin(margins::SQUARE_OF_BOUND));
        bound.mul(bound).mul(slack).store(&mut self.square);
        self.around = Aabb { lower: position.smallest_lanes(), upper: position.greatest_lanes() };
        let middle = (self.around.lower + self.around.upper) * T::of(0.5);
        self.centre = QueryPoint { position: middle, factor, inverse, margin: T::zero() };
        let from_centre = position.sub(Vectors::splat(&middle));
        from_centre.dot(from_centre).sqrt().mul(slack).store(&mut self.from_centre);
        self.renew_limits::<L>();
        true
    }

    /// To be called where squares have become smaller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn renew_limits<L: Lanes<T>>(&mut self) {
        // As `QueryPoint::square_of_boxes`.
        let slack = T::one() + margins::margin(margins::SQUARE_OF_LIMIT);
        let margin = L::load(&self.margin);
        let distance = L::load(&self.square).sqrt().add(margin);
        let limit = distance.mul(distance).mul(L::splat(slack));
        limit.store(&mut self.limit);
        self.greatest_limit = limit.greatest();
        let of_cylinders = distance.add(margin);
        of_cylinders.mul(of_cylinders).mul(L::splat(slack)).store(&mut self.cylinder_limit);
        // The centre is no farther from a box than a point is plus the distance between the two.
        let farthest = distance.add(L::load(&self.from_centre)).greatest();
        self.centre_limit = farthest * farthest * slack;
    }

    /// Which points may be near enough to something in the box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn near<L: Lanes<T>>(&self, aabb: &Aabb<T>) -> Mask {
        let at = Vectors::<T, L>::load(&self.position);
        let below = Vectors::splat(&(aabb.lower * self.centre.factor)).sub(at);
        let above = at.sub(Vectors::splat(&(aabb.upper * self.centre.factor)));
        let apart = below.larger(above).larger(Vectors::zeros());
        apart.dot(apart).is_at_most(L::load(&self.limit)) & self.present
    }

    /// How far the farthest point is from the centre, at most.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn spread<L: Lanes<T>>(&self) -> T {
        L::load(&self.from_centre).greatest()
    }

    /// Keeps the nearest of a tile's triangles for those points to which it is nearer than the one known, or as near and before
    /// it. The squared distances are in `squares`; `smallest` has the least of each point, `sought` the triangles that count.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn keep_nearer<L: Lanes<T>>(
        &mut self,
        points: Mask,
        sought: Mask,
        smallest: &[T; LANE_COUNT],
        triangles: &[u32; LANE_COUNT],
    ) {
        let (known, smallest_of_each) = (L::load(&self.square), L::load(smallest));
        let nearer = smallest_of_each.is_at_most(known) & points;
        if nearer == 0 {
            return;
        }
        let as_near = known.is_at_most(smallest_of_each) & self.found;
        L::select(nearer, smallest_of_each, known).store(&mut self.square);
        self.found |= nearer;
        self.renew_limits::<L>();
        for lane in lanes_of(nearer) {
            let mut first = if as_near >> lane & 1 == 1 { self.triangle[lane] } else { u32::MAX };
            let nearest = L::load(&self.squares[lane]).is_at_most(L::splat(smallest[lane])) & sought;
            for place in lanes_of(nearest) {
                first = first.min(triangles[place]);
            }
            self.triangle[lane] = first;
        }
    }

    /// Counts tiles that were looked at, and the points that looked at each.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn count_looks(&mut self, of_tiles: u32, of_points: u32) {
        let [tiles, looks] = &mut self.looks;
        (*tiles, *looks) = (*tiles + of_tiles, *looks + of_points);
        if *tiles >= TILES_TO_TELL && *looks < *tiles {
            self.centre_limit = -T::one();
        }
    }

    /// One of the points, as a query of its own.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn query(&self, lane: usize) -> QueryPoint<T> {
        QueryPoint { position: self.point(lane), margin: self.margin[lane], ..self.centre }
    }

    /// One of the points, scaled.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn point(&self, lane: usize) -> Vector3<T> {
        vector_in_lane(&self.position, lane)
    }
}
