//! The CSV file, and the table of ratios for people.

use crate::measure::Result;
use crate::method::Precision;
use std::fmt::Write;

pub const COLUMNS: &str = "workload,method,precision,threads,triangles,contacts,total_us,normals_us,structure_us,\
                           trace_us,filter_us,missing,spurious,wrong_triangle";

/// One line of the CSV file.
pub fn line(result: &Result) -> String {
    let method = &result.method;
    let stages = result
        .stages
        .map_or(",,,".to_owned(), |s| format!("{:.2},{:.2},{:.2},{:.2}", s.normals, s.structure, s.trace, s.filter));
    let verdict =
        result.verdict.map_or(",,".to_owned(), |v| format!("{},{},{}", v.missing, v.spurious, v.wrong_triangle));
    format!(
        "{},{},{},{},{},{},{:.2},{stages},{verdict}",
        result.workload,
        method.name,
        method.precision.name(),
        method.threads,
        result.triangles,
        result.contacts,
        result.total
    )
}

/// How many times as long as raycontact each method takes, workload by workload.
pub fn ratios(results: &[Result]) -> String {
    let mut workloads: Vec<&str> = results.iter().map(|r| r.workload.as_str()).collect();
    workloads.dedup();
    let mut rows: Vec<Label> = Vec::new();
    for result in results {
        let label = Label::of(result);
        if !rows.contains(&label) {
            rows.push(label);
        }
    }
    let total = |workload: &str, label: &Label| {
        results.iter().find(|r| r.workload == workload && Label::of(r) == *label).map(|r| r.total)
    };
    let ours = Label { name: "raycontact", precision: Precision::F32, threads: 1 };
    let floor = Label { name: "floor", ..ours };

    let mut text = String::new();
    let mut row = |name: &str, cell: &dyn Fn(&str) -> Option<String>| {
        write!(text, "{name:<27}").expect("writing to a string");
        for workload in &workloads {
            let cell = cell(workload).unwrap_or("-".to_owned());
            write!(text, " {cell:>11}").expect("writing to a string");
        }
        text.push('\n');
    };
    row("", &|workload| Some(workload.to_owned()));
    row("raycontact f32, us", &|workload| total(workload, &ours).map(|t| format!("{t:.1}")));
    row("raycontact / floor", &|workload| Some(format!("{:.2}", total(workload, &ours)? / total(workload, &floor)?)));
    for label in rows.iter().filter(|&label| *label != ours && label.name != "floor") {
        row(&format!("{} / raycontact", label.text()), &|workload| {
            Some(format!("{:.2}", total(workload, label)? / total(workload, &ours)?))
        });
    }
    text
}

/// A row of the table.
#[derive(Clone, Copy, PartialEq)]
struct Label {
    name: &'static str,
    precision: Precision,
    threads: u32,
}

impl Label {
    fn of(result: &Result) -> Self {
        let method = result.method;
        Self { name: method.name, precision: method.precision, threads: method.threads }
    }

    fn text(&self) -> String {
        let precision = if self.precision == Precision::F64 { " f64" } else { "" };
        let threads = if self.threads > 1 { format!(" {} threads", self.threads) } else { String::new() };
        format!("{}{precision}{threads}", self.name)
    }
}

/// Methods whose contacts are not the oracle's, for the reader's eye.
pub fn faults(results: &[Result]) -> String {
    let mut text = String::new();
    for result in results {
        if let Some(v) = result.verdict.filter(|v| *v != Default::default()) {
            writeln!(
                text,
                "{} on {}: of {} contacts {} missing, {} spurious, {} on another triangle",
                Label::of(result).text(),
                result.workload,
                result.contacts,
                v.missing,
                v.spurious,
                v.wrong_triangle
            )
            .expect("writing to a string");
        }
    }
    text
}
