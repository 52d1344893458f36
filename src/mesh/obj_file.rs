use super::obj_text::{self, ObjSurface};
use crate::memory;
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Positions and triangles as [`Mesh::new`](super::Mesh::new) takes them.
pub type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Why an `.obj` file could not be read.
#[derive(Debug)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum ObjFileError {
    /// The file is missing or may not be read.
    NotReadable { path: PathBuf, source: std::io::Error },
    /// The file's text is not an `.obj` surface, for this reason.
    Broken { path: PathBuf, reason: String },
}

impl fmt::Display for ObjFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotReadable { path, source } => {
                write!(f, "cannot read {}: {source}; check the path and its permissions", path.display())
            }
            Self::Broken { path, reason } => {
                let advice = "only .obj files are read: convert other formats, or export it again as a triangle mesh";
                write!(f, "{} is not a usable .obj file: {reason}; {advice}", path.display())
            }
        }
    }
}

impl std::error::Error for ObjFileError {}

/// Reads the surface of a Wavefront `.obj` file: vertices in the file's order, faces of all objects and groups together,
/// polygons cut into triangle fans.
///
/// # Errors
/// [`ObjFileError`]; whether the surface is closed and so on is checked later, by [`Mesh::new`](super::Mesh::new).
pub fn read_obj_file(path: &Path) -> Result<Surface, ObjFileError> {
    let ObjSurface { positions, triangles, .. } = read_obj_surface(path)?;
    Ok((positions, triangles))
}

/// The same, with the line of each triangle's face.
pub(crate) fn read_obj_surface(path: &Path) -> Result<ObjSurface, ObjFileError> {
    // For the copies of the path in an error.
    memory::ask(2 * path.as_os_str().len());
    let bytes = read_bytes(path).map_err(|source| ObjFileError::NotReadable { path: path.to_owned(), source })?;
    obj_text::read(&bytes).map_err(|reason| ObjFileError::Broken { path: path.to_owned(), reason })
}

fn read_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata().map_or(0, |file| file.len());
    // One byte more, so that the end is met without growing.
    let mut bytes = memory::with_room(usize::try_from(length).unwrap_or(usize::MAX).saturating_add(1));
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}
