//! A binary tree of boxes over a mesh's triangles, refitted as they move. The program's own, so that its judge and its
//! proximity method owe nothing to the library.

use nalgebra::Vector3;

#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub lower: Vector3<f64>,
    pub upper: Vector3<f64>,
}

impl Bounds {
    pub fn of(points: impl IntoIterator<Item = Vector3<f64>>) -> Self {
        let nothing = Self { lower: Vector3::repeat(f64::INFINITY), upper: Vector3::repeat(f64::NEG_INFINITY) };
        points.into_iter().fold(nothing, |b, p| Self { lower: b.lower.inf(&p), upper: b.upper.sup(&p) })
    }

    pub fn grown(&self, margin: f64) -> Self {
        Self { lower: self.lower.add_scalar(-margin), upper: self.upper.add_scalar(margin) }
    }

    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.lower[axis] <= other.upper[axis] && other.lower[axis] <= self.upper[axis])
    }

    pub fn holds(&self, point: &Vector3<f64>) -> bool {
        (0..3).all(|axis| self.lower[axis] <= point[axis] && point[axis] <= self.upper[axis])
    }

    fn joined(&self, other: &Self) -> Self {
        Self { lower: self.lower.inf(&other.lower), upper: self.upper.sup(&other.upper) }
    }
}

/// Nodes in depth-first order: a node's left child follows it.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    /// Where this node's descendants end among the nodes.
    end: usize,
    /// Its triangles in `order`, for leaves.
    triangles: std::ops::Range<usize>,
}

const LEAF: usize = 4;

impl Tree {
    pub fn new(positions: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..triangles.len() as u32).collect() };
        let middle = |triangle: u32| {
            triangles[triangle as usize].iter().fold(Vector3::zeros(), |sum, &v| sum + positions[v as usize])
        };
        let middles: Vec<_> = (0..triangles.len() as u32).map(middle).collect();
        tree.build(0..triangles.len(), &middles);
        tree.refit(positions, triangles);
        tree
    }

    fn build(&mut self, range: std::ops::Range<usize>, middles: &[Vector3<f64>]) {
        let node = self.nodes.len();
        let bounds = Bounds::of(self.order[range.clone()].iter().map(|&triangle| middles[triangle as usize]));
        self.nodes.push(Node { bounds, end: 0, triangles: range.clone() });
        if range.len() > LEAF {
            let axis = (bounds.upper - bounds.lower).imax();
            let along = |triangle: &u32| middles[*triangle as usize][axis];
            self.order[range.clone()].sort_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            let middle = range.start + range.len() / 2;
            self.build(range.start..middle, middles);
            self.build(middle..range.end, middles);
        }
        self.nodes[node].end = self.nodes.len();
    }

    pub fn refit(&mut self, positions: &[Vector3<f64>], triangles: &[[u32; 3]]) {
        for place in (0..self.nodes.len()).rev() {
            let node = &self.nodes[place];
            self.nodes[place].bounds = if node.end == place + 1 {
                let corners = self.order[node.triangles.clone()].iter().flat_map(|&t| triangles[t as usize]);
                Bounds::of(corners.map(|vertex| positions[vertex as usize]))
            } else {
                let left = &self.nodes[place + 1];
                left.bounds.joined(&self.nodes[left.end].bounds)
            };
        }
    }

    pub fn bounds(&self) -> &Bounds {
        &self.nodes[0].bounds
    }

    /// Offers the triangles of the leaves that meet `bounds` until `stop` says so; whether it did.
    pub fn any(&self, bounds: &Bounds, mut stop: impl FnMut(u32) -> bool) -> bool {
        let mut place = 0;
        while let Some(node) = self.nodes.get(place) {
            if !node.bounds.meets(bounds) {
                place = node.end;
                continue;
            }
            if node.end == place + 1 && self.order[node.triangles.clone()].iter().any(|&triangle| stop(triangle)) {
                return true;
            }
            place += 1;
        }
        false
    }
}
