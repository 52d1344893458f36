//! The charts, drawn from the rows as SVG.

use crate::method::PAPER;
use crate::row::{Row, labels};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::Path;

type Failure = Box<dyn std::error::Error>;
type Chart = fn(&[Row], &Area) -> Result<(), Failure>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws the names of a chart's series into it, whatever its coordinates are.
macro_rules! draw_legend {
    ($chart:ident) => {
        $chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.2))
            .label_font(("sans-serif", 14))
            .draw()?
    };
}

/// One curve: a method's label, and its points.
type Curve = (String, Vec<(f64, f64)>);

/// Dark enough on white, and apart from one another for most eyes (after Paul Tol).
const COLOURS: [RGBColor; 10] = [
    RGBColor(204, 51, 17),
    RGBColor(0, 119, 187),
    RGBColor(0, 153, 136),
    RGBColor(238, 119, 51),
    RGBColor(170, 51, 119),
    RGBColor(51, 34, 136),
    RGBColor(153, 153, 51),
    RGBColor(102, 102, 102),
    RGBColor(136, 204, 238),
    RGBColor(68, 170, 153),
];
/// Methods in the growth charts, one thread each.
const SHOWN: [&str; 10] = [
    PAPER,
    "embree-refit",
    "embree-low",
    "obvhs-refit",
    "parry3d-refit",
    "fcl-aabb",
    "bullet-vf",
    "lower-bound",
    "raycontact-paper-avx2",
    "raycontact-paper-classic",
];

/// Draws every chart for which there are rows.
pub fn draw(rows: &[Row], folder: &Path) -> Result<(), String> {
    let charts: [(&str, Chart); 3] =
        [("growth_triangles.svg", by_triangles), ("growth_bodies.svg", by_bodies), ("parallel.svg", parallel)];
    for (name, chart) in charts {
        let path = folder.join(name);
        let drawn = (|| {
            let area = SVGBackend::new(&path, (900, 560)).into_drawing_area();
            area.fill(&WHITE)?;
            chart(rows, &area)?;
            Ok::<(), Failure>(area.present()?)
        })();
        drawn.map_err(|error| format!("cannot draw {}: {error}", path.display()))?;
    }
    Ok(())
}

fn by_triangles(rows: &[Row], area: &Area) -> Result<(), Failure> {
    let size = |row: &Row| {
        let is_pair = row.workload.starts_with("pair") || row.workload == "stack2";
        is_pair.then_some(row.triangles as f64 / 2.0)
    };
    growth(area, "Two bodies, finer and finer", "triangles of each body", &curves(rows, size))
}

fn by_bodies(rows: &[Row], area: &Area) -> Result<(), Failure> {
    let size = |row: &Row| row.workload.strip_prefix("stack")?.parse().ok();
    growth(area, "More and more bodies of 1600 triangles", "bodies", &curves(rows, size))
}

fn curves(rows: &[Row], size: impl Fn(&Row) -> Option<f64>) -> Vec<Curve> {
    let curve = |label: &&str| {
        let of_method = rows.iter().filter(|row| row.label() == **label);
        let mut points: Vec<_> = of_method.filter_map(|row| Some((size(row)?, row.total_us))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        ((*label).to_owned(), points)
    };
    SHOWN.iter().map(curve).filter(|(_, points)| !points.is_empty()).collect()
}

fn growth(area: &Area, title: &str, unit: &str, curves: &[Curve]) -> Result<(), Failure> {
    let points = || curves.iter().flat_map(|(_, points)| points);
    let bounds = |pick: fn(&(f64, f64)) -> f64| {
        let values = || points().map(pick);
        (values().fold(f64::MAX, f64::min).min(1e6), values().fold(1.0, f64::max))
    };
    let ((left, right), (low, high)) = (bounds(|p| p.0), bounds(|p| p.1));
    // Room for the names on the left.
    let margin = (right / left).powf(0.4).max(1.5);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 22))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d((left / margin..right * 1.2).log_scale(), (low / 1.5..high * 1.5).log_scale())?;
    let number = |x: &f64| format!("{x}");
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc(unit)
        .y_desc("µs per step")
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 14))
        .draw()?;
    for ((label, points), colour) in curves.iter().zip(COLOURS) {
        let style = colour.stroke_width(if label == PAPER { 3 } else { 2 });
        let line = chart.draw_series(LineSeries::new(points.iter().copied(), style).point_size(3))?;
        line.label(label.as_str()).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
    }
    draw_legend!(chart);
    Ok(())
}

/// One thread's time over two threads', for the methods measured with both.
fn parallel(rows: &[Row], area: &Area) -> Result<(), Failure> {
    let workloads: Vec<String> = crate::row::workloads(rows);
    let total = |workload: &str, label: &str| crate::row::total(rows, workload, label);
    let mut curves: Vec<(String, Vec<(usize, f64)>)> = Vec::new();
    for label in labels(rows) {
        let Some(method) = label.strip_suffix(", 2 threads") else { continue };
        let speedup =
            |(place, workload): (usize, &String)| Some((place, total(workload, method)? / total(workload, &label)?));
        curves.push((method.to_owned(), workloads.iter().enumerate().filter_map(speedup).collect()));
    }
    let mut chart = ChartBuilder::on(area)
        .caption("Two threads: how many times as fast as one", ("sans-serif", 22))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(50)
        .build_cartesian_2d((0..workloads.len().max(1) - 1).into_segmented(), 0.0..2.2)?;
    let name = |place: &SegmentValue<usize>| match place {
        SegmentValue::CenterOf(place) => workloads.get(*place).cloned().unwrap_or_default(),
        _ => String::new(),
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(workloads.len().max(1))
        .x_label_formatter(&name)
        .label_style(("sans-serif", 13))
        .draw()?;
    for (number, ((label, points), colour)) in curves.iter().zip(COLOURS).enumerate() {
        // Beside one another within a workload's segment.
        let bars = points.iter().map(|&(place, speedup)| {
            let mut bar = Rectangle::new(
                [(SegmentValue::Exact(place), 0.0), (SegmentValue::Exact(place + 1), speedup)],
                colour.filled(),
            );
            let width = 800 / (workloads.len().max(1) * (curves.len() + 1)) as i32;
            let before = width / 2 + number as i32 * width;
            bar.set_margin(0, 0, before as u32, (width * curves.len() as i32 + width / 2 - before) as u32);
            bar
        });
        let series = chart.draw_series(bars)?;
        series
            .label(label.as_str())
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 14, y + 5)], colour.filled()));
    }
    draw_legend!(chart);
    Ok(())
}
