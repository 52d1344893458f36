use libc::c_void;

/// The type of a number. In structs it stands as a uint32_t and is checked.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_scalar {
    /// float
    RAYC_SCALAR_F32 = 1,
    /// double
    RAYC_SCALAR_F64 = 2,
}

/// An array of 3-vectors of the caller's, of any stride: vector i lies at data + i · stride. Only its three numbers
/// are read, never anything beyond the last one; they need no alignment. The memory stays the caller's and is used during
/// the call only.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_vectors {
    /// x of the first vector. With count 0 it may be anything.
    pub data: *const c_void,
    /// How many vectors.
    pub count: usize,
    /// Bytes from one vector to the next; 0: they are packed. At least three numbers' size.
    pub stride: usize,
    /// The numbers' type, a rayc_scalar.
    pub scalar: u32,
}

/// The same, to be written or added to.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_vectors_mut {
    /// x of the first vector. With count 0 it may be anything.
    pub data: *mut c_void,
    /// How many vectors.
    pub count: usize,
    /// Bytes from one vector to the next; 0: they are packed. At least three numbers' size.
    pub stride: usize,
    /// The numbers' type, a rayc_scalar.
    pub scalar: u32,
}

impl rayc_vectors_mut {
    pub(in crate::capi) fn to_read(self) -> rayc_vectors {
        let Self { data, count, stride, scalar } = self;
        rayc_vectors { data, count, stride, scalar }
    }
}
