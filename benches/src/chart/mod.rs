//! Speed against accuracy: every method over its settings on six scenes.

mod closest;
mod draw;
mod load;
mod measure;
#[path = "../../../examples/poses/proximity.rs"]
#[allow(dead_code)] // the pose benchmark uses more of it
mod proximity;
mod row;
mod scene;
mod setting;
#[path = "../../../examples/support/shapes.rs"]
#[allow(dead_code)] // the examples use more of it
mod shapes;
#[path = "../../../examples/poses/tree.rs"]
#[allow(dead_code)] // the pose benchmark uses more of it
mod tree;

use crate::peer;
use crate::report::aligned;
use indicatif::{ProgressBar, ProgressStyle};
use row::{Measure, Row, front};
use std::ffi::OsString;
use std::path::PathBuf;

/// A point or a difference of points, as the examples' shapes have it.
type Vector = nalgebra::Vector3<f64>;

/// Measures speed against accuracy: every method over its settings on six scenes.
#[derive(clap::Args)]
pub struct Arguments {
    /// Each option with each other, instead of one at a time beside the default.
    #[arg(long)]
    full: bool,
    /// Only these scenes.
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<String>,
    /// Two closed surfaces as Wavefront files: one scene more, `given`, called after them.
    #[arg(long, num_args = 2)]
    files: Vec<PathBuf>,
    /// Spacings of rays, in mean edges of the scene's finest body.
    #[arg(long, value_delimiter = ',', default_value = "0.5,1,2,4,8,16")]
    spacings: Vec<f64>,
    /// The shared library with the peers.
    #[arg(long, default_value = "libraycontact_bench_peers.so")]
    peers: OsString,
    /// The folder for chart.csv and the charts.
    #[arg(long, default_value = "out/chart")]
    out: PathBuf,
    /// Measures nothing: draws and prints the folder's chart.csv.
    #[arg(long)]
    draw: bool,
}

impl Arguments {
    fn settings_for(&self, scene: &scene::Scene) -> Vec<setting::Setting> {
        let edge = scene::shortest_mean_edge(&scene.workload);
        setting::all(self.spacings.iter().map(|count| count * edge), self.full)
    }
}

pub fn run(arguments: &Arguments) -> Result<(), String> {
    let path = arguments.out.join("chart.csv");
    if !arguments.draw {
        measure_all(arguments, &path)?;
    }
    let rows = row::read(&path)?;
    draw::draw(&rows, &arguments.out)?;
    print!("{}", fronts(&rows));
    Ok(())
}

fn measure_all(arguments: &Arguments, path: &std::path::Path) -> Result<(), String> {
    let peers = peer::Library::open(&arguments.peers)?;
    std::fs::create_dir_all(&arguments.out).map_err(|e| format!("cannot make {}: {e}", arguments.out.display()))?;
    let failed = |error: csv::Error| format!("cannot write {}: {error}", path.display());
    let mut csv = csv::Writer::from_path(path).map_err(failed)?;
    let names: Vec<String> = match arguments.scenes.as_slice() {
        [] => {
            let given = (!arguments.files.is_empty()).then_some(scene::GIVEN);
            scene::NAMES.into_iter().chain(given).map(str::to_owned).collect()
        }
        chosen => chosen.to_vec(),
    };
    let progress = ProgressBar::new(names.len() as u64);
    let style = ProgressStyle::with_template("{pos} of {len} scenes, {elapsed}  {msg}");
    progress.set_style(style.expect("the template is right"));
    for name in names {
        let scene = scene::Scene::new(&name, &arguments.files)?;
        for row in measure::run(&scene, &arguments.settings_for(&scene), &peers, &progress)? {
            csv.serialize(row).map_err(failed)?;
        }
        csv.flush().map_err(|e| failed(e.into()))?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}

/// The settings of each scene that none beats in both time and force, and the default.
fn fronts(rows: &[Row]) -> String {
    let mut text = String::new();
    for scene in scenes(rows) {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
        let mut best = front(&of_scene, Measure::Force);
        let missing = of_scene.iter().filter(|row| row.is_default() && best.iter().all(|other| !other.is_default()));
        best.extend(missing.collect::<Vec<_>>());
        let head = ["floor ×", "force error", "recall", "direction", "contacts", "method"].map(str::to_owned);
        let line = |row: &&Row| {
            let percent = |part: Option<f64>| part.map_or("–".to_owned(), |part| format!("{:.3} %", part * 100.0));
            let mark = if row.is_default() { " (default)" } else { "" };
            vec![
                format!("{:.1}", row.time_floor_multiple),
                percent(row.force_error),
                percent(row.recall),
                format!("{:.3}°", row.direction_error),
                row.contacts.to_string(),
                format!("{} {}{mark}", row.method, row.settings),
            ]
        };
        let table = std::iter::once(head.to_vec()).chain(best.iter().map(line)).collect();
        text += &format!("{scene}\n{}\n", aligned(&table));
    }
    text
}

/// In the order of the rows.
fn scenes(rows: &[Row]) -> Vec<String> {
    let mut names: Vec<String> = rows.iter().map(|row| row.scene.clone()).collect();
    names.dedup();
    names
}
