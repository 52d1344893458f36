//! One line of `chart.csv`.

use serde::{Deserialize, Serialize};
use std::path::Path;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub method: String,
    pub settings: String,
    /// The time of a step over the lower bound's.
    pub time_over_lower_bound: f64,
    /// The larger of the errors of net force and torque, against the limit of the method's own law; empty where its depths are
    /// of neither law.
    pub force_error: Option<f64>,
    /// Part of the vertices inside that have a contact; empty where contacts do not belong to vertices.
    pub recall: Option<f64>,
    /// Degrees from the limit of the pressure law.
    pub direction_error: f64,
    pub contacts: usize,
}

/// C's default options, as settings are written.
pub const DEFAULT: &str = "law=pressure sampling=accuracy:0.01 precision=f64 layout=wide edges=on weights=area";

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

    /// The settings in a few words: what is not said is as in the defaults.
    pub fn short(&self) -> String {
        let value = |name: &str| {
            let mut pairs = self.settings.split(' ').filter_map(|pair| pair.split_once('='));
            pairs.find(|(found, _)| *found == name).map_or("", |(_, value)| value)
        };
        let mut words = match self.method.as_str() {
            "raycontact" => vec![value("sampling").replace(':', " ")],
            "paper" => vec!["the paper's mode".to_owned()],
            other => return other.to_owned(),
        };
        let also = [
            ("precision", "f32", "single"),
            ("layout", "classic", "classic"),
            ("law", "ray-length", "ray lengths"),
            ("edges", "off", "no edges"),
            ("weights", "paper", "paper's weights"),
        ];
        // The paper's mode knows no other law, no edges and no other weights.
        let known = if self.method == "paper" { &also[..2] } else { &also[..] };
        words.extend(known.iter().filter(|(name, other, _)| value(name) == *other).map(|also| also.2.to_owned()));
        words.join(", ")
    }
}

/// Errors that differ by less than a hundredth are alike, and so are times by less than three.
const ALIKE: [f64; 2] = [0.99, 1.03];

/// The rows that none beats in time without being worse, by time. Of rows alike in both, that with the fewest words.
pub fn front<'a>(rows: &[&'a Row], measure: Measure) -> Vec<&'a Row> {
    let mut by_time: Vec<_> = rows.iter().filter_map(|row| Some((*row, measure.of(row)?))).collect();
    let time = |row: &Row| row.time_over_lower_bound;
    by_time.sort_by(|(a, x), (b, y)| time(a).total_cmp(&time(b)).then(x.total_cmp(y)));
    let mut best: Vec<(&Row, f64)> = Vec::new();
    for (row, value) in by_time {
        let Some(&(last, last_value)) = best.last() else {
            best.push((row, value));
            continue;
        };
        let is_as_fast = time(row) <= time(last) * ALIKE[1];
        let is_better = value < last_value * ALIKE[0];
        let is_simpler = value * ALIKE[0] <= last_value && row.short().len() < last.short().len();
        if is_as_fast && (is_better || is_simpler) {
            best.pop();
        }
        if is_better || (is_as_fast && is_simpler) {
            best.push((row, value));
        }
    }
    best.into_iter().map(|(row, _)| row).collect()
}

pub fn read(path: &Path) -> Result<Vec<Row>, String> {
    let failed = |error: csv::Error| format!("cannot read {}: {error}", path.display());
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(failed)?;
    reader.deserialize().map(|row| row.map_err(failed)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: f64, error: f64) -> Row {
        Row {
            scene: String::new(),
            method: "raycontact".to_owned(),
            settings: String::new(),
            time_over_lower_bound: time,
            force_error: Some(error),
            recall: None,
            direction_error: error,
            contacts: 0,
        }
    }

    #[test]
    fn settings_in_short_say_what_is_not_as_in_the_defaults() {
        let short = |settings: &str| Row { settings: settings.to_owned(), ..row(1.0, 1.0) }.short();
        assert_eq!(short(DEFAULT), "accuracy 0.01");
        let other = "law=ray-length sampling=spacing:0.1 precision=f32 layout=classic edges=off weights=paper";
        assert_eq!(short(other), "spacing 0.1, single, classic, ray lengths, no edges, paper's weights");
    }

    #[test]
    fn the_front_holds_what_none_beats() {
        let rows = [row(3.0, 0.1), row(1.0, 0.5), row(2.0, 0.6), row(4.0, 0.1), row(5.0, 0.01)];
        let rows: Vec<&Row> = rows.iter().collect();
        let times: Vec<f64> = front(&rows, Measure::Force).iter().map(|row| row.time_over_lower_bound).collect();
        assert_eq!(times, [1.0, 3.0, 5.0]);
        assert!(front(&rows, Measure::Missed).is_empty());
    }
}
