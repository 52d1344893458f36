//! The charts, one panel for each scene, as SVG.

use super::row::{Measure, Row, front};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

type Failure = Box<dyn std::error::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const PANELS_ABREAST: usize = 3;
/// Heights in pixels.
const HEAD: u32 = 64;
const PANEL: u32 = 328;

/// What has the same colour: its name, and its rows.
type Family = (&'static str, RGBColor, fn(&Row) -> bool);

/// Told apart by most eyes (after Paul Tol). The first that fits counts.
const FAMILIES: [Family; 9] = [
    ("ray lengths", RGBColor(221, 170, 51), |row| {
        row.method == "raycontact" && row.settings.contains("law=ray-length")
    }),
    ("accuracy", RGBColor(204, 51, 17), |row| is_ours(row, "sampling=accuracy")),
    ("spacing", RGBColor(0, 153, 136), |row| is_ours(row, "sampling=spacing")),
    ("vertices", RGBColor(238, 119, 51), |row| is_ours(row, "sampling=vertices")),
    ("the paper's mode", RGBColor(51, 34, 136), |row| row.method == "paper"),
    ("Embree, Algorithm 1", RGBColor(170, 51, 119), |row| row.method.starts_with("embree")),
    ("Bullet", RGBColor(153, 153, 51), |row| row.method.starts_with("bullet")),
    ("FCL", RGBColor(102, 102, 102), |row| row.method.starts_with("fcl")),
    ("proximity", RGBColor(136, 204, 238), |row| row.method == "proximity"),
];

fn is_ours(row: &Row, sampling: &str) -> bool {
    row.method == "raycontact" && row.settings.contains(sampling)
}

fn colour(row: &Row) -> RGBColor {
    FAMILIES.iter().find(|(_, _, is_of)| is_of(row)).map_or(BLACK, |family| family.1)
}

/// Draws what there are rows of.
pub fn draw(rows: &[Row], folder: &Path) -> Result<(), String> {
    let lines = super::scenes(rows).len().div_ceil(PANELS_ABREAST);
    let charts = ["force.svg", "recall.svg", "direction.svg"].into_iter().zip(Measure::ALL);
    for (name, measure) in charts {
        let path = folder.join(name);
        let drawn = (|| {
            let area = SVGBackend::new(&path, (1000, HEAD + PANEL * lines as u32)).into_drawing_area();
            area.fill(&WHITE)?;
            figure(rows, measure, lines, &area)?;
            Ok::<(), Failure>(area.present()?)
        })();
        drawn.map_err(|error| format!("cannot draw {}: {error}", path.display()))?;
    }
    Ok(())
}

fn figure(rows: &[Row], measure: Measure, lines: usize, area: &Area) -> Result<(), Failure> {
    let (title, unit) = match measure {
        Measure::Force => ("Speed against accuracy: error of net force and torque", "error, %"),
        Measure::Missed => ("Speed against accuracy: vertices inside that got no contact", "missed, %"),
        Measure::Direction => ("Speed against accuracy: direction of the net force", "degrees"),
    };
    let (head, panels) = area.split_vertically(HEAD);
    head.draw_text(title, &("sans-serif", 20).into_text_style(&head), (16, 8))?;
    let mut x = 16;
    for (name, colour, _) in FAMILIES {
        head.draw(&Circle::new((x + 5, 47), 5, colour.filled()))?;
        head.draw_text(name, &("sans-serif", 13).into_text_style(&head), (x + 14, 40))?;
        x += 30 + 7 * name.chars().count() as i32;
    }
    let names = super::scenes(rows);
    for (panel, name) in panels.split_evenly((lines, PANELS_ABREAST)).iter().zip(&names) {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == *name).collect();
        self::panel(&of_scene, measure, name, unit, panel)?;
    }
    Ok(())
}

fn panel(rows: &[&Row], measure: Measure, name: &str, unit: &str, area: &Area) -> Result<(), Failure> {
    let (factor, least) = if measure == Measure::Direction { (1.0, 0.001) } else { (100.0, 0.01) };
    // Nothing wrong at all has no place on a logarithmic axis: it stands at the lower end.
    let point = |row: &Row| Some((row.time_over_lower_bound, (measure.of(row)? * factor).max(least)));
    let points = || rows.iter().filter_map(|row| point(row));
    let fold = |pick: fn((f64, f64)) -> f64, choose: fn(f64, f64) -> f64| points().map(pick).reduce(choose);
    let bounds = |pick| Some((fold(pick, f64::min)?, fold(pick, f64::max)?));
    let (Some((left, right)), Some((low, high))) = (bounds(|p| p.0), bounds(|p| p.1)) else { return Ok(()) };
    let mut chart = ChartBuilder::on(area)
        .caption(name, ("sans-serif", 15))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(52)
        // Room for what is written to the left of the front.
        .build_cartesian_2d(
            (left / (right / left).powf(0.55)..right * 1.3).log_scale(),
            (low / 1.5..high * 1.5).log_scale(),
        )?;
    let number = |x: &f64| format!("{x}");
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("time of a step, times the lower bound's")
        .y_desc(unit)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 12))
        .draw()?;
    let best = front(rows, measure);
    chart.draw_series(LineSeries::new(best.iter().filter_map(|row| point(row)), BLACK.mix(0.5).stroke_width(2)))?;
    let beside = |size: i32| ("sans-serif", size).into_text_style(area).pos(Pos::new(HPos::Right, VPos::Top));
    // One line of text for each height, first that of the default.
    let line = (high / low * 2.25).powf(0.045);
    let mut written: Vec<f64> =
        rows.iter().filter(|row| row.is_default()).filter_map(|row| Some(point(row)?.1)).collect();
    for row in best.iter().filter(|row| !row.is_default()) {
        let Some((x, y)) = point(row) else { continue };
        if written.iter().all(|other| y * line < *other || *other * line < y) {
            written.push(y);
            chart.draw_series([Text::new(row.short(), (x / 1.12, y / 1.05), beside(10))])?;
        }
    }
    for row in rows {
        let Some(place) = point(row) else { continue };
        chart.draw_series([Circle::new(place, 4, colour(row).mix(0.75).filled())])?;
        if row.is_default() {
            chart.draw_series([Circle::new(place, 8, BLACK.stroke_width(2))])?;
            chart.draw_series([Text::new("default", (place.0 / 1.25, place.1 / 1.05), beside(12))])?;
        }
    }
    Ok(())
}
