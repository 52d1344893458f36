//! The contacts by brute force, in double precision, with code of its own: every ray against every triangle.

use crate::host::{Host, HostBody};
use crate::method::Key;
use crate::workload::{Body, Workload};
use rayon::prelude::*;

/// Above this many ray–triangle tests only every n-th vertex is judged.
const MOST_TESTS: u64 = 2_000_000_000;

pub struct Oracle {
    contacts: Vec<Key>,
    /// Vertices whose number is a multiple of this are judged.
    stride: u32,
}

/// How a method's contacts differ from the oracle's.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub struct Verdict {
    pub missing: usize,
    pub spurious: usize,
    pub wrong_triangle: usize,
}

type Vector = [f64; 3];

fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

struct Surface<'a> {
    positions: &'a [Vector],
    triangles: &'a [[u32; 3]],
    /// Sums of the surrounding triangles' normals.
    normals: Vec<Vector>,
    lower: Vector,
    upper: Vector,
}

struct Hit {
    t: f64,
    triangle: u32,
    is_exit: bool,
}

impl<'a> Surface<'a> {
    fn new(body: &'a Body, host: &'a HostBody) -> Self {
        let positions = host.double();
        let mut normals = vec![[0.0; 3]; positions.len()];
        for corners in &body.triangles {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            let normal = cross(sub(b, a), sub(c, a));
            for &v in corners {
                normals[v as usize] = sub(normals[v as usize], normal.map(|x| -x));
            }
        }
        let bound = |pick: fn(f64, f64) -> f64| {
            positions.iter().copied().reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i]))).expect("not empty")
        };
        Self { positions, triangles: &body.triangles, normals, lower: bound(f64::min), upper: bound(f64::max) }
    }

    /// The nearest hit, not counting triangles around `vertex`.
    fn nearest(&self, origin: Vector, direction: Vector, vertex: Option<u32>) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| sub(self.positions[v as usize], origin));
            let normal = cross(direction, c);
            let (u, v) = (dot(normal, b), dot(cross(direction, a), c));
            let w = dot(cross(direction, b), a);
            // Signed volumes: all of one sign where the line passes through the triangle.
            if !((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0)) {
                continue;
            }
            let outward = cross(sub(b, a), sub(c, a));
            let along = dot(outward, direction);
            let t = dot(outward, a) / along;
            let is_nearer = t >= 0.0 && t.is_finite() && nearest.as_ref().is_none_or(|hit| t < hit.t);
            if is_nearer && vertex.is_none_or(|vertex| !corners.contains(&vertex)) {
                nearest = Some(Hit { t, triangle: triangle as u32, is_exit: along > 0.0 });
            }
        }
        nearest
    }
}

/// One vertex that casts: colliding body, collided body, vertex.
type Ray = (u32, u32, u32);

/// Which vertices lie inside another body, as body and vertex; of many only each n-th. The first surface that a ray into
/// the own body meets is then left there. The bodies must not overlap themselves.
pub fn inside(workload: &Workload, host: &Host) -> Vec<[u32; 2]> {
    let (bodies, rays, stride) = prepare(workload, host);
    let judged = rays.into_par_iter().filter(|ray| ray.2 % stride == 0);
    let inside = judged.filter_map(|(colliding, collided, vertex)| {
        let body = &bodies[colliding as usize];
        let direction = body.normals[vertex as usize].map(|x| -x);
        let hit = bodies[collided as usize].nearest(body.positions[vertex as usize], direction, None)?;
        hit.is_exit.then_some([colliding, vertex])
    });
    let mut inside: Vec<_> = inside.collect();
    inside.sort_unstable();
    inside.dedup();
    inside
}

/// The surfaces, their rays, and of how many vertices one is judged.
fn prepare<'a>(workload: &'a Workload, host: &'a Host) -> (Vec<Surface<'a>>, Vec<Ray>, u32) {
    let bodies: Vec<_> =
        workload.bodies.par_iter().zip(&host.bodies).map(|(body, host)| Surface::new(body, host)).collect();
    let rays = casting(&bodies);
    let tests: u64 = rays.iter().map(|ray| bodies[ray.1 as usize].triangles.len() as u64 * 2).sum();
    (bodies, rays, tests.div_ceil(MOST_TESTS).max(1) as u32)
}

impl Oracle {
    pub fn new(workload: &Workload, host: &Host) -> Self {
        let (bodies, rays, stride) = prepare(workload, host);
        let judged = rays.into_par_iter().filter(|ray| ray.2 % stride == 0);
        let mut contacts: Vec<Key> = judged.filter_map(|ray| contact(&bodies, ray)).collect();
        contacts.sort_unstable();
        Self { contacts, stride }
    }

    pub fn judge(&self, mut found: Vec<Key>) -> Verdict {
        found.retain(|key| key.vertex % self.stride == 0);
        found.sort_unstable();
        let place = |key: &Key| (key.colliding, key.collided, key.vertex);
        let mut verdict = Verdict::default();
        let (mut wanted, mut found) = (self.contacts.iter().peekable(), found.iter().peekable());
        loop {
            match (wanted.peek(), found.peek()) {
                (None, None) => return verdict,
                (Some(a), Some(b)) if place(a) == place(b) => {
                    verdict.wrong_triangle += usize::from(a.triangle != b.triangle);
                    wanted.next();
                    found.next();
                }
                (Some(a), b) if b.is_none_or(|b| place(a) < place(b)) => {
                    verdict.missing += 1;
                    wanted.next();
                }
                _ => {
                    verdict.spurious += 1;
                    found.next();
                }
            }
        }
    }
}

fn casting(bodies: &[Surface]) -> Vec<Ray> {
    let mut rays = Vec::new();
    for (collided, b) in bodies.iter().enumerate() {
        for (colliding, a) in bodies.iter().enumerate().filter(|&(colliding, _)| colliding != collided) {
            let lower: Vector = std::array::from_fn(|i| a.lower[i].max(b.lower[i]));
            let upper: Vector = std::array::from_fn(|i| a.upper[i].min(b.upper[i]));
            if (0..3).any(|i| lower[i] > upper[i]) {
                continue;
            }
            for (vertex, p) in a.positions.iter().enumerate() {
                if (0..3).all(|i| lower[i] <= p[i] && p[i] <= upper[i]) {
                    rays.push((colliding as u32, collided as u32, vertex as u32));
                }
            }
        }
    }
    rays
}

fn contact(bodies: &[Surface], (colliding, collided, vertex): Ray) -> Option<Key> {
    let body = &bodies[colliding as usize];
    let origin = body.positions[vertex as usize];
    let direction = body.normals[vertex as usize].map(|x| -x);
    let hit = bodies[collided as usize].nearest(origin, direction, None).filter(|hit| hit.is_exit)?;
    let own = body.nearest(origin, direction, Some(vertex));
    if own.is_some_and(|own| own.t < hit.t) {
        return None;
    }
    Some(Key { colliding, collided, vertex, triangle: hit.triangle })
}
