use crate::bvh::rays::packet::answer::{Answer, excluded_around};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes, Mask};
use crate::triangle::{HitLanes, RayPacket, ShearedRay};

/// How often the mesh winds around where each ray starts: all its crossings, +1 for an exit and −1 for an entry.
pub(crate) struct Windings<'a, T: Scalar> {
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) packet: &'a RayPacket<T>,
    pub(crate) touched: &'a [[u32; LANE_COUNT]; 3],
    pub(crate) numbers: &'a mut [i32; LANE_COUNT],
}

impl<T: Scalar> Answer<T> for Windings<'_, T> {
    const EXITS_ONLY: bool = false;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn end(&self) -> &[T; LANE_COUNT] {
        &self.packet.t_max
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn settled(&self) -> Mask {
        0
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<L: Lanes<T>>(&self, ray: usize, vertices: &[u32; LANE_COUNT], corners: &[[u8; LANE_COUNT]; 3]) -> Mask {
        excluded_around::<T, L>(self.touched.each_ref().map(|vertices| vertices[ray]), vertices, corners)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(&mut self, ray: usize, triangle: u32, found: &HitLanes<T>, lane: usize) {
        let mut is_on_border = false;
        for weights in &found.weights {
            is_on_border |= weights[lane] == T::zero();
        }
        if !is_on_border || self.crosses(ray, triangle) {
            self.numbers[ray] += if found.exits >> lane & 1 == 1 { 1 } else { -1 };
        }
    }
}

impl<T: Scalar> Windings<'_, T> {
    /// Whether a ray through the border of a triangle crosses this triangle and not its neighbour.
    #[cold]
    fn crosses(&self, ray: usize, triangle: u32) -> bool {
        ShearedRay::new(&self.packet.ray(ray)).crossing(&self.mesh.corners(triangle), triangle).is_some()
    }
}
