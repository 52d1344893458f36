//! The thirteen bodies: closed, manifold, outward, 4 to 434 vertices as they come, and finer on request.

mod cells;
mod surfaces;

pub use surfaces::Surface;

use crate::common::shapes as common;

/// In the order of their numbers.
pub const NAMES: [&str; 13] = [
    "torus",
    "sphere",
    "box",
    "tetrahedron",
    "star",
    "plate",
    "c-clamp",
    "comb",
    "bowl",
    "helix",
    "cross",
    "l-beam",
    "holed-shell",
];

/// The torus: its core circle, of radius 1, runs around the axis z of [`generate`]'s result.
pub const TORUS: usize = 0;

/// Shape `number` with about `vertices` vertices; 0 leaves it as coarse as it comes.
pub fn generate(number: usize, vertices: usize) -> Surface {
    let coarse = at_detail(number, 1);
    let detail = (2.0 * vertices as f64 / coarse.triangles.len() as f64).sqrt().round() as usize;
    if detail > 1 { at_detail(number, detail) } else { coarse }
}

/// Every edge of the coarse shape cut into `detail` pieces; round shapes get rounder.
fn at_detail(number: usize, detail: usize) -> Surface {
    let flat = |surface: Surface| surface.refined(detail);
    match NAMES[number] {
        "torus" => common::torus(20 * detail, 10 * detail, 0.35).into(),
        "sphere" => Surface::from(common::icosahedron()).refined(4 * detail).map(|p| p.normalize()),
        "box" => flat(common::block([1, 1, 1]).into()),
        "tetrahedron" => flat(common::tetrahedron().into()),
        "star" => flat(common::star().into()),
        "plate" => flat(Surface::from(common::block([8, 8, 1])).map(|p| [p.x / 8.0, p.y / 8.0, p.z * 0.02].into())),
        "c-clamp" => flat(cells::c_clamp()),
        "comb" => flat(cells::comb()),
        "bowl" => surfaces::shell(6 * detail, 16 * detail, 85.0, 0.85),
        "helix" => surfaces::helix(53 * detail, 8 * detail),
        "cross" => flat(cells::cross()),
        "l-beam" => flat(cells::l_beam()),
        "holed-shell" => surfaces::shell(10 * detail, 16 * detail, 150.0, 0.88),
        other => unreachable!("{other} has no generator"),
    }
}
