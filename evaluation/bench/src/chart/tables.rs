//! The tables of `docs/choosing.md`.

use super::row::{Measure, Row, front};
use super::scenes;
use crate::measure::median;
use crate::report::Table;

/// By their names in the document.
pub fn all(rows: &[Row]) -> [(&'static str, Table); 2] {
    [("front", fronts(rows)), ("options", options(rows))]
}

/// Larger force errors are of no use.
const LARGEST_ERROR: f64 = 0.1;

/// The settings of each scene that none beats in both time and force, and the default.
fn fronts(rows: &[Row]) -> Table {
    let head = ["scene", "setting", "time / lower bound", "force error", "contacts", "vertices found", "direction"];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    let percent =
        |part: Option<f64>, digits| part.map_or("–".to_owned(), |part| format!("{:.digits$} %", part * 100.0));
    for scene in scenes(rows) {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
        let mut best = front(&of_scene, Measure::Force);
        best.retain(|row| row.force_error.is_some_and(|error| error <= LARGEST_ERROR));
        if best.iter().all(|row| !row.is_default()) {
            best.extend(of_scene.iter().filter(|row| row.is_default()));
        }
        table.extend(best.into_iter().map(|row| {
            let mark = if row.is_default() { " (default)" } else { "" };
            vec![
                scene.clone(),
                format!("{}{mark}", row.short()),
                format!("{:.1}", row.time_over_lower_bound),
                percent(row.force_error, 3),
                row.contacts.to_string(),
                percent(row.recall, 1),
                format!("{:.3}°", row.direction_error),
            ]
        }));
    }
    table
}

/// What an option changes: the time, in the median over all settings of the wide octree that differ in nothing else.
fn options(rows: &[Row]) -> Table {
    let scenes = scenes(rows);
    let mut table = vec![std::iter::once("time".to_owned()).chain(scenes.iter().cloned()).collect::<Vec<_>>()];
    let pairs = [
        ("double / float", "precision=f32", "precision=f64"),
        ("classic octree / wide", "layout=wide", "layout=classic"),
        ("without edges / with", "edges=on", "edges=off"),
        ("ray lengths / pressure", "law=pressure", "law=ray-length"),
    ];
    for (name, from, to) in pairs {
        let cells = scenes.iter().map(|scene| {
            let ours = || rows.iter().filter(|row| row.scene == *scene && row.method == "raycontact");
            let other = |row: &Row| ours().find(|other| other.settings == row.settings.replace(from, to));
            let is_one =
                |row: &&Row| [from, "layout=wide", "weights=area"].iter().all(|part| row.settings.contains(part));
            let times = ours()
                .filter(is_one)
                .filter_map(|row| Some(other(row)?.time_over_lower_bound / row.time_over_lower_bound));
            let times: Vec<f64> = times.collect();
            if times.is_empty() { "–".to_owned() } else { format!("{:.2}", median(times)) }
        });
        table.push(std::iter::once(name.to_owned()).chain(cells).collect());
    }
    table
}
