//! Rays against one body through the C interface, beside Embree's.

mod embree;
mod kinds;
mod measure;
mod row;

use crate::libraries;
use crate::report::{Table, aligned};
use crate::workload::{self, Workload};
use clap::ValueEnum;
use row::Row;
use std::path::PathBuf;

/// Measures rays against one body through the C interface, beside Embree's single rays and streams.
#[derive(clap::Args)]
pub struct Arguments {
    /// Workloads: rays meet the first body; some start from the second.
    #[arg(long, value_delimiter = ',', default_value = "deep40,deep320,deepbumpy")]
    workloads: Vec<String>,
    /// Two closed surfaces as Wavefront files: a workload more.
    #[arg(long, num_args = 2)]
    files: Vec<PathBuf>,
    /// The instructions that both may use.
    #[arg(long, default_value = "avx512")]
    simd: Simd,
    /// How many rays of a kind.
    #[arg(long, default_value = "65536")]
    count: usize,
    #[command(flatten)]
    libraries: libraries::Paths,
    /// The folder for rays.csv.
    #[arg(long, default_value = "out/bench")]
    out: PathBuf,
}

/// The best that both may use; Embree has no path between SSE2 and AVX that raycontact has.
#[derive(Clone, Copy, ValueEnum)]
enum Simd {
    Avx512,
    Avx2,
    Baseline,
}

impl Simd {
    fn name(self) -> &'static str {
        match self {
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Baseline => "baseline",
        }
    }

    /// For Embree's configuration: all that the processor has, or no more than this.
    fn of_embree(self) -> &'static str {
        match self {
            Self::Avx512 => "",
            Self::Avx2 => ",isa=avx2",
            Self::Baseline => ",isa=sse2",
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), String> {
    // SAFETY: no other thread runs yet. The library asks for it at its first call, and this program never calls its own.
    unsafe { std::env::set_var("RAYCONTACT_SIMD", arguments.simd.name()) };
    let libraries = arguments.libraries.open()?;
    let path = arguments.out.join("rays.csv");
    std::fs::create_dir_all(&arguments.out).map_err(|e| format!("cannot make {}: {e}", arguments.out.display()))?;
    let failed = |error: csv::Error| format!("cannot write {}: {error}", path.display());
    let mut csv = csv::Writer::from_path(&path).map_err(failed)?;
    let mut names = arguments.workloads.clone();
    if let [first, second] = &arguments.files[..] {
        names.push(workload::of_files([first, second], 0.2, 1));
    }
    let mut rows = Vec::new();
    for name in &names {
        let workload = Workload::new(name)?;
        rows.extend(measure::run(&workload, arguments, &libraries)?);
    }
    for row in &rows {
        csv.serialize(row).map_err(failed)?;
    }
    csv.flush().map_err(|e| failed(e.into()))?;
    print!("{}", aligned(&table(&rows)));
    Ok(())
}

/// Nanoseconds for a ray of Embree's single rays, and how many times as long as each method they take.
fn table(rows: &[Row]) -> Table {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let head = ["surface", "rays", "ns, embree-single"].into_iter().chain(methods[1..].iter().copied());
    let mut table = vec![head.map(str::to_owned).collect::<Vec<_>>()];
    for first in rows.iter().filter(|row| row.method == methods[0]) {
        let same = rows.iter().filter(|row| (&row.workload, &row.kind) == (&first.workload, &first.kind));
        let mut line = vec![first.workload.clone(), first.kind.clone(), format!("{:.0}", first.ns)];
        line.extend(same.skip(1).map(|row| {
            let faults =
                if row.wrong > 0 { format!(" ({} of {} wrong)", row.wrong, row.checked) } else { String::new() };
            format!("{:.2}{faults}", row.embree_single_over_this)
        }));
        table.push(line);
    }
    table
}
