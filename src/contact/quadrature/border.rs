//! Pieces of triangles that the other body's surface crosses. Only the part inside casts, from its own middle. So a thin strip
//! counts with the part that is inside, and forces do not jump when a piece's middle passes the surface.

use crate::contact::pair::Direction;
use crate::contact::point_pair::touched_of;
use crate::contact::quadrature::cutter::CutPiece;
use crate::contact::quadrature::packet::{KnownDistances, SamplePacket};
use crate::contact::quadrature::part::{Cut, Part, Plane};
use crate::contact::quadrature::sample::{MeasuredSample, Sample};
use crate::math::{Scalar, Vector3, direction};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::query::{PointDistances, Tracer};
use crate::self_contact::rounding;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask, vector_in_lane};
use crate::triangle::{ClosestPoint, Hit};

/// A piece is cut by at most this many planes: three faces meet at a simple corner of the other body.
const MOST_PLANES: usize = 3;

/// Holds the pieces in a packet against the other body's surface, and keeps what lies inside of those that it
/// crosses. Gives which of the rays in `exits` are no contacts thereby.
pub(crate) struct CutAtSurface<'a, 'b, T: Scalar> {
    pub(crate) direction: &'a Direction<'b, T>,
    pub(crate) samples: &'a SamplePacket<T>,
    pub(crate) exits: Mask,
    /// Of the samples that are left as they are.
    pub(crate) known: &'a mut KnownDistances<T>,
    pub(crate) distances: &'a mut PointDistances<T>,
    /// Scratch memory for the crossings of a ray.
    pub(crate) crossings: &'a mut Vec<Hit<T>>,
    pub(crate) inside: &'a mut Vec<MeasuredSample<T>>,
}

impl<T: Scalar> Kernel<T> for CutAtSurface<'_, '_, T> {
    type Output = Mask;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Mask {
        let Direction { pair, side } = *self.direction;
        let (own, other) = (pair.tracers[side].mesh(), pair.tracers[1 - side]);
        let Self { samples, exits, known, distances, crossings, inside, .. } = self;
        let lanes = |mask: Mask| (0..LANE_COUNT).filter(move |lane| mask >> lane & 1 == 1);
        let mut parts = [Part::none(); LANE_COUNT];
        let no_plane = Plane { point: Vector3::zeros(), inward: Vector3::zeros() };
        let (mut planes, mut plane_counts) = ([[no_plane; MOST_PLANES]; LANE_COUNT], [0; LANE_COUNT]);
        let rounding = rounding(other.mesh());
        let (mut middles, mut reaches) = (samples.lanes.position, [T::zero(); LANE_COUNT]);
        for lane in lanes(samples.cut) {
            parts[lane] = Part::whole(&samples.corner_weights[lane]);
            let corners = own.corners(samples.indices[lane]);
            reaches[lane] = parts[lane].reach(&corners, &vector_in_lane(&middles, lane));
        }
        // Those that another plane may cut, and those of which a plane has cut something off, but not all.
        let (mut open, mut cut, mut ever_cut) = (samples.cut, 0, 0);
        for round in 0..MOST_PLANES {
            other.distances_of_packet::<L>(&middles, open, &reaches, distances);
            let near = open & !L::load(&reaches).is_at_most(L::load(&distances.distances));
            L::select(near, L::load(&distances.distances), L::load(&known.distances)).store(&mut known.distances);
            known.lanes |= near;
            if round == 0 {
                open = near;
            }
            if open == 0 {
                break;
            }
            other.resolve_packet::<L>(distances);
            for lane in lanes(open) {
                let bit = 1 << lane;
                let (middle, corners) = (vector_in_lane(&middles, lane), own.corners(samples.indices[lane]));
                let nearest = other.closest_of_packet(&middle, reaches[lane], lane, distances);
                // After the first cut it is not known on which side the new middle lies.
                let is_inside = (round == 0).then_some(exits & bit != 0);
                let plane = nearest.and_then(|nearest| plane(other.mesh(), &middle, &nearest, is_inside, rounding));
                let plane = plane.filter(|plane| {
                    !pair.options.past_folds || is_border(other, &middle, plane.depth(&middle), crossings)
                });
                match plane.map(|plane| parts[lane].beyond(&corners, rounding, |at| plane.depth(at))) {
                    None | Some(Cut::All) => open &= !bit,
                    Some(Cut::Nothing) => (open, cut) = (open & !bit, cut & !bit),
                    Some(Cut::Some(part)) => {
                        let (middle, _) = part.middle(&corners);
                        (parts[lane], reaches[lane]) = (part, part.reach(&corners, &middle));
                        (0..3).for_each(|axis| middles[axis][lane] = middle[axis]);
                        (cut, ever_cut, known.lanes) = (cut | bit, ever_cut | bit, known.lanes & !bit);
                        planes[lane][plane_counts[lane]] = plane.unwrap_or(no_plane);
                        plane_counts[lane] += 1;
                    }
                }
            }
        }
        let mut crossed = 0;
        for lane in lanes(cut) {
            let (piece, planes) = (samples.piece(lane, own), &planes[lane][..plane_counts[lane]]);
            let corners = own.corners(piece.sample.point.triangle);
            // Where the nearest face changes, the depth bends, and one middle would not do for all.
            for place in 0..planes.len() {
                let part = parts[lane].nearest_to(planes, place, rounding, &corners);
                let Some(mut sample) = part.and_then(|part| sample_of_part(&piece, own, &part)) else { continue };
                if planes.len() > 1 {
                    sample.piece = sample.piece.wrapping_mul(4).wrapping_add(place as u32);
                }
                let distance = (planes.len() == 1 && known.lanes >> lane & 1 == 1).then(|| known.distances[lane]);
                inside.room_for(1).push(MeasuredSample { sample, distance });
                crossed |= exits & 1 << lane;
            }
        }
        known.lanes &= !ever_cut;
        crossed
    }
}

/// Whether the part of a body's surface nearest to a point is its border, and not a fold within it, given how deep the point
/// lies below that part: the surface winds around a point below its border once, and not around one above.
fn is_border<T: Scalar>(other: &Tracer<'_, T>, at: &Vector3<T>, depth: T, crossings: &mut Vec<Hit<T>>) -> bool {
    other.winding_number(at, crossings) == Some(i32::from(depth > T::zero()))
}

/// The sample in the middle of what a plane has left of a piece; `None` where that is no area.
fn sample_of_part<T: Scalar>(piece: &CutPiece<T>, own: &Mesh<T>, part: &Part<T>) -> Option<Sample<T>> {
    let whole = Part::whole(&piece.corner_weights);
    let is_cut = part.count != whole.count || part.weights != whole.weights;
    let area = piece.sample.area * (part.doubled_area() / whole.doubled_area());
    (is_cut && area > T::zero()).then(|| {
        let (position, weights) = part.middle(&own.corners(piece.sample.point.triangle));
        let mut sample = Sample { area, ..piece.sample };
        (sample.point.position, sample.point.weights) = (position, weights.into());
        sample
    })
}

/// The plane beyond which the depth below the surface grows at the point, given on which side of it that is, or else as the
/// surface tells. Of the triangles at the nearest point the one whose plane is the farthest does: that is the one to be cut
/// at first, and the one that knows the side. `None` where nothing tells, or the surface tells otherwise than what is given: a
/// face within another part of its body is no border.
fn plane<T: Scalar>(
    other: &Mesh<T>,
    at: &Vector3<T>,
    nearest: &ClosestPoint<T>,
    is_inside: Option<bool>,
    rounding: T,
) -> Option<Plane<T>> {
    let (point, triangles) = (nearest.position, other.topology().triangles());
    let touched = touched_of(triangles[nearest.triangle as usize], nearest.weights);
    let around = other.topology().triangles_around(touched[0]).iter();
    let meeting =
        around.filter(|&&triangle| touched.iter().all(|vertex| triangles[triangle as usize].contains(vertex)));
    let planes =
        meeting.filter_map(|&triangle| Some(Plane { point, inward: direction(&-other.scaled_normal(triangle))? }));
    let farther =
        |best: Plane<T>, plane: Plane<T>| if plane.depth(at).abs() > best.depth(at).abs() { plane } else { best };
    let plane = planes.reduce(farther)?;
    let depth = plane.depth(at);
    let is_known_otherwise = |is_inside| if is_inside { depth < -rounding } else { depth > rounding };
    if is_inside.is_some_and(is_known_otherwise) {
        return None;
    }
    let within_face = nearest.weights.iter().all(|&weight| weight > T::zero());
    match direction(&(at - point)) {
        Some(away) if !within_face && depth > rounding => Some(Plane { point, inward: away }),
        _ => Some(plane),
    }
}
