//! Bodies as line drawings, side by side, in SVG.

use super::body::Body;
use nalgebra::{Matrix3, Vector3};
use std::fmt::Write;

pub struct Panel<'a> {
    pub title: String,
    pub bodies: Vec<Body<'a>>,
}

const SIDE: f64 = 220.0;
const TITLE: f64 = 24.0;
/// Told apart by colour-blind readers too.
const COLOURS: [&str; 2] = ["#1b6ab3", "#ee8822"];

/// All panels to one scale, each around the middle of its bodies.
pub fn svg(panels: &[Panel]) -> String {
    let view = view();
    let boxes: Vec<_> = panels.iter().map(|panel| bounds(&panel.bodies, &view)).collect();
    let widest = boxes.iter().map(|(lower, upper)| (upper - lower).xy().max()).fold(0.0, f64::max);
    let scale = 0.9 * SIDE / widest;
    let (width, height) = (SIDE * panels.len() as f64, SIDE + TITLE);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"13\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (place, (panel, (lower, upper))) in panels.iter().zip(boxes).enumerate() {
        let (left, middle) = (SIDE * place as f64, (lower + upper) / 2.0);
        let title =
            format!("<text x=\"{}\" y=\"17\" text-anchor=\"middle\">{}</text>\n", left + SIDE / 2.0, panel.title);
        text.push_str(&title);
        for (number, body) in panel.bodies.iter().enumerate() {
            let mut path = String::new();
            for ends in outline(body, &view) {
                let [a, b] = ends.map(|end| (view * end - middle) * scale);
                let [x, y] = [left + SIDE / 2.0, TITLE + SIDE / 2.0];
                // Writing to a string cannot fail.
                let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", x + a.x, y - a.y, x + b.x, y - b.y);
            }
            let colour = COLOURS[number % COLOURS.len()];
            let _ = writeln!(text, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\".8\"/>");
        }
    }
    text.push_str("</svg>\n");
    text
}

/// From the front, the right and above; depth is the third coordinate, towards the eye.
fn view() -> Matrix3<f64> {
    let eye = Vector3::new(0.5, -0.75, 0.43).normalize();
    let right = Vector3::z().cross(&eye).normalize();
    Matrix3::from_rows(&[right.transpose(), eye.cross(&right).transpose(), eye.transpose()])
}

fn bounds(bodies: &[Body], view: &Matrix3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let points = bodies.iter().flat_map(|body| &body.positions).map(|point| view * point);
    let nothing = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points.fold(nothing, |(lower, upper), point| (lower.inf(&point), upper.sup(&point)))
}

/// The edges where the surface turns away from the eye, and the sharp ones.
fn outline<'a>(body: &'a Body, view: &'a Matrix3<f64>) -> impl Iterator<Item = [Vector3<f64>; 2]> + 'a {
    let is_drawn = move |edge: &&super::body::Edge| {
        let [one, other] = edge.triangles.map(|triangle| {
            let [a, b, c] = body.corners(triangle);
            view * (b - a).cross(&(c - a)).normalize()
        });
        one.z * other.z <= 0.0 || one.dot(&other) < 0.7
    };
    body.rest.edges.iter().filter(is_drawn).map(|edge| body.ends(edge))
}
