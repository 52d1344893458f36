use crate::bytes::BytesError;
use crate::capi::base::rayc_status;
use crate::distributed::PackedMeshError;
use crate::force::LawError;
use crate::math::PoseError;
use crate::memory::text;
use crate::mesh::{MeshError, ObjFileError};
use crate::query::OctreeError;
use crate::scene::SceneError;
use crate::system::SystemError;
use std::borrow::Cow;
use std::fmt::Display;

use rayc_status::*;

/// A status other than OK, and its message.
#[derive(Debug)]
pub(in crate::capi) struct Failure {
    pub(in crate::capi) status: rayc_status,
    pub(in crate::capi) message: Cow<'static, str>,
}

impl Failure {
    pub(in crate::capi) fn new(status: rayc_status, message: impl Into<Cow<'static, str>>) -> Self {
        Self { status, message: message.into() }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::new(mesh_status(&error), text!("{error}"))
    }
}

impl From<ObjFileError> for Failure {
    fn from(error: ObjFileError) -> Self {
        let status = match error {
            ObjFileError::NotReadable { .. } => RAYC_STATUS_FILE_NOT_READABLE,
            ObjFileError::Broken { .. } => RAYC_STATUS_FILE_BROKEN,
        };
        Self::new(status, text!("{error}"))
    }
}

impl From<OctreeError> for Failure {
    fn from(error: OctreeError) -> Self {
        let status = match error {
            OctreeError::Stale => RAYC_STATUS_OCTREE_STALE,
            OctreeError::OtherMesh => RAYC_STATUS_OCTREE_OF_OTHER_MESH,
        };
        Self::new(status, text!("{error}"))
    }
}

impl From<LawError> for Failure {
    fn from(error: LawError) -> Self {
        Self::new(RAYC_STATUS_INVALID_OPTION, text!("{error}"))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        let message = text!("{error}");
        match error {
            SceneError::UnknownBody { .. } => Self::new(RAYC_STATUS_UNKNOWN_BODY, message),
            SceneError::SameBody { .. } | SceneError::StepLength { .. } => {
                Self::new(RAYC_STATUS_INVALID_OPTION, message)
            }
            SceneError::KeyTaken { .. } => Self::new(RAYC_STATUS_KEY_TAKEN, message),
            SceneError::PairMemory { .. } => Self::new(RAYC_STATUS_SAVED_STATE_BROKEN, message),
            SceneError::Pose { source: PoseError::Position { .. } | PoseError::Rotation { .. }, .. } => {
                Self::new(RAYC_STATUS_NOT_FINITE, message)
            }
            SceneError::Pose { .. } => Self::new(RAYC_STATUS_INVALID_DIRECTION, message),
            SceneError::PoseBeyondRange { .. } => Self::new(RAYC_STATUS_MESH_BEYOND_RANGE, message),
            SceneError::ContactsOutdated { .. } => Self::new(RAYC_STATUS_OCTREE_STALE, message),
            SceneError::SavedState(error) => Self::new(bytes_status(error), message),
            SceneError::ThreadsNotStarted { .. } => Self::new(RAYC_STATUS_THREADS_NOT_STARTED, message),
        }
    }
}

impl From<PackedMeshError> for Failure {
    fn from(error: PackedMeshError) -> Self {
        let status = match &error {
            PackedMeshError::Bytes(error) => bytes_status(*error),
            PackedMeshError::Mesh(error) => mesh_status(error),
        };
        Self::new(status, text!("{error}"))
    }
}

impl From<SystemError> for Failure {
    fn from(error: SystemError) -> Self {
        let status = match &error {
            SystemError::NotInScene { .. } | SystemError::UnknownBody { .. } => RAYC_STATUS_UNKNOWN_BODY,
            SystemError::BodyTwice { .. } => RAYC_STATUS_BODY_TWICE,
            SystemError::WrongCount { .. } | SystemError::UnknownHalfSpace { .. } => RAYC_STATUS_WRONG_COUNT,
            SystemError::NotFinite { .. } => RAYC_STATUS_NOT_FINITE,
            SystemError::BeyondRange { .. } => RAYC_STATUS_INVALID_OPTION,
            SystemError::StepLength { .. } => RAYC_STATUS_INVALID_STEP,
            SystemError::Mass { .. } => RAYC_STATUS_INVALID_MASS,
            SystemError::Inertia => RAYC_STATUS_INVALID_INERTIA,
            SystemError::Rotation { .. } | SystemError::Normal { .. } => RAYC_STATUS_INVALID_DIRECTION,
            SystemError::Material { .. } => RAYC_STATUS_INVALID_MATERIAL,
            SystemError::WeightSum { .. } | SystemError::NodeRange { .. } | SystemError::Offsets { .. } => {
                RAYC_STATUS_INVALID_WEIGHTS
            }
            SystemError::NoStep | SystemError::StepUnderWay => RAYC_STATUS_OUT_OF_ORDER,
            SystemError::NotRemembered { .. } => RAYC_STATUS_WRONG_COUNT,
            SystemError::Memory { .. } => RAYC_STATUS_SAVED_STATE_BROKEN,
            SystemError::Eliminated => RAYC_STATUS_RIGID_ELIMINATED,
            SystemError::MatrixSize => RAYC_STATUS_MATRIX_TOO_LARGE,
            SystemError::TooStiff { .. } => RAYC_STATUS_TOO_STIFF,
            SystemError::Mesh { source, .. } => mesh_status(source),
        };
        Self::new(status, text!("{error}"))
    }
}

pub(in crate::capi) fn mesh_status(error: &MeshError) -> rayc_status {
    match error {
        MeshError::Empty => RAYC_STATUS_MESH_EMPTY,
        MeshError::TooLarge { .. } => RAYC_STATUS_MESH_TOO_LARGE,
        MeshError::IndexOutOfRange { .. } => RAYC_STATUS_MESH_INDEX_OUT_OF_RANGE,
        MeshError::DegenerateTriangle { .. } => RAYC_STATUS_MESH_DEGENERATE_TRIANGLE,
        MeshError::Open { .. }
        | MeshError::Seam { .. }
        | MeshError::HolesTouch { .. }
        | MeshError::HoleTooLong { .. }
        | MeshError::HoleTooLarge { .. }
        | MeshError::HoleNotClosed { .. } => RAYC_STATUS_MESH_OPEN,
        MeshError::InconsistentOrientation { .. } => RAYC_STATUS_MESH_INCONSISTENT_ORIENTATION,
        MeshError::NonManifold { .. } => RAYC_STATUS_MESH_NON_MANIFOLD,
        MeshError::Inward { .. } => RAYC_STATUS_MESH_INWARD,
        MeshError::WrongCount { .. } => RAYC_STATUS_WRONG_COUNT,
        MeshError::NotFinite { .. } => RAYC_STATUS_NOT_FINITE,
        MeshError::Flat { .. } => RAYC_STATUS_MESH_FLAT,
        MeshError::Overflow { .. } | MeshError::BeyondRange { .. } => RAYC_STATUS_MESH_BEYOND_RANGE,
        MeshError::CarrierSpacing { .. } | MeshError::CloseHoles { .. } => RAYC_STATUS_INVALID_OPTION,
    }
}

/// A number that names no member of an enum.
pub(in crate::capi) fn unknown_enum(field: impl Display, value: u32, name: &str) -> Failure {
    Failure::new(
        RAYC_STATUS_UNKNOWN_ENUM,
        text!("{field} is {value}, which is no member of {name}; use one of its names"),
    )
}

fn bytes_status(error: BytesError) -> rayc_status {
    match error {
        BytesError::Foreign { .. } | BytesError::Damaged => RAYC_STATUS_SAVED_STATE_BROKEN,
        BytesError::OtherVersion { .. } => RAYC_STATUS_SAVED_STATE_OTHER_VERSION,
        BytesError::OtherPrecision { .. } => RAYC_STATUS_PRECISION_MISMATCH,
    }
}
