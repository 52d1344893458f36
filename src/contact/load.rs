use super::Contact;
use crate::math::{LANE_COUNT, Lanes, Scalar, Vector3, Vectors, length};
use crate::mesh::NormalLanes;

/// How much surface one direction of a pair casts from, and how much of it cancels out.
#[derive(Clone, Copy, Debug)]
pub(super) struct CastSurface<T: Scalar> {
    area: T,
    vector: Vector3<T>,
}

impl<T: Scalar> Default for CastSurface<T> {
    fn default() -> Self {
        Self { area: T::zero(), vector: Vector3::zeros() }
    }
}

/// [`CastSurface`] in sixteen sums.
#[repr(C, align(64))]
pub(super) struct CastSurfaceLanes<T: Scalar> {
    area: [T; LANE_COUNT],
    vector: [[T; LANE_COUNT]; 3],
}

impl<T: Scalar> CastSurfaceLanes<T> {
    pub(super) fn new() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { area: zeros, vector: [zeros; 3] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn add<L: Lanes<T>>(&mut self, samples: &NormalLanes<T>) {
        let zero = L::splat(T::zero());
        let area = L::select(samples.found, L::load(&samples.area), zero);
        // What has no area may have no normal either.
        let normal = Vectors::select(samples.found, Vectors::load(&samples.normal), Vectors::zeros());
        L::load(&self.area).add(area).store(&mut self.area);
        Vectors::load(&self.vector).add(normal.scaled(area)).store(&mut self.vector);
    }

    pub(super) fn total(&self) -> CastSurface<T> {
        let sum = |lanes: &[T; LANE_COUNT]| lanes.iter().fold(T::zero(), |sum, &part| sum + part);
        let [x, y, z] = &self.vector;
        CastSurface { area: sum(&self.area), vector: Vector3::new(sum(x), sum(y), sum(z)) }
    }
}

impl<T: Scalar> CastSurface<T> {
    pub(super) fn add(&mut self, normal: &Vector3<T>, area: T) {
        self.area += area;
        self.vector += normal * area;
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.area += other.area;
        self.vector += other.vector;
    }

    /// How much of the pair's load this direction should carry, beside the other's number.
    ///
    /// Either direction alone integrates the pressure over the overlapped surface, but not equally well. Rays of a
    /// curved body into a flat one give exactly the force of Archimedes, since depth · cos α is then the depth across
    /// the face; the flat body's own rays are columns of that depth, lessened once more by cos α. So what counts first
    /// is how much the overlapped surface turns, weighted by depth: 1 − |Σ a δ d| / Σ a δ. Then, between two flat faces,
    /// the body whose edges lie in the overlap: its faces are summed exactly, while the other's rays only count points
    /// beneath it. The last term leaves equal bodies equal shares. The factor Σ a δ makes all continuous: contacts
    /// appear with δ = 0.
    pub(super) fn claim(&self, contacts: &[Contact<T>]) -> T {
        let mut pressure = T::zero();
        let mut vector = Vector3::zeros();
        for contact in contacts {
            let share = contact.area * contact.depth;
            pressure += share;
            vector += contact.direction * share;
        }
        if pressure > T::zero() {
            let little = T::of(1.0 / 256.0);
            let turning = |vector: &Vector3<T>, whole: T| T::one() - length(vector) / whole;
            pressure * (turning(&vector, pressure) + little * turning(&self.vector, self.area) + little * little)
        } else {
            T::zero()
        }
    }
}

/// Scales the contacts' areas so that the two directions of a pair together carry the load once, as they claim it. A
/// direction whose rays see nothing, such as that of a coarse floor cast from its corners, leaves all to the other.
pub(super) fn share_load<T: Scalar>(claims: [T; 2], directions: [&mut [Contact<T>]; 2]) {
    let sum = claims[0] + claims[1];
    for (claim, contacts) in claims.into_iter().zip(directions) {
        let share = if sum > T::zero() { claim / sum } else { T::of(0.5) };
        contacts.iter_mut().for_each(|contact| contact.area *= share);
    }
}
