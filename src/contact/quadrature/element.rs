//! An element of the quadrature: a patch of a surface, or a part of one triangle, and what is known of the other body's
//! distance in its middle.

// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

use crate::contact::point_pair::SurfacePoint;
use crate::contact::quadrature::sample::{Sample, WHOLE};
use crate::math::{Aabb, Scalar, Vector3, direction, length, normalising_factor};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::query::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Vectors};
use crate::triangle::ClosestPoint;

/// Halvings of halves beyond this change nothing in either precision.
const DEEPEST: u8 = 96;

/// The coordinates in which elements are measured: about the middle of the overlap box, which is about as large as 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<T: Scalar> {
    middle: Vector3<T>,
    factor: T,
    inverse: T,
    /// The overlap box with its margin.
    region: Aabb<T>,
}

impl<T: Scalar> Frame<T> {
    pub(crate) fn new(overlap: &Aabb<T>, region: &Aabb<T>) -> Self {
        let middle = overlap.centre();
        let [factor, inverse] = normalising_factor((overlap.upper - overlap.lower).max()).into();
        let local = |corner: &Vector3<T>| (corner - middle) * factor;
        let region = Aabb { lower: local(&region.lower), upper: local(&region.upper) };
        Self { middle, factor, inverse, region }
    }

    pub(crate) fn local(&self, point: &Vector3<T>) -> Vector3<T> {
        (point - self.middle) * self.factor
    }

    pub(crate) fn of_length(&self, length: T) -> T {
        length * self.factor
    }

    pub(crate) fn of_area(&self, area: T) -> T {
        area * self.factor * self.factor
    }

    pub(crate) fn point(&self, local: &Vector3<T>) -> Vector3<T> {
        local * self.inverse + self.middle
    }

    pub(crate) fn length(&self, local: T) -> T {
        local * self.inverse
    }

    pub(crate) fn area(&self, local: T) -> T {
        local * self.inverse * self.inverse
    }
}

/// What an element is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent<T: Scalar> {
    /// A patch of several triangles.
    Patch(u32),
    /// A triangle or a half of a half of it.
    Piece { triangle: u32, corners: Corners<T>, number: u32, depth: u8 },
}

/// Where a part of a triangle has its corners, and their barycentric weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners<T: Scalar> {
    positions: [Vector3<T>; 3],
    weights: [Vector3<T>; 3],
}

/// On which side of the other body's surface an element's middle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Unknown,
    Inside,
    Outside,
}

/// A part of a surface, in the coordinates of a [`Frame`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element<T: Scalar> {
    /// Which body's surface.
    pub(crate) body: u8,
    extent: Extent<T>,
    pub(crate) area: T,
    /// Σ area · normal.
    pub(crate) vector: Vector3<T>,
    /// The centroid of its area.
    pub(crate) centre: Vector3<T>,
    /// How far it reaches.
    pub(crate) radius: T,
    pub(crate) side: Side,
    /// How far the middle is from the other body's surface, negative outside; before that is measured, how far at most.
    pub(crate) depth: T,
    /// A triangle of the other body near it, where one is known.
    pub(crate) near: Option<u32>,
    /// By how much the mean depth differs from that in the middle, as far as known from what it is a part of.
    bend: T,
    /// How steeply the depth changes along it.
    slope: T,
    /// How much of it counts: its parts fade in.
    pub(crate) weight: T,
    /// The depth of what it is a half of, where that was measured.
    expected: Option<T>,
    /// Whether the other half comes next.
    is_first_half: bool,
    pub(crate) is_halved: bool,
}

impl<T: Scalar> Element<T> {
    /// A patch; `None` where it has no area, or lies beside the overlap box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn patch<L: Lanes<T>>(body: u8, patch: u32, mesh: &Mesh<T>, frame: &Frame<T>) -> Option<Self> {
        let patches = mesh.patches();
        if let &[triangle] = patches.triangles_of(patch) {
            let weights = [Vector3::x(), Vector3::y(), Vector3::z()];
            return Self::piece(
                body,
                triangle,
                Corners { positions: mesh.corners(triangle), weights },
                WHOLE,
                0,
                frame,
            );
        }
        // Outlined, so that it has the lanes' instructions whoever asks.
        let triangles = patches.triangles_of(patch);
        let Moments { area, vector, first, second } = L::outlined(MomentsOf { mesh, frame, triangles });
        let centre = first / area;
        let spread = (second / area - centre.norm_squared()).max(T::zero());
        Self::new(body, Extent::Patch(patch), area, vector, centre, spread.sqrt() * T::of(2.0), frame)
    }

    fn piece(body: u8, triangle: u32, corners: Corners<T>, number: u32, depth: u8, frame: &Frame<T>) -> Option<Self> {
        let [a, b, c] = corners.positions.map(|corner| frame.local(&corner));
        let vector = (b - a).cross(&(c - a)) * T::of(0.5);
        let centre = (a + b + c) / T::of(3.0);
        let farthest = [a, b, c].iter().fold(T::zero(), |most, corner| most.max((corner - centre).norm_squared()));
        let extent = Extent::Piece { triangle, corners, number, depth };
        Self::new(body, extent, length(&vector), vector, centre, farthest.sqrt(), frame)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(
        body: u8,
        extent: Extent<T>,
        area: T,
        vector: Vector3<T>,
        centre: Vector3<T>,
        radius: T,
        frame: &Frame<T>,
    ) -> Option<Self> {
        let is_near = |axis: usize| {
            frame.region.lower[axis] <= centre[axis] + radius && centre[axis] - radius <= frame.region.upper[axis]
        };
        (area > T::zero() && (0..3).all(is_near)).then(|| Self {
            body,
            extent,
            area,
            vector,
            centre,
            radius,
            side: Side::Unknown,
            depth: T::INFINITY,
            near: None,
            bend: T::zero(),
            slope: T::one(),
            weight: T::one(),
            expected: None,
            is_first_half: false,
            is_halved: false,
        })
    }

    /// Whether it is a patch of several triangles.
    pub(crate) fn is_patch(&self) -> bool {
        matches!(self.extent, Extent::Patch(_))
    }

    /// Adds its two halves, which know of its depth; fewer where some have no area or lie beside the overlap box. Gives false
    /// where it cannot be halved.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn halve<L: Lanes<T>>(&self, mesh: &Mesh<T>, frame: &Frame<T>, halves: &mut Vec<Self>) -> bool {
        let body = self.body;
        let found = match self.extent {
            Extent::Patch(patch) => {
                let Some(parts) = mesh.patches().parts(patch) else { return false };
                parts.map(|part| Self::patch::<L>(body, part, mesh, frame))
            }
            Extent::Piece { triangle, corners, number, depth } => {
                let Some(halves) = corners.halves().filter(|_| depth < DEEPEST) else { return false };
                let numbers = [0, 1].map(|half| number.wrapping_mul(2).wrapping_add(half));
                [0, 1].map(|half| Self::piece(body, triangle, halves[half], numbers[half], depth + 1, frame))
            }
        };
        let are_both = found[0].is_some() && found[1].is_some();
        for (number, half) in found.into_iter().enumerate() {
            let Some(mut half) = half else { continue };
            half.is_first_half = are_both && number == 0;
            if self.side != Side::Unknown {
                let away = length(&(half.centre - self.centre));
                // The surface is as far from the middle as it is from this one, but for the way between the two.
                half.side = if self.depth.abs() > away { self.side } else { Side::Unknown };
                (half.depth, half.near, half.expected) = (self.depth.abs() + away, self.near, Some(self.depth));
                (half.bend, half.slope) = (self.bend, self.slope);
            }
            halves.room_for(1).push(half);
        }
        true
    }

    /// Holds what was measured of two halves against one another, and against what was expected of them together.
    pub(crate) fn compare([first, second]: [&mut Self; 2]) {
        let half = T::of(0.5);
        let mean = (first.depth * first.area + second.depth * second.area) / (first.area + second.area);
        let bend = first.expected.map_or(T::zero(), |expected| (mean - expected).abs().max(first.bend * half));
        let step = length(&(first.centre - second.centre));
        let slope = ((first.depth - second.depth).abs() / step).min(T::one()).max(first.slope * half);
        for element in [first, second] {
            (element.bend, element.slope) = (bend, slope);
        }
    }

    /// Whether the next element is the other half of what this one is a half of.
    pub(crate) fn is_first_half(&self) -> bool {
        self.is_first_half
    }

    /// Notes whether the next element is the other half of what this one is a half of.
    pub(crate) fn note_other_half(&mut self, next: Option<&Self>, mesh: &Mesh<T>) {
        self.is_first_half = match (self.extent, next.map(|next| next.extent)) {
            (Extent::Patch(this), Some(Extent::Patch(next))) => mesh.patches().are_halves(this, next),
            (Extent::Piece { triangle, number, .. }, Some(Extent::Piece { triangle: of_next, number: next, .. })) => {
                triangle == of_next && number == next ^ 1
            }
            _ => false,
        };
    }

    /// What the depth in the middle leaves out where the other surface crosses the element: at most about a fifth of how
    /// far the depth reaches across it, and nothing where it does not cross.
    pub(crate) fn cut(&self, thickness: T) -> T {
        let reach = self.slope * self.radius;
        if reach > T::zero() {
            let crossed = (T::one() - self.depth.abs() / reach).max(T::zero());
            reach.min(thickness) * crossed * crossed * T::of(CUT)
        } else {
            T::zero()
        }
    }

    /// How far its part of the load may be off, for unit stiffness.
    pub(crate) fn error(&self, thickness: T) -> T {
        let unseen = self.radius * T::of(UNSEEN) * (self.radius / self.depth.abs()).min(T::one());
        self.area * (self.bend + self.cut(thickness)).max(unseen)
    }

    /// Its part of the load, for unit stiffness.
    pub(crate) fn load(&self, thickness: T) -> T {
        length(&self.vector) * (self.depth.max(T::zero()) + self.cut(thickness))
    }

    /// What casts for it: from its middle, or the triangle in the middle of a patch, as much as it counts. `None` where it has
    /// no normal.
    pub(crate) fn sample(&self, tracer: &Tracer<'_, T>, frame: &Frame<T>) -> Option<Sample<T>> {
        let area = frame.area(length(&self.vector) * self.weight);
        let mesh = tracer.mesh();
        match self.extent {
            Extent::Piece { triangle, corners: Corners { positions: [a, b, c], weights }, number, .. } => {
                let third = T::one() / T::of(3.0);
                let vertices = mesh.topology().triangles()[triangle as usize];
                let position = (a + b + c) * third;
                let weights = ((weights[0] + weights[1] + weights[2]) * third).into();
                // As the triangle's, so that parallel faces are so to the bit.
                let normal = direction(&mesh.scaled_normal(triangle))?;
                Some(Sample {
                    point: SurfacePoint { triangle, vertices, weights, position },
                    normal,
                    area,
                    piece: number,
                })
            }
            Extent::Patch(patch) => {
                let triangle = mesh.patches().triangle(patch);
                let vertices = mesh.topology().triangles()[triangle as usize];
                let ClosestPoint { weights, position, .. } = tracer.closest_on(triangle, &frame.point(&self.centre))?;
                let point = SurfacePoint { triangle, vertices, weights, position };
                // Apart from all pieces of the triangle.
                Some(Sample { point, normal: direction(&self.vector)?, area, piece: !patch })
            }
        }
    }
}

/// Parts of this many times how far the depth reaches are left out where the surface crosses an element in its middle.
const CUT: f64 = 0.2;
/// What an element may hide beyond what it and its neighbours show, as a part of its size.
const UNSEEN: f64 = 0.1;

impl<T: Scalar> Corners<T> {
    /// The halves, cut at the middle of the longest edge; `None` where rounding leaves none.
    fn halves(&self) -> Option<[Self; 2]> {
        let Self { positions, weights } = self;
        let squares: [T; 3] = std::array::from_fn(|i| (positions[i] - positions[(i + 1) % 3]).norm_squared());
        // Of equal edges the first in space is cut, so that it does not matter with which corner the triangle begins.
        let ends = |i: usize| {
            let sum = positions[i] + positions[(i + 1) % 3];
            [sum.x, sum.y, sum.z]
        };
        let is_longer =
            |i: usize, best: usize| squares[i] > squares[best] || (squares[i] == squares[best] && ends(i) < ends(best));
        let longest = (1..3).fold(0, |best, i| if is_longer(i, best) { i } else { best });
        let [from, to] = [longest, (longest + 1) % 3];
        let half = T::of(0.5);
        let middle = (positions[from] + positions[to]) * half;
        let can_halve = middle != positions[from] && middle != positions[to];
        can_halve.then(|| {
            [to, from].map(|replaced| {
                let mut part = *self;
                part.positions[replaced] = middle;
                part.weights[replaced] = (weights[from] + weights[to]) * half;
                part
            })
        })
    }
}

/// Sums over triangles.
struct Moments<T: Scalar> {
    area: T,
    /// Σ area · normal.
    vector: Vector3<T>,
    /// Σ area · middle.
    first: Vector3<T>,
    /// The integral of the squared distance from the frame's middle.
    second: T,
}

/// Adds up the moments of some triangles.
struct MomentsOf<'a, T: Scalar> {
    mesh: &'a Mesh<T>,
    frame: &'a Frame<T>,
    triangles: &'a [u32],
}

impl<T: Scalar> Kernel<T> for MomentsOf<'_, T> {
    type Output = Moments<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Moments<T> {
        let Self { mesh, frame, triangles } = self;
        let all = mesh.topology().triangles();
        let (middle, factor) = (Vectors::<T, L>::splat(&frame.middle), L::splat(frame.factor));
        let (third, twelfth) = (L::splat(T::one() / T::of(3.0)), L::splat(T::one() / T::of(12.0)));
        let mut area_sum = L::splat(T::zero());
        let mut second_sum = L::splat(T::zero());
        let (mut vector_sum, mut first_sum) = (Vectors::<T, L>::zeros(), Vectors::<T, L>::zeros());
        for some in triangles.chunks(LANE_COUNT) {
            // Lanes beyond the last have three times the same corner, and no area.
            let mut vertices = [[all[some[0] as usize][0]; LANE_COUNT]; 3];
            for (lane, &triangle) in some.iter().enumerate() {
                let [a, b, c] = all[triangle as usize];
                (vertices[0][lane], vertices[1][lane], vertices[2][lane]) = (a, b, c);
            }
            let a = mesh.gather::<L>(&vertices[0]).sub(middle).scaled(factor);
            let b = mesh.gather::<L>(&vertices[1]).sub(middle).scaled(factor);
            let c = mesh.gather::<L>(&vertices[2]).sub(middle).scaled(factor);
            let vector = b.sub(a).cross(c.sub(a)).scaled(L::splat(T::of(0.5)));
            let area = vector.dot(vector).sqrt();
            let whole = a.add(b).add(c);
            area_sum = area_sum.add(area);
            vector_sum = vector_sum.add(vector);
            first_sum = first_sum.add(whole.scaled(area.mul(third)));
            let squares = a.dot(a).add(b.dot(b)).add(c.dot(c)).add(whole.dot(whole));
            second_sum = second_sum.add(squares.mul(area.mul(twelfth)));
        }
        Moments {
            area: sum(area_sum),
            vector: Vector3::new(sum(vector_sum.x), sum(vector_sum.y), sum(vector_sum.z)),
            first: Vector3::new(sum(first_sum.x), sum(first_sum.y), sum(first_sum.z)),
            second: sum(second_sum),
        }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn sum<T: Scalar, L: Lanes<T>>(lanes: L) -> T {
    let mut values = [T::zero(); LANE_COUNT];
    lanes.store(&mut values);
    let mut total = T::zero();
    for value in values {
        total += value;
    }
    total
}
