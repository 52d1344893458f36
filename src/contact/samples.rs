use super::SurfacePoint;
use crate::math::{Aabb, Scalar, Vector3, direction, length};
use crate::mesh::Mesh;

/// Where on a surface rays start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sampling<T: Scalar> {
    /// In the middle of each triangle, along its normal; triangles that are large beside the overlap are cut first, so
    /// that about 128 rays stand on its largest side. Forces then hardly depend on the triangulation.
    #[default]
    Automatic,
    /// In the middle of each triangle, or of the pieces of about this size, a length > 0, into which larger triangles
    /// are cut.
    Spacing(T),
    /// At each vertex, along the mean of the surrounding normals: the paper's.
    Vertices,
}

/// A surface point that casts a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample<T: Scalar> {
    pub(super) point: SurfacePoint<T>,
    /// Outward, of unit length.
    pub(super) normal: Vector3<T>,
    /// The surface it stands for.
    pub(super) area: T,
}

/// Offers the samples of `mesh` inside `region`, which is the overlap box with a margin, in a fixed order; returns how
/// many points have no normal and cast no ray.
pub(super) fn for_each_sample<T: Scalar>(
    mesh: &Mesh<T>,
    overlap: &Aabb<T>,
    region: &Aabb<T>,
    sampling: Sampling<T>,
    offer: impl FnMut(Sample<T>),
) -> u64 {
    let sides = overlap.upper - overlap.lower;
    let largest_face = (sides.x * sides.y).max(sides.y * sides.z).max(sides.z * sides.x);
    let squared_spacing = match sampling {
        Sampling::Vertices => return at_vertices(mesh, region, offer),
        Sampling::Automatic => largest_face / T::of(128.0),
        // However small the caller's number: no more than about a million pieces.
        Sampling::Spacing(spacing) => (spacing * spacing).max(largest_face / T::of(1_048_576.0)),
    };
    on_faces(mesh, region, squared_spacing, offer)
}

fn at_vertices<T: Scalar>(mesh: &Mesh<T>, region: &Aabb<T>, mut offer: impl FnMut(Sample<T>)) -> u64 {
    let mut without_normal = 0;
    for &vertex in mesh.topology().surface_vertices() {
        if !region.contains(&mesh.positions()[vertex as usize]) {
            continue;
        }
        match mesh.vertex_normal(vertex) {
            Some(normal) => {
                offer(Sample { point: vertex_point(mesh, vertex), normal: normal.normal, area: normal.area });
            }
            None => without_normal += 1,
        }
    }
    without_normal
}

fn vertex_point<T: Scalar>(mesh: &Mesh<T>, vertex: u32) -> SurfacePoint<T> {
    let triangle = mesh.topology().triangles_around(vertex)[0];
    let mut vertices = mesh.topology().triangles()[triangle as usize];
    let place = vertices.iter().position(|&v| v == vertex).expect("triangle lies around its vertex");
    vertices.rotate_left(place);
    let weights = [T::one(), T::zero(), T::zero()];
    SurfacePoint { triangle, vertices, weights, position: mesh.positions()[vertex as usize] }
}

fn on_faces<T: Scalar>(mesh: &Mesh<T>, region: &Aabb<T>, squared_spacing: T, mut offer: impl FnMut(Sample<T>)) -> u64 {
    let mut without_normal = 0;
    // A region that is no more than a line or a point gives no measure: one ray for each triangle then.
    let longest_allowed = if squared_spacing > T::zero() { squared_spacing * T::of(2.0) } else { T::INFINITY };
    for triangle in 0..mesh.topology().triangles().len() as u32 {
        let corners = mesh.corners(triangle);
        if !Aabb::of_triangle(&corners).overlaps(region) {
            continue;
        }
        let scaled_normal = mesh.scaled_normal(triangle);
        let Some(normal) = direction(&scaled_normal) else {
            without_normal += 1;
            continue;
        };
        let vertices = mesh.topology().triangles()[triangle as usize];
        let piece = Piece::whole(corners, length(&scaled_normal) * T::of(0.5));
        piece.cut(region, longest_allowed, &mut |weights, position, area| {
            offer(Sample { point: SurfacePoint { triangle, vertices, weights, position }, normal, area });
        });
    }
    without_normal
}

/// A part of a triangle.
struct Piece<T: Scalar> {
    corners: [Vector3<T>; 3],
    /// Barycentric weights of each corner in the triangle.
    weights: [Vector3<T>; 3],
    area: T,
    depth: u8,
}

/// Halvings beyond this change nothing in either precision; it bounds the recursion.
const DEEPEST: u8 = 96;

impl<T: Scalar> Piece<T> {
    fn whole(corners: [Vector3<T>; 3], area: T) -> Self {
        Self { corners, weights: [Vector3::x(), Vector3::y(), Vector3::z()], area, depth: 0 }
    }

    /// Halves the piece at the middle of its longest edge until that edge is short enough, and offers the middle of
    /// each part that lies in the region. Parts beside the region are dropped whole, so that a floor costs what lies
    /// under the body.
    fn cut(&self, region: &Aabb<T>, longest_allowed: T, offer: &mut impl FnMut([T; 3], Vector3<T>, T)) {
        if !Aabb::of_triangle(&self.corners).overlaps(region) {
            return;
        }
        let squares: [T; 3] = std::array::from_fn(|i| (self.corners[i] - self.corners[(i + 1) % 3]).norm_squared());
        let longest = (1..3).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
        let [from, to, opposite] = [longest, (longest + 1) % 3, (longest + 2) % 3];
        let half = T::of(0.5);
        let middle = (self.corners[from] + self.corners[to]) * half;
        let can_halve = middle != self.corners[from] && middle != self.corners[to] && self.depth < DEEPEST;
        // In this form NaN stops too.
        if squares[longest] > longest_allowed && can_halve {
            let weights = (self.weights[from] + self.weights[to]) * half;
            for kept in [from, to] {
                let (mut corners, mut all_weights) = (self.corners, self.weights);
                let replaced = from + to - kept;
                corners[replaced] = middle;
                all_weights[replaced] = weights;
                let part = Self { corners, weights: all_weights, area: self.area * half, depth: self.depth + 1 };
                part.cut(region, longest_allowed, offer);
            }
            return;
        }
        let third = T::one() / T::of(3.0);
        let position = (self.corners[from] + self.corners[to] + self.corners[opposite]) * third;
        if region.contains(&position) {
            let weights = (self.weights[0] + self.weights[1] + self.weights[2]) * third;
            offer(weights.into(), position, self.area);
        }
    }
}
