use super::wide::Candidates;
use super::{Cells, Tracer};
use crate::math::{LANE_COUNT, Lanes, Scalar, Vector3};
use crate::ray::{Hit, Ray, RayPacket};

impl<T: Scalar> Tracer<'_, T> {
    /// How often the surface winds around a point: 0 outside, 1 inside, more where it folds over itself, negative where it is
    /// inside out. `None` where the surface is open, so that it has no inside, and where the point is not finite. On the
    /// surface, or so near that rounding decides, it is the number of one of the sides. `crossings` is room for a list.
    pub fn winding_number(&self, point: &Vector3<T>, crossings: &mut Vec<Hit<T>>) -> Option<i32> {
        if self.mesh().is_open() || !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        if !self.mesh().aabb().contains(point) {
            return Some(0);
        }
        // Any direction will do: edges and vertices on the way are counted as if the ray passed beside them.
        self.crossings(&Ray::new(*point, Vector3::z()), crossings);
        Some(crossings.iter().map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum())
    }

    /// How often the surface winds around the start of each ray of a packet, whose ends lie outside, not counting the
    /// triangles that have all vertices in its `touched`. `crossings` is room for a list.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn windings_of_packet<L: Lanes<T>>(
        &self,
        packet: &RayPacket<T>,
        touched: &[[u32; 3]; LANE_COUNT],
        list: &mut Candidates<T>,
        crossings: &mut Vec<Hit<T>>,
        numbers: &mut [i32; LANE_COUNT],
    ) {
        match self.cells {
            Cells::Wide(cells) => cells.windings::<L>(self.mesh(), packet, touched, list, numbers),
            Cells::Classic(_) => self.windings_one_by_one(packet, touched, crossings, numbers),
        }
    }

    fn windings_one_by_one(
        &self,
        packet: &RayPacket<T>,
        touched: &[[u32; 3]; LANE_COUNT],
        crossings: &mut Vec<Hit<T>>,
        numbers: &mut [i32; LANE_COUNT],
    ) {
        let triangles = self.mesh().topology().triangles();
        for lane in (0..LANE_COUNT).filter(|lane| packet.present >> lane & 1 == 1) {
            self.crossings(&packet.ray(lane), crossings);
            let is_own = |hit: &Hit<T>| touched[lane].iter().all(|v| triangles[hit.triangle as usize].contains(v));
            let counted = crossings.iter().filter(|hit| !is_own(hit));
            numbers[lane] = counted.map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum();
        }
    }
}
