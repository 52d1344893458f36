//! One line of `detect.csv`.

use crate::method::{C_DEFAULTS, RUST_DEFAULTS};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Medians of one method on one workload. Columns stay empty where a method has nothing to say.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub workload: String,
    pub method: String,
    pub precision: String,
    pub threads: u32,
    pub triangles: usize,
    pub contacts: usize,
    pub total_us: f64,
    pub normals_us: Option<f64>,
    pub structure_us: Option<f64>,
    pub trace_us: Option<f64>,
    pub filter_us: Option<f64>,
    pub missing: Option<usize>,
    pub spurious: Option<usize>,
    pub wrong_triangle: Option<usize>,
}

impl Row {
    /// How a reader should find the method named. The default is in double precision; all else that names none is in single.
    pub fn label(&self) -> String {
        let is_default = [C_DEFAULTS, RUST_DEFAULTS].contains(&self.method.as_str());
        let precision = match (is_default, self.precision == "f64") {
            (true, false) => " f32",
            (false, true) => " f64",
            _ => "",
        };
        let threads = if self.threads > 1 { format!(", {} threads", self.threads) } else { String::new() };
        format!("{}{precision}{threads}", self.method)
    }

    /// In how many contacts it differs from the oracle.
    pub fn faults(&self) -> usize {
        [self.missing, self.spurious, self.wrong_triangle].into_iter().flatten().sum()
    }
}

pub fn read(path: &Path) -> Result<Vec<Row>, String> {
    let failed = |error: csv::Error| format!("cannot read {}: {error}", path.display());
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(failed)?;
    reader.deserialize().map(|row| row.map_err(failed)).collect()
}

/// The labels of all methods, and the names of all workloads, each in the order of the rows.
pub fn labels(rows: &[Row]) -> Vec<String> {
    in_order(rows.iter().map(Row::label))
}

pub fn workloads(rows: &[Row]) -> Vec<String> {
    in_order(rows.iter().map(|row| row.workload.clone()))
}

pub fn total(rows: &[Row], workload: &str, label: &str) -> Option<f64> {
    rows.iter().find(|row| row.workload == workload && row.label() == label).map(|row| row.total_us)
}

fn in_order(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept: Vec<String> = Vec::new();
    for name in names {
        if !kept.contains(&name) {
            kept.push(name);
        }
    }
    kept
}
