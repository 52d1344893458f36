//! An element of the quadrature: a patch of a surface, or a part of one triangle, and what is known of the other body's
//! distance in its middle.

use crate::contact::point_pair::SurfacePoint;
use crate::contact::quadrature::corners::{Corners, DEEPEST, longest_edge};
use crate::contact::quadrature::moments::{Moments, MomentsOf};
use crate::contact::quadrature::sample::{Sample, WHOLE};
use crate::math::{Aabb, Scalar, Vector3, direction, length, normalising_factor};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::query::Tracer;
use crate::simd::Lanes;
use crate::triangle::ClosestPoint;

/// The coordinates of elements: about the middle of the overlap box, scaled so that its longest side is about 1.
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

/// Which surface an element covers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent {
    /// A patch of several triangles.
    Patch(u32),
    /// A triangle, or a half of a half of it: its index in a list of pieces.
    Piece(u32),
}

/// A triangle, or a half of a half of it. Elements are copied often, so this is kept apart from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<T: Scalar> {
    triangle: u32,
    corners: Corners<T>,
    number: u32,
    depth: u8,
}

/// On which side of the other body's surface an element's middle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Unknown,
    Inside,
    Outside,
}

/// An element, in the coordinates of a [`Frame`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element<T: Scalar> {
    /// Which body's surface.
    pub(crate) body: u8,
    extent: Extent,
    pub(crate) area: T,
    /// Σ area · normal.
    pub(crate) vector: Vector3<T>,
    /// The centroid; of a curved patch the point of its surface that is nearest to that. Two errors of the depth there cancel
    /// over a whole contact, by Gauss's theorem: the depth is above its mean where it bends, and below it where the other
    /// surface crosses elements. For curved patches this holds only on the surface.
    pub(crate) centre: Vector3<T>,
    /// How far it reaches.
    pub(crate) radius: T,
    pub(crate) side: Side,
    /// How far the centre is from the other body's surface, negative outside; before that is measured, how far at most.
    pub(crate) depth: T,
    /// A triangle of the other body near it, where one is known.
    pub(crate) near: Option<u32>,
    /// By how much its mean depth may differ from that in the centre, as the halving of its whole has shown.
    bend: T,
    /// How steeply the depth changes along it.
    slope: T,
    /// Its push on the first body for a stiffness of 1, the size of that, and how far it may be off; known once it is measured.
    pub(crate) push: Vector3<T>,
    pub(crate) load: T,
    pub(crate) error: T,
    /// How much of it counts, as its halves fade in.
    pub(crate) weight: T,
    /// The depth of the element that it is a half of, where that was measured.
    expected: Option<T>,
    /// Whether the other half comes next.
    pub(crate) is_first_half: bool,
    pub(crate) is_halved: bool,
}

impl<T: Scalar> Element<T> {
    /// Adds a patch or, where it is larger than `largest`, its two parts; not what has no area or lies beside the overlap box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn add_patch<L: Lanes<T>>(
        body: u8,
        patch: u32,
        largest: T,
        tracer: &Tracer<'_, T>,
        frame: &Frame<T>,
        pieces: &mut Vec<Piece<T>>,
        elements: &mut Vec<Self>,
    ) {
        let (mesh, &Frame { middle, factor, .. }) = (tracer.mesh(), frame);
        let mut parts = [(patch, Moments::default()); 2];
        if let Some(numbers) = mesh.patches().parts(patch) {
            for (part, number) in parts.iter_mut().zip(numbers) {
                let triangles = mesh.patches().triangles_of(number);
                // Outlined, so that it is compiled with the lanes' instructions.
                *part = (number, L::outlined(MomentsOf { mesh, triangles, middle, factor }));
            }
        }
        let whole = (patch, parts[0].1.with(&parts[1].1));
        let added = if whole.1.area > largest { &parts[..] } else { &[whole] };
        for &(patch, Moments { area, vector, first, second }) in added {
            let triangles = mesh.patches().triangles_of(patch);
            if let &[triangle] = triangles {
                let corners = Corners::of_triangle(mesh.corners(triangle));
                pieces.room_for(1).push(Piece { triangle, corners, number: WHOLE, depth: 0 });
                Self::add_last_piece(body, frame, pieces, elements);
                continue;
            }
            let centroid = first / area;
            let radius = (second / area - centroid.norm_squared()).max(T::zero()).sqrt() * T::of(2.0);
            let on_surface = || tracer.closest_on(mesh.patches().middle(patch), &frame.point(&centroid));
            let closest = if triangles.len() < FEWEST_OF_CURVED { None } else { on_surface() };
            let centre = closest.map_or(centroid, |closest| frame.local(&closest.position));
            let bounds = Aabb { lower: centre, upper: centre }.grown(radius);
            if area > T::zero() && bounds.overlaps(&frame.region) {
                elements.room_for(1).push(Self::new(body, Extent::Patch(patch), area, vector, centre, radius));
            }
        }
    }

    /// Adds the last of the pieces, made where it stays, or removes it where it has no area or lies beside the overlap box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add_last_piece(body: u8, frame: &Frame<T>, pieces: &mut Vec<Piece<T>>, elements: &mut Vec<Self>) {
        let last = pieces.len() - 1;
        let [a, b, c] = pieces[last].corners.positions.each_ref().map(|corner| frame.local(corner));
        let vector = (b - a).cross(&(c - a)) * T::of(0.5);
        let overlaps = Aabb::of_triangle(&[a, b, c]).overlaps(&frame.region);
        let area = if overlaps { length(&vector) } else { T::zero() };
        if area > T::zero() {
            let centre = (a + b + c) / T::of(3.0);
            let farthest = [a, b, c].iter().fold(T::zero(), |most, corner| most.max((corner - centre).norm_squared()));
            let extent = Extent::Piece(last as u32);
            elements.room_for(1).push(Self::new(body, extent, area, vector, centre, farthest.sqrt()));
        } else {
            pieces.truncate(last);
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(body: u8, extent: Extent, area: T, vector: Vector3<T>, centre: Vector3<T>, radius: T) -> Self {
        Self {
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
            push: Vector3::zeros(),
            load: T::zero(),
            error: T::zero(),
            weight: T::one(),
            expected: None,
            is_first_half: false,
            is_halved: false,
        }
    }

    /// Whether it is a patch of several triangles.
    pub(crate) fn is_patch(&self) -> bool {
        matches!(self.extent, Extent::Patch(..))
    }

    /// Whether it is a piece with an edge whose squared length is more than this.
    pub(crate) fn has_edge_beyond(&self, square: T, pieces: &[Piece<T>]) -> bool {
        let Extent::Piece(piece) = self.extent else { return false };
        longest_edge(&pieces[piece as usize].corners.positions).1 > square
    }

    /// Adds its two halves, which take over what its depth tells; fewer where some have no area or lie beside the overlap box.
    /// Gives false where it cannot be halved.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn halve<L: Lanes<T>>(
        &self,
        tracer: &Tracer<'_, T>,
        frame: &Frame<T>,
        pieces: &mut Vec<Piece<T>>,
        halves: &mut Vec<Self>,
    ) -> bool {
        let (body, before) = (self.body, halves.len());
        match self.extent {
            Extent::Patch(patch) => {
                let Some(parts) = tracer.mesh().patches().parts(patch) else { return false };
                for part in parts {
                    Self::add_patch::<L>(body, part, T::INFINITY, tracer, frame, pieces, halves);
                }
            }
            Extent::Piece(piece) => {
                let whole = piece as usize;
                let cut = pieces[whole].corners.cut().filter(|_| pieces[whole].depth < DEEPEST);
                let Some((replaced, position, weights)) = cut else { return false };
                for (half, corner) in replaced.into_iter().enumerate() {
                    let part = pieces.len();
                    let copied = pieces[whole];
                    pieces.room_for(1).push(copied);
                    let Piece { corners, number, depth, .. } = &mut pieces[part];
                    (corners.positions[corner], corners.weights[corner]) = (position, weights);
                    *number = number.wrapping_mul(2).wrapping_add(half as u32);
                    *depth += 1;
                    Self::add_last_piece(body, frame, pieces, halves);
                }
            }
        }
        let added = &mut halves[before..];
        if let [first, _] = added {
            first.is_first_half = true;
        }
        if self.side != Side::Unknown {
            for half in added {
                let away = length(&(half.centre - self.centre));
                // From the half's centre the surface is as far as from this one's, give or take the distance of the two.
                half.side = if self.depth.abs() > away { self.side } else { Side::Unknown };
                (half.depth, half.near, half.expected) = (self.depth.abs() + away, self.near, Some(self.depth));
                (half.bend, half.slope) = (self.bend, self.slope);
            }
        }
        true
    }

    /// Compares the depths of two halves with each other, and their mean with the depth of the whole.
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

    /// Notes whether the next element is the other half of the same whole.
    pub(crate) fn note_other_half(&mut self, next: Option<&Self>, mesh: &Mesh<T>, pieces: &[Piece<T>]) {
        self.is_first_half = match (self.extent, next.map(|next| next.extent)) {
            (Extent::Patch(this), Some(Extent::Patch(next))) => {
                mesh.patches().other_half(this, T::INFINITY) == Some(next)
            }
            (Extent::Piece(this), Some(Extent::Piece(next))) => {
                let [this, next] = [this, next].map(|piece| &pieces[piece as usize]);
                this.triangle == next.triangle && this.number == next.number ^ 1
            }
            _ => false,
        };
    }

    /// By how much the mean depth exceeds that in the centre where the other surface crosses the element. At most about a tenth
    /// of what the depth changes across it; nothing where no surface crosses.
    fn cut(&self, thickness: T) -> T {
        let reach = self.slope * self.radius;
        if reach > T::zero() {
            let crossed = (T::one() - self.depth.abs() / reach).max(T::zero());
            reach.min(thickness) * crossed * crossed * T::of(CUT)
        } else {
            T::zero()
        }
    }

    /// Finds its load, and how far that may be off, where the bodies' shares are these.
    pub(crate) fn assess(&mut self, thickness: T, shares: [T; 2]) {
        let share = shares[usize::from(self.body)];
        let cut = self.cut(thickness);
        let pressure = share * (self.depth.max(T::zero()) + cut);
        self.push = self.vector * if self.body == 0 { -pressure } else { pressure };
        self.load = length(&self.vector) * pressure;
        let unseen = self.radius.min(thickness) * T::of(UNSEEN) * (self.radius / self.depth.abs()).min(T::one());
        self.error = share * self.area * (self.bend + cut).max(unseen);
    }

    /// The sample that casts for it. `None` where it has no normal.
    pub(crate) fn sample(&self, tracer: &Tracer<'_, T>, frame: &Frame<T>, pieces: &[Piece<T>]) -> Option<Sample<T>> {
        let mesh = tracer.mesh();
        let area = frame.area(length(&self.vector) * self.weight);
        let distance = (self.depth < T::INFINITY).then(|| frame.length(self.depth));
        match self.extent {
            Extent::Piece(piece) => {
                let Piece { triangle, corners, number, .. } = pieces[piece as usize];
                let (position, weights) = corners.middle();
                let vertices = mesh.topology().triangles()[triangle as usize];
                let point = SurfacePoint { triangle, vertices, weights: weights.into(), position };
                // The triangle's own, so that parallel faces have the same to the bit.
                let normal = direction(&mesh.scaled_normal(triangle))?;
                Some(Sample { point, normal, area, piece: number, distance })
            }
            // Its number is that of no piece of the triangle.
            Extent::Patch(patch) => {
                let triangle = mesh.patches().middle(patch);
                let ClosestPoint { weights, position, .. } = tracer.closest_on(triangle, &frame.point(&self.centre))?;
                let vertices = mesh.topology().triangles()[triangle as usize];
                let point = SurfacePoint { triangle, vertices, weights, position };
                Some(Sample { point, normal: direction(&self.vector)?, area, piece: !patch, distance })
            }
        }
    }
}

/// Patches of at least so many triangles are curved; those of fewer have an edge in the middle, which stands out.
const FEWEST_OF_CURVED: usize = 8;
/// By this fraction of what the depth changes across an element its mean exceeds that in the centre, if the surface crosses
/// there.
const CUT: f64 = 0.1;
/// What an element may hide beyond what it and its neighbours show, over its size, or over the overlap's thickness where that
/// is less.
const UNSEEN: f64 = 0.1;
