//! A mesh as it was created, as bytes: what another process needs to make the same mesh.

use crate::bytes::{self, BytesError, CHECKSUM, Reader, checksum};
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::mesh::{Mesh, MeshError};
use std::fmt;

/// Why packed bytes were refused.
#[derive(Clone, Debug, PartialEq)]
pub enum PackedMeshError {
    /// They are not what was packed.
    Bytes(BytesError),
    /// They fit their checksum, but are no mesh.
    Mesh(MeshError),
}

impl fmt::Display for PackedMeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bytes(error) => write!(f, "packed mesh: {error}"),
            Self::Mesh(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for PackedMeshError {}

impl From<BytesError> for PackedMeshError {
    fn from(error: BytesError) -> Self {
        Self::Bytes(error)
    }
}

const MARK: [u8; 8] = *b"raycmesh";
const VERSION: u32 = 2;
const HEAD: usize = 8 + 3 * 4 + 3 * 8;
/// A vertex has three numbers, always in double precision, which holds either.
const VERTEX: usize = 3 * 8;
/// A triangle has its corners, and an entry of the clusters' list of triangles.
const TRIANGLE: usize = 3 * 4 + 4;

/// How many bytes a number of a packed mesh had, by which its precision is known; and what follows.
pub(crate) fn packed_number_size(bytes: &[u8]) -> Result<(u32, Reader<'_>), BytesError> {
    bytes::opened(bytes, MARK, VERSION)
}

/// How many bytes [`pack_mesh`] appends.
pub fn packed_mesh_length<T: Scalar>(mesh: &Mesh<T>) -> usize {
    let [vertices, triangles] = [mesh.reference_positions().len(), mesh.topology().triangles().len()];
    HEAD + vertices * VERTEX + triangles * TRIANGLE + mesh.clusters().len() + CHECKSUM
}

/// Appends the mesh as it was created: its triangles, its reference positions, not the present ones, and the clusters of
/// triangles that its tree needs, so that these need not be found again. The mesh that is [unpacked](unpack_mesh) from it has the
/// same contacts in the same order at the same positions, to the bit, in any process on any machine.
pub fn pack_mesh<T: Scalar>(mesh: &Mesh<T>, bytes: &mut Vec<u8>) {
    let start = bytes.len();
    let (positions, triangles) = (mesh.reference_positions(), mesh.topology().triangles());
    let clusters = mesh.clusters();
    bytes.room_for(packed_mesh_length(mesh));
    bytes.extend(MARK);
    [VERSION, size_of::<T>() as u32, u32::from(mesh.is_open())]
        .into_iter()
        .for_each(|word| bytes.extend(word.to_le_bytes()));
    [positions.len(), triangles.len(), clusters.len()]
        .into_iter()
        .for_each(|count| bytes.extend((count as u64).to_le_bytes()));
    for number in positions.iter().flat_map(|position| position.iter()) {
        bytes.extend(number.to_f64().to_le_bytes());
    }
    for number in triangles.as_flattened().iter().chain(clusters.triangles()) {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(clusters.sizes());
    let checksum = checksum(&bytes[start..]);
    bytes.extend(checksum.to_le_bytes());
}

/// The mesh that was packed, at its reference positions.
pub fn unpack_mesh<T: Scalar>(bytes: &[u8]) -> Result<Mesh<T>, PackedMeshError> {
    let (number_size, mut head) = packed_number_size(bytes)?;
    let open = head.whole();
    let mut count = || usize::try_from(head.long()?).ok();
    let counts = [count(), count(), count()];
    let counted = || {
        let [vertices, triangles, clusters] = [counts[0]?, counts[1]?, counts[2]?];
        let numbers = vertices.checked_mul(VERTEX)?.checked_add(triangles.checked_mul(TRIANGLE)?)?;
        Some((numbers.checked_add(clusters)?.checked_add(HEAD + CHECKSUM)?, vertices, triangles, clusters))
    };
    let (length, vertices, triangles, clusters) = counted().ok_or(BytesError::Foreign { length: bytes.len() })?;
    bytes::check::<T>(bytes, Some(length), number_size)?;
    let mut vector = || Some([head.number()?, head.number()?, head.number()?]);
    let positions = memory::tried((0..vertices).map(|_| vector().ok_or(BytesError::Damaged)))?;
    let mut corners = || Some([head.whole()?, head.whole()?, head.whole()?]);
    let triangles = memory::tried((0..triangles).map(|_| corners().ok_or(BytesError::Damaged)))?;
    let in_clusters = memory::tried((0..triangles.len()).map(|_| head.whole().ok_or(BytesError::Damaged)))?;
    let sizes =
        memory::tried((0..clusters).map(|_| head.take().map(|[size]: [u8; 1]| size).ok_or(BytesError::Damaged)))?;
    let made = match open {
        Some(0) => Mesh::new(&positions, &triangles),
        Some(1) => Mesh::open(&positions, &triangles),
        _ => return Err(BytesError::Damaged.into()),
    };
    let mesh = made.map_err(PackedMeshError::Mesh)?;
    if mesh.takes_clusters(in_clusters, sizes) { Ok(mesh) } else { Err(BytesError::Damaged.into()) }
}
