//! Says what a ray meets, from exact arithmetic and the mesh alone.
//!
//! Seen along the ray, the mesh lies in a plane and the ray's line is a point, 0. The library rounds that picture: each
//! projected vertex moves by at most 8.5 rounding units of its reach (the largest coordinate difference from the ray's
//! origin). So an edge that passes 0 at more than [`NEAR`] = 16 rounding units is on the same side in the library's
//! picture and in the exact one, and only such edges can be held against it. The judge therefore
//!
//! 1. finds the edges that pass *near* 0. Rounded arithmetic with an error bound decides; where it cannot, exact
//!    arithmetic does;
//! 2. joins triangles over near edges. Each connected set with a triangle around 0 or near it is one *crossing*: the
//!    edges around the set are not near, so how often the set winds around 0 is certain (exact predicates, from
//!    `robust`, on the projected vertices);
//! 3. bounds where along the ray a crossing lies, by clipping its triangles to a square around 0 that is wider than
//!    all rounding.
//!
//! A crossing that winds around 0 cannot be lost by rounding, whether it is one triangle or a fan around a vertex: the
//! library must hit one of its triangles, from the side that the winding says. That is "the closed surface never
//! opens". A triangle of no crossing must not be hit at all.

use super::exact;
use super::range::{range_by_clipping, range_on_plane};
use robust::{Coord, orient2d};

/// Edges that pass the ray at no more than so many rounding units of their reach may fall on either side of it.
const NEAR: f64 = 16.0;
/// The error of the judge's own projection (8.5, as the library's) and of the distance of near edges (1.5), in f64's
/// rounding units of the reach, with room.
const OWN_ERROR: f64 = 14.0;
/// f64's rounding unit.
const F64_UNIT: f64 = f64::EPSILON / 2.0;

/// A ray's line, and the axes of its projection: the last is the one along which it runs most.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub origin: [f64; 3],
    pub direction: [f64; 3],
    pub axes: [usize; 3],
}

impl Line {
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        let [x, y, z] = direction.map(f64::abs);
        let z = if z > x && z > y { 2 } else { usize::from(y > x) };
        Self { origin, direction, axes: [(z + 1) % 3, (z + 2) % 3, z] }
    }

    /// The largest component of the direction. Projected lengths are as many times too long.
    fn stretch(&self) -> f64 {
        self.direction[self.axes[2]]
    }
}

/// A vertex as seen along the ray.
#[derive(Clone, Copy, Debug, Default)]
struct Projected {
    x: f64,
    y: f64,
    /// Where along the ray, in the ray's `t`.
    t: f64,
    /// Largest coordinate difference from the ray's origin.
    reach: f64,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    vertices: [u32; 2],
    triangles: [u32; 2],
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug)]
struct Side {
    edge: u32,
    /// Whether the triangle runs through the edge against its own direction.
    backward: bool,
}

/// How an edge passes the ray.
#[derive(Clone, Copy, Debug, Default)]
struct Passing {
    near: bool,
    /// 1 or −1 where it crosses the half line y = 0, x > 0 upward or downward.
    turn: i32,
}

/// A place where the ray's line meets the surface.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// How often the line leaves the body here, less how often it enters: 0 where it only touches.
    pub exits: i32,
    /// The crossing lies between these `t`.
    pub first: f64,
    pub last: f64,
}

/// Judges the rays against one mesh.
pub struct Judge {
    /// The rounding unit of the library's arithmetic.
    unit: f64,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    sides: Vec<[Side; 3]>,
    line: Line,
    projected: Vec<Projected>,
    passings: Vec<Passing>,
    crossings: Vec<Crossing>,
    crossing_of: Vec<Option<u32>>,
    waiting: Vec<u32>,
    near_triangles: Vec<u32>,
    /// How many edges rounded arithmetic could not decide.
    pub exact_decisions: u64,
}

impl Judge {
    /// `positions` are those of the library's mesh; `unit` is its rounding unit.
    pub fn new(positions: Vec<[f64; 3]>, triangles: &[[u32; 3]], unit: f64) -> Self {
        let mut judge = Self {
            unit,
            projected: vec![Projected::default(); positions.len()],
            positions,
            triangles: triangles.to_vec(),
            edges: Vec::new(),
            sides: Vec::new(),
            line: Line::new([0.0; 3], [0.0, 0.0, 1.0]),
            passings: Vec::new(),
            crossings: Vec::new(),
            crossing_of: vec![None; triangles.len()],
            waiting: Vec::new(),
            near_triangles: Vec::new(),
            exact_decisions: 0,
        };
        judge.find_edges();
        judge
    }

    fn find_edges(&mut self) {
        let mut known = std::collections::HashMap::new();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let sides = [0, 1, 2].map(|i| {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                let vertices = [from.min(to), from.max(to)];
                let edge = *known.entry(vertices).or_insert_with(|| {
                    self.edges.push(Edge { vertices, triangles: [triangle as u32; 2] });
                    self.edges.len() - 1
                });
                self.edges[edge].triangles[1] = triangle as u32;
                Side { edge: edge as u32, backward: from > to }
            });
            self.sides.push(sides);
        }
        self.passings = vec![Passing::default(); self.edges.len()];
    }

    /// Finds all crossings of a line with the mesh.
    pub fn look(&mut self, line: Line) {
        self.line = line;
        self.project();
        for edge in 0..self.edges.len() {
            self.passings[edge] = self.passing(edge);
        }
        self.crossings.clear();
        self.crossing_of.fill(None);
        self.near_triangles.clear();
        for triangle in 0..self.triangles.len() as u32 {
            let passings = self.sides[triangle as usize].map(|side| self.passings[side.edge as usize]);
            if passings.iter().any(|passing| passing.near) {
                self.near_triangles.push(triangle);
            } else if passings.iter().any(|passing| passing.turn != 0) && self.turns(triangle) != 0 {
                self.add_crossing(triangle);
            }
        }
        for place in 0..self.near_triangles.len() {
            let triangle = self.near_triangles[place];
            if self.crossing_of[triangle as usize].is_none() {
                self.add_crossing(triangle);
            }
        }
    }

    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// The crossing that a triangle belongs to.
    pub fn crossing_of(&self, triangle: u32) -> Option<usize> {
        self.crossing_of[triangle as usize].map(|crossing| crossing as usize)
    }

    fn project(&mut self) {
        let Line { origin, direction, axes: [x, y, z] } = self.line;
        for (projected, position) in self.projected.iter_mut().zip(&self.positions) {
            let from_origin: [f64; 3] = std::array::from_fn(|axis| position[axis] - origin[axis]);
            *projected = Projected {
                x: from_origin[x] * direction[z] - direction[x] * from_origin[z],
                y: from_origin[y] * direction[z] - direction[y] * from_origin[z],
                t: from_origin[z] / direction[z],
                reach: from_origin[0].abs().max(from_origin[1].abs()).max(from_origin[2].abs()),
            };
        }
    }

    fn passing(&mut self, edge: usize) -> Passing {
        let [from, to] = self.edges[edge].vertices;
        let (p, q) = (self.projected[from as usize], self.projected[to as usize]);
        let near = self.is_near(from, to);
        // Half open, so that a chain of edges crosses the half line once where a vertex lies on it.
        let is_upward = p.y <= 0.0 && q.y > 0.0;
        let is_downward = q.y <= 0.0 && p.y > 0.0;
        if near || !(is_upward || is_downward) {
            return Passing { near, turn: 0 };
        }
        let [p, q, zero] = [(p.x, p.y), (q.x, q.y), (0.0, 0.0)].map(|(x, y)| Coord { x, y });
        let side = orient2d(p, q, zero);
        let turn = i32::from(is_upward && side > 0.0) - i32::from(is_downward && side < 0.0);
        Passing { near, turn }
    }

    fn is_near(&mut self, from: u32, to: u32) -> bool {
        let (p, q) = (self.projected[from as usize], self.projected[to as usize]);
        let stretch = self.line.stretch().abs();
        if p.reach == 0.0 || q.reach == 0.0 {
            // The ray starts from that vertex.
            return true;
        }
        let reach = p.reach.max(q.reach);
        let own_error = OWN_ERROR * F64_UNIT * reach * stretch;
        let limit = NEAR * self.unit * reach * stretch;
        let far = limit + own_error;
        if p.x.min(q.x) > far || p.x.max(q.x) < -far || p.y.min(q.y) > far || p.y.max(q.y) < -far {
            return false;
        }
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let cross = p.x * q.y - p.y * q.x;
        if cross.abs() > far * (dx.abs() + dy.abs()) {
            return false;
        }
        let length_squared = dx * dx + dy * dy;
        let foot = if length_squared > 0.0 { -(p.x * dx + p.y * dy) / length_squared } else { 0.0 };
        let distance = if foot <= 0.0 {
            p.x.hypot(p.y)
        } else if foot >= 1.0 {
            q.x.hypot(q.y)
        } else {
            cross.abs() / length_squared.sqrt()
        };
        if distance > far {
            false
        } else if distance < limit - own_error {
            true
        } else {
            self.exact_decisions += 1;
            let ends = [&self.positions[from as usize], &self.positions[to as usize]];
            exact::is_near(&self.line, ends, NEAR * self.unit * reach)
        }
    }

    /// The winding of a triangle's edges around the ray, without the near ones.
    fn turns(&self, triangle: u32) -> i32 {
        let of_side = |side: Side| {
            let turn = self.passings[side.edge as usize].turn;
            if side.backward { -turn } else { turn }
        };
        self.sides[triangle as usize].into_iter().map(of_side).sum()
    }

    /// Adds the crossing of a triangle and of all that are joined to it over near edges.
    fn add_crossing(&mut self, seed: u32) {
        let index = self.crossings.len() as u32;
        let mut crossing = Crossing { exits: 0, first: f64::INFINITY, last: -f64::INFINITY };
        self.waiting.push(seed);
        self.crossing_of[seed as usize] = Some(index);
        while let Some(triangle) = self.waiting.pop() {
            crossing.exits += self.turns(triangle);
            if let Some((first, last)) = self.range(triangle) {
                crossing.first = crossing.first.min(first);
                crossing.last = crossing.last.max(last);
            }
            for side in self.sides[triangle as usize] {
                let edge = side.edge as usize;
                if !self.passings[edge].near {
                    continue;
                }
                let neighbour = self.edges[edge].triangles.into_iter().find(|&other| other != triangle);
                let neighbour = neighbour.expect("the mesh is closed");
                if self.crossing_of[neighbour as usize].is_none() {
                    self.crossing_of[neighbour as usize] = Some(index);
                    self.waiting.push(neighbour);
                }
            }
        }
        // Counter-clockwise in the projection is outward along +z, which may be against the ray.
        if self.line.stretch() < 0.0 {
            crossing.exits = -crossing.exits;
        }
        self.crossings.push(crossing);
    }

    /// The corners of a triangle in the projection, and its reach.
    fn corners(&self, triangle: u32) -> ([Projected; 3], f64) {
        let corners = self.triangles[triangle as usize].map(|vertex| self.projected[vertex as usize]);
        (corners, corners[0].reach.max(corners[1].reach).max(corners[2].reach))
    }

    /// The `t` between which a triangle lies within rounding of the ray, widened by the rounding of `t` itself.
    fn range(&self, triangle: u32) -> Option<(f64, f64)> {
        let (corners, reach) = self.corners(triangle);
        let stretch = self.line.stretch().abs();
        let half_width = ((NEAR + 4.0) * self.unit + OWN_ERROR * F64_UNIT) * reach * stretch;
        let margin = 16.0 * self.unit * reach / stretch;
        let corners = corners.map(|corner| [corner.x, corner.y, corner.t]);
        let (first, last) = range_on_plane(&corners, half_width).or_else(|| range_by_clipping(&corners, half_width))?;
        Some((first - margin, last + margin))
    }

    /// Whether the ray leaves through a triangle; `None` where the triangle is seen so nearly edge-on that rounding may
    /// turn it over.
    pub fn is_exit(&self, triangle: u32) -> Option<bool> {
        let ([a, b, c], reach) = self.corners(triangle);
        let stretch = self.line.stretch();
        let doubled_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        let longest = [(a, b), (b, c), (c, a)]
            .map(|(p, q)| (q.x - p.x).abs() + (q.y - p.y).abs())
            .into_iter()
            .fold(0.0, f64::max);
        let rounding = (3.0 * NEAR * self.unit + OWN_ERROR * F64_UNIT) * reach * stretch.abs();
        (doubled_area.abs() > rounding * longest).then_some((doubled_area > 0.0) == (stretch > 0.0))
    }

    /// How far the hit's two ways of naming a point differ: `origin + t · direction` and the weighted corners. In
    /// rounding units of the triangle's reach; exact where the answer is near `limit`.
    pub fn point_error(&self, triangle: u32, t: f64, weights: [f64; 3], limit: f64) -> f64 {
        let corners = self.triangles[triangle as usize].map(|vertex| &self.positions[vertex as usize]);
        let (_, reach) = self.corners(triangle);
        let differences: [f64; 3] = std::array::from_fn(|axis| {
            let origin = self.line.origin[axis];
            let on_triangle: f64 = (0..3).map(|i| weights[i] * (corners[i][axis] - origin)).sum();
            (on_triangle - t * self.line.direction[axis]).abs()
        });
        let rounding = self.unit * reach;
        let error = differences.into_iter().fold(0.0, f64::max) / rounding;
        let own_error = OWN_ERROR * F64_UNIT / self.unit;
        if (error - limit).abs() > own_error {
            return error;
        }
        let is_within = exact::is_same_point(&self.line, t, corners, weights, limit * rounding);
        if is_within { error.min(limit) } else { error.max(limit + 1.0) }
    }
}
