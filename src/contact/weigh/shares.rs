use crate::contact::options::ContactLaw;
use crate::contact::point_pair::Contact;
use crate::math::{Scalar, Vector3, length};
use crate::mesh::NormalLanes;
use crate::simd::{LANE_COUNT, Lanes, Vectors};

/// Unit vectors, each with a weight: the sum of the weights, and how much of it is left when the vectors cancel out.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turning<T: Scalar> {
    whole: T,
    vector: Vector3<T>,
}

impl<T: Scalar> Turning<T> {
    fn add(&mut self, direction: &Vector3<T>, weight: T) {
        self.whole += weight;
        self.vector += direction * weight;
    }

    fn merge(&mut self, other: &Self) {
        self.whole += other.whole;
        self.vector += other.vector;
    }

    /// 0 where all vectors are one, 1 where they cancel out.
    fn turned_fraction(&self) -> T {
        T::one() - length(&self.vector) / self.whole
    }
}

/// The surface that casts, in sixteen sums.
#[repr(C, align(64))]
pub(crate) struct CastSurfaceLanes<T: Scalar> {
    area: [T; LANE_COUNT],
    vector: [[T; LANE_COUNT]; 3],
}

impl<T: Scalar> CastSurfaceLanes<T> {
    pub(crate) fn new() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { area: zeros, vector: [zeros; 3] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn add<L: Lanes<T>>(&mut self, samples: &NormalLanes<T>) {
        let zero = L::splat(T::zero());
        let area = L::select(samples.found, L::load(&samples.area), zero);
        // What has no area may have no normal either.
        let normal = Vectors::select(samples.found, Vectors::load(&samples.normal), Vectors::zeros());
        L::load(&self.area).add(area).store(&mut self.area);
        Vectors::load(&self.vector).add(normal.scaled(area)).store(&mut self.vector);
    }

    pub(crate) fn total(&self) -> Turning<T> {
        let sum = |lanes: &[T; LANE_COUNT]| lanes.iter().fold(T::zero(), |sum, &part| sum + part);
        let [x, y, z] = &self.vector;
        Turning { whole: sum(&self.area), vector: Vector3::new(sum(x), sum(y), sum(z)) }
    }
}

/// The surface that one direction of a pair casts from, and what its contacts carry.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CastLoad<T: Scalar> {
    /// The normals of the surface that casts, by area.
    surface: Turning<T>,
    /// The contacts' directions, by area · depth, or by area · pressure.
    pressure: Turning<T>,
}

impl<T: Scalar> CastLoad<T> {
    pub(crate) fn new(surface: Turning<T>, contacts: &[Contact<T>], law: ContactLaw) -> Self {
        let mut pressure = Turning::default();
        for contact in contacts {
            let depth = match law {
                ContactLaw::Pressure => contact.depth * contact.cos_alpha,
                ContactLaw::RayLength => contact.depth,
            };
            pressure.add(&contact.direction, contact.area * depth);
        }
        Self { surface, pressure }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.surface.merge(&other.surface);
        self.pressure.merge(&other.pressure);
    }

    /// How strongly this direction should carry the pair's load; the two shares are in proportion to the claims.
    ///
    /// Either direction alone integrates the pressure over the overlapped surface, but not equally well. Rays of a
    /// curved body into a flat one give exactly the force of Archimedes, since depth · cos α is then the depth below
    /// the face. The flat body's own rays give columns of that depth, multiplied by cos α a second time. So what counts
    /// first is how much the overlapped surface turns, weighted by depth: 1 − |Σ a δ d| / Σ a δ. Between two flat faces
    /// it is which body has edges in the overlap: its faces are summed exactly, while the other body's rays only count
    /// points beneath it. The last term gives equal bodies equal shares. The factor Σ a δ makes all this continuous,
    /// since contacts appear with δ = 0.
    fn claim(&self) -> T {
        if self.pressure.whole > T::zero() {
            let little = T::of(1.0 / 256.0);
            let turning = self.pressure.turned_fraction() + little * self.surface.turned_fraction();
            self.pressure.whole * (turning + little * little)
        } else {
            T::zero()
        }
    }
}

/// The factors that scale the areas of each direction's contacts, so that both together carry the load once, in proportion
/// to their claims. A direction without contacts, such as that of a coarse floor whose rays start at its corners, leaves
/// all to the other.
pub(crate) fn shares<T: Scalar>(loads: &[CastLoad<T>; 2]) -> [T; 2] {
    let claims = loads.each_ref().map(CastLoad::claim);
    let sum = claims[0] + claims[1];
    claims.map(|claim| if sum > T::zero() { claim / sum } else { T::of(0.5) })
}

/// Scales the contacts of both directions by what each carries; the second's begin at `middle`.
pub(crate) fn scale_contacts<T: Scalar>(shares: [T; 2], contacts: &mut [Contact<T>], middle: usize) {
    let (first, second) = contacts.split_at_mut(middle);
    for (share, contacts) in shares.into_iter().zip([first, second]) {
        contacts.iter_mut().for_each(|contact| contact.area *= share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::test_contact::contact;
    use std::f64::consts::TAU;

    fn turning(parts: &[([f64; 3], f64)]) -> Turning<f64> {
        let mut turning = Turning::default();
        parts.iter().for_each(|&(direction, weight)| turning.add(&Vector3::from(direction), weight));
        turning
    }

    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const MINUS_X: [f64; 3] = [-1.0, 0.0, 0.0];

    #[test]
    fn what_turns_is_what_is_lost_of_the_sum() {
        for (parts, expected) in [
            (vec![(X, 3.0)], 0.0),
            (vec![(X, 3.0), (X, 0.5)], 0.0),
            (vec![(X, 2.0), (MINUS_X, 2.0)], 1.0),
            (vec![(X, 3.0), (MINUS_X, 1.0)], 0.5),
            (vec![(X, 3.0), (Y, 4.0)], 1.0 - 5.0 / 7.0),
        ] {
            assert!((turning(&parts).turned_fraction() - expected).abs() < 1e-15, "{parts:?}");
            let (first, rest) = parts.split_at(1);
            let mut merged = turning(first);
            merged.merge(&turning(rest));
            assert_eq!(merged.turned_fraction(), turning(&parts).turned_fraction());
        }
    }

    /// What a direction's rays carry, each from a sample by its normal, area, depth and cos α; and how much of that is along x.
    fn cast(samples: &[([f64; 3], [f64; 3])]) -> (CastLoad<f64>, f64) {
        let (mut surface, mut contacts, mut along) = (Turning::default(), Vec::new(), 0.0);
        for &(normal, [area, depth, cos_alpha]) in samples {
            surface.add(&Vector3::from(normal), area);
            contacts.push(contact(0, [0.0; 3], normal, [area, depth, cos_alpha]));
            along += area * depth * cos_alpha * normal[0];
        }
        (CastLoad::new(surface, &contacts, ContactLaw::RayLength), along)
    }

    /// The force of both directions, as they share it, is that of Archimedes, the volume below the face of a half space,
    /// though the rays of one direction alone miss it: of a ball, into which those of the face lead at an angle; and of a box
    /// with its sides, beneath which those of a coarse face count points.
    #[test]
    fn shared_loads_push_as_archimedes_says() {
        for half_angle in [0.1, 0.5, 1.0, 1.5f64] {
            let (rings, around, lowest) = (200, 16, half_angle.cos());
            let (mut of_ball, mut of_face) = (Vec::new(), Vec::new());
            for (ring, turn) in (0..rings).flat_map(|ring| (0..around).map(move |turn| (ring, turn))) {
                // Rings of equal areas.
                let x = 1.0 - (1.0 - lowest) * (f64::from(ring) + 0.5) / f64::from(rings);
                let (sin, cos) = (TAU * f64::from(turn) / f64::from(around)).sin_cos();
                let (area, beside) = (TAU * (1.0 - lowest) / f64::from(rings * around), (1.0 - x * x).sqrt());
                of_ball.push(([x, beside * cos, beside * sin], [area, (x - lowest) / x, x]));
                of_face.push((MINUS_X, [area * x, x - lowest, x]));
            }
            let [(ball, by_ball), (face, by_face)] = [cast(&of_ball), cast(&of_face)];
            let volume = TAU / 6.0 * (1.0 - lowest).powi(2) * (2.0 + lowest);
            let [share, rest] = shares(&[ball, face]);
            let force = share * by_ball - rest * by_face;
            assert!((force / volume - 1.0).abs() < 1e-3, "{half_angle}: {force} for {volume}");
            assert!(half_angle < 1.0 || -by_face < 0.9 * volume, "{half_angle}: {by_face} for {volume}");
        }
        for depth in [0.1, 0.5] {
            let sides = [Y, [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]].map(|side| (side, [depth, 0.0, 0.0]));
            let (bottom, point) = ([(X, [1.0, depth, 1.0])], (MINUS_X, [0.16, depth, 1.0]));
            let [(edged, by_box), (face, by_face)] = [cast(&[&bottom[..], &sides].concat()), cast(&[point; 9])];
            let [share, rest] = shares(&[edged, face]);
            assert!(
                ((share * by_box - rest * by_face) / depth - 1.0).abs() < 1e-2 && by_face < -1.4 * depth,
                "{depth}"
            );
        }
    }

    #[test]
    fn equal_loads_are_shared_equally_and_none_carries_nothing() {
        let turned = [(X, [1.5, 1.0, 0.5]), (Y, [2.0, 0.5, 1.0])];
        let loads = [cast(&turned).0, cast(&turned[..1]).0, CastLoad::default()];
        assert!(loads.iter().all(|&load| shares(&[load, load]) == [0.5; 2]));
        for load in &loads[..2] {
            assert_eq!(shares(&[*load, loads[2]]), [1.0, 0.0]);
        }
        let [share, rest] = shares(&[loads[0], loads[1]]);
        assert!((share + rest - 1.0).abs() < 1e-15);
    }

    /// Rays count by area · depth, whatever the angle, and pressure by area · distance.
    #[test]
    fn contacts_press_by_area_and_depth() {
        let contacts = [contact(0, X, X, [3.0, 0.5, 0.1]), contact(0, Y, Y, [0.5, 4.0, 0.9])];
        let by_distance = CastLoad::new(Turning::default(), &contacts, ContactLaw::Pressure);
        assert!((by_distance.pressure.whole - (0.15 + 1.8)).abs() < 1e-15);
        let load = CastLoad::new(turning(&[(X, 1.0)]), &contacts, ContactLaw::RayLength);
        assert_eq!((load.pressure.whole, load.pressure.vector), (3.5, Vector3::new(1.5, 2.0, 0.0)));
        let mut contacts = [contact(0, X, X, [3.0, 0.5, 0.1]), contact(1, Y, Y, [2.0, 4.0, 0.9])];
        scale_contacts(shares(&[load, CastLoad::default()]), &mut contacts, 1);
        assert_eq!(contacts.map(|contact| contact.area), [3.0, 0.0]);
    }
}
