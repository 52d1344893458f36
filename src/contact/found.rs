// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

use super::pair::Direction;
use super::samples::{VERTEX, WHOLE, vertex_point};
use super::{Contact, ContactKind, SurfacePoint};
use crate::math::{LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors, cosine};
use crate::memory::Room;
use crate::mesh::{Mesh, NormalLanes};
use crate::octree::PacketHits;
use crate::ray::RayPacket;

/// What the rays of a packet start from.
pub(super) struct Origins<T: Scalar> {
    /// Else they start from points on triangles.
    pub(super) are_vertices: bool,
    /// Vertices, or triangles.
    pub(super) indices: [u32; LANE_COUNT],
    /// Of the points on triangles.
    pub(super) weights: [[T; LANE_COUNT]; 3],
    /// As [`Contact::piece`].
    pub(super) pieces: [u32; LANE_COUNT],
}

/// The rays of a packet, what they start from and where they end.
pub(super) struct Found<'a, T: Scalar> {
    pub(super) packet: &'a RayPacket<T>,
    pub(super) samples: &'a NormalLanes<T>,
    pub(super) origins: &'a Origins<T>,
    pub(super) hits: &'a PacketHits<T>,
    pub(super) cos_alpha: [T; LANE_COUNT],
}

impl<T: Scalar> Origins<T> {
    pub(super) fn new(are_vertices: bool) -> Self {
        let piece = if are_vertices { VERTEX } else { WHOLE };
        Self {
            are_vertices,
            indices: [0; LANE_COUNT],
            weights: [[T::zero(); LANE_COUNT]; 3],
            pieces: [piece; LANE_COUNT],
        }
    }

    /// The triangles at each ray's origin are those that have all of these vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn touched(&self, own: &Mesh<T>) -> [[u32; 3]; LANE_COUNT] {
        let mut touched = [[0; 3]; LANE_COUNT];
        for lane in 0..LANE_COUNT {
            let index = self.indices[lane];
            touched[lane] = if self.are_vertices { [index; 3] } else { own.topology().triangles()[index as usize] };
        }
        touched
    }
}

impl<T: Scalar> Found<'_, T> {
    /// Makes contacts of the accepted rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn accept<L: Lanes<T>>(
        &self,
        mut accepted: Mask,
        of: &Direction<'_, T>,
        contacts: &mut Vec<Contact<T>>,
    ) {
        let Direction { pair, side } = *of;
        let [own, collided] = [pair.tracers[side].mesh(), pair.tracers[1 - side].mesh()];
        let directions = Vectors::<T, L>::load(&self.packet.direction);
        let mut ends = [[T::zero(); LANE_COUNT]; 3];
        Vectors::load(&self.packet.origin).add(directions.scaled(L::load(&self.hits.t))).store(&mut ends);
        let hit_weights = &self.hits.weights;
        contacts.room_for(accepted.count_ones() as usize);
        while accepted != 0 {
            let lane = accepted.trailing_zeros() as usize;
            accepted &= accepted - 1;
            let triangle = self.hits.triangle[lane];
            contacts.push(Contact {
                kind: ContactKind::Ray,
                piece: self.origins.pieces[lane],
                colliding: pair.bodies[side],
                collided: pair.bodies[1 - side],
                p1: self.origin(lane, own),
                p2: SurfacePoint {
                    triangle,
                    vertices: collided.topology().triangles()[triangle as usize],
                    weights: [hit_weights[0][lane], hit_weights[1][lane], hit_weights[2][lane]],
                    position: vector(&ends, lane),
                },
                direction: vector(&self.packet.direction, lane),
                depth: self.hits.t[lane],
                cos_alpha: self.cos_alpha[lane],
                area: self.samples.area[lane],
            });
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn origin(&self, lane: usize, own: &Mesh<T>) -> SurfacePoint<T> {
        let Origins { are_vertices, indices, weights, .. } = self.origins;
        let index = indices[lane];
        if *are_vertices {
            return vertex_point(own, index);
        }
        SurfacePoint {
            triangle: index,
            vertices: own.topology().triangles()[index as usize],
            weights: [weights[0][lane], weights[1][lane], weights[2][lane]],
            position: vector(&self.packet.origin, lane),
        }
    }
}

/// The cosines between rays and the normals where they end, of those in `asked`; zero where a triangle has no normal.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn cosines<T: Scalar, L: Lanes<T>>(
    packet: &RayPacket<T>,
    hits: &PacketHits<T>,
    asked: Mask,
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
    let mut left = !is_safe & asked;
    while left != 0 {
        let lane = left.trailing_zeros() as usize;
        left &= left - 1;
        cos_alpha[lane] = one_cosine(packet, hits, lane, collided);
    }
    cos_alpha
}

/// The lane's cosine with all care that too large and too small squares need.
#[cold]
fn one_cosine<T: Scalar>(packet: &RayPacket<T>, hits: &PacketHits<T>, lane: usize, collided: &Mesh<T>) -> T {
    cos_alpha(collided, hits.triangle[lane], &vector(&packet.direction, lane))
}

/// The cosine between a ray and the normal of the triangle where it ends; zero where that has none.
pub(super) fn cos_alpha<T: Scalar>(collided: &Mesh<T>, triangle: u32, ray: &Vector3<T>) -> T {
    cosine(&collided.scaled_normal(triangle), ray).clamp(T::zero(), T::one())
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn vector<T: Scalar>([x, y, z]: &[[T; LANE_COUNT]; 3], lane: usize) -> Vector3<T> {
    Vector3::new(x[lane], y[lane], z[lane])
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn set_lane<T: Scalar>([x, y, z]: &mut [[T; LANE_COUNT]; 3], lane: usize, vector: &Vector3<T>) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}
