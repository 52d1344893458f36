use crate::memory;
use obj::{ObjData, ObjError};
use std::fmt;
use std::path::{Path, PathBuf};

/// Positions and triangles as [`Mesh::new`](super::Mesh::new) takes them.
pub type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Why an `.obj` file could not be read.
#[derive(Debug)]
pub enum ObjFileError {
    /// The file is missing or may not be read.
    NotReadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file's text is not an `.obj` surface.
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        reason: String,
    },
}

impl fmt::Display for ObjFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotReadable { path, source } => {
                write!(f, "cannot read {}: {source}; check the path and its permissions", path.display())
            }
            Self::Broken { path, reason } => {
                write!(f, "{} is not a usable .obj file: {reason}; export it again as a triangle mesh", path.display())
            }
        }
    }
}

impl std::error::Error for ObjFileError {}

/// Reads the surface of a Wavefront `.obj` file: vertices in the file's order (through `f32`, the reader's
/// precision), faces of all objects and groups together, polygons cut into triangle fans.
///
/// # Errors
/// [`ObjFileError`]; whether the surface is closed and so on is checked later, by [`Mesh::new`](super::Mesh::new).
pub fn read_obj_file(path: &Path) -> Result<Surface, ObjFileError> {
    let broken = |reason| ObjFileError::Broken { path: path.to_owned(), reason };
    ask_for_memory(path);
    let text = std::fs::read(path).map_err(|source| ObjFileError::NotReadable { path: path.to_owned(), source })?;
    let data = ObjData::load_buf(text.as_slice()).map_err(|error| broken(reason(&error)))?;

    let vertex_count = data.position.len();
    let mut triangles = Vec::new();
    let polygons = data.objects.iter().flat_map(|object| &object.groups).flat_map(|group| &group.polys);
    for (face, polygon) in polygons.enumerate() {
        let face = face + 1;
        if polygon.0.len() < 3 {
            return Err(broken(format!("face {face} has fewer than three corners")));
        }
        // The reader gives wrapped numbers for negative ones that reach before the first vertex.
        if let Some(corner) = polygon.0.iter().find(|corner| corner.0 >= vertex_count) {
            let vertex = (corner.0 as isize).wrapping_add(1);
            return Err(broken(format!("face {face} names vertex {vertex}, but there are {vertex_count} vertices")));
        }
        let corners: Vec<u32> = polygon.0.iter().map(|corner| corner.0 as u32).collect();
        triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
    }
    if triangles.is_empty() {
        return Err(broken("it holds no faces".to_owned()));
    }
    Ok((data.position.iter().map(|p| p.map(f64::from)).collect(), triangles))
}

/// What the reader found; it counts lines from 0, people from 1.
/// The reader cannot say that there is none. A file's shortest line is four bytes long; what cannot be read says so later.
fn ask_for_memory(path: &Path) {
    let length = std::fs::metadata(path).map_or(0, |file| file.len());
    memory::ask(usize::try_from(length).unwrap_or(usize::MAX).saturating_mul(64));
}

fn reason(error: &ObjError) -> String {
    match error {
        ObjError::Io(error) => format!("it is not text ({error})"),
        ObjError::ArgumentListFailure { line_number, list } => {
            format!("line {} should give numbers, not {list}", line_number + 1)
        }
        ObjError::MalformedFaceGroup { line_number, group } => {
            format!("line {}: the corner {group:?} names no vertex", line_number + 1)
        }
        ObjError::ZeroVertexNumber { line_number } => {
            format!("line {} names vertex 0, but vertices count from 1", line_number + 1)
        }
        other => other.to_string(),
    }
}
