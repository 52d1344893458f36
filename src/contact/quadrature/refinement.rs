//! The quadrature of the pressure over the surfaces of a pair, each inside the other body: few large elements at first, each
//! halved where that changes the load.

#[cfg(test)]
mod tests;

use crate::contact::pair::Pair;
use crate::contact::quadrature::element::{Element, Frame, Piece};
use crate::contact::quadrature::measurement::Measurement;
use crate::contact::quadrature::sample::{Sample, Sampling};
use crate::contact::statistics::Statistics;
use crate::math::{Aabb, Scalar, Vector3, direction, length};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::triangle::Hit;

// These numbers were chosen together: docs/architecture.md, *Tuned constants*.

/// About this many elements cover the overlap box's largest face at first, at tolerances up to `SYSTEMATIC`; fewer at larger
/// ones, in inverse proportion.
const FIRST_ELEMENTS: f64 = 203.0;
/// By how many times the tolerance all elements may be off together, if their errors are independent. They turn out to be off
/// by half of that.
const ESTIMATE: f64 = 1.3;
/// Below this tolerance, what errors have in common shows too, and they may be off by less, in proportion.
const SYSTEMATIC: f64 = 0.01;
/// But one element may always be off by this fraction of the tolerance, or by this many times its square, whichever is less.
const ERROR_AT_ONCE: [f64; 2] = [0.1, 3.0];
/// Where the forces of a pair cancel, errors are compared with this fraction of their load.
const LEAST_FORCE: f64 = 0.1;
/// An element is halved where it carries more than this fraction of the load.
const LARGEST_SHARE: f64 = 1.0 / 40.0;
/// Halves fade in while the error grows from the limit to this many times that,
const FADE: f64 = 1.5;
/// and while the area grows from that of the first elements to this many times that.
const AREA_FADE: f64 = 1.1;
/// How unevenly a mesh may be stretched until its first elements are smaller than they might be.
const MARGIN_OF_AREA: f64 = 2.0;
/// The most elements of a pair: this many at a tolerance of 1, more at others in inverse proportion, within these bounds.
const ELEMENTS_AT_TOLERANCE_OF_ONE: f64 = 200.0;
const MOST_ELEMENTS: [f64; 2] = [8192.0, 1_048_576.0];
/// About this many samples stand on the overlap box's largest face where loads are not measured.
const UNMEASURED: f64 = 128.0;
/// Halving may then add this many elements to the first ones of a body; the second number is for escapes.
const MOST_UNMEASURED: f64 = 4096.0;
const MOST_OF_ESCAPE: f64 = 512.0;
/// About this many samples stand on the overlap box's largest face at least, however far apart the nodes are that carry the
/// bodies: what stands on a face must not tip over before its centre is beyond an edge.
const FEWEST_FOR_CARRIERS: f64 = 16.0;
/// If both bodies of a pair meet more others than this, the pair has fewer samples, in inverse proportion: their number then
/// grows with the bodies and not with the pairs. But each pair has at least this fraction of the usual number.
const MOST_WITH_ALL_SAMPLES: u32 = 12;
const LEAST_PART: f64 = 1.0 / 16.0;

/// The samples of a pair whose bodies both meet at least `neighbours` others, over the usual number.
pub(crate) fn sample_fraction<T: Scalar>(neighbours: u32) -> T {
    T::of((f64::from(MOST_WITH_ALL_SAMPLES) / f64::from(neighbours.max(1))).clamp(LEAST_PART, 1.0))
}

/// What samples are for.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Purpose {
    /// Forces by the depth below the other body's surface, which is measured: an accuracy puts samples where the load needs them.
    Load,
    /// Forces by what rays meet: an accuracy puts samples on each triangle, and on the pieces of large ones.
    Rays,
    /// One push for all alike: an accuracy puts samples on patches.
    Escape,
}

/// The samples of both bodies of a pair, and scratch memory for finding them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quadrature<T: Scalar> {
    pub(crate) samples: [Vec<Sample<T>>; 2],
    pub(crate) counts: Statistics,
    /// The patches to begin with, and marks for finding them.
    patches: Vec<u32>,
    marks: Vec<u64>,
    elements: Vec<Element<T>>,
    pieces: Vec<Piece<T>>,
    /// By body, how far each element may be off.
    errors: [Vec<T>; 2],
    /// Elements that may still be too large, at the start.
    waiting: Vec<Element<T>>,
    /// How many elements there may be; or, where loads are not measured, how many halving may add.
    most: usize,
    crossings: Vec<Hit<T>>,
}

impl<T: Scalar> Quadrature<T> {
    /// Finds the samples of a pair, given the groups of either body's triangles that may lie inside the other.
    pub(crate) fn fill(&mut self, pair: &Pair<'_, T>, groups: &[Vec<u32>; 2], purpose: Purpose) {
        debug_assert!(pair.options.sampling != Sampling::Vertices, "vertices are no elements");
        dispatch::<T, _>(Filling { pair, groups, purpose, quadrature: self });
    }
}

/// [`Quadrature::fill`].
struct Filling<'a, 'b, T: Scalar> {
    pair: &'a Pair<'b, T>,
    groups: &'a [Vec<u32>; 2],
    purpose: Purpose,
    quadrature: &'a mut Quadrature<T>,
}

impl<T: Scalar> Kernel<T> for Filling<'_, '_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { pair, groups, purpose, quadrature } = self;
        let frame = Frame::new(pair.overlap, pair.region);
        quadrature.counts = Statistics::default();
        let spacing = pair.carrier_spacing().min((pair.overlap.largest_face() / T::of(FEWEST_FOR_CARRIERS)).sqrt());
        let sampling = match pair.options.sampling {
            // What few unknowns carry has no use for more samples.
            Sampling::Accuracy(accuracy)
                if purpose != Purpose::Escape
                    && frame.of_area(spacing * spacing) > Size::new(pair, accuracy, &frame).first =>
            {
                Sampling::Spacing(spacing)
            }
            sampling => sampling,
        };
        match sampling {
            Sampling::Accuracy(accuracy) if purpose == Purpose::Load => {
                let size = Size::new(pair, accuracy, &frame);
                quadrature.counts.error_asked = size.tolerance.to_f64();
                let [fewest, most] = MOST_ELEMENTS;
                quadrature.most = (ELEMENTS_AT_TOLERANCE_OF_ONE / size.tolerance.to_f64()).clamp(fewest, most) as usize;
                // Above this area halves have replaced the whole.
                let largest = size.first * T::of(AREA_FADE);
                // An area at the reference positions. With the margin, some patches are too large, and are halved.
                let of_patches = |body: usize| {
                    let mesh = pair.tracers[body].mesh();
                    let growth = mesh.patches().growth(|triangle| mesh.corners(triangle));
                    frame.area(largest * T::of(MARGIN_OF_AREA)) / growth
                };
                quadrature.start::<L>(pair, &frame, groups, of_patches, Largest::Area(largest));
                quadrature.refine::<L>(pair, &frame, &size);
            }
            sampling => {
                let unmeasured = pair.overlap.largest_face() / (T::of(UNMEASURED) * pair.sample_fraction);
                // A body with itself takes no patches, which may lie on either side of a fold.
                let (square, most, is_joined) = match (sampling, purpose) {
                    (Sampling::Spacing(spacing), _) => {
                        (spacing * spacing, MOST_ELEMENTS[1], pair.bodies[0] != pair.bodies[1])
                    }
                    (_, Purpose::Escape) => (unmeasured, MOST_OF_ESCAPE, true),
                    _ => (unmeasured, MOST_UNMEASURED, false),
                };
                quadrature.most = most as usize;
                // A region that is no more than a line or a point gives no measure.
                let longest = if square > T::zero() { square * T::of(2.0) } else { T::INFINITY };
                let of_patches = if is_joined { square } else { T::zero() };
                quadrature.start::<L>(pair, &frame, groups, |_| of_patches, Largest::Edge(longest));
            }
        }
        quadrature.sample(pair, &frame);
    }
}

/// The largest elements to begin with.
#[derive(Clone, Copy)]
enum Largest<T> {
    /// Of this area.
    Area(T),
    /// Pieces with no edge whose squared length is more; patches of any size.
    Edge(T),
}

impl<T: Scalar> Largest<T> {
    /// Whether an element is larger than this many times the largest.
    fn is_exceeded_by(self, element: &Element<T>, times: T, pieces: &[Piece<T>]) -> bool {
        match self {
            Self::Area(area) => element.area > area * times,
            Self::Edge(square) => element.has_edge_beyond(square * times, pieces),
        }
    }
}

/// How large elements may be, in the coordinates of a [`Frame`].
struct Size<T: Scalar> {
    /// The area of the first ones.
    first: T,
    /// How far the net force may be off.
    tolerance: T,
    /// The fraction of the load that one element may carry.
    largest_load: T,
    /// The overlap box's shortest side.
    thickness: T,
    /// The shares of the load that the two bodies carry.
    shares: [T; 2],
}

impl<T: Scalar> Size<T> {
    fn new(pair: &Pair<'_, T>, accuracy: T, frame: &Frame<T>) -> Self {
        let tolerance = accuracy / pair.sample_fraction;
        let times = (tolerance / T::of(SYSTEMATIC)).clamp(T::one(), T::of(1.0 / LEAST_PART));
        let face = frame.of_area(pair.overlap.largest_face());
        Self {
            // A region that is no more than a line or a point gives no measure.
            first: if face > T::zero() { face * times / T::of(FIRST_ELEMENTS) } else { T::INFINITY },
            tolerance,
            largest_load: times * T::of(LARGEST_SHARE),
            thickness: frame.of_length((pair.overlap.upper - pair.overlap.lower).min()),
            shares: pair.fixed_shares.unwrap_or([T::of(0.5); 2]),
        }
    }

    /// How far the halves of an element have faded in, from 0 to 1.
    fn halved(&self, element: &Element<T>, limits: &Limits<T>) -> T {
        let ramp = ramp(element.area / self.first, AREA_FADE)
            .max(ramp(element.error * element.weight / limits.error, FADE))
            .max(ramp(element.load / limits.load, FADE));
        ramp * ramp * (T::of(3.0) - T::of(2.0) * ramp)
    }

    /// The limits that follow from what all elements carry.
    fn limits(&self, elements: &[Element<T>], errors: &mut [Vec<T>; 2]) -> Limits<T> {
        // By body, so that it does not matter which comes first.
        let mut sums = [[T::zero(); 5]; 2];
        errors.iter_mut().for_each(Vec::clear);
        for &Element { body, push, load, error, weight, .. } in elements {
            let numbers = [push.x, push.y, push.z, load, error * error];
            sums[usize::from(body)].iter_mut().zip(numbers).for_each(|(sum, number)| *sum += weight * number);
            errors[usize::from(body)].room_for(1).push(weight * error);
        }
        let [x, y, z, load, square] = std::array::from_fn(|number| sums[0][number] + sums[1][number]);
        let force = length(&Vector3::new(x, y, z)).max(load * T::of(LEAST_FORCE));
        let estimate = if load > T::zero() { square.sqrt() / force } else { T::zero() };
        let allowed = force * self.tolerance;
        let together = T::of(ESTIMATE) * (self.tolerance / T::of(SYSTEMATIC)).min(T::one());
        let always = T::of(ERROR_AT_ONCE[0]).min(T::of(ERROR_AT_ONCE[1]) * self.tolerance);
        let error = limit_of_errors(errors, allowed * together).max(allowed * always);
        Limits { error, load: load * self.largest_load, estimate }
    }
}

/// The limit to which the largest errors have to come down so that the root of the sum of all squares is no more than `together`.
fn limit_of_errors<T: Scalar>(errors: &[Vec<T>; 2], together: T) -> T {
    let mut limit = T::zero();
    loop {
        let of_body = |errors: &Vec<T>| {
            errors.iter().fold([T::zero(); 2], |[squares, larger], &error| {
                if error > limit { [squares, larger + T::one()] } else { [squares + error * error, larger] }
            })
        };
        let [first, second] = errors.each_ref().map(of_body);
        // The larger ones get equal parts of what the others leave. The limit rises, and fewer are larger, each time.
        let next = ((together * together - (first[0] + second[0])) / (first[1] + second[1])).sqrt();
        // In this form NaN ends it.
        if next > limit {
            limit = next;
        } else {
            return limit;
        }
    }
}

/// How far an element's load may be off, and how large it may be.
struct Limits<T> {
    error: T,
    load: T,
    /// By what fraction the net force is expected to be off.
    estimate: T,
}

/// From 0 at 1 to 1 at this number.
fn ramp<T: Scalar>(excess: T, end: f64) -> T {
    // In this form NaN is 0.
    if excess > T::one() { ((excess - T::one()) / T::of(end - 1.0)).min(T::one()) } else { T::zero() }
}

impl<T: Scalar> Quadrature<T> {
    /// Makes the first elements of both bodies, of patches of the given areas that reach into these groups.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<T>>(
        &mut self,
        pair: &Pair<'_, T>,
        frame: &Frame<T>,
        groups: &[Vec<u32>; 2],
        of_patches: impl Fn(usize) -> T,
        largest: Largest<T>,
    ) {
        let Self { counts, patches, marks, elements, pieces, waiting, most, .. } = self;
        elements.clear();
        pieces.clear();
        for (body, groups) in groups.iter().enumerate().filter(|(_, groups)| !groups.is_empty()) {
            let (tracer, first, before) = (pair.tracers[body], [elements.len(), pieces.len()], *counts);
            tracer.patches_of_groups(of_patches(body)).list(groups, marks, patches);
            // Where they would be too many, all may be larger: what comes first must not matter.
            let mut times = T::one();
            'larger: loop {
                let mut added = 0;
                waiting.clear();
                elements.truncate(first[0]);
                pieces.truncate(first[1]);
                *counts = before;
                for &patch in &*patches {
                    let largest_patch = if let Largest::Area(area) = largest { area * times } else { T::INFINITY };
                    Element::add_patch::<L>(body as u8, patch, largest_patch, tracer, frame, pieces, waiting);
                    counts.without_normal +=
                        u64::from(waiting.is_empty() && is_degenerate(tracer.mesh(), patch, pair.region));
                    while let Some(element) = waiting.pop() {
                        let others = waiting.len();
                        let is_too_large = largest.is_exceeded_by(&element, times, pieces);
                        if !(is_too_large && element.halve::<L>(tracer, frame, pieces, waiting)) {
                            counts.uncut_pieces += u64::from(largest.is_exceeded_by(&element, T::one(), pieces));
                            elements.room_for(1).push(element);
                            continue;
                        }
                        added += waiting.len().saturating_sub(others + 1);
                        if added > *most {
                            times *= times.max(T::of(8.0));
                            continue 'larger;
                        }
                    }
                }
                break;
            }
            for index in first[0]..elements.len() {
                let (before, after) = elements.split_at_mut(index + 1);
                before[index].note_other_half(after.first(), tracer.mesh(), pieces);
            }
        }
    }

    /// Measures elements and halves those that need it, until none do.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn refine<L: Lanes<T>>(&mut self, pair: &Pair<'_, T>, frame: &Frame<T>, size: &Size<T>) {
        let (mut measurement, mut first) = (Measurement::new(pair, frame), 0);
        while first < self.elements.len() {
            let Self { counts, elements, crossings, .. } = &mut *self;
            let fresh = &mut elements[first..];
            for body in 0..2 {
                counts.estimate_rays += measurement.run::<L>(body, fresh, crossings);
            }
            compare_halves(fresh);
            // What lies outside as a whole can go.
            let mut kept = first;
            for index in first..elements.len() {
                if elements[index].depth > -elements[index].radius {
                    elements[index].assess(size.thickness, size.shares);
                    if kept < index {
                        elements[kept] = elements[index];
                    }
                    kept += 1;
                }
            }
            elements.truncate(kept);
            first = kept;
            self.halve::<L>(pair, frame, size);
        }
    }

    /// Adds the halves of elements that need it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn halve<L: Lanes<T>>(&mut self, pair: &Pair<'_, T>, frame: &Frame<T>, size: &Size<T>) {
        let Self { counts, elements, pieces, errors, most, .. } = self;
        let limits = size.limits(elements, errors);
        counts.error_estimated = limits.estimate.to_f64();
        // All that need it or none: what comes first must not matter.
        if 3 * elements.len() > *most {
            let is_wanted = |element: &&Element<T>| !element.is_halved && size.halved(element, &limits) > T::zero();
            let wanted = elements.iter().filter(is_wanted).count();
            if elements.len() + 2 * wanted > *most {
                counts.uncut_pieces += wanted as u64;
                return;
            }
        }
        for index in 0..elements.len() {
            let element = &mut elements[index];
            let halved = if element.is_halved { T::zero() } else { size.halved(element, &limits) };
            if halved == T::zero() {
                continue;
            }
            element.is_halved = true;
            let whole = *element;
            let (tracer, before) = (pair.tracers[usize::from(whole.body)], elements.len());
            if whole.halve::<L>(tracer, frame, pieces, elements) {
                elements[index].weight = whole.weight * (T::one() - halved);
                elements[before..].iter_mut().for_each(|half| half.weight = whole.weight * halved);
            } else {
                counts.uncut_pieces += 1;
            }
        }
    }

    /// Makes samples of the elements that count and do not lie outside.
    fn sample(&mut self, pair: &Pair<'_, T>, frame: &Frame<T>) {
        let Self { samples, counts, elements, pieces, .. } = self;
        samples.iter_mut().for_each(Vec::clear);
        for element in elements.iter().filter(|element| element.weight > T::zero() && element.depth > T::zero()) {
            let body = usize::from(element.body);
            if element.depth == T::INFINITY && !pair.region.contains(&frame.point(&element.centre)) {
                continue;
            }
            let Some(sample) = element.sample(pair.tracers[body], frame, pieces) else {
                counts.without_normal += 1;
                continue;
            };
            counts.patches += u64::from(element.is_patch());
            samples[body].room_for(1).push(sample);
        }
    }
}

/// Whether a patch is a triangle without an area, inside a region.
fn is_degenerate<T: Scalar>(mesh: &Mesh<T>, patch: u32, region: &Aabb<T>) -> bool {
    let &[triangle] = mesh.patches().triangles_of(patch) else { return false };
    Aabb::of_triangle(&mesh.corners(triangle)).overlaps(region) && direction(&mesh.scaled_normal(triangle)).is_none()
}

/// Compares the halves of each whole.
fn compare_halves<T: Scalar>(elements: &mut [Element<T>]) {
    for index in 1..elements.len() {
        let (before, after) = elements.split_at_mut(index);
        let first = &mut before[index - 1];
        if first.is_first_half {
            Element::compare([first, &mut after[0]]);
        }
    }
}
