use super::obj_text::ObjSurface;
use std::fmt;

/// Why a mesh was refused. Nothing was created or changed.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum MeshError {
    /// There is no triangle.
    Empty,
    /// More vertices or triangles than 32-bit indices reach.
    TooLarge { count: usize },
    /// A triangle names a vertex that does not exist, by this index.
    IndexOutOfRange { triangle: usize, index: u32, vertex_count: usize },
    /// A triangle names one vertex twice, or its three corners lie on a line.
    DegenerateTriangle { triangle: usize, corners: [u32; 3] },
    /// An edge, given by its two vertices, belongs to one triangle only.
    Open { triangle: usize, edge: [u32; 2] },
    /// So many vertices of the border lie where another does, such as these two: a seam that was not welded.
    Seam { vertices: [u32; 2], count: usize },
    /// Two holes share a vertex, so the loop around each of them is not settled.
    HolesTouch { vertex: u32 },
    /// The hole at this vertex has more vertices around it than are closed.
    HoleTooLong { vertex: u32, vertex_count: usize, most: usize },
    /// With the hole at this vertex, the caps have a larger share of the area of their connected part than they may.
    HoleTooLarge { vertex: u32, vertex_count: usize, share: f64, most: f64 },
    /// The hole at this vertex cannot be closed by triangles that all have an area, without an edge that the mesh has already.
    HoleNotClosed { vertex: u32, vertex_count: usize },
    /// The part of the area that caps may have is below 0, above 1 or NaN.
    CloseHoles { value: f64 },
    /// Two neighbours run through their shared edge the same way, so one of them faces inward.
    InconsistentOrientation { triangles: [usize; 2], edge: [u32; 2] },
    /// An edge belongs to more than two triangles.
    NonManifold { edge: [u32; 2], triangle_count: usize },
    /// The closed part with this triangle is consistent, but its normals point into it, so that its volume is negative, and it lies
    /// in no other part as a cavity would.
    Inward { triangle: usize, volume: f64 },
    /// The closed part with this triangle encloses no volume beyond rounding: two sheets back to back, or one half turned against
    /// the other.
    Flat { triangle: usize },
    /// A triangle is so large that its area is beyond the largest number of the mesh's precision.
    Overflow { triangle: usize },
    /// Positions for another number of vertices.
    WrongCount { given: usize, expected: usize },
    /// A coordinate of a vertex is NaN or infinite, when the mesh was made or, in a renewal, given new positions.
    NotFinite { vertex: usize, is_renewal: bool },
    /// A vertex has a coordinate that is finite, but larger than the largest number of the mesh's precision.
    BeyondRange { vertex: usize, value: f64, largest: f64 },
    /// The distance between the unknowns that carry a mesh is negative or NaN.
    CarrierSpacing { value: f64 },
}

/// How messages name triangles and vertices.
#[derive(Clone, Copy)]
enum Names<'a> {
    /// By their numbers in arrays, from 0.
    OfArrays,
    /// By lines and vertices of a file, from 1.
    OfFile(&'a ObjSurface),
}

struct Triangle<'a>(Names<'a>, usize);

struct Vertex<'a>(Names<'a>, usize);

impl fmt::Display for Triangle<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Names::OfArrays => write!(f, "triangle {}", self.1),
            Names::OfFile(surface) => match surface.lines.get(self.1) {
                Some(line) => write!(f, "the face in line {line}"),
                None => write!(f, "a triangle that closes a hole"),
            },
        }
    }
}

impl fmt::Display for Vertex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Names::OfArrays => self.1.fmt(f),
            Names::OfFile(_) => (self.1 + 1).fmt(f),
        }
    }
}

/// An error about the surface of a file, in the file's own numbers.
pub(crate) struct InFile<'a> {
    pub(crate) error: &'a MeshError,
    pub(crate) surface: &'a ObjSurface,
}

impl fmt::Display for InFile<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.write(f, Names::OfFile(self.surface))
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, Names::OfArrays)
    }
}

impl MeshError {
    fn write(&self, f: &mut fmt::Formatter<'_>, names: Names<'_>) -> fmt::Result {
        self.write_fault(f, names)?;
        match (self, names) {
            (Self::Empty | Self::TooLarge { .. } | Self::WrongCount { .. }, _) => Ok(()),
            (Self::CarrierSpacing { .. } | Self::CloseHoles { .. }, _) => Ok(()),
            (_, Names::OfArrays) => write!(f, " (numbers count from 0)"),
            (_, Names::OfFile(_)) => write!(f, " (lines and vertices count from 1)"),
        }
    }

    fn write_fault(&self, f: &mut fmt::Formatter<'_>, names: Names<'_>) -> fmt::Result {
        let triangle = |number: usize| Triangle(names, number);
        let vertex = |number: u32| Vertex(names, number as usize);
        match *self {
            Self::Empty => write!(f, "the mesh has no triangle; give at least four, forming a closed surface"),
            Self::TooLarge { count } => {
                write!(f, "{count} vertices or triangles are too many; at most {} are allowed", u32::MAX / 3 - 1)
            }
            Self::IndexOutOfRange { triangle: t, index, vertex_count } => write!(
                f,
                "{} names vertex {}, but there are {vertex_count} vertices; give the number of one of them",
                triangle(t),
                vertex(index)
            ),
            Self::DegenerateTriangle { triangle: t, corners } => {
                let [a, b, c] = corners.map(vertex);
                write!(
                    f,
                    "{} ({a}, {b}, {c}) has no area: a repeated vertex, or corners on one line; remove it or merge its \
                     vertices",
                    triangle(t)
                )
            }
            Self::Open { triangle: t, edge } => {
                let [a, b] = edge.map(vertex);
                write!(
                    f,
                    "the mesh is open: edge ({a}, {b}) belongs to {} only; merge duplicate vertices along a seam, set \
                     close_holes to close small holes, or say that it may be open",
                    triangle(t)
                )
            }
            Self::Seam { vertices, count } => {
                let [a, b] = vertices.map(vertex);
                write!(
                    f,
                    "the mesh is open along a seam: {count} vertices of its border lie where another does, such as {a} \
                     and {b}; weld them, so that triangles on both sides name the same vertex"
                )
            }
            Self::HolesTouch { vertex: v } => write!(
                f,
                "two holes share vertex {}, so it is not settled what is around each; remove one of the triangles there, \
                 or close one of the holes by hand",
                vertex(v)
            ),
            Self::HoleTooLong { vertex: v, vertex_count, most } => write!(
                f,
                "the hole at vertex {} has {vertex_count} vertices around it, and holes of at most {most} are closed; \
                 close it by hand",
                vertex(v)
            ),
            Self::HoleTooLarge { vertex: v, vertex_count, share, most } => write!(
                f,
                "with the hole at vertex {}, of {vertex_count} vertices, the caps have {share:.3} of the area of their \
                 part of the surface, and close_holes is {most}; raise it if that is a hole, or say that the mesh may be \
                 open if that is the border of a sheet",
                vertex(v)
            ),
            Self::HoleNotClosed { vertex: v, vertex_count } => write!(
                f,
                "the hole at vertex {}, of {vertex_count} vertices, cannot be closed without triangles of no area or \
                 edges of four triangles; merge vertices along a narrow gap, or close it by hand",
                vertex(v)
            ),
            Self::CloseHoles { value } => write!(
                f,
                "close_holes is {value}; give the largest part of the area that may be closed, from 0 to 1, 0 for none"
            ),
            Self::InconsistentOrientation { triangles, edge } => {
                let ([s, t], [a, b]) = (triangles.map(triangle), edge.map(vertex));
                write!(
                    f,
                    "{s} and {t} run through their shared edge ({a}, {b}) the same way; flip one of them so that all \
                     face outward"
                )
            }
            Self::NonManifold { edge, triangle_count } => {
                let [a, b] = edge.map(vertex);
                write!(
                    f,
                    "edge ({a}, {b}) is not manifold: {triangle_count} triangles share it, and only two may; split the \
                     surface there"
                )
            }
            Self::Inward { triangle: t, volume } => write!(
                f,
                "the closed part of the surface with {} is inside out: it encloses a volume of {volume:e}, and is no \
                 cavity of another part; reverse the corner order of all its triangles",
                triangle(t)
            ),
            Self::Flat { triangle: t } => write!(
                f,
                "the closed part of the surface with {} encloses no volume beyond rounding: it is flat, or one half of it \
                 is turned against the other; give it thickness, or remove one of its sides and say that the mesh may \
                 be open",
                triangle(t)
            ),
            Self::Overflow { triangle: t } => write!(
                f,
                "{} is so large that its area, or the volume around it, is beyond the largest number; scale all \
                 coordinates down by another unit of length, or make the mesh of double precision",
                triangle(t)
            ),
            Self::WrongCount { given, expected } => {
                write!(f, "{given} positions were given for {expected} vertices; give one for each")
            }
            Self::NotFinite { vertex, is_renewal } => write!(
                f,
                "vertex {} has a coordinate that is NaN or infinite; check the {}",
                Vertex(names, vertex),
                if is_renewal { "simulation's last step" } else { "input" }
            ),
            Self::CarrierSpacing { value } => write!(
                f,
                "carrier_spacing is {value}; give the distance between the nodes that carry the mesh, 0 where its vertices \
                 are the nodes, infinity where nothing moves it"
            ),
            Self::BeyondRange { vertex, value, largest } => write!(
                f,
                "vertex {} has the coordinate {value:e}, beyond {largest:e}, the largest number of the mesh's \
                 precision; scale the coordinates down, or make the mesh of double precision",
                Vertex(names, vertex)
            ),
        }
    }
}

impl std::error::Error for MeshError {}
