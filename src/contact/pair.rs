//! Two bodies whose boxes overlap, as plain data: what each step of a detection is given.

use crate::contact::fixed_shares::fixed_shares;
use crate::contact::options::{ContactLaw, DetectionOptions};
use crate::contact::quadrature::Sampling;
use crate::math::{Aabb, Scalar, Vector3, direction, margins};
use crate::mesh::Mesh;
use crate::query::Tracer;
use crate::triangle::Ray;

/// The overlap box of two boxes, and the same with a margin: points on a face of one mesh that lies on the overlap box's
/// own face must not fall outside by rounding.
pub(crate) fn overlap_region<T: Scalar>(a: &Aabb<T>, b: &Aabb<T>) -> (Aabb<T>, Aabb<T>) {
    let overlap = a.intersection(b);
    let largest = overlap.lower.amax().max(overlap.upper.amax());
    (overlap, overlap.grown(largest * margins::margin(margins::SAMPLE_IN_BOX)))
}

/// Most nearest points of the surface lie no farther beyond an overlap box than this fraction of the box's shortest side.
const BEYOND_OVERLAP: f64 = 0.5;

/// Where most rays end, and most distances, of a pair with these boxes.
pub(crate) fn reach_region<T: Scalar>(a: &Aabb<T>, b: &Aabb<T>, law: ContactLaw) -> Aabb<T> {
    let (overlap, region) = overlap_region(a, b);
    match law {
        ContactLaw::Pressure => region.grown((overlap.upper - overlap.lower).min() * T::of(BEYOND_OVERLAP)),
        ContactLaw::RayLength => region,
    }
}

/// Two bodies whose boxes overlap.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'a, T: Scalar> {
    pub(crate) bodies: [u32; 2],
    pub(crate) tracers: [&'a Tracer<'a, T>; 2],
    pub(crate) overlap: &'a Aabb<T>,
    /// The overlap box with a margin.
    pub(crate) region: &'a Aabb<T>,
    pub(crate) options: &'a DetectionOptions<T>,
    pub(crate) may_escape: bool,
    /// How many samples this pair has, over the usual number.
    pub(crate) sample_fraction: T,
    /// Where the rays of either body end.
    pub(crate) ray_regions: [Aabb<T>; 2],
    /// Whether only those rays count that leave the other body before their own.
    pub(crate) hides_behind_own_surface: bool,
    /// The share of the load that each direction carries; `None`: found from the contacts.
    pub(crate) fixed_shares: Option<[T; 2]>,
}

/// One direction of a pair: the rays of one body through the other. Algorithm 1 of the paper.
pub(crate) struct Direction<'a, T: Scalar> {
    pub(crate) pair: &'a Pair<'a, T>,
    /// Which body casts.
    pub(crate) side: usize,
}

impl<'a, T: Scalar> Pair<'a, T> {
    /// Two bodies with their overlap box, as it is and with a margin.
    pub(crate) fn new(
        bodies: [u32; 2],
        tracers: [&'a Tracer<'a, T>; 2],
        [overlap, region]: [&'a Aabb<T>; 2],
        options: &'a DetectionOptions<T>,
    ) -> Self {
        let meshes = tracers.map(|tracer| tracer.mesh());
        // A sheet has no inside, so only the point's own body can tell whether the point lies behind the sheet.
        let hides_behind_own_surface = options.law == ContactLaw::RayLength || meshes.iter().any(|mesh| mesh.is_open());
        // A ray that leaves its own body first may end outside that body's box.
        let ray_regions = if hides_behind_own_surface {
            [*region; 2]
        } else {
            [1, 0].map(|side| overlap_region(meshes[side].aabb(), meshes[side].aabb()).1)
        };
        // With rays from vertices a coarse flat body may cast nothing. Then the other direction must carry all of the load.
        let is_fixed = !hides_behind_own_surface && options.sampling != Sampling::Vertices;
        let fixed_shares = is_fixed.then(|| fixed_shares(meshes.map(Mesh::roundness)));
        let (may_escape, sample_fraction) = (true, T::one());
        Self {
            bodies,
            tracers,
            overlap,
            region,
            options,
            may_escape,
            sample_fraction,
            ray_regions,
            hides_behind_own_surface,
            fixed_shares,
        }
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Whether forces grow with the distance to the other body's surface, at all points inside.
    pub(crate) fn measures_distances(&self) -> bool {
        self.options.law == ContactLaw::Pressure && !self.hides_behind_own_surface
    }

    /// How far apart the unknowns of the finer carrier are; 0 where nothing moves either body, since their contacts are for
    /// the host alone.
    pub(crate) fn carrier_spacing(&self) -> T {
        let [first, second] = self.tracers.map(|tracer| tracer.mesh().carrier_spacing());
        let finer = first.min(second);
        if finer < T::INFINITY { finer } else { T::zero() }
    }

    /// From the middle of the second body's box to that of the first; where they are the same, along an axis.
    pub(crate) fn line_of_centres(&self) -> Vector3<T> {
        let [first, second] = self.tracers.map(|tracer| tracer.mesh().aabb().centre());
        direction(&(first - second)).unwrap_or_else(|| self.of_first(Vector3::x()))
    }

    /// Turns a direction of the body that comes first in space into one of the pair's first body. Where one way is as good as
    /// its opposite, bodies therefore go the same ways whatever their numbers, and since all pairs share this order, no three
    /// bodies of a pile chase one another in a circle. Boxes are compared by their corners; with equal boxes the pair's first
    /// body comes first.
    pub(crate) fn of_first(&self, away: Vector3<T>) -> Vector3<T> {
        let [first, second] = self.tracers.map(|tracer| {
            let Aabb { lower, upper } = tracer.mesh().aabb();
            [lower.x, lower.y, lower.z, upper.x, upper.y, upper.z]
        });
        if first <= second { away } else { -away }
    }

    /// The ray from a point of one body along which it leaves the other, when its first body goes `away`.
    pub(crate) fn ray_out(&self, side: usize, origin: Vector3<T>, away: &Vector3<T>) -> Ray<T> {
        let other = self.tracers[1 - side].mesh().aabb();
        let largest = other.lower.amax().max(other.upper.amax());
        let ray = Ray::new(origin, if side == 0 { *away } else { -away });
        ray.until(ray.exit_from(&other.grown(largest * margins::margin(margins::SAMPLE_IN_BOX))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::test_contact::with_pair;
    use crate::mesh::test_mesh::boxes;

    #[test]
    fn the_line_of_centres_leads_to_the_first_body() {
        let around = |[x, y, z]: [f64; 3]| boxes(&[[[x - 1.0, y - 2.0, z - 0.5], [x + 1.0, y + 2.0, z + 0.5]]]);
        let line = |first, second| {
            let meshes = [&around(first), &around(second)];
            with_pair(meshes, &DetectionOptions::paper(), |pair| pair.line_of_centres())
        };
        assert_eq!(line([1.0, 2.0, 3.0], [4.0, 6.0, 3.0]), Vector3::new(-0.6, -0.8, 0.0));
        assert_eq!(line([1.0, 2.0, 3.0], [1.0, 2.0, 2.0]), Vector3::z());
        assert_eq!(line([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]), Vector3::x());
    }
}
