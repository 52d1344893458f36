use std::fmt;

/// Why a mesh was refused. Nothing was created or changed.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// There is no triangle.
    Empty,
    /// More vertices or triangles than 32-bit indices reach.
    TooLarge {
        /// How many were given.
        count: usize,
    },
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A triangle names one vertex twice, or its three corners lie on a line.
    DegenerateTriangle {
        /// The triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
    },
    /// An edge belongs to one triangle only.
    Open {
        /// The triangle.
        triangle: usize,
        /// The edge's two vertices.
        edge: [u32; 2],
    },
    /// Two neighbours run through their shared edge the same way, so one of them faces inward.
    InconsistentOrientation {
        /// The two triangles.
        triangles: [usize; 2],
        /// The edge's two vertices.
        edge: [u32; 2],
    },
    /// An edge belongs to more than two triangles.
    NonManifold {
        /// The edge's two vertices.
        edge: [u32; 2],
        /// How many triangles share it.
        triangle_count: usize,
    },
    /// Closed and consistent, but its normals point into the body.
    Inward {
        /// The enclosed volume, negative or zero.
        volume: f64,
    },
    /// Positions for another number of vertices.
    WrongCount {
        /// How many were given.
        given: usize,
        /// How many the mesh has.
        expected: usize,
    },
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the mesh has no triangle; give at least four, forming a closed surface"),
            Self::TooLarge { count } => {
                write!(f, "{count} vertices or triangles are too many; at most {} are allowed", u32::MAX - 1)
            }
            Self::IndexOutOfRange { triangle, index, vertex_count } => write!(
                f,
                "triangle {triangle} names vertex {index}, but there are {vertex_count} vertices; indices count from 0"
            ),
            Self::DegenerateTriangle { triangle, corners: [a, b, c] } => write!(
                f,
                "triangle {triangle} ({a}, {b}, {c}) has no area: a repeated vertex, or corners on one line; remove it \
                 or merge its vertices"
            ),
            Self::Open { triangle, edge: [a, b] } => write!(
                f,
                "the mesh is open: edge ({a}, {b}) belongs to triangle {triangle} only; close the hole, merge \
                 duplicate vertices along the seam, or say that it may be open"
            ),
            Self::InconsistentOrientation { triangles: [s, t], edge: [a, b] } => write!(
                f,
                "triangles {s} and {t} run through their shared edge ({a}, {b}) the same way; flip one of them so that \
                 all face outward"
            ),
            Self::NonManifold { edge: [a, b], triangle_count } => write!(
                f,
                "edge ({a}, {b}) is not manifold: {triangle_count} triangles share it, and only two may; split the \
                 surface there"
            ),
            Self::Inward { volume } => write!(
                f,
                "the mesh is inside out: its enclosed volume is {volume:e}; reverse the corner order of every triangle"
            ),
            Self::WrongCount { given, expected } => {
                write!(f, "{given} positions were given for {expected} vertices; give one for each")
            }
            Self::NotFinite { vertex } => {
                write!(f, "vertex {vertex} has a coordinate that is NaN or infinite; check the simulation's last step")
            }
        }
    }
}

impl std::error::Error for MeshError {}
