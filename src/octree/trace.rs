use super::{Node, Octree};
use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;
use crate::ray::{Hit, PreparedRay, Ray, TriangleTest};

/// A mesh together with its up-to-date octree: what rays are traced in.
#[derive(Clone, Copy, Debug)]
pub struct Tracer<'a, T: Scalar> {
    octree: &'a Octree<T>,
    mesh: &'a Mesh<T>,
    test: TriangleTest,
}

impl<'a, T: Scalar> Tracer<'a, T> {
    pub(super) fn new(octree: &'a Octree<T>, mesh: &'a Mesh<T>) -> Self {
        Self { octree, mesh, test: TriangleTest::default() }
    }

    /// The same, deciding with another triangle test.
    pub fn with_test(self, test: TriangleTest) -> Self {
        Self { test, ..self }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T> {
        self.mesh
    }

    /// The first hit along the ray, the same to the bit as testing every triangle would give; at equal `t` the
    /// triangle with the smallest index.
    pub fn nearest_hit(&self, ray: &Ray<T>) -> Option<Hit<T>> {
        let prepared = PreparedRay::new(ray, self.test);
        let mut nearest: Option<Hit<T>> = None;
        self.octree.visit(ray, &mut |triangle| {
            let hit = prepared.intersect(&self.mesh.corners(triangle), triangle);
            if let Some(hit) = hit.filter(|hit| hit.t <= ray.t_max && nearest.is_none_or(|n| hit.is_before(&n))) {
                nearest = Some(hit);
            }
            nearest.map_or(ray.t_max, |hit| hit.t)
        });
        nearest
    }

    /// Whether the ray meets a triangle strictly before its `t_max`, not counting the triangles around `vertex`.
    pub fn is_hit_before_end(&self, ray: &Ray<T>, vertex: u32) -> bool {
        let prepared = PreparedRay::new(ray, self.test);
        let mut found = false;
        self.octree.visit(ray, &mut |triangle| {
            found |= !self.mesh.topology().triangles()[triangle as usize].contains(&vertex)
                && prepared.intersect(&self.mesh.corners(triangle), triangle).is_some_and(|hit| hit.t < ray.t_max);
            if found { -T::INFINITY } else { ray.t_max }
        });
        found
    }
}

impl<T: Scalar> Octree<T> {
    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned; a triangle that lives
    /// in several cells may be offered several times.
    fn visit(&self, ray: &Ray<T>, visitor: &mut impl FnMut(u32) -> T) {
        let mut walk = Walk { octree: self, slabs: Slabs::new(ray, self), t_max: ray.t_max, visitor };
        walk.descend(&self.nodes[0], self.root.lower, self.root.upper.x - self.root.lower.x);
    }
}

/// The ray as the cells' faces see it, after Revelles, Ureña and Lastra 2000, "An efficient parametric algorithm for
/// octree traversal": each face plane is a value of `t`, and mirroring the axes along which the ray runs backwards
/// puts the octants in the order 0…7 for every ray. Unlike theirs, each child's interval is tested by itself, widened
/// outward, so that a ray along a shared face visits both sides and nothing is lost to rounding.
struct Slabs<T: Scalar> {
    origin: Vector3<T>,
    inverse: Vector3<T>,
    /// Bit i: the ray runs backwards along axis i.
    mirror: usize,
    /// More than what rounding can move a plane, a vertex or a hit, seen from the ray's origin.
    margin: T,
}

impl<T: Scalar> Slabs<T> {
    fn new(ray: &Ray<T>, octree: &Octree<T>) -> Self {
        // A finite stand-in for 1/0 keeps 0 · ∞ out of the planes.
        let inverse = ray.direction.map(|d| (T::one() / d).clamp(-T::LARGEST, T::LARGEST));
        let mirror = (0..3).map(|axis| usize::from(inverse[axis] < T::zero()) << axis).sum();
        let margin = octree.root.reach_from(&ray.origin) * T::ROUNDING_UNIT * T::of(16.0);
        Self { origin: ray.origin, inverse, mirror, margin }
    }

    /// Where the ray enters and leaves the first and the second half of a cell along one axis, in the ray's order.
    fn halves(&self, axis: usize, lower: T, side: T) -> [(T, T); 2] {
        let middle = lower + side * T::of(0.5);
        let upper = lower + side;
        let from = lower - self.margin - self.origin[axis];
        let middle_from = middle - self.margin - self.origin[axis];
        let middle_to = middle + self.margin - self.origin[axis];
        let to = upper + self.margin - self.origin[axis];
        let inverse = self.inverse[axis];
        if self.mirror >> axis & 1 == 0 {
            [(from * inverse, middle_to * inverse), (middle_from * inverse, to * inverse)]
        } else {
            [(to * inverse, middle_from * inverse), (middle_to * inverse, from * inverse)]
        }
    }
}

struct Walk<'a, T: Scalar, V> {
    octree: &'a Octree<T>,
    slabs: Slabs<T>,
    t_max: T,
    visitor: &'a mut V,
}

impl<T: Scalar, V: FnMut(u32) -> T> Walk<'_, T, V> {
    fn descend(&mut self, node: &Node, lower: Vector3<T>, side: T) {
        for entry in &self.octree.entries[node.first_entry as usize..node.own_end as usize] {
            self.t_max = (self.visitor)(entry.triangle);
        }
        if node.children == 0 {
            return;
        }
        let halves: [_; 3] = std::array::from_fn(|axis| self.slabs.halves(axis, lower[axis], side));
        let half_side = side * T::of(0.5);
        for in_ray_order in 0..8usize {
            let octant = in_ray_order ^ self.slabs.mirror;
            if node.children >> octant & 1 == 0 {
                continue;
            }
            let [x, y, z] = std::array::from_fn(|axis| halves[axis][in_ray_order >> axis & 1]);
            let enters = x.0.max(y.0).max(z.0);
            let leaves = x.1.min(y.1).min(z.1);
            // In this form NaN, from coordinates near the end of the range, never skips a cell.
            if enters > leaves || leaves < T::zero() || enters > self.t_max {
                continue;
            }
            let rank = (node.children & ((1 << octant) - 1)).count_ones();
            let child_lower =
                Vector3::from_fn(|axis, _| if octant >> axis & 1 == 0 { lower[axis] } else { lower[axis] + half_side });
            let child = &self.octree.nodes[(node.first_child + rank) as usize];
            self.descend(child, child_lower, half_side);
        }
    }
}
