//! What the oracle asks: meshes and rays, each case with its own way of being difficult.

use crate::common::shapes::{self, Point, Shape};
use crate::random::Random;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::triangle::Ray;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    Random,
    GridAligned,
    AxisAligned,
    EdgeAimed,
    VertexAimed,
    Grazing,
    Sliver,
    Tiny,
    Huge,
    FarOffset,
}

impl Case {
    pub const ALL: [Self; 10] = [
        Self::Random,
        Self::GridAligned,
        Self::AxisAligned,
        Self::EdgeAimed,
        Self::VertexAimed,
        Self::Grazing,
        Self::Sliver,
        Self::Tiny,
        Self::Huge,
        Self::FarOffset,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::GridAligned => "grid-aligned",
            Self::AxisAligned => "axis-aligned",
            Self::EdgeAimed => "edge-aimed",
            Self::VertexAimed => "vertex-aimed",
            Self::Grazing => "grazing",
            Self::Sliver => "sliver",
            Self::Tiny => "tiny",
            Self::Huge => "huge",
            Self::FarOffset => "far-offset",
        }
    }
}

/// Sizes that differ with the precision.
struct Limits {
    /// Scales reach from 2^−scale to 2^scale.
    scale: f64,
    /// Offsets reach to 2^offset times the size.
    offset: f64,
    /// Slivers get as thin as 2^−thinness of their length.
    thinness: f64,
}

impl Limits {
    fn of<T: Scalar>() -> Self {
        if T::ROUNDING_UNIT.to_f64() > 1e-10 {
            Self { scale: 30.0, offset: 18.0, thinness: 20.0 }
        } else {
            Self { scale: 60.0, offset: 46.0, thinness: 45.0 }
        }
    }
}

/// A mesh, and what its rays need to know of it.
pub struct Target<T: Scalar> {
    pub mesh: Mesh<T>,
    /// The mesh and its inner points, where the mesh is.
    shape: Shape,
    case: Case,
    size: f64,
}

impl<T: Scalar> Target<T> {
    /// A random mesh of this case.
    pub fn new(case: Case, random: &mut Random) -> Self {
        loop {
            let (shape, size) = shape_of::<T>(case, random);
            // Rounding to a coarse grid may flatten a triangle; such a mesh is refused, and another one drawn.
            if let Ok(mesh) = shape.try_mesh() {
                return Self { mesh, shape, case, size };
            }
        }
    }

    /// About how large the mesh is.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Random rays of this case. In every second batch they are all cut, and neighbours stand together: the library
    /// traces each 16 as a packet, which should then be a small one.
    pub fn rays(&self, count: usize, random: &mut Random) -> Vec<Ray<T>> {
        let are_cut = random.once_in(2);
        let mut rays: Vec<Ray<T>> = (0..count).map(|_| self.ray(are_cut, random)).collect();
        if are_cut {
            let axis = random.below(3);
            rays.sort_by(|a, b| a.origin[axis].to_f64().total_cmp(&b.origin[axis].to_f64()));
        }
        rays
    }

    /// A random ray of this case.
    fn ray(&self, is_cut: bool, random: &mut Random) -> Ray<T> {
        let aim = match self.case {
            Case::Random => Aim::Anywhere,
            Case::GridAligned => return grid_ray(is_cut, random),
            Case::AxisAligned => Aim::AlongAxis,
            Case::EdgeAimed => Aim::Edge,
            Case::VertexAimed => Aim::Vertex,
            Case::Grazing => Aim::Grazing,
            Case::Sliver | Case::Tiny | Case::Huge | Case::FarOffset => {
                *random.pick(&[Aim::Anywhere, Aim::Surface, Aim::AlongAxis, Aim::Edge, Aim::Vertex, Aim::Grazing])
            }
        };
        let (origin, direction) = match aim {
            Aim::AlongAxis => self.along_axis(random),
            Aim::Grazing => self.grazing(random),
            _ => self.towards(aim, random),
        };
        let ray = Ray::new(origin, self.resized(direction, random));
        if is_cut {
            // Near what it was aimed at.
            let reached = direction.amax() / ray.direction.amax();
            ray.until(reached * T::of(random.between(0.0, 2.0)))
        } else {
            ray
        }
    }

    /// `t` counts multiples of the direction, so its length must not matter.
    fn resized(&self, direction: Vector3<T>, random: &mut Random) -> Vector3<T> {
        match random.below(3) {
            0 => direction,
            1 => direction * T::of(random.whole(-8, 8).exp2()),
            _ => raycontact::math::direction(&direction).unwrap_or(direction),
        }
    }

    pub fn vertex(&self, random: &mut Random) -> Vector3<T> {
        *random.pick(self.mesh.positions())
    }

    fn corners(&self, random: &mut Random) -> [Vector3<T>; 3] {
        self.mesh.corners(random.below(self.mesh.topology().triangles().len()) as u32)
    }

    fn rounded(&self, point: Point) -> Vector3<T> {
        Vector3::from(point.map(T::of))
    }

    /// A point at most so many sizes away from the middle.
    pub fn around(&self, sizes: f64, random: &mut Random) -> Vector3<T> {
        let middle = *random.pick(&self.shape.inside);
        let offset = random.point(sizes * self.size);
        self.rounded(std::array::from_fn(|axis| middle[axis] + offset[axis]))
    }

    pub fn on_edge(&self, random: &mut Random) -> Vector3<T> {
        let [a, b, _] = self.corners(random);
        let part = if random.once_in(4) { 0.5 } else { random.unit() };
        a + (b - a) * T::of(part)
    }

    pub fn on_surface(&self, random: &mut Random) -> Vector3<T> {
        let [a, b, c] = self.corners(random);
        let (first, second) = (random.unit(), random.unit());
        let (first, second) = if first + second > 1.0 { (1.0 - first, 1.0 - second) } else { (first, second) };
        a + (b - a) * T::of(first) + (c - a) * T::of(second)
    }

    pub fn origin(&self, random: &mut Random) -> Vector3<T> {
        match random.below(8) {
            0 | 1 => self.rounded(*random.pick(&self.shape.inside)),
            2 => self.around(0.2, random),
            3 | 4 => self.around(2.0, random),
            5 => self.around(50.0, random),
            6 => self.vertex(random),
            _ => self.on_surface(random),
        }
    }

    fn towards(&self, aim: Aim, random: &mut Random) -> (Vector3<T>, Vector3<T>) {
        let origin = self.origin(random);
        let target = match aim {
            Aim::Vertex => self.vertex(random),
            Aim::Edge => self.on_edge(random),
            Aim::Surface => self.on_surface(random),
            _ => return (origin, self.rounded(random.direction().map(|x| x * self.size))),
        };
        (origin, target - origin)
    }

    /// A ray along an axis, through a vertex, an edge or the surface.
    fn along_axis(&self, random: &mut Random) -> (Vector3<T>, Vector3<T>) {
        let through = match random.below(3) {
            0 => self.vertex(random),
            1 => self.on_edge(random),
            _ => self.on_surface(random),
        };
        let axis = random.below(3);
        let mut origin = through;
        origin[axis] = self.origin(random)[axis];
        let mut direction = Vector3::zeros();
        direction[axis] = T::of(if random.once_in(2) { self.size } else { -self.size });
        (origin, direction)
    }

    /// A ray in the plane of a triangle, or so nearly that rounding decides, from a point in or near that plane.
    fn grazing(&self, random: &mut Random) -> (Vector3<T>, Vector3<T>) {
        let [a, b, c] = self.corners(random);
        let (along, across) = (b - a, c - a);
        let in_plane = |random: &mut Random, from: f64, to: f64| {
            along * T::of(random.between(from, to)) + across * T::of(random.between(from, to))
        };
        let normal = raycontact::math::direction(&along.cross(&across)).unwrap_or(along) * T::of(self.size);
        let small = |random: &mut Random| {
            let least = T::ROUNDING_UNIT.to_f64().log2() - 2.0;
            if random.once_in(3) { 0.0 } else { random.between(least, -2.0).exp2() * random.whole(-1, 1) }
        };
        let origin = a + in_plane(random, -2.0, 3.0) + normal * T::of(small(random));
        let direction = if random.once_in(3) { along } else { in_plane(random, -1.0, 1.0) };
        (origin, direction + normal * T::of(small(random)))
    }
}

/// What a ray is aimed at.
#[derive(Clone, Copy)]
enum Aim {
    Anywhere,
    Surface,
    AlongAxis,
    Edge,
    Vertex,
    Grazing,
}

/// A shape where it belongs, and its size.
fn shape_of<T: Scalar>(case: Case, random: &mut Random) -> (Shape, f64) {
    let limits = Limits::of::<T>();
    if case == Case::GridAligned {
        return (grid_shape(random), 4.0);
    }
    let mut shape = any_shape(random);
    if case == Case::Sliver {
        shape = thinned(&shape, limits.thinness, random);
    }
    if !(case == Case::AxisAligned && random.once_in(2)) {
        shape = shape.turned(random.between(0.0, 7.0), random.between(0.0, 7.0));
    }
    let size = match case {
        Case::Tiny => -random.between(limits.scale / 2.0, limits.scale),
        Case::Huge => random.between(limits.scale / 2.0, limits.scale),
        _ => random.between(-2.0, 2.0),
    }
    .exp2();
    shape = shape.scaled(size);
    let offset = match case {
        Case::FarOffset => random.between(2.0, limits.offset).exp2(),
        _ => random.pick(&[0.0, 0.3, 3.0]) * random.unit(),
    };
    let direction = random.direction();
    (shape.moved(direction.map(|x| x * offset * size)), size)
}

fn any_shape(random: &mut Random) -> Shape {
    // Small ones more often: a larger mesh costs time and adds little that is new. The largest has several levels of
    // boxes in either layout.
    match random.below(40) {
        0..8 => shapes::tetrahedron(),
        8..15 => shapes::cube(1),
        15..22 => shapes::octahedron(),
        22..28 => shapes::icosahedron(),
        28..32 => shapes::cube(2),
        32..36 => shapes::torus(7, 4, 0.4),
        36 => shapes::sphere(1),
        37 | 38 => shapes::star(),
        _ => shapes::torus(20, 10, 0.4),
    }
}

/// The shape pressed flat, or drawn into a needle, in an oblique direction.
fn thinned(shape: &Shape, thinness: f64, random: &mut Random) -> Shape {
    let thin = -random.between(4.0, thinness);
    let (first, second) = (thin.exp2(), if random.once_in(2) { 1.0 } else { (thin * random.unit()).exp2() });
    shape.turned(random.between(0.0, 7.0), random.between(0.0, 7.0)).map(|[x, y, z]| [x, y * second, z * first])
}

/// Small whole coordinates: vertices, edges and faces fall on top of one another in every projection.
fn grid_shape(random: &mut Random) -> Shape {
    let shape = match random.below(4) {
        0 => shapes::tetrahedron(),
        1 => shapes::cube(1),
        2 => shapes::block([1, 1, 1].map(|least| least + random.below(2))),
        _ => shapes::octahedron(),
    };
    shape.scaled(*random.pick(&[1.0, 2.0]))
}

fn grid_ray<T: Scalar>(is_cut: bool, random: &mut Random) -> Ray<T> {
    let origin = Vector3::from_fn(|_, _| T::of(random.whole(-6, 6) / 2.0));
    let direction = loop {
        let direction = Vector3::from_fn(|_, _| T::of(random.whole(-2, 2)));
        if direction != Vector3::zeros() {
            break direction;
        }
    };
    let ray = Ray::new(origin, direction);
    if is_cut { ray.until(T::of(random.whole(0, 8) / 4.0)) } else { ray }
}
