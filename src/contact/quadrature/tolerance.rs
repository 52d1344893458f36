use crate::contact::list::ContactList;
use crate::contact::pair::Pair;
use crate::contact::point_pair::Contact;
use crate::contact::quadrature::cutter::largest_face;
use crate::math::{Scalar, Vector3, length};

// These numbers were chosen together, by overlaps of tori, balls, thorns, boxes and animals: docs/architecture.md, *Tuned
// constants*. `tests/library/contact/tolerance.rs` holds the rule to the tolerance.

/// The first try has this many rays on the overlap box's largest face, each further one four times as many.
const FEWEST_RAYS: f64 = 32.0;
/// A try is made only if at most one triangle in this many casts. A finer try would save little, and it would share the error
/// of the one before: with patches of two or three triangles that is where in the patch the ray stands.
const LARGEST_PART: usize = 3;
/// Two tries may agree by chance, so the coarser one must have at least this many contacts, and so many that each carries no
/// larger part of the force than the tolerance.
const FEWEST_CONTACTS: usize = 48;
/// Two tries in a row must agree within this part of the tolerance,
const AT_ONCE: f64 = 0.6;
/// or within this part if the two before agreed
const AT_LAST: f64 = 0.9;
/// within this many times the tolerance.
const BEFORE: f64 = 3.0;
/// Four times the rays are expected to reduce the disagreement by this factor at most. Where even that would not bring it
/// within the tolerance in the tries that are left, all triangles cast at once.
const MENDED_BY_A_TRY: f64 = 8.0;

/// The net force on the pair's first body and its torque about the middle of the overlap box, for unit stiffness.
#[derive(Clone, Copy)]
struct Load<T: Scalar> {
    force: Vector3<T>,
    torque: Vector3<T>,
}

impl<T: Scalar> Load<T> {
    fn of(pair: &Pair<'_, T>, contacts: &[Contact<T>]) -> Self {
        let middle = pair.overlap.centre();
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for contact in contacts {
            let pressure = contact.area * contact.depth * contact.cos_alpha;
            let on_first = if contact.colliding == pair.bodies[0] { pressure } else { -pressure };
            let [acts_at, push] = [contact.p1.position - middle, contact.direction * on_first];
            force += push;
            torque += acts_at.cross(&push);
        }
        Self { force, torque }
    }

    /// How much the other load differs, relative to this force; torques are divided by half the overlap box's diagonal. NaN
    /// without a force.
    fn difference(&self, other: &Self, pair: &Pair<'_, T>) -> T {
        let half_diagonal = length(&(pair.overlap.upper - pair.overlap.lower)) * T::of(0.5);
        let [force, torque] = [self.force - other.force, self.torque - other.torque].map(|part| length(&part));
        force.max(torque / half_diagonal) / length(&self.force)
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Adds the contacts of as few rays as keep net force and torque within the tolerance: patches get smaller until two
    /// tries agree, or until all triangles cast.
    pub(crate) fn cast_to_tolerance(&self, tolerance: T, contacts: &mut ContactList<T>) {
        let (start, before) = (contacts.len(), contacts.statistics);
        let mut area = steady(largest_face(self.overlap) / T::of(FEWEST_RAYS));
        let mut tries_left = self.tries_from(area, &contacts.workspace.groups);
        // One try alone cannot be compared with anything.
        if tries_left < 2 {
            tries_left = 0;
        }
        let mut last: Option<(Load<T>, usize)> = None;
        let mut last_difference = T::INFINITY;
        let mut estimate_rays = 0;
        loop {
            area = if tries_left > 0 { area } else { T::zero() };
            let pair = Pair { patch_area: Some(area), ..*self };
            pair.cast_samples(contacts);
            if tries_left == 0 {
                break;
            }
            tries_left -= 1;
            let found = &contacts.contacts[start..];
            let load = Load::of(self, found);
            if let Some((coarser, count)) = last {
                let difference = load.difference(&coarser, self);
                let converges = last_difference <= tolerance * T::of(BEFORE);
                let allowed = tolerance * T::of(if converges { AT_LAST } else { AT_ONCE });
                let are_many = count >= FEWEST_CONTACTS && T::of(count as f64) * tolerance >= T::one();
                if are_many && difference <= allowed {
                    break;
                }
                last_difference = difference;
                if difference > tolerance * T::of(MENDED_BY_A_TRY.powi(tries_left)) {
                    tries_left = 0;
                }
            }
            // If nothing is found yet, there is little to find, if anything: all triangles cast.
            tries_left = if found.is_empty() { 0 } else { tries_left };
            last = Some((load, found.len()));
            area /= T::of(4.0);
            estimate_rays += contacts.statistics.rays - before.rays;
            contacts.contacts.truncate(start);
            contacts.statistics = before;
        }
        contacts.statistics.estimate_rays += estimate_rays;
    }

    /// How many tries there can be, the first with patches of this area.
    fn tries_from(&self, mut area: T, groups: &[Vec<u32>; 2]) -> i32 {
        let count = |area: T| -> usize {
            let sides = self.tracers.iter().zip(groups);
            sides.map(|(tracer, groups)| tracer.casting_in(groups, area)).sum()
        };
        let all = count(T::zero());
        let mut tries = 0;
        // An infinite area gets no smaller. Any other reaches 0 at the latest, where all triangles cast.
        while area.is_finite() && area > T::zero() && count(area) <= all / LARGEST_PART {
            tries += 1;
            area /= T::of(4.0);
        }
        tries
    }
}

/// Rounded down to one of the areas 2, 8, 32 and so on, or 1/2, 1/8: the tries stay the same while the overlap changes.
fn steady<T: Scalar>(area: T) -> T {
    const DIGITS: u32 = f64::MANTISSA_DIGITS;
    T::of(f64::from_bits(area.to_f64().to_bits() >> DIGITS << DIGITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::options::DetectionOptions;
    use crate::contact::quadrature::sample::Sampling;
    use crate::contact::test_contact;
    use crate::contact::test_contact::contact;
    use crate::math::Aabb;
    use crate::query::Octree;
    use crate::shapes;

    /// Asks about a pair whose overlap box is this one.
    fn with_pair<R>([lower, upper]: [[f64; 3]; 2], ask: impl FnOnce(&Pair<'_, f64>) -> R) -> R {
        let mesh = shapes::tetrahedron().mesh();
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let overlap = Aabb { lower: lower.into(), upper: upper.into() };
        let options = DetectionOptions { sampling: Sampling::Tolerance(0.1), ..DetectionOptions::default() };
        let (bodies, tracers) = ([0, 1], [&tracer; 2]);
        ask(&Pair::new(bodies, tracers, [&overlap; 2], &options))
    }

    const OVERLAP: [[f64; 3]; 2] = [[1.0, 1.0, 1.0], [3.0, 5.0, 5.0]];

    /// Force and torque about (2, 3, 3), half the diagonal 3 long.
    #[test]
    fn loads_are_forces_and_torques_on_the_first_body() {
        with_pair(OVERLAP, |pair| {
            let contacts = [
                // A push of 3 · 4 · 0.5 along x, 2 beside the middle along y.
                contact(0, [2.0, 5.0, 3.0], [1.0, 0.0, 0.0], [3.0, 4.0, 0.5]),
                // One of 0.5 · 2 · 0.25 on the second body along z, 8 beside the middle along x.
                contact(1, [10.0, 3.0, 3.0], [0.0, 0.0, 1.0], [0.5, 2.0, 0.25]),
            ];
            let load = Load::of(pair, &contacts);
            assert_eq!(load.force, Vector3::new(6.0, 0.0, -0.25));
            assert_eq!(load.torque, Vector3::new(0.0, 2.0, -12.0));
        });
    }

    #[test]
    fn differences_are_parts_of_the_force() {
        with_pair(OVERLAP, |pair| {
            let load =
                |x: f64, torque: f64| Load { force: Vector3::new(x, 0.0, 0.0), torque: Vector3::new(0.0, torque, 0.0) };
            let rest = load(4.0, 30.0);
            assert_eq!(rest.difference(&load(4.0, 30.0), pair), 0.0);
            assert_eq!(rest.difference(&load(3.0, 30.0), pair), 0.25);
            assert_eq!(rest.difference(&load(4.0, 24.0), pair), 0.5);
            assert_eq!(rest.difference(&load(3.0, 24.0), pair), 0.5);
            assert_eq!(rest.difference(&load(1.0, 24.0), pair), 0.75);
            assert!(load(0.0, 1.0).difference(&load(0.0, 1.0), pair).is_nan());
        });
    }

    #[test]
    fn areas_go_in_steps_of_four() {
        for (area, expected) in [
            (2.0, 2.0),
            (7.9, 2.0),
            (8.0, 8.0),
            (31.9, 8.0),
            (33.0, 32.0),
            (1.9, 0.5),
            (0.5, 0.5),
            (0.49, 0.125),
            (3e-30, 2.0 * 4f64.powi(-50)),
        ] {
            assert_eq!(steady(area), expected, "{area}");
        }
        assert_eq!(steady(7.9f32), 2.0);
    }

    /// What one try with patches of an area finds.
    struct Try {
        load: Load<f64>,
        contacts: usize,
        rays: u64,
    }

    /// Tolerances that two of the tries' differences meet just or just not, are hopelessly beyond, or meet where the tries
    /// before agreed too; by the number of the difference and its part of the tolerance, which try is taken, if any, and how
    /// many are made in vain. What is taken is as near to the load of all triangles as was asked. Counts and contacts are added
    /// to those of the pairs before.
    #[test]
    fn tries_are_made_until_two_agree_or_none_is_left() {
        let mut list = ContactList::<f64>::default();
        let first = [(0, 0.599, (Some(1), 1)), (0, 0.601, (Some(2), 2)), (0, 8.01, (None, 2)), (1, 0.75, (None, 3))];
        let second = [(1, 0.75, (Some(2), 2))];
        for (by, parts) in [([0.25, 0.1, 0.3], first.as_slice()), ([0.3, 0.1, 0.3], &second)] {
            let torus = shapes::torus(96, 48, 0.4);
            let meshes = [torus.mesh(), torus.turned(0.0, 0.9).moved(by).mesh()];
            let options = DetectionOptions { sampling: Sampling::Tolerance(0.1), ..DetectionOptions::paper() };
            test_contact::with_pair(meshes.each_ref(), &options, |pair| {
                for (tracer, groups) in pair.tracers.iter().zip(&mut list.workspace.groups) {
                    tracer.groups_in(pair.region, groups);
                }
                let largest = steady(largest_face(pair.overlap) / FEWEST_RAYS);
                let try_number = |number| {
                    let mut list = ContactList { workspace: list.workspace.clone(), ..ContactList::default() };
                    Pair { patch_area: Some(largest / 4f64.powi(number)), ..*pair }.cast_samples(&mut list);
                    let load = Load::of(pair, &list.contacts);
                    Try { load, contacts: list.len(), rays: list.statistics.rays }
                };
                let tries: Vec<Try> = (0..pair.tries_from(largest, &list.workspace.groups)).map(try_number).collect();
                let mut every_triangle = ContactList { workspace: list.workspace.clone(), ..ContactList::default() };
                Pair { patch_area: None, ..*pair }.cast_samples(&mut every_triangle);
                let all = Load::of(pair, &every_triangle.contacts);
                for &(number, part, expected) in parts {
                    let tolerance = tries[number + 1].load.difference(&tries[number].load, pair) / part;
                    let (contacts, before) = (list.len(), list.statistics);
                    pair.cast_to_tolerance(tolerance, &mut list);
                    let error = all.difference(&Load::of(pair, &list.contacts[contacts..]), pair);
                    assert!(error <= tolerance, "{number}, {part}: {error} for {tolerance}");
                    let (contacts, rays) = (list.len() - contacts, list.statistics.rays - before.rays);
                    match expected.0 {
                        Some(taken) => assert_eq!((contacts, rays), (tries[taken].contacts, tries[taken].rays)),
                        None => assert_eq!(list.statistics.patches, before.patches, "all triangles cast"),
                    }
                    assert!(rays > 0);
                    let in_vain: u64 = tries[..expected.1].iter().map(|one| one.rays).sum();
                    assert_eq!(list.statistics.estimate_rays - before.estimate_rays, in_vain, "{number}, {part}");
                }
            });
        }
    }
}
