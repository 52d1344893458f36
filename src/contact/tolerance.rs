use super::cutter::largest_face;
use super::pair::Pair;
use super::{Contact, ContactList};
use crate::math::{Scalar, Vector3, length};

/// So many rays on the overlap box's largest face are the fewest that are tried; each further try has four times as many.
const FEWEST_RAYS: f64 = 32.0;
/// Tries are made only while no more than one of so many triangles casts: more save little, and patches of two or three
/// triangles err by where in them the ray stands, which the next try does no better.
const LARGEST_PART: usize = 3;
/// Two tries may agree by chance; fewer contacts in the coarser one tell nothing.
const FEWEST_CONTACTS: usize = 48;
/// Two tries must agree so much better than asked, or so much where the two before agreed up to so many times as badly. Held
/// against the finest result in 614 overlaps of tori, balls, thorns, boxes and animals, none was farther off than asked
/// then, for tolerances from 0.003 to 0.1.
const AT_ONCE: f64 = 0.6;
const AT_LAST: f64 = 0.9;
const BEFORE: f64 = 3.0;
/// Where tries disagree by so many times more than four times the rays could mend, all triangles cast at once.
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

    /// How much the other differs, in parts of this force; torques over the overlap box's half diagonal. NaN where there is
    /// no force.
    fn difference(&self, other: &Self, pair: &Pair<'_, T>) -> T {
        let half_diagonal = length(&(pair.overlap.upper - pair.overlap.lower)) * T::of(0.5);
        let [force, torque] = [self.force - other.force, self.torque - other.torque].map(|part| length(&part));
        force.max(torque / half_diagonal) / length(&self.force)
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Adds the contacts of as few rays as keep net force and torque within the tolerance: patches get smaller until two
    /// tries agree, or until all triangles cast.
    pub(super) fn cast_to_tolerance(&self, tolerance: T, contacts: &mut ContactList<T>) {
        let (start, before) = (contacts.len(), contacts.statistics);
        let mut area = steady(largest_face(self.overlap) / T::of(FEWEST_RAYS));
        let mut tries_left = self.tries_from(area, &contacts.workspace.groups);
        // One alone tells nothing.
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
                if count >= FEWEST_CONTACTS && difference <= allowed {
                    break;
                }
                last_difference = difference;
                if difference > tolerance * T::of(MENDED_BY_A_TRY.powi(tries_left)) {
                    tries_left = 0;
                }
            }
            // Where nothing is found yet, little is there to find, if anything: all rays look for it.
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
        // Without end where the box's faces are too large for numbers.
        while area.is_finite() && count(area) <= all / LARGEST_PART {
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
