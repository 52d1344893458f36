//! Measures raycontact and its peers on the same workloads, interleaved in one run.

mod c_library;
mod chart;
mod charts;
mod clock;
mod elsewhere;
mod host;
mod libraries;
mod library;
mod measure;
mod method;
mod oracle;
mod peer;
mod rays;
mod record;
mod report;
mod row;
#[path = "../../programs/support/shapes.rs"]
#[allow(dead_code)] // the examples use more of it
mod shapes;
mod shared_library;
mod surfaces;
mod workload;

/// A point or a difference of points, as the examples' shapes have it.
type Vector = nalgebra::Vector3<f64>;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use row::Row;
use std::path::PathBuf;
use std::process::ExitCode;
use workload::Workload;

/// Measures raycontact and its peers on the same workloads, interleaved in one run.
#[derive(Parser)]
#[command(name = "bench")]
struct Arguments {
    /// Also the workloads that take long: up to 409 600 triangles a body, up to 1000 bodies.
    #[arg(long)]
    full: bool,
    /// Only these workloads (stackN, pairMxN and deepN@APART may have any numbers).
    #[arg(long, value_delimiter = ',')]
    workloads: Vec<String>,
    /// Two closed surfaces as Wavefront files: a deep pair of them, once for each number of --apart. Without --workloads, nothing else
    /// is measured.
    #[arg(long, num_args = 2)]
    files: Vec<PathBuf>,
    /// How far the centres of the surfaces in --files are apart, in their size.
    #[arg(long, value_delimiter = ',', default_value = "0.2", requires = "files")]
    apart: Vec<f64>,
    /// How the surfaces in --files are turned.
    #[arg(long, default_value = "1", requires = "files")]
    seed: u64,
    /// Only these methods.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    #[command(flatten)]
    libraries: libraries::Paths,
    /// The folder for detect.csv and the charts.
    #[arg(long, default_value = "out/bench")]
    out: PathBuf,
    /// Measures nothing: draws the charts from the folder's detect.csv and renews the tables of this document.
    #[arg(long)]
    document: Option<PathBuf>,
    /// Answers requests on standard input; for this program's own use.
    #[arg(long, hide = true)]
    serve: Option<String>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(clap::Subcommand)]
enum Command {
    Chart(chart::Arguments),
    Rays(rays::Arguments),
    Record(record::Arguments),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("bench: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    match &arguments.command {
        Some(Command::Chart(arguments)) => return chart::run(arguments),
        Some(Command::Rays(arguments)) => return rays::run(arguments),
        Some(Command::Record(arguments)) => return record::run(arguments),
        None => {}
    }
    if let Some(workload) = &arguments.serve {
        return elsewhere::serve(workload);
    }
    let csv = arguments.out.join("detect.csv");
    if arguments.document.is_none() {
        measure_all(arguments)?;
    }
    let rows = row::read(&csv)?;
    charts::draw(&rows, &arguments.out)?;
    match &arguments.document {
        Some(document) => report::renew_tables(document, &report::all(&rows))?,
        None => {
            let tables = [report::ratios(&rows), report::growth(&rows)].map(|table| report::aligned(&table));
            println!("{}{}", tables.join("\n"), report::faults(&rows));
        }
    }
    Ok(())
}

/// Measures and writes the CSV file, workload by workload.
fn measure_all(arguments: &Arguments) -> Result<(), String> {
    let workloads = chosen_workloads(arguments);
    let methods = chosen_methods(arguments)?;
    let libraries = arguments.libraries.open()?;
    let path = arguments.out.join("detect.csv");
    std::fs::create_dir_all(&arguments.out).map_err(|e| format!("cannot make {}: {e}", arguments.out.display()))?;
    let failed = |error: csv::Error| format!("cannot write {}: {error}", path.display());
    let mut csv = csv::Writer::from_path(&path).map_err(failed)?;

    let progress = ProgressBar::new((workloads.len() * methods.len()) as u64 * u64::from(measure::ROUNDS));
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {elapsed}, {eta} left  {msg}");
    progress.set_style(style.expect("the template is right"));
    for name in &workloads {
        let workload = Workload::new(name)?;
        let rows: Vec<Row> = measure::run(&workload, &methods, &libraries, &progress)?;
        for row in rows {
            csv.serialize(row).map_err(failed)?;
        }
        csv.flush().map_err(|e| failed(e.into()))?;
    }
    progress.finish_and_clear();
    Ok(())
}

fn chosen_workloads(arguments: &Arguments) -> Vec<String> {
    if arguments.workloads.is_empty() && arguments.files.is_empty() {
        return workload::names(arguments.full).into_iter().map(str::to_owned).collect();
    }
    let mut names = arguments.workloads.clone();
    if let [first, second] = &arguments.files[..] {
        names.extend(arguments.apart.iter().map(|&apart| workload::of_files([first, second], apart, arguments.seed)));
    }
    names
}

fn chosen_methods(arguments: &Arguments) -> Result<Vec<method::Description>, String> {
    let mut methods = method::all();
    for name in &arguments.methods {
        if methods.iter().all(|method| method.name != name) {
            return Err(format!("there is no method '{name}'"));
        }
    }
    methods.retain(|method| arguments.methods.is_empty() || arguments.methods.iter().any(|name| name == method.name));
    Ok(methods)
}
