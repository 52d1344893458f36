//! One line of `chart.csv`.

use serde::{Deserialize, Serialize};
use std::path::Path;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub method: String,
    pub settings: String,
    /// Times the floor's.
    pub time_floor_multiple: f64,
    /// The larger of the errors of net force and torque; empty where the method's depths are not the law's.
    pub force_error: Option<f64>,
    /// Part of the vertices inside that have a contact; empty where contacts do not belong to vertices.
    pub recall: Option<f64>,
    /// Degrees.
    pub direction_error: f64,
    pub contacts: usize,
}

/// The library's default options, as settings are written.
pub const DEFAULT: &str = "sampling=automatic precision=f32 layout=wide edges=on weights=area";

/// What is drawn upward against the time; less is better.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Measure {
    Force,
    Missed,
    Direction,
}

impl Measure {
    pub const ALL: [Self; 3] = [Self::Force, Self::Missed, Self::Direction];

    pub fn of(self, row: &Row) -> Option<f64> {
        match self {
            Self::Force => row.force_error,
            Self::Missed => row.recall.map(|recall| 1.0 - recall),
            Self::Direction => Some(row.direction_error),
        }
    }
}

impl Row {
    pub fn is_default(&self) -> bool {
        self.method == "raycontact" && self.settings == DEFAULT
    }
}

/// The rows that none beats in time without being worse, by time.
pub fn front<'a>(rows: &[&'a Row], measure: Measure) -> Vec<&'a Row> {
    let mut by_time: Vec<_> = rows.iter().filter_map(|row| Some((*row, measure.of(row)?))).collect();
    let time = |row: &Row| row.time_floor_multiple;
    by_time.sort_by(|(a, x), (b, y)| time(a).total_cmp(&time(b)).then(x.total_cmp(y)));
    let mut best = f64::INFINITY;
    by_time.retain(|(_, value)| {
        *value < best && {
            best = *value;
            true
        }
    });
    by_time.into_iter().map(|(row, _)| row).collect()
}

pub fn read(path: &Path) -> Result<Vec<Row>, String> {
    let failed = |error: csv::Error| format!("cannot read {}: {error}", path.display());
    csv::Reader::from_path(path).map_err(failed)?.deserialize().map(|row| row.map_err(failed)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: f64, error: f64) -> Row {
        Row {
            scene: String::new(),
            method: "raycontact".to_owned(),
            settings: String::new(),
            time_floor_multiple: time,
            force_error: Some(error),
            recall: None,
            direction_error: error,
            contacts: 0,
        }
    }

    #[test]
    fn the_front_holds_what_none_beats() {
        let rows = [row(3.0, 0.1), row(1.0, 0.5), row(2.0, 0.6), row(4.0, 0.1), row(5.0, 0.01)];
        let rows: Vec<&Row> = rows.iter().collect();
        let times: Vec<f64> = front(&rows, Measure::Force).iter().map(|row| row.time_floor_multiple).collect();
        assert_eq!(times, [1.0, 3.0, 5.0]);
        assert!(front(&rows, Measure::Missed).is_empty());
    }
}
