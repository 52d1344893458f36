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

/// What was left out or done less finely than asked.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shortfall {
    /// Points that have no normal and cast no ray.
    pub(super) without_normal: u64,
    /// Pieces left larger than asked, because their surface had been cut often enough.
    pub(super) uncut: u64,
}

/// Offers the samples of `mesh` inside `region`, which is the overlap box with a margin, in a fixed order.
pub(super) fn for_each_sample<T: Scalar>(
    mesh: &Mesh<T>,
    overlap: &Aabb<T>,
    region: &Aabb<T>,
    sampling: Sampling<T>,
    offer: impl FnMut(Sample<T>),
) -> Shortfall {
    let sides = overlap.upper - overlap.lower;
    let largest_face = (sides.x * sides.y).max(sides.y * sides.z).max(sides.z * sides.x);
    let (squared_spacing, halvings_left) = match sampling {
        Sampling::Vertices => return at_vertices(mesh, region, offer),
        Sampling::Automatic => (largest_face / T::of(128.0), MOST_HALVINGS_AUTOMATIC),
        Sampling::Spacing(spacing) => (spacing * spacing, MOST_HALVINGS),
    };
    // A region that is no more than a line or a point gives no measure: one ray for each triangle then.
    let longest_allowed = if squared_spacing > T::zero() { squared_spacing * T::of(2.0) } else { T::INFINITY };
    on_faces(mesh, Cutter { region, longest_allowed, halvings_left, uncut: 0, offer })
}

fn at_vertices<T: Scalar>(mesh: &Mesh<T>, region: &Aabb<T>, mut offer: impl FnMut(Sample<T>)) -> Shortfall {
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
    Shortfall { without_normal, uncut: 0 }
}

fn vertex_point<T: Scalar>(mesh: &Mesh<T>, vertex: u32) -> SurfacePoint<T> {
    let triangle = mesh.topology().triangles_around(vertex)[0];
    let mut vertices = mesh.topology().triangles()[triangle as usize];
    let place = vertices.iter().position(|&v| v == vertex).expect("triangle lies around its vertex");
    vertices.rotate_left(place);
    let weights = [T::one(), T::zero(), T::zero()];
    SurfacePoint { triangle, vertices, weights, position: mesh.positions()[vertex as usize] }
}

fn on_faces<T: Scalar, F: FnMut(Sample<T>)>(mesh: &Mesh<T>, mut cutter: Cutter<'_, T, F>) -> Shortfall {
    let mut without_normal = 0;
    for triangle in 0..mesh.topology().triangles().len() as u32 {
        let corners = mesh.corners(triangle);
        if !Aabb::of_triangle(&corners).overlaps(cutter.region) {
            continue;
        }
        let scaled_normal = mesh.scaled_normal(triangle);
        let Some(normal) = direction(&scaled_normal) else {
            without_normal += 1;
            continue;
        };
        let face = Face { triangle, vertices: mesh.topology().triangles()[triangle as usize], normal };
        cutter.cut(&face, &Piece::whole(corners, length(&scaled_normal) * T::of(0.5)));
    }
    Shortfall { without_normal, uncut: cutter.uncut }
}

/// Cuts triangles into pieces of the size asked for.
struct Cutter<'a, T: Scalar, F> {
    region: &'a Aabb<T>,
    /// The square of a piece's longest edge.
    longest_allowed: T,
    halvings_left: u32,
    uncut: u64,
    offer: F,
}

/// How often a surface is cut in all, so that needles and any number a caller may ask for end: ten times what an
/// overlap with sides all alike takes, and about a million pieces.
const MOST_HALVINGS_AUTOMATIC: u32 = 1 << 13;
const MOST_HALVINGS: u32 = 1 << 20;

/// The triangle that pieces are cut from.
struct Face<T: Scalar> {
    triangle: u32,
    vertices: [u32; 3],
    normal: Vector3<T>,
}

/// A part of a triangle.
struct Piece<T: Scalar> {
    corners: [Vector3<T>; 3],
    /// Barycentric weights of each corner in the triangle.
    weights: [Vector3<T>; 3],
    area: T,
    depth: u8,
}

/// Halvings of halves beyond this change nothing in either precision; it bounds the recursion.
const DEEPEST: u8 = 96;

impl<T: Scalar> Piece<T> {
    fn whole(corners: [Vector3<T>; 3], area: T) -> Self {
        Self { corners, weights: [Vector3::x(), Vector3::y(), Vector3::z()], area, depth: 0 }
    }

    /// The middle: where it is, and its barycentric weights.
    fn middle(&self) -> (Vector3<T>, Vector3<T>) {
        let third = T::one() / T::of(3.0);
        let mean = |[a, b, c]: [Vector3<T>; 3]| (a + b + c) * third;
        (mean(self.corners), mean(self.weights))
    }
}

impl<T: Scalar, F: FnMut(Sample<T>)> Cutter<'_, T, F> {
    /// Halves the piece at the middle of its longest edge until that edge is short enough, and offers the middle of
    /// each part that lies in the region. Parts beside the region are dropped whole, so that a floor costs what lies
    /// under the body.
    fn cut(&mut self, face: &Face<T>, piece: &Piece<T>) {
        if !Aabb::of_triangle(&piece.corners).overlaps(self.region) {
            return;
        }
        let squares: [T; 3] = std::array::from_fn(|i| (piece.corners[i] - piece.corners[(i + 1) % 3]).norm_squared());
        let longest = (1..3).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
        let [from, to] = [longest, (longest + 1) % 3];
        let half = T::of(0.5);
        let middle = (piece.corners[from] + piece.corners[to]) * half;
        let can_halve = middle != piece.corners[from] && middle != piece.corners[to] && piece.depth < DEEPEST;
        // In this form NaN stops too.
        let is_too_long = squares[longest] > self.longest_allowed && can_halve;
        if is_too_long && self.halvings_left > 0 {
            self.halvings_left -= 1;
            let weights = (piece.weights[from] + piece.weights[to]) * half;
            for kept in [from, to] {
                let (mut corners, mut all_weights) = (piece.corners, piece.weights);
                let replaced = from + to - kept;
                corners[replaced] = middle;
                all_weights[replaced] = weights;
                let part = Piece { corners, weights: all_weights, area: piece.area * half, depth: piece.depth + 1 };
                self.cut(face, &part);
            }
            return;
        }
        self.uncut += u64::from(is_too_long);
        let (position, weights) = piece.middle();
        if self.region.contains(&position) {
            let point =
                SurfacePoint { triangle: face.triangle, vertices: face.vertices, weights: weights.into(), position };
            (self.offer)(Sample { point, normal: face.normal, area: piece.area });
        }
    }
}
