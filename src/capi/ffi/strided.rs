use super::failure::{Failure, unknown_enum};
use crate::capi::base::{rayc_scalar, rayc_status, rayc_vectors, rayc_vectors_mut};
use crate::force::VectorsMut;
use crate::math::{Scalar, Vector3};
use crate::memory::text;
use std::fmt::Display;
use std::ops::Range;

pub(in crate::capi) fn scalar_from(value: u32, field: impl Display) -> Result<rayc_scalar, Failure> {
    match value {
        v if v == rayc_scalar::RAYC_SCALAR_F32 as u32 => Ok(rayc_scalar::RAYC_SCALAR_F32),
        v if v == rayc_scalar::RAYC_SCALAR_F64 as u32 => Ok(rayc_scalar::RAYC_SCALAR_F64),
        other => Err(unknown_enum(field, other, "rayc_scalar")),
    }
}

/// How many bytes three numbers take.
fn packed(scalar: rayc_scalar) -> usize {
    3 * match scalar {
        rayc_scalar::RAYC_SCALAR_F32 => size_of::<f32>(),
        rayc_scalar::RAYC_SCALAR_F64 => size_of::<f64>(),
    }
}

fn greatest_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

/// A checked array of the caller's, readable and, where it came from a `rayc_vectors_mut`, writable.
#[derive(Clone, Copy)]
pub(in crate::capi) struct Strided {
    data: *mut u8,
    count: usize,
    stride: usize,
    scalar: rayc_scalar,
}

impl Strided {
    /// # Safety
    /// The array is as it says, and stays so while the result is used.
    pub(in crate::capi) unsafe fn new(vectors: &rayc_vectors, name: impl Display) -> Result<Self, Failure> {
        let rayc_vectors { data, count, stride, scalar } = *vectors;
        let scalar = scalar_from(scalar, format_args!("{name}.scalar"))?;
        let packed = packed(scalar);
        let stride = if stride == 0 { packed } else { stride };
        if stride < packed {
            let message =
                text!("{name}.stride is {stride} bytes, but three numbers take {packed}; give at least that, or 0");
            // By such a stride, the C++ headers tell of an array with one or two numbers too many.
            let message = match count.checked_mul(3).and_then(|numbers| numbers.checked_add(stride)) {
                Some(numbers) if stride < 3 => text!(
                    "{message}. From raycontact::vectors() it stands for an array of {numbers} numbers, which is no \
                     multiple of three; give three for each vector"
                ),
                _ => message,
            };
            return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_STRIDE, message));
        }
        // Unchecked, the product could wrap around and point anywhere.
        if count.checked_mul(stride).is_none_or(|bytes| bytes > isize::MAX as usize) {
            return Err(Failure::new(
                rayc_status::RAYC_STATUS_INVALID_STRIDE,
                text!("{name}: {count} vectors with a stride of {stride} bytes exceed any memory; check both"),
            ));
        }
        if count > 0 && data.is_null() {
            return Err(Failure::new(
                rayc_status::RAYC_STATUS_NULL_POINTER,
                text!("{name}.data is NULL, but {name}.count is {count}; pass the array"),
            ));
        }
        Ok(Self { data: data.cast_mut().cast(), count, stride, scalar })
    }

    /// # Safety
    /// The array is as it says, and nobody else uses it while the result is used.
    pub(in crate::capi) unsafe fn new_mut(vectors: &rayc_vectors_mut, name: impl Display) -> Result<Self, Failure> {
        // SAFETY: by this function's contract.
        unsafe { Self::new(&vectors.to_read(), name) }
    }

    /// # Safety
    /// As [`new`](Self::new), which has found no fault with it.
    #[inline]
    pub(in crate::capi) unsafe fn known(vectors: &rayc_vectors) -> Self {
        let rayc_vectors { data, count, stride, scalar } = *vectors;
        let is_single = scalar == rayc_scalar::RAYC_SCALAR_F32 as u32;
        let scalar = if is_single { rayc_scalar::RAYC_SCALAR_F32 } else { rayc_scalar::RAYC_SCALAR_F64 };
        Self { data: data.cast_mut().cast(), count, stride: if stride == 0 { packed(scalar) } else { stride }, scalar }
    }

    /// # Safety
    /// As [`new_mut`](Self::new_mut), which has found no fault with it.
    #[inline]
    pub(in crate::capi) unsafe fn known_mut(vectors: &rayc_vectors_mut) -> Self {
        // SAFETY: by this function's contract.
        unsafe { Self::known(&vectors.to_read()) }
    }

    pub(in crate::capi) fn count(&self) -> usize {
        self.count
    }

    pub(in crate::capi) fn scalar(&self) -> rayc_scalar {
        self.scalar
    }

    pub(in crate::capi) fn stride(&self) -> usize {
        self.stride
    }

    /// From its first byte to the one after its last; none where it has no vectors.
    pub(in crate::capi) fn bytes(&self) -> Range<usize> {
        let start = self.data.addr();
        let length = self.count.checked_sub(1).map_or(0, |last| last * self.stride + packed(self.scalar));
        start..start.saturating_add(length)
    }

    /// Whether a byte belongs to both. Those between vectors belong to neither.
    pub(in crate::capi) fn shares_with(&self, other: &Self) -> bool {
        let (own, others) = (self.bytes(), other.bytes());
        if own.start.max(others.start) >= own.end.min(others.end) {
            return false;
        }
        // Vectors of both arrays are this far apart, plus multiples of what divides both strides.
        let step = greatest_divisor(self.stride, other.stride) as isize;
        let behind = (others.start as isize).wrapping_sub(own.start as isize).rem_euclid(step) as usize;
        behind < packed(self.scalar) || step as usize - behind < packed(other.scalar)
    }

    /// Whether no bytes lie between the vectors.
    pub(in crate::capi) fn is_packed(&self) -> bool {
        self.stride == packed(self.scalar)
    }

    /// Where `count` vectors from number `first` on begin.
    ///
    /// # Panics
    /// Where the array has not so many.
    #[inline]
    pub(in crate::capi) fn places(&self, first: usize, count: usize) -> *const u8 {
        let last = first + count;
        assert!(first < last && last <= self.count, "vectors {first} to {last} of {}", self.count);
        self.data.wrapping_add(first * self.stride)
    }

    fn place(&self, index: usize) -> *mut u8 {
        self.places(index, 1).cast_mut()
    }

    pub(in crate::capi) fn read<T: Scalar>(&self, index: usize) -> Vector3<T> {
        let place = self.place(index);
        // SAFETY: three numbers of the given type lie there, aligned or not.
        unsafe {
            match self.scalar {
                rayc_scalar::RAYC_SCALAR_F32 => {
                    place.cast::<[f32; 3]>().read_unaligned().map(|x| T::of(f64::from(x))).into()
                }
                rayc_scalar::RAYC_SCALAR_F64 => place.cast::<[f64; 3]>().read_unaligned().map(T::of).into(),
            }
        }
    }

    pub(in crate::capi) fn write<T: Scalar>(&mut self, index: usize, vector: &Vector3<T>) {
        let place = self.place(index);
        let vector: [f64; 3] = vector.map(T::to_f64).into();
        // SAFETY: three numbers of the given type fit there, aligned or not, and only arrays made by `new_mut` are
        // written to.
        unsafe {
            match self.scalar {
                rayc_scalar::RAYC_SCALAR_F32 => place.cast::<[f32; 3]>().write_unaligned(vector.map(|x| x as f32)),
                rayc_scalar::RAYC_SCALAR_F64 => place.cast::<[f64; 3]>().write_unaligned(vector),
            }
        }
    }
}

impl<T: Scalar> VectorsMut<T> for Strided {
    fn add(&mut self, vertex: u32, vector: Vector3<T>) {
        let sum = self.read::<T>(vertex as usize) + vector;
        self.write(vertex as usize, &sum);
    }
}
