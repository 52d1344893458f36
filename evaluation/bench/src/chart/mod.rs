//! Speed against accuracy: every method over its settings on six scenes.

mod closest;
mod draw;
mod load;
mod measure;
#[path = "../../../programs/poses/proximity.rs"]
#[allow(dead_code)] // the pose benchmark uses more of it
mod proximity;
mod row;
mod scene;
mod setting;
mod tables;
#[path = "../../../programs/poses/tree.rs"]
#[allow(dead_code)] // the pose benchmark uses more of it
mod tree;

use crate::libraries;
use crate::report::{aligned, renew_tables};
use indicatif::{ProgressBar, ProgressStyle};
use row::Row;
use std::path::PathBuf;

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
    #[command(flatten)]
    libraries: libraries::Paths,
    /// The folder for chart.csv and the charts.
    #[arg(long, default_value = "out/chart")]
    out: PathBuf,
    /// Measures nothing: draws and prints the folder's chart.csv.
    #[arg(long)]
    draw: bool,
    /// Instead of printing the tables, renews them in this document.
    #[arg(long)]
    document: Option<PathBuf>,
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
    match &arguments.document {
        Some(document) => renew_tables(document, &tables::all(&rows)),
        None => {
            print!("{}", tables::all(&rows).map(|(_, table)| aligned(&table)).join("\n"));
            Ok(())
        }
    }
}

fn measure_all(arguments: &Arguments, path: &std::path::Path) -> Result<(), String> {
    let libraries = arguments.libraries.open()?;
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
        for row in measure::run(&scene, &arguments.settings_for(&scene), &libraries, &progress)? {
            csv.serialize(row).map_err(failed)?;
        }
        csv.flush().map_err(|e| failed(e.into()))?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}

/// In the order of the rows.
fn scenes(rows: &[Row]) -> Vec<String> {
    let mut names: Vec<String> = rows.iter().map(|row| row.scene.clone()).collect();
    names.dedup();
    names
}
