//! Decides from measured times whether a query runs on all threads. Results do not depend on it.

use std::time::Duration;

/// How a query runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// On all threads.
    SideBySide,
    /// On the calling thread alone.
    Alone,
}

/// A trial lasts this many queries in a row. The first does not count, since threads have to wake up and caches to fill. The
/// median of the others does, since single queries may take long by chance.
const QUERIES_OF_A_TRIAL: usize = 6;
/// The slower way is tried again after this many queries: in the first ones threads still allocate memory.
const FIRST_AGAIN_AFTER: u32 = 16;
/// Each further trial waits twice as long, up to the first number of queries where the slower way takes less than
/// [`NEARLY_AS_FAST`] times as long, else up to the second.
const AT_LAST_AGAIN_AFTER: [u32; 2] = [256, 2048];
const NEARLY_AS_FAST: f64 = 1.3;
/// A trial is due sooner where there is this many times as much or as little to do as in the last one, but not within
/// [`NOT_WITHIN`] queries of it, since there may be more and less to do by turns.
const OTHER_WORK: f64 = 2.0;
const NOT_WITHIN: u32 = 64;
/// The known time of the way in use moves up or down by this part with each query, towards the median.
const STEP: f64 = 0.02;

/// The measured times of the two ways.
#[derive(Debug)]
pub(super) struct Autotuner {
    side_by_side: Option<Known>,
    alone: Option<Known>,
    trial: Option<Trial>,
    /// Queries since the last trial.
    waited: u32,
    /// After how many queries the slower way is tried again, up to [`AT_LAST_AGAIN_AFTER`].
    again_after: u32,
}

impl Default for Autotuner {
    fn default() -> Self {
        Self { side_by_side: None, alone: None, trial: None, waited: 0, again_after: FIRST_AGAIN_AFTER }
    }
}

#[derive(Clone, Copy, Debug)]
struct Known {
    /// The time per expected ray, in s.
    seconds: f64,
    /// How many rays were expected when it was tried.
    rays: f64,
}

#[derive(Debug)]
struct Trial {
    way: Way,
    seconds: [f64; QUERIES_OF_A_TRIAL],
    count: usize,
}

impl Autotuner {
    /// Chooses the way for a query that is expected to take as long as this many rays.
    pub(super) fn way(&mut self, rays: f64) -> Way {
        if let Some(trial) = &self.trial {
            return trial.way;
        }
        let (way, is_trial) = match (self.side_by_side, self.alone) {
            (None, _) => (Way::SideBySide, true),
            (_, None) => (Way::Alone, true),
            (Some(side_by_side), Some(alone)) => {
                let is_alone_slower = side_by_side.seconds <= alone.seconds;
                let ways = [Way::SideBySide, Way::Alone];
                let [faster, slower] = if is_alone_slower { ways } else { [ways[1], ways[0]] };
                let [less, more] = if is_alone_slower { [side_by_side, alone] } else { [alone, side_by_side] };
                let is_nearly_as_fast = more.seconds < less.seconds * NEARLY_AS_FAST;
                let at_last = AT_LAST_AGAIN_AFTER[usize::from(!is_nearly_as_fast)];
                let is_due = self.waited >= self.again_after.min(at_last);
                let is_other_work = rays > more.rays * OTHER_WORK || more.rays > rays * OTHER_WORK;
                let is_asked = is_due || (is_other_work && self.waited >= NOT_WITHIN);
                if is_asked {
                    self.again_after = (self.again_after * 2).min(at_last);
                    (slower, true)
                } else {
                    (faster, false)
                }
            }
        };
        self.waited += 1;
        self.trial = is_trial.then_some(Trial { way, seconds: [0.0; QUERIES_OF_A_TRIAL], count: 0 });
        way
    }

    /// Records the time of a query.
    pub(super) fn took(&mut self, way: Way, rays: f64, time: Duration) {
        let seconds = time.as_secs_f64() / rays.max(1.0);
        let known = match way {
            Way::SideBySide => &mut self.side_by_side,
            Way::Alone => &mut self.alone,
        };
        match (&mut self.trial, known) {
            (Some(trial), known) => {
                trial.seconds[trial.count] = seconds;
                trial.count += 1;
                if trial.count == QUERIES_OF_A_TRIAL {
                    let counted = &mut trial.seconds[1..];
                    counted.sort_unstable_by(f64::total_cmp);
                    *known = Some(Known { seconds: counted[counted.len() / 2], rays });
                    (self.trial, self.waited) = (None, 0);
                }
            }
            (None, Some(known)) => known.seconds *= if seconds > known.seconds { 1.0 + STEP } else { 1.0 - STEP },
            (None, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of so many queries each way does, where it takes so many µs.
    fn queries(tuner: &mut Autotuner, count: usize, rays: f64, [side_by_side, alone]: [f64; 2]) -> [usize; 2] {
        let mut done = [0; 2];
        for _ in 0..count {
            let way = tuner.way(rays);
            let (place, micros) = if way == Way::SideBySide { (0, side_by_side) } else { (1, alone) };
            done[place] += 1;
            tuner.took(way, rays, Duration::from_secs_f64(micros * 1e-6));
        }
        done
    }

    #[test]
    fn the_faster_way_is_taken_and_the_other_tried_now_and_then() {
        let mut tuner = Autotuner::default();
        let trial = QUERIES_OF_A_TRIAL;
        assert_eq!(queries(&mut tuner, 2 * trial, 3000.0, [500.0, 400.0]), [trial; 2]);
        for again_after in [16, 32, 64, 128, 256, 256] {
            let expected = [trial, again_after];
            assert_eq!(queries(&mut tuner, again_after + trial, 3000.0, [500.0, 400.0]), expected);
        }
        // It has become much faster: after the next trial it is taken.
        assert_eq!(queries(&mut tuner, 500, 3000.0, [200.0, 400.0]), [244, 256]);
        // By so much that the other is hardly ever tried.
        assert_eq!(queries(&mut tuner, 4000, 3000.0, [200.0, 400.0])[1], 4 * trial);
    }

    #[test]
    fn other_work_asks_anew() {
        let mut tuner = Autotuner::default();
        queries(&mut tuner, 500, 2000.0, [900.0, 300.0]);
        let [side_by_side, alone] = queries(&mut tuner, 200, 9000.0, [900.0, 1500.0]);
        assert!(side_by_side >= 130 && alone <= 70, "{side_by_side} {alone}");
    }

    #[test]
    fn more_and_less_work_by_turns_does_not_keep_it_trying() {
        let mut tuner = Autotuner::default();
        queries(&mut tuner, 2 * QUERIES_OF_A_TRIAL, 2000.0, [900.0, 300.0]);
        let mut slow = 0;
        for turn in 0..350 {
            let rays = [2000.0, 9000.0][turn % 2];
            slow += queries(&mut tuner, 1, rays, [0.45 * rays, 0.15 * rays])[0];
        }
        assert!(slow <= 6 * QUERIES_OF_A_TRIAL, "{slow}");
    }

    #[test]
    fn single_long_queries_decide_nothing() {
        let mut tuner = Autotuner::default();
        let mut alone = 0;
        for _ in 0..50 {
            alone += queries(&mut tuner, 1, 3000.0, [9000.0, 9000.0])[1];
            alone += queries(&mut tuner, 2, 3000.0, [300.0, 500.0])[1];
        }
        // Only in its trials.
        assert_eq!(alone, 4 * QUERIES_OF_A_TRIAL);
    }
}
