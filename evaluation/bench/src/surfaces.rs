//! Closed surfaces that are nobody's parametric shape.

use crate::Vector;
use crate::shapes::{self, Shape};
use raycontact::mesh::read_obj_file;
use std::path::{Path, PathBuf};

/// `cow.obj` and `spot.obj`: `cow-spot`.
pub fn stems(files: [&PathBuf; 2]) -> String {
    files.map(|file| file.file_stem().unwrap_or_default().to_string_lossy().replace(',', " ")).join("-")
}

/// The longest side of the standard torus's box.
pub const SIZE: f64 = 2.8;

/// The longest side of the box around a surface.
pub fn longest_side(shape: &Shape) -> f64 {
    let [lower, upper] = corners(&shape.points);
    (upper - lower).max()
}

fn corners(points: &[Vector]) -> [Vector; 2] {
    let first = points[0];
    points.iter().fold([first; 2], |[lower, upper], point| [lower.inf(point), upper.sup(point)])
}

/// A surface scaled to the size of the tori.
pub fn read(path: &Path) -> Result<Shape, String> {
    let (positions, triangles) = read_obj_file(path).map_err(|error| error.to_string())?;
    if positions.is_empty() {
        return Err(format!("{} has no vertices", path.display()));
    }
    let points: Vec<Vector> = positions.into_iter().map(Vector::from).collect();
    let [lower, upper] = corners(&points);
    let factor = SIZE / (upper - lower).max();
    let points = points.iter().map(|point| (point - (lower + upper) / 2.0) * factor).collect();
    Ok(Shape { points, triangles })
}

/// A ball with bumps.
pub fn bumpy(waves: f64, parts: usize) -> Shape {
    let mut shape = shapes::icosphere(parts);
    for p in &mut shape.points {
        *p *= 1.0 + 0.15 * (waves * p.x).sin() * (waves * p.y + 1.0).sin() * (waves * p.z + 2.0).sin();
    }
    shape
}
