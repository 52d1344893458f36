//! Whether threads pay: the times of queries say it. Results do not depend on it.

use std::time::Duration;

/// Who finds a query's contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// All threads.
    SideBySide,
    /// The calling thread.
    Alone,
}

/// A single time may be long by chance: the shorter of two counts.
const TIMES: usize = 2;
/// The slower way is tried again after so many queries, where it takes less than this many times as long, or longer.
const NEARLY_AS_FAST: f64 = 1.3;
const TRY_AGAIN_AFTER: [u32; 2] = [64, 1024];
/// And at once where there is so many times as much to do, or so many times as little, as when it was tried last.
const OTHER_WORK: f64 = 2.0;

/// What the two ways took lately.
#[derive(Debug, Default)]
pub(super) struct Pace {
    side_by_side: Times,
    alone: Times,
    /// Queries since the slower way was tried.
    waited: u32,
}

#[derive(Debug, Default)]
struct Times {
    /// For a ray expected, in s: the newest, and the one before.
    seconds: [Option<f64>; TIMES],
    /// How many rays were expected then.
    rays: f64,
}

impl Times {
    fn shortest(&self) -> f64 {
        self.seconds.iter().flatten().copied().fold(f64::INFINITY, f64::min)
    }

    fn is_known(&self) -> bool {
        self.seconds.iter().all(Option::is_some)
    }

    fn is_of_other_work(&self, rays: f64) -> bool {
        rays > self.rays * OTHER_WORK || self.rays > rays * OTHER_WORK
    }
}

impl Pace {
    /// How to do a query that is expected to take as long as so many rays.
    pub(super) fn way(&mut self, rays: f64) -> Way {
        if !self.side_by_side.is_known() {
            return Way::SideBySide;
        }
        if !self.alone.is_known() {
            return Way::Alone;
        }
        let [side_by_side, alone] = [self.side_by_side.shortest(), self.alone.shortest()];
        let (faster, slower, slower_times) = match side_by_side <= alone {
            true => (Way::SideBySide, Way::Alone, &self.alone),
            false => (Way::Alone, Way::SideBySide, &self.side_by_side),
        };
        let is_nearly_as_fast = side_by_side.max(alone) < side_by_side.min(alone) * NEARLY_AS_FAST;
        self.waited += 1;
        let is_due = self.waited > TRY_AGAIN_AFTER[usize::from(!is_nearly_as_fast)];
        if is_due || slower_times.is_of_other_work(rays) { slower } else { faster }
    }

    /// Takes note of what a query took.
    pub(super) fn took(&mut self, way: Way, rays: f64, time: Duration) {
        let times = match way {
            Way::SideBySide => &mut self.side_by_side,
            Way::Alone => &mut self.alone,
        };
        if times.is_of_other_work(rays) {
            times.seconds = [None; TIMES];
        }
        times.seconds = [Some(time.as_secs_f64() / rays.max(1.0)), times.seconds[0]];
        times.rays = rays;
        if self.slower() == Some(way) {
            self.waited = 0;
        }
    }

    fn slower(&self) -> Option<Way> {
        let are_known = self.side_by_side.is_known() && self.alone.is_known();
        let is_alone_slower = self.side_by_side.shortest() <= self.alone.shortest();
        are_known.then_some(if is_alone_slower { Way::Alone } else { Way::SideBySide })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of so many queries each way does, where it takes so many µs.
    fn queries(pace: &mut Pace, count: usize, rays: f64, [side_by_side, alone]: [f64; 2]) -> [usize; 2] {
        let mut done = [0; 2];
        for _ in 0..count {
            let way = pace.way(rays);
            let (place, micros) = if way == Way::SideBySide { (0, side_by_side) } else { (1, alone) };
            done[place] += 1;
            pace.took(way, rays, Duration::from_secs_f64(micros * 1e-6));
        }
        done
    }

    #[test]
    fn the_faster_way_is_taken_and_the_other_tried_now_and_then() {
        let mut pace = Pace::default();
        // Two each to begin with.
        assert_eq!(queries(&mut pace, 4, 3000.0, [500.0, 400.0]), [2, 2]);
        assert_eq!(queries(&mut pace, 650, 3000.0, [500.0, 400.0]), [10, 640]);
        // It has become much faster: after the next try or two it is taken.
        let [side_by_side, alone] = queries(&mut pace, 300, 3000.0, [200.0, 400.0]);
        assert!(alone <= 65 && side_by_side >= 235, "{side_by_side} {alone}");
        // By so much that the other is hardly ever tried.
        assert!(queries(&mut pace, 2000, 3000.0, [200.0, 400.0])[1] <= 2);
    }

    #[test]
    fn other_work_asks_anew() {
        let mut pace = Pace::default();
        assert!(queries(&mut pace, 500, 2000.0, [900.0, 300.0])[0] <= 3);
        let [side_by_side, alone] = queries(&mut pace, 100, 9000.0, [900.0, 1500.0]);
        assert!(side_by_side >= 95 && alone <= 5, "{side_by_side} {alone}");
    }

    #[test]
    fn one_long_query_decides_nothing() {
        let mut pace = Pace::default();
        queries(&mut pace, 4, 3000.0, [300.0, 500.0]);
        assert_eq!(queries(&mut pace, 1, 3000.0, [9000.0, 500.0]), [1, 0]);
        assert_eq!(queries(&mut pace, 20, 3000.0, [300.0, 500.0]), [20, 0]);
    }
}
