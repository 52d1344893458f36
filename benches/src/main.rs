//! Measures raycontact and its peers on the same workloads, interleaved in one run.

mod elsewhere;
mod host;
mod library;
mod measure;
mod method;
mod oracle;
mod peer;
mod report;
mod workload;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use workload::Workload;

/// Measures raycontact and its peers on the same workloads, interleaved in one run.
#[derive(Parser)]
#[command(name = "bench")]
struct Arguments {
    /// Also the workloads that take long: up to 409 600 triangles a body, up to 1000 bodies.
    #[arg(long)]
    full: bool,
    /// Only these workloads (stackN and pairMxN may have any numbers).
    #[arg(long, value_delimiter = ',')]
    workloads: Vec<String>,
    /// Only these methods.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// The shared library with the peers.
    #[arg(long, default_value = "libraycontact_bench_peers.so")]
    peers: OsString,
    /// Where to write detect.csv.
    #[arg(long, default_value = "out/bench")]
    out: PathBuf,
    /// Answers requests on standard input; for this program's own use.
    #[arg(long, hide = true)]
    serve: Option<String>,
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
    if let Some(workload) = &arguments.serve {
        return elsewhere::serve(workload);
    }
    let workloads = chosen_workloads(arguments)?;
    let methods = chosen_methods(arguments)?;
    let peers = peer::Library::open(&arguments.peers)?;
    let mut csv = create_csv(&arguments.out)?;
    let progress = ProgressBar::new((workloads.len() * methods.len()) as u64 * u64::from(measure::ROUNDS));
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {elapsed}, {eta} left  {msg}");
    progress.set_style(style.expect("the template is right"));

    let mut results = Vec::new();
    for name in &workloads {
        let workload = Workload::new(name).ok_or_else(|| format!("there is no workload '{name}'"))?;
        let more = measure::run(&workload, &methods, &peers, &progress)?;
        for result in &more {
            writeln!(csv, "{}", report::line(result)).map_err(|e| format!("cannot write the CSV file: {e}"))?;
        }
        results.extend(more);
    }
    progress.finish_and_clear();
    println!("{}{}", report::ratios(&results), report::faults(&results));
    Ok(())
}

fn chosen_workloads(arguments: &Arguments) -> Result<Vec<String>, String> {
    if arguments.workloads.is_empty() {
        return Ok(workload::names(arguments.full).into_iter().map(str::to_owned).collect());
    }
    Ok(arguments.workloads.clone())
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

fn create_csv(out: &Path) -> Result<std::fs::File, String> {
    let path = out.join("detect.csv");
    let failed = |error: std::io::Error| format!("cannot write {}: {error}", path.display());
    std::fs::create_dir_all(out).map_err(failed)?;
    let mut csv = std::fs::File::create(&path).map_err(failed)?;
    writeln!(csv, "{}", report::COLUMNS).map_err(failed)?;
    Ok(csv)
}
