//! Where the bodies of a pose start.

use super::body::{Body, Edge, Rest};
use super::judge::{surfaces_meet, vertices_inside};
use super::options::Options;
use crate::random::Random;
use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};

/// How the bodies overlap at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A random point inside one lies on a random point inside the other.
    Deep,
    /// The same body twice, vertex on vertex.
    Coincident,
    /// One swallowed by the other, around the point deepest inside it.
    ContainedCentre,
    /// One swallowed by the other, somewhere.
    ContainedAside,
    /// Edge over edge, and no vertex of either inside the other.
    Edges,
}

impl Kind {
    pub const ALL: [Self; 5] = [Self::Deep, Self::Coincident, Self::ContainedCentre, Self::ContainedAside, Self::Edges];

    pub fn name(self) -> &'static str {
        match self {
            Self::Deep => "deep",
            Self::Coincident => "coincident",
            Self::ContainedCentre => "contained-centre",
            Self::ContainedAside => "contained-aside",
            Self::Edges => "edges",
        }
    }

    /// Four poses of ten are deep, two coincident, two contained, two edge on edge.
    fn of_pose(number: u64) -> Self {
        match number % 10 {
            0..4 => Self::Deep,
            4 | 5 => Self::Coincident,
            6 => Self::ContainedCentre,
            7 => Self::ContainedAside,
            _ => Self::Edges,
        }
    }
}

/// A pose to start from.
pub struct Start<'a> {
    pub kind: Kind,
    pub bodies: Vec<Body<'a>>,
    /// The share of the smaller of the first two that lies inside the other.
    pub overlap: f64,
}

/// Pose `number` of the options' seed: bodies of the given shapes, each overlapping an earlier one, no two tori linked.
pub fn start<'a>(rests: &'a [Rest], options: &Options, number: u64) -> Start<'a> {
    let mut random = Random::new(options.seed, number);
    let kind = options.kind.unwrap_or_else(|| Kind::of_pose(number));
    loop {
        let bodies = draw(rests, kind, options.pile, &mut random);
        if let Some(bodies) = bodies.filter(|bodies| !has_linked_tori(bodies)) {
            let overlap = overlap(&bodies[0], &bodies[1]);
            return Start { kind, bodies, overlap };
        }
    }
}

fn draw<'a>(rests: &'a [Rest], kind: Kind, count: usize, random: &mut Random) -> Option<Vec<Body<'a>>> {
    let first = random.pick(rests);
    let mut bodies = vec![Body::new(first, random.between(0.8, 1.2), turn(random), random.point(0.5).into())];
    while bodies.len() < count {
        let rest = random.pick(rests);
        let earlier = &bodies[random.below(bodies.len())];
        let next = match kind {
            Kind::Deep => deep(rest, earlier, random),
            Kind::Coincident => Some(bodies[0].clone()),
            Kind::ContainedCentre => contained(rest, &bodies[0], true, random),
            Kind::ContainedAside => contained(rest, &bodies[0], false, random),
            Kind::Edges => edge_on_edge(rest, earlier, random),
        };
        bodies.push(next?);
    }
    Some(bodies)
}

/// All orientations alike (Shoemake 1992).
pub fn turn(random: &mut Random) -> UnitQuaternion<f64> {
    let axis = Unit::new_normalize(Vector3::from(random.direction()));
    let (share, angle) = (random.unit(), random.between(0.0, std::f64::consts::TAU));
    let other = Unit::new_normalize(Vector3::from(random.direction()));
    UnitQuaternion::from_axis_angle(&axis, angle)
        * UnitQuaternion::from_axis_angle(&other, share * std::f64::consts::PI)
}

/// The deepest of a few: most overlaps of thin bodies are small.
fn deep<'a>(rest: &'a Rest, earlier: &Body, random: &mut Random) -> Option<Body<'a>> {
    const DRAWS: usize = 12;
    let mut best: Option<(f64, Body)> = None;
    for _ in 0..DRAWS {
        let (size, rotation) = (random.between(0.8, 1.2), turn(random));
        let point = earlier.to_world(&random.pick(&earlier.rest.interior).0);
        let centre = point - rotation * random.pick(&rest.interior).0 * size;
        let body = Body::new(rest, size, rotation, centre);
        let overlap = overlap(earlier, &body);
        if best.as_ref().is_none_or(|(deepest, _)| overlap > *deepest) {
            best = Some((overlap, body));
        }
    }
    best.map(|(_, body)| body)
}

fn overlap(a: &Body, b: &Body) -> f64 {
    const POINTS: usize = 40;
    let volume = |body: &Body| body.rest.volume * body.size.powi(3);
    let (smaller, larger) = if volume(a) < volume(b) { (a, b) } else { (b, a) };
    let points = smaller.rest.interior[..POINTS].iter();
    let inside = points.filter(|(point, _)| larger.rest.is_inside(&larger.to_rest(&smaller.to_world(point))));
    inside.count() as f64 / POINTS as f64
}

fn contained<'a>(rest: &'a Rest, outer: &Body, at_centre: bool, random: &mut Random) -> Option<Body<'a>> {
    let interior = &outer.rest.interior;
    let deepest = interior.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    // So that the inner body is not too small beside the outer one.
    let wide: Vec<_> = interior.iter().filter(|(_, clearance)| *clearance > 0.3 * deepest.1).collect();
    let (point, clearance) = if at_centre { deepest } else { random.pick(&wide) };
    let size = clearance * outer.size * random.between(0.5, 0.95) / rest.radius;
    let body = Body::new(rest, size, turn(random), outer.to_world(point));
    (!surfaces_meet(outer, &body)).then_some(body)
}

/// Two convex edges across each other, the one dipped below the other.
fn edge_on_edge<'a>(rest: &'a Rest, earlier: &Body, random: &mut Random) -> Option<Body<'a>> {
    let size = random.between(0.8, 1.2);
    let (edge, outward) = convex_edge(earlier.rest, random)?;
    let (point, length) = edge_point(earlier.rest, &edge, random);
    let (other, other_outward) = convex_edge(rest, random)?;
    let (other_point, other_length) = edge_point(rest, &other, random);

    let outward = earlier.rotation * outward;
    let facing = Rotation3::rotation_between(&other_outward, &-outward)?;
    let twist = Rotation3::from_axis_angle(&Unit::new_normalize(outward), random.between(0.0, std::f64::consts::TAU));
    let tilt = Rotation3::from_scaled_axis(Vector3::from(random.direction()) * random.between(0.0, 0.3));
    let rotation = UnitQuaternion::from_rotation_matrix(&(tilt * twist * facing));
    let dip = (length * earlier.size).min(other_length * size) * 10f64.powf(random.between(-2.0, -0.3));
    let centre = earlier.to_world(&point) - outward * dip - rotation * other_point * size;
    let body = Body::new(rest, size, rotation, centre);
    let crosses =
        surfaces_meet(earlier, &body) && vertices_inside(&body, earlier) + vertices_inside(earlier, &body) == 0;
    crosses.then_some(body)
}

fn convex_edge(rest: &Rest, random: &mut Random) -> Option<(Edge, Vector3<f64>)> {
    (0..256).find_map(|_| {
        let edge = *random.pick(&rest.edges);
        let normal = |triangle: u32| {
            let [a, b, c] = rest.corners(triangle);
            (b - a).cross(&(c - a)).normalize()
        };
        let [one, other] = edge.triangles.map(normal);
        let start = rest.positions[edge.vertices[0] as usize];
        let falls = rest.corners(edge.triangles[1]).iter().all(|corner| (corner - start).dot(&one) < 1e-9);
        (falls && one.dot(&other) < 0.999).then(|| (edge, (one + other).normalize()))
    })
}

fn edge_point(rest: &Rest, edge: &Edge, random: &mut Random) -> (Vector3<f64>, f64) {
    let [from, to] = edge.vertices.map(|vertex| rest.positions[vertex as usize]);
    (from + (to - from) * random.between(0.2, 0.8), (to - from).norm())
}

fn has_linked_tori(bodies: &[Body]) -> bool {
    let tori: Vec<&Body> = bodies.iter().filter(|body| body.rest.ring.is_some()).collect();
    tori.iter().enumerate().any(|(place, a)| tori[..place].iter().any(|b| linking_number(a, b) != 0))
}

/// The Gauss linking number of two circles: how often the second goes through the first's disc, forth less back. Two
/// bodies that are linked can only be parted through each other.
fn linking_number(a: &Body, b: &Body) -> i32 {
    let radius = |body: &Body| body.rest.ring.unwrap_or(0.0) * body.size;
    let [normal, axis] = [a, b].map(|body| body.rotation * Vector3::z());
    let offset = b.centre - a.centre;
    // The second circle at the angle φ: offset + radius (u cos φ + v sin φ), with u in the first circle's plane.
    let Some(u) = normal.cross(&axis).try_normalize(1e-12) else { return 0 };
    let v = axis.cross(&u);
    let sine = -offset.dot(&normal) / (radius(b) * v.dot(&normal));
    if sine.abs() >= 1.0 {
        return 0;
    }
    let cosine = (1.0 - sine * sine).sqrt();
    let passes = [cosine, -cosine].map(|cosine| {
        let point = offset + (u * cosine + v * sine) * radius(b);
        let upward = (cosine * v.dot(&normal)).signum() as i32;
        if point.norm() < radius(a) { upward } else { 0 }
    });
    passes[0] + passes[1]
}
