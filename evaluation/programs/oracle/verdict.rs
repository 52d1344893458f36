//! Holds the library's answers to one ray against one another and against the judge.

use super::judge::{Crossing, Judge};
use super::query::Answers;
use super::tally::{Failure, Tally};
use raycontact::math::Scalar;
use raycontact::triangle::{Hit, Ray};

/// A hit's `t` and weights must name one point to within so many rounding units of the triangle's reach, axis by axis.
///
/// Where it comes from: weights from accurate edge functions are off by 5 rounding units of themselves, the projected
/// corners they apply to are up to two reaches from the ray, and were themselves rounded by 6; `t` by 10: 28 in all
/// at the very worst.
pub const POINT_ERROR: f64 = 32.0;

/// What is wrong with the answers to one ray: of each kind the first fault.
#[derive(Default)]
pub struct Verdict {
    missing: Option<String>,
    spurious: Option<String>,
    wrong: Option<String>,
    leak: Option<String>,
}

impl Verdict {
    fn wrong(&mut self, what: impl FnOnce() -> String) {
        self.wrong.get_or_insert_with(what);
    }

    /// All ways of asking must agree to the bit.
    pub fn compare<T: Scalar>(&mut self, answers: &Answers<T>) {
        for (name, answer) in &answers.nearest {
            if answer.as_ref().map(bits) != answers.expected.as_ref().map(bits) {
                self.wrong(|| format!("{name} differs from the nearest of all triangles' hits"));
            }
        }
        let [classic, wide] = &answers.crossings;
        if !classic.iter().map(bits).eq(wide.iter().map(bits)) {
            self.wrong(|| format!("classic finds crossings {classic:?}, wide {wide:?}"));
        }
        let [classic, wide, every] = answers.leaves;
        if classic != every || wide != every {
            self.wrong(|| format!("leaves before its end: {every}, but classic says {classic}, wide {wide}"));
        }
    }

    /// No hit without a crossing, each at the right place and from the right side.
    pub fn judge_hits<T: Scalar>(&mut self, judge: &Judge, answers: &Answers<T>, tally: &mut Tally) {
        let unit = T::ROUNDING_UNIT.to_f64();
        for hit in &answers.all {
            let triangle = hit.triangle;
            let (t, weights) = (hit.t.to_f64(), hit.weights.map(T::to_f64));
            let Some(crossing) = judge.crossing_of(triangle) else {
                self.spurious.get_or_insert_with(|| format!("triangle {triangle} is hit, but the ray passes it"));
                continue;
            };
            let sum: f64 = weights.iter().sum();
            if !weights.iter().all(|weight| (0.0..=1.0).contains(weight)) || (sum - 1.0).abs() > 8.0 * unit {
                self.wrong(|| format!("weights of triangle {triangle} are {weights:?}"));
            }
            let error = judge.point_error(triangle, t, weights, POINT_ERROR);
            tally.note_point_error::<T>(error);
            if error > POINT_ERROR {
                self.wrong(|| format!("t and weights of triangle {triangle} differ by {error} rounding units"));
            }
            let Crossing { first, last, .. } = judge.crossings()[crossing];
            if !(first <= t && t <= last) {
                self.wrong(|| format!("triangle {triangle} is hit at {t}, not in [{first}, {last}]"));
            }
            if judge.is_exit(triangle).is_some_and(|is_exit| is_exit != hit.is_exit) {
                self.wrong(|| format!("triangle {triangle} is hit from the wrong side"));
            }
        }
    }

    /// No crossing lost: each that is certain, and certainly ahead of the origin, has a hit from its side, no answer
    /// lies beyond it, and its signs sum up.
    pub fn judge_answers<T: Scalar>(&mut self, judge: &Judge, ray: &Ray<T>, answers: &Answers<T>) {
        let t_max = ray.t_max.to_f64();
        let (mut winding, mut is_winding_known) = (0, true);
        for (index, crossing) in judge.crossings().iter().enumerate() {
            if crossing.first <= 0.0 {
                is_winding_known &= crossing.last < 0.0;
                continue;
            }
            winding += crossing.exits;
            let is_within = crossing.last <= t_max;
            let is_here = |hit: &&Hit<T>| judge.crossing_of(hit.triangle) == Some(index);
            let signs = answers.crossings[1].iter().filter(is_here).map(|hit| if hit.is_exit { 1 } else { -1 });
            if is_within && signs.sum::<i32>() != crossing.exits {
                self.wrong(|| format!("the signs at {crossing:?} do not sum up"));
            }
            if crossing.exits == 0 {
                continue;
            }
            let is_from_its_side = |hit: &Hit<T>| hit.is_exit == (crossing.exits > 0);
            if !answers.all.iter().filter(is_here).any(is_from_its_side) {
                self.missing.get_or_insert_with(|| format!("no triangle is hit at {crossing:?}"));
            }
            for (name, answer) in &answers.nearest {
                if is_within && answer.is_none_or(|hit| hit.t.to_f64() > crossing.last) {
                    self.missing.get_or_insert_with(|| format!("{name} goes past {crossing:?}"));
                }
            }
        }
        let is_inside = is_winding_known && winding != 0;
        let lost = answers.nearest.iter().find(|(_, answer)| answer.is_none());
        if let Some((name, _)) = lost.filter(|_| is_inside && ray.t_max == T::INFINITY) {
            self.leak = Some(format!("{name}: the ray starts inside and hits nothing"));
        }
    }

    /// Counts a query once for each kind of fault; a leak is not counted as a missing hit again.
    pub fn count(self, tally: &mut Tally, describe: impl Fn(String) -> Failure) {
        let missing = self.missing.filter(|_| self.leak.is_none());
        tally.missing += u64::from(missing.is_some());
        tally.spurious += u64::from(self.spurious.is_some());
        tally.wrong += u64::from(self.wrong.is_some());
        tally.leaks += u64::from(self.leak.is_some());
        let faults = [("leak", self.leak), ("missing", missing), ("spurious", self.spurious), ("wrong", self.wrong)];
        if tally.first_failure.is_none() {
            let first = faults.into_iter().find_map(|(kind, what)| what.map(|what| format!("{kind}: {what}")));
            tally.first_failure = first.map(describe);
        }
    }
}

fn bits<T: Scalar>(hit: &Hit<T>) -> (u32, bool, [u64; 4]) {
    let [u, v, w] = hit.weights;
    (hit.triangle, hit.is_exit, [hit.t, u, v, w].map(|number| number.to_f64().to_bits()))
}
