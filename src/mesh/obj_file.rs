use obj::{ObjData, ObjError};
use std::fmt;
use std::fs::File;
use std::io::BufReader;
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
    let not_readable = |source| ObjFileError::NotReadable { path: path.to_owned(), source };
    let broken = |reason| ObjFileError::Broken { path: path.to_owned(), reason };
    let file = File::open(path).map_err(not_readable)?;
    let data = match ObjData::load_buf(BufReader::new(file)) {
        Ok(data) => data,
        Err(ObjError::Io(source)) if source.kind() != std::io::ErrorKind::InvalidData => {
            return Err(not_readable(source));
        }
        Err(error) => return Err(broken(error.to_string())),
    };

    let mut triangles = Vec::new();
    let polygons = data.objects.iter().flat_map(|object| &object.groups).flat_map(|group| &group.polys);
    for polygon in polygons {
        let corners: Vec<u32> = polygon.0.iter().map(|corner| corner.0 as u32).collect();
        triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
    }
    if triangles.is_empty() {
        return Err(broken("it holds no faces".to_owned()));
    }
    Ok((data.position.iter().map(|p| p.map(f64::from)).collect(), triangles))
}
