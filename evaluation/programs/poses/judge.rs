//! Are two bodies apart? Decided by exact predicates on the very coordinates the library is given, and by nothing of the
//! library: apart means that no edge of one meets a triangle of the other, not even in a point, and that no vertex of
//! one lies inside the other.

use super::body::Body;
use super::tree::Bounds;
use nalgebra::Vector3;
use robust::{Coord, Coord3D, orient2d, orient3d};

type Point = Vector3<f64>;

/// Which bodies are apart; remembers where two last met, since they mostly still do.
#[derive(Debug, Default)]
pub struct Judge {
    meeting: Option<Meeting>,
}

#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// The edge's body and the triangle's.
    bodies: [usize; 2],
    edge: usize,
    triangle: u32,
}

impl Judge {
    /// Whether all bodies are apart from one another.
    pub fn all_apart(&mut self, bodies: &[Body]) -> bool {
        if let Some(Meeting { bodies: [a, b], edge, triangle }) = self.meeting {
            let ends = bodies[a].ends(&bodies[a].rest.edges[edge]);
            if meets(&ends, &bodies[b].corners(triangle)) {
                return false;
            }
        }
        let pairs = (0..bodies.len()).flat_map(|a| (a + 1..bodies.len()).map(move |b| [a, b]));
        let close = |[a, b]: &[usize; 2]| bodies[*a].tree.bounds().meets(bodies[*b].tree.bounds());
        let close: Vec<_> = pairs.filter(close).collect();
        for [a, b] in close.iter().copied().flat_map(|[a, b]| [[a, b], [b, a]]) {
            if let Some((edge, triangle)) = first_meeting(&bodies[a], &bodies[b]) {
                self.meeting = Some(Meeting { bodies: [a, b], edge, triangle });
                return false;
            }
        }
        // The surfaces do not meet, so a connected one is inside another with all its vertices or with none.
        !close
            .into_iter()
            .any(|[a, b]| holds_first_vertex(&bodies[a], &bodies[b]) || holds_first_vertex(&bodies[b], &bodies[a]))
    }
}

/// Whether the surfaces meet.
pub fn surfaces_meet(a: &Body, b: &Body) -> bool {
    first_meeting(a, b).is_some() || first_meeting(b, a).is_some()
}

/// How many vertices of `body` lie inside `other`.
pub fn vertices_inside(body: &Body, other: &Body) -> usize {
    body.positions.iter().filter(|point| is_inside(point, other)).count()
}

fn holds_first_vertex(outer: &Body, inner: &Body) -> bool {
    is_inside(&inner.positions[0], outer)
}

fn first_meeting(a: &Body, b: &Body) -> Option<(usize, u32)> {
    a.rest.edges.iter().enumerate().find_map(|(number, edge)| {
        let ends = a.ends(edge);
        let bounds = Bounds::of(ends);
        let mut met = None;
        bounds.meets(b.tree.bounds()).then(|| {
            b.tree.any(&bounds, |triangle| {
                let corners = b.corners(triangle);
                let meeting = Bounds::of(corners).meets(&bounds) && meets(&ends, &corners);
                met = met.or(meeting.then_some(triangle));
                meeting
            })
        });
        met.map(|triangle| (number, triangle))
    })
}

/// Whether a point lies inside a body, by the parity of the crossings on a way out of it. Points on the surface may be
/// either.
fn is_inside(point: &Point, body: &Body) -> bool {
    if !body.tree.bounds().holds(point) {
        return false;
    }
    let reach = 2.0 * (body.tree.bounds().upper.x - point.x) + body.size;
    // A way through an edge or vertex tells nothing: take another.
    for attempt in 0..64 {
        let slant = 0.01 + f64::from(attempt) * 0.0137;
        let far = point + Point::new(1.0, slant, slant * 0.618) * reach;
        if let Some(crossings) = count_crossings(&[*point, far], body) {
            return crossings % 2 == 1;
        }
    }
    true
}

fn count_crossings(way: &[Point; 2], body: &Body) -> Option<usize> {
    let mut crossings = 0;
    let undecided = body.tree.any(&Bounds::of(*way), |triangle| {
        let corners = body.corners(triangle);
        let [from, to] = way.map(|end| side(&corners, &end));
        if from * to > 0.0 {
            return false;
        }
        let turns = turns(way, &corners);
        if turns.iter().any(|&t| t > 0.0) && turns.iter().any(|&t| t < 0.0) {
            return false;
        }
        crossings += 1;
        from * to == 0.0 || turns.contains(&0.0)
    });
    (!undecided).then_some(crossings)
}

/// Whether a segment and a triangle have a point in common.
pub fn meets(segment: &[Point; 2], triangle: &[Point; 3]) -> bool {
    let [from, to] = segment.map(|end| side(triangle, &end));
    if (from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0) {
        return false;
    }
    if from == 0.0 && to == 0.0 {
        return meets_in_plane(segment, triangle);
    }
    let turns = turns(segment, triangle);
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// −1, 0 or 1: on which side of the triangle's plane a point lies.
fn side([a, b, c]: &[Point; 3], point: &Point) -> f64 {
    sign(orient3d(coord(a), coord(b), coord(c), coord(point)))
}

/// On which side of the segment's line the three edges pass.
fn turns([from, to]: &[Point; 2], corners: &[Point; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| coord(&corner));
    [(a, b), (b, c), (c, a)].map(|(p, q)| sign(orient3d(coord(from), coord(to), p, q)))
}

/// All in one plane: along each pair of axes at once, since a projection can only bring things together. Where a
/// projection flattens the triangle to a line it tells nothing apart, and another does.
fn meets_in_plane(segment: &[Point; 2], triangle: &[Point; 3]) -> bool {
    (0..3).all(|axis| {
        let flat = |point: &Point| Coord { x: point[(axis + 1) % 3], y: point[(axis + 2) % 3] };
        let [from, to] = segment.each_ref().map(flat);
        let [a, b, c] = triangle.each_ref().map(flat);
        let separates = |p, q, one: [_; 3]| {
            let signs = one.map(|r| sign(orient2d(p, q, r)));
            signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0)
        };
        let edge_separates = |p, q, opposite| {
            let inner = sign(orient2d(p, q, opposite));
            inner != 0.0 && [from, to].iter().all(|&end| sign(orient2d(p, q, end)) * inner < 0.0)
        };
        let apart = separates(from, to, [a, b, c])
            || edge_separates(a, b, c)
            || edge_separates(b, c, a)
            || edge_separates(c, a, b)
            || !Bounds::of(*segment).meets(&Bounds::of(*triangle));
        !apart
    })
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

fn coord(point: &Point) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
}

/// `cargo test --release --example measure`
#[cfg(test)]
mod tests {
    use super::*;
    use crate::poses::body::Rest;
    use crate::random::Random;
    use nalgebra::UnitQuaternion;

    const BOX: usize = 2;

    fn all_apart(bodies: &[Body]) -> bool {
        Judge::default().all_apart(bodies)
    }

    #[test]
    fn touching_is_not_apart_and_the_next_number_is() {
        let rest = Rest::new(BOX, 0);
        let at = |x: f64, y: f64, size| Body::new(&rest, size, UnitQuaternion::identity(), Point::new(x, y, 0.0));
        let beyond = 1.0 + 2.0 * f64::EPSILON;
        for (x, y, apart) in
            [(0.0, 0.0, false), (1.0, 0.3, false), (1.0, 1.0, false), (beyond, 0.3, true), (3.0, 0.0, true)]
        {
            assert_eq!(all_apart(&[at(0.0, 0.0, 1.0), at(x, y, 1.0)]), apart, "{x} {y}");
            assert_eq!(all_apart(&[at(x, y, 1.0), at(0.0, 0.0, 1.0)]), apart, "{x} {y}");
        }
        let outer = at(0.0, 0.0, 1.0);
        assert!(!all_apart(&[outer.clone(), at(0.1, 0.2, 0.3)]));
        assert!(!all_apart(&[at(0.1, 0.2, 0.3), outer]));
    }

    #[test]
    fn agrees_with_testing_everything() {
        let rests: Vec<_> = (0..crate::poses::shapes::NAMES.len()).map(|number| Rest::new(number, 0)).collect();
        let mut random = Random::new(5, 0);
        let mut apart_count = 0;
        for _ in 0..200 {
            let [a, b] = [0.0, 0.9].map(|far| {
                let turn = UnitQuaternion::new(Point::from(random.direction()) * random.between(0.0, 3.0));
                let centre = Point::from(random.direction()) * random.between(0.0, far);
                Body::new(random.pick(&rests), random.between(0.2, 1.2), turn, centre)
            });
            let pierces = |a: &Body, b: &Body| {
                let triangles = 0..b.rest.triangles.len() as u32;
                a.rest.edges.iter().any(|edge| triangles.clone().any(|t| meets(&a.ends(edge), &b.corners(t))))
            };
            let holds = |a: &Body, b: &Body| b.positions.iter().any(|point| a.rest.is_inside(&a.to_rest(point)));
            let apart = !pierces(&a, &b) && !pierces(&b, &a) && !holds(&a, &b) && !holds(&b, &a);
            assert_eq!(all_apart(&[a.clone(), b.clone()]), apart);
            let inside = |a: &Body, b: &Body| b.positions.iter().filter(|p| a.rest.is_inside(&a.to_rest(p))).count();
            assert_eq!(vertices_inside(&b, &a), inside(&a, &b));
            apart_count += usize::from(apart);
        }
        assert!((20..180).contains(&apart_count), "{apart_count}");
    }
}
