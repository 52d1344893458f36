//! The tables: for the terminal, and for documents, of which `docs/performance_notebook.md` has these.

use crate::method::PAPER;
use crate::row::{Row, labels, total, workloads};
use std::path::Path;

const LOWER_BOUND: &str = "lower-bound";

pub type Table = Vec<Vec<String>>;

/// By their names in the document.
pub fn all(rows: &[Row]) -> [(&'static str, Table); 3] {
    [("ratios", ratios(rows)), ("times", times(rows)), ("growth", growth(rows))]
}

/// How many times as long as the paper's work each method takes, and how that stands to the lower bound, by workload.
pub fn ratios(rows: &[Row]) -> Table {
    let workloads = workloads(rows);
    let line = |name: String, cell: &dyn Fn(&str) -> Option<String>| {
        let cells = workloads.iter().map(|workload| cell(workload).unwrap_or("–".to_owned()));
        std::iter::once(name).chain(cells).collect::<Vec<_>>()
    };
    let ratio = |workload: &str, over: &str, under: &str| {
        Some(format!("{:.2}", total(rows, workload, over)? / total(rows, workload, under)?))
    };
    let mut table = vec![
        line(String::new(), &|workload| Some(workload.to_owned())),
        line(format!("{PAPER}, µs"), &|workload| Some(format!("{:.1}", total(rows, workload, PAPER)?))),
        line(format!("{PAPER} / lower-bound"), &|workload| ratio(workload, PAPER, LOWER_BOUND)),
    ];
    for label in labels(rows) {
        if label.starts_with(LOWER_BOUND) || label == PAPER {
            continue;
        }
        table.push(line(format!("{label} / {PAPER}"), &|workload| ratio(workload, &label, PAPER)));
    }
    table
}

/// Microseconds of every method, by workload.
fn times(rows: &[Row]) -> Table {
    let workloads = workloads(rows);
    let mut table = vec![std::iter::once("µs".to_owned()).chain(workloads.iter().cloned()).collect::<Vec<_>>()];
    for label in labels(rows) {
        let cells = workloads
            .iter()
            .map(|workload| total(rows, workload, &label).map_or("–".to_owned(), |total| format!("{total:.1}")));
        table.push(std::iter::once(label.clone()).chain(cells).collect());
    }
    table
}

/// How time grows: the slope of its logarithm over that of the triangles, among pairs of ever finer bodies, among stacks of
/// ever more, and among those of them whose bodies nearly all have two neighbours; only of methods with more than two of
/// either. 1 is in proportion.
pub fn growth(rows: &[Row]) -> Table {
    let slope = |label: &str, family: &str, fewest: u32| {
        // The bodies of a stack; of a pair, more than any limit.
        let bodies = |workload: &str| workload.strip_prefix(family).map(|rest| rest.parse().unwrap_or(u32::MAX));
        let points: Vec<[f64; 2]> = rows
            .iter()
            .filter(|row| row.label() == label && bodies(&row.workload).is_some_and(|count| count >= fewest))
            .map(|row| [(row.triangles as f64).ln(), row.total_us.ln()])
            .collect();
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
        let [x, y] = [mean(0), mean(1)];
        let spread: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
        let shared: f64 = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
        if points.len() > 2 { format!("{:.3}", shared / spread) } else { "–".to_owned() }
    };
    let families = [("finer bodies", "pair", 0), ("more bodies", "stack", 0), ("from ten bodies on", "stack", 10)];
    let head = std::iter::once("slope").chain(families.map(|(name, ..)| name)).map(str::to_owned).collect();
    let lines = labels(rows).into_iter().map(|label| {
        let slopes = families.map(|(_, family, fewest)| slope(&label, family, fewest));
        std::iter::once(label).chain(slopes).collect()
    });
    let has_slope = |line: &Vec<String>| line[1..].iter().any(|cell| cell != "–");
    std::iter::once(head).chain(lines.filter(has_slope)).collect()
}

/// For the terminal.
pub fn aligned(table: &Table) -> String {
    let columns = table.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| table.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: &Vec<String>| {
        let first = format!("{:<width$}", cells[0], width = widths[0]);
        cells.iter().zip(&widths).skip(1).fold(first, |text, (cell, width)| format!("{text}  {cell:>width$}")) + "\n"
    };
    table.iter().map(line).collect()
}

fn markdown(table: &Table) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule: Vec<String> = (0..table[0].len()).map(|column| if column == 0 { "---" } else { "--:" }.into()).collect();
    line(&table[0]) + &line(&rule) + &table[1..].iter().map(|cells| line(cells)).collect::<String>()
}

/// Which contacts are not the oracle's.
pub fn faults(rows: &[Row]) -> String {
    let count = |number: Option<usize>| number.unwrap_or(0);
    let line = |row: &Row| {
        format!(
            "{} on {}: of {} contacts {} missing, {} spurious, {} on another triangle\n",
            row.label(),
            row.workload,
            row.contacts,
            count(row.missing),
            count(row.spurious),
            count(row.wrong_triangle)
        )
    };
    rows.iter().filter(|row| row.faults() > 0).map(line).collect()
}

/// Rewrites the tables of a document: each stands between `<!-- begin NAME -->` and `<!-- end NAME -->`.
pub fn renew_tables(document: &Path, tables: &[(&str, Table)]) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("cannot renew {}: {error}", document.display());
    let mut text = std::fs::read_to_string(document).map_err(failed)?;
    for (name, table) in tables {
        let (begin, end) = (format!("<!-- begin {name} -->\n"), format!("<!-- end {name} -->"));
        let (Some(from), Some(to)) = (text.find(&begin), text.find(&end)) else {
            return Err(format!("{} has no place for the table '{name}'", document.display()));
        };
        text.replace_range(from + begin.len()..to, &markdown(table));
    }
    std::fs::write(document, text).map_err(failed)
}
