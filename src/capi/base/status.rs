/// How a call ended. The numbers never change; new ones may be added.
///
/// After every status but RAYC_STATUS_OK the call has changed nothing, no output has been written, and
/// rayc_last_error_message() says what was wrong where and what to do.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_status {
    /// The call did what it says.
    RAYC_STATUS_OK = 0,

    /// A pointer that must not be NULL is NULL.
    RAYC_STATUS_NULL_POINTER = 100,
    /// An options struct's struct_size is zero, too small, or larger than this library knows.
    RAYC_STATUS_INVALID_STRUCT_SIZE = 101,
    /// A number that stands for an enum names no member of it.
    RAYC_STATUS_UNKNOWN_ENUM = 102,
    /// A number among the options or arguments lies outside its range.
    RAYC_STATUS_INVALID_OPTION = 103,
    /// An array has another length than is needed, or a range reaches beyond the end.
    RAYC_STATUS_WRONG_COUNT = 104,
    /// A stride is smaller than the three numbers it must span.
    RAYC_STATUS_INVALID_STRIDE = 105,
    /// The scene has no body of this number.
    RAYC_STATUS_UNKNOWN_BODY = 106,
    /// A coordinate is NaN or infinite.
    RAYC_STATUS_NOT_FINITE = 107,
    /// The library that is linked is of another ABI than the headers. Only the C++ headers say so: see rayc_abi_version().
    RAYC_STATUS_OTHER_ABI = 108,
    /// A pointer that should be a handle is not one, is a handle of another type, or was destroyed. Do not rely on the
    /// last: a destroyed handle is recognised only while its memory has not been used for something else or returned to
    /// the system.
    RAYC_STATUS_INVALID_HANDLE = 109,
    /// A call that has not returned is using the handle, and at least one of the two calls changes it. The other call
    /// is one of another thread, or the query whose parallel_for is running. It is not disturbed; wait for it.
    RAYC_STATUS_BUSY = 110,
    /// Another body of the scene has the key.
    RAYC_STATUS_KEY_TAKEN = 111,

    /// The mesh has no triangle.
    RAYC_STATUS_MESH_EMPTY = 200,
    /// A triangle names a vertex that does not exist.
    RAYC_STATUS_MESH_INDEX_OUT_OF_RANGE = 201,
    /// A triangle names a vertex twice or has its corners on one line.
    RAYC_STATUS_MESH_DEGENERATE_TRIANGLE = 202,
    /// An edge belongs to one triangle only: the surface has a hole, and the options do not say that it may.
    RAYC_STATUS_MESH_OPEN = 203,
    /// Two neighbouring triangles face opposite ways.
    RAYC_STATUS_MESH_INCONSISTENT_ORIENTATION = 204,
    /// An edge belongs to more than two triangles.
    RAYC_STATUS_MESH_NON_MANIFOLD = 205,
    /// A closed part of the surface is inside out and is not a cavity in another part.
    RAYC_STATUS_MESH_INWARD = 206,
    /// More vertices or triangles than 32-bit indices reach.
    RAYC_STATUS_MESH_TOO_LARGE = 207,
    /// A closed part of the surface encloses no volume.
    RAYC_STATUS_MESH_FLAT = 208,
    /// A finite coordinate, or the area of a triangle, is beyond the largest number of the mesh's precision. New positions
    /// may also be refused with this.
    RAYC_STATUS_MESH_BEYOND_RANGE = 209,

    /// The octree is older than its mesh's positions: call rayc_octree_update().
    RAYC_STATUS_OCTREE_STALE = 300,
    /// The octree was built for another mesh.
    RAYC_STATUS_OCTREE_OF_OTHER_MESH = 301,
    /// Handles of float and of double precision were used together.
    RAYC_STATUS_PRECISION_MISMATCH = 302,

    /// A file is missing or may not be read.
    RAYC_STATUS_FILE_NOT_READABLE = 400,
    /// A file's text is not what it should be.
    RAYC_STATUS_FILE_BROKEN = 401,
    /// The bytes given are not what the library saved or packed, or have been changed since.
    RAYC_STATUS_SAVED_STATE_BROKEN = 402,
    /// The bytes given were saved by another version of the library, which wrote them in another form.
    RAYC_STATUS_SAVED_STATE_OTHER_VERSION = 403,

    /// The system gave no threads.
    RAYC_STATUS_THREADS_NOT_STARTED = 500,
    /// There is not enough memory. Any call may return this. A contact list that the call was to fill is then as before
    /// or empty. Three things still end the process if memory runs out in them: reading a file, starting the threads of
    /// a pool, and handing them work.
    RAYC_STATUS_OUT_OF_MEMORY = 501,

    /// A step of the contact system is under way and the call must come outside a step, or none is and the call must
    /// come within one.
    RAYC_STATUS_OUT_OF_ORDER = 600,
    /// A contact system has a body of this number already.
    RAYC_STATUS_BODY_TWICE = 601,
    /// The weights of a surface vertex do not sum to 1, or name a node that its body does not have.
    RAYC_STATUS_INVALID_WEIGHTS = 602,
    /// A mass is not above 0, or not from 2^-400 kg (3.9e-121) to 2^400 kg (2.6e120).
    RAYC_STATUS_INVALID_MASS = 603,
    /// An inertia is singular, or not symmetric and positive definite.
    RAYC_STATUS_INVALID_INERTIA = 604,
    /// A number of a material is out of its range: a stiffness, damping time or friction that is negative or above 2^80
    /// (1.2e24), a cap that is not above 0.
    RAYC_STATUS_INVALID_MATERIAL = 605,
    /// A normal is no unit vector, or a rotation no rotation matrix.
    RAYC_STATUS_INVALID_DIRECTION = 606,
    /// A step's length is not finite and above 0, or not from 2^-80 s (8.3e-25) to 2^80 s (1.2e24).
    RAYC_STATUS_INVALID_STEP = 607,
    /// The call needs the velocities of rigid bodies among the unknowns: see keeps_rigid_unknowns in
    /// rayc_contact_system_options.
    RAYC_STATUS_RIGID_ELIMINATED = 608,
    /// Contacts are so stiff beside the mass of a rigid body that this would be lost in rounding where its velocities are
    /// eliminated: some 1e12 times, stiffness (N/m) · dt · (dt + damping time) over mass. Use a softer material or a shorter
    /// step, or see keeps_rigid_unknowns in rayc_contact_system_options.
    RAYC_STATUS_TOO_STIFF = 609,
    /// A matrix in compressed rows has more numbers or rows than 32-bit indices reach, 2^31 - 1.
    RAYC_STATUS_MATRIX_TOO_LARGE = 610,

    /// Options that must be equal on all ranks are not. This and the next are only said by raycontact/mpi.hpp, on all ranks.
    RAYC_STATUS_RANKS_DISAGREE = 700,
    /// Two ranks have a body of the same key.
    RAYC_STATUS_BODY_ON_TWO_RANKS = 701,
    /// A body's owner is to be a rank that the communicator does not have.
    RAYC_STATUS_UNKNOWN_RANK = 702,
    /// A body has come back under its key with another mesh.
    RAYC_STATUS_OTHER_MESH = 703,
    /// The communicator is MPI_COMM_NULL or joins two groups, or MPI has not begun or has ended.
    RAYC_STATUS_INVALID_COMMUNICATOR = 704,
    /// MPI or Zoltan refused a call, or a message is longer than MPI can count.
    RAYC_STATUS_MPI_FAILED = 705,

    /// A fault inside the library was caught. Destroy the handles of this call; please report it.
    RAYC_STATUS_PANIC = 900,
}
