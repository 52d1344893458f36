//! The paper's opponent, for comparison only: closest features within a thickness, found through a hierarchy of boxes
//! (after Bridson, Fedkiw and Anderson 2002). Every vertex nearer to a face, and every edge nearer to an edge, than the
//! thickness is pushed away from it along the line between the two closest points, until the thickness is reached.

use super::tree::{Bounds, Tree};
use nalgebra::Vector3;

type Point = Vector3<f64>;

/// In sizes of the smaller body.
const THICKNESS: f64 = 0.05;

/// What the method has to know of a body.
pub trait Surface {
    /// Its extent, for the thickness.
    fn size(&self) -> f64;
    fn positions(&self) -> &[Point];
    fn triangles(&self) -> &[[u32; 3]];
    fn edges(&self) -> impl Iterator<Item = [u32; 2]>;
    /// Over its triangles, as they are now.
    fn tree(&self) -> &Tree;
}

/// A wish: body 0 should move by `depth` along `direction` at the first point, against body 1 at the second.
#[derive(Clone, Copy, Debug)]
pub struct Repulsion {
    pub bodies: [usize; 2],
    pub points: [Point; 2],
    pub direction: Point,
    pub depth: f64,
}

/// The repulsions between all bodies.
pub fn repulsions<S: Surface>(bodies: &[S]) -> Vec<Repulsion> {
    let mut pushes = Vec::new();
    for [a, b] in (0..bodies.len()).flat_map(|a| (a + 1..bodies.len()).map(move |b| [a, b])) {
        let thickness = THICKNESS * bodies[a].size().min(bodies[b].size());
        vertices_on_faces(bodies, [a, b], thickness, &mut pushes);
        vertices_on_faces(bodies, [b, a], thickness, &mut pushes);
        edges_on_edges(bodies, [a, b], thickness, &mut pushes);
    }
    pushes
}

fn vertices_on_faces<S: Surface>(bodies: &[S], [a, b]: [usize; 2], thickness: f64, pushes: &mut Vec<Repulsion>) {
    let (triangles, positions) = (bodies[b].triangles(), bodies[b].positions());
    for &point in bodies[a].positions() {
        let bounds = Bounds::of([point]).grown(thickness);
        bodies[b].tree().any(&bounds, |triangle| {
            let corners = triangles[triangle as usize].map(|vertex| positions[vertex as usize]);
            // Beside the face, its edges and the vertex's own do the work.
            if Bounds::of(corners).meets(&bounds)
                && let Some(closest) = closest_within_triangle(&point, &corners)
            {
                let [p, q, r] = corners;
                push_apart([a, b], [point, closest], thickness, (q - p).cross(&(r - p)), pushes);
            }
            false
        });
    }
}

fn edges_on_edges<S: Surface>(bodies: &[S], [a, b]: [usize; 2], thickness: f64, pushes: &mut Vec<Repulsion>) {
    let (triangles, positions) = (bodies[b].triangles(), bodies[b].positions());
    for edge in bodies[a].edges() {
        let [p, q] = edge.map(|vertex| bodies[a].positions()[vertex as usize]);
        let bounds = Bounds::of([p, q]).grown(thickness);
        bodies[b].tree().any(&bounds, |triangle| {
            let corners = triangles[triangle as usize];
            for (from, to) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])] {
                // Its other triangle has the edge the other way round.
                if from < to {
                    let [r, s] = [from, to].map(|vertex| positions[vertex as usize]);
                    if Bounds::of([r, s]).meets(&bounds)
                        && let Some(points) = closest_on_lines([p, q], [r, s])
                    {
                        push_apart([a, b], points, thickness, (q - p).cross(&(s - r)), pushes);
                    }
                }
            }
            false
        });
    }
}

/// `across`: the direction where the two points coincide.
fn push_apart(bodies: [usize; 2], points: [Point; 2], thickness: f64, across: Point, pushes: &mut Vec<Repulsion>) {
    let between = points[0] - points[1];
    let distance = between.norm();
    if distance < thickness {
        let direction = between.try_normalize(1e-12).or_else(|| across.try_normalize(0.0));
        if let Some(direction) = direction {
            pushes.push(Repulsion { bodies, points, direction, depth: thickness - distance });
        }
    }
}

/// The closest point of a triangle's plane, where it lies within the triangle, not on its border.
fn closest_within_triangle(point: &Point, [a, b, c]: &[Point; 3]) -> Option<Point> {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(&ac);
    let foot = point - a;
    let square = normal.norm_squared();
    let v = foot.cross(&ac).dot(&normal) / square;
    let w = ab.cross(&foot).dot(&normal) / square;
    (v > 0.0 && w > 0.0 && v + w < 1.0).then(|| a + ab * v + ac * w)
}

/// The closest point of a triangle (Ericson 2004, section 5.1.5, by regions).
pub fn closest_on_triangle(point: &Point, corners: &[Point; 3]) -> Point {
    if let Some(closest) = closest_within_triangle(point, corners) {
        return closest;
    }
    let [a, b, c] = corners;
    let on_edge = |from: &Point, to: &Point| {
        let along = to - from;
        from + along * ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
    };
    let candidates = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    let nearest = candidates.into_iter().min_by(|p, q| (p - point).norm().total_cmp(&(q - point).norm()));
    nearest.unwrap_or(*a)
}

/// The closest points of two segments, where both lie strictly between the ends.
fn closest_on_lines([p, q]: [Point; 2], [r, s]: [Point; 2]) -> Option<[Point; 2]> {
    let (u, v, w) = (q - p, s - r, p - r);
    let (uu, uv, vv, uw, vw) = (u.norm_squared(), u.dot(&v), v.norm_squared(), u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    if determinant <= 1e-12 * uu * vv {
        return None;
    }
    let (x, y) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
    let between = |share: f64| share > 0.0 && share < 1.0;
    (between(x) && between(y)).then(|| [p + u * x, r + v * y])
}
