//! What a contact counts: its pressure, its area, and the share of the load that its direction carries.

pub(crate) mod distance;
pub(crate) mod shares;

use crate::bvh::PacketHits;
use crate::contact::pair::Direction;
use crate::contact::point_pair::{Contact, ContactKind, SpreadNumber, SurfacePoint};
use crate::contact::quadrature::Sample;
use crate::contact::quadrature::packet::SamplePacket;
use crate::contact::trace::Rays;
use crate::math::{Scalar, Vector3, cosine};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, lanes_of, vector_in_lane};
use crate::triangle::{Hit, RayPacket};

/// Makes contacts of the accepted rays.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn accept<T: Scalar, L: Lanes<T>>(
    kind: ContactKind,
    of: &Direction<'_, T>,
    samples: &SamplePacket<T>,
    rays: &Rays<T>,
    accepted: Mask,
    cos_alpha: &[T; LANE_COUNT],
    contacts: &mut Vec<Contact<T>>,
) {
    if accepted == 0 {
        return;
    }
    let Direction { pair, side } = *of;
    let [own, collided] = [pair.tracers[side].mesh(), pair.tracers[1 - side].mesh()];
    let bodies = [pair.bodies[side], pair.bodies[1 - side]];
    let triangles = samples.triangles::<L>(own);
    let mut lanes = [0; LANE_COUNT];
    let mut count = 0;
    for lane in lanes_of(accepted) {
        lanes[count] = lane as u8;
        count += 1;
    }
    // Of an iterator that knows its length, `extend` writes each contact straight into the list.
    contacts.room_for(count).extend((0..count).map(|index| {
        let lane = usize::from(lanes[index]) % LANE_COUNT;
        let direction = vector_in_lane(&rays.packet.direction, lane);
        let sample = samples.sample(triangles[lane], lane, own);
        // Where the middle of a curved patch lies deeper than its ray is long, the area grows instead of the cosine.
        let more = cos_alpha[lane].max(T::one());
        let sample = Sample { area: sample.area * more, ..sample };
        make_contact(kind, bodies, &sample, direction, collided, &rays.hits.hit(lane), cos_alpha[lane] / more)
    }));
}

/// The contact of a sample whose ray leaves the other body there; all contacts are made here.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn make_contact<T: Scalar>(
    kind: ContactKind,
    [colliding, collided]: [u32; 2],
    sample: &Sample<T>,
    direction: Vector3<T>,
    mesh: &Mesh<T>,
    hit: &Hit<T>,
    cos_alpha: T,
) -> Contact<T> {
    let p2 = SurfacePoint {
        triangle: hit.triangle,
        vertices: mesh.topology().triangles()[hit.triangle as usize],
        weights: hit.weights,
        position: sample.point.position + direction * hit.t,
    };
    let (p1, depth, area, piece) = (sample.point, hit.t, sample.area, sample.piece);
    let spread = SpreadNumber::default();
    Contact { kind, colliding, collided, piece, p1, p2, direction, depth, cos_alpha, area, spread }
}

/// The cosines between rays and the normals where they end, in these lanes; zero where a triangle has no normal.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn cosines<T: Scalar, L: Lanes<T>>(
    packet: &RayPacket<T>,
    hits: &PacketHits<T>,
    lanes: Mask,
    collided: &Mesh<T>,
) -> [T; LANE_COUNT] {
    let mut vertices = [[0; LANE_COUNT]; 3];
    for lane in 0..LANE_COUNT {
        let [a, b, c] = collided.topology().triangles()[hits.triangle[lane] as usize];
        (vertices[0][lane], vertices[1][lane], vertices[2][lane]) = (a, b, c);
    }
    let a = collided.gather::<L>(&vertices[0]);
    let b = collided.gather::<L>(&vertices[1]);
    let c = collided.gather::<L>(&vertices[2]);
    let scaled = b.sub(a).cross(c.sub(a));
    let square = scaled.dot(scaled);
    let along = scaled.dot(Vectors::load(&packet.direction)).div(square.sqrt());
    let mut cos_alpha = [T::zero(); LANE_COUNT];
    along.larger(L::splat(T::zero())).smaller(L::splat(T::one())).store(&mut cos_alpha);
    let is_safe = L::splat(T::SAFE_SQUARES.0).is_at_most(square) & square.is_at_most(L::splat(T::SAFE_SQUARES.1));
    for lane in lanes_of(!is_safe & lanes) {
        cos_alpha[lane] = one_cosine(packet, hits, lane, collided);
    }
    cos_alpha
}

/// The lane's cosine, where the square of the normal is too large or too small.
#[cold]
fn one_cosine<T: Scalar>(packet: &RayPacket<T>, hits: &PacketHits<T>, lane: usize, collided: &Mesh<T>) -> T {
    cos_alpha(collided, hits.triangle[lane], &vector_in_lane(&packet.direction, lane))
}

/// The cosine between a ray and the normal of the triangle where it ends; zero where that has none.
pub(crate) fn cos_alpha<T: Scalar>(collided: &Mesh<T>, triangle: u32, ray: &Vector3<T>) -> T {
    cosine(&collided.scaled_normal(triangle), ray).clamp(T::zero(), T::one())
}
