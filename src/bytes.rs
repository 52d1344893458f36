//! Bytes that a host keeps or sends: numbers little-endian on every machine, with a checksum at their end.

use crate::math::Scalar;
use std::fmt;

/// How many bytes the checksum takes.
pub(crate) const CHECKSUM: usize = 8;

/// FNV-1a.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

/// Why bytes were refused that should have been packed or saved before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum BytesError {
    /// So many bytes do not start as such bytes do, or are not as long as they say.
    Foreign { length: usize },
    /// Another version of the library wrote them, in the form of this number.
    OtherVersion { version: u32 },
    /// They hold numbers of the other precision, of so many bytes each.
    OtherPrecision { bytes: u32 },
    /// They have been changed since they were written.
    Damaged,
}

impl fmt::Display for BytesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign { length } => {
                write!(f, "the {length} bytes are something else, or not all; pass all that were written")
            }
            Self::OtherVersion { version } => {
                write!(f, "the bytes have form {version}, which this library does not read; write them anew")
            }
            Self::OtherPrecision { bytes } => {
                write!(f, "the bytes hold {bytes}-byte numbers; read them with that precision")
            }
            Self::Damaged => f.write_str("the bytes have been changed since they were written; write them anew"),
        }
    }
}

impl std::error::Error for BytesError {}

/// The size of a number, which follows the mark and the form's number, and all that comes after it.
pub(crate) fn opened(bytes: &[u8], mark: [u8; 8], version: u32) -> Result<(u32, Reader<'_>), BytesError> {
    let mut head = Reader { rest: bytes };
    let is_marked = head.take::<8>() == Some(mark);
    let foreign = BytesError::Foreign { length: bytes.len() };
    let found = head.whole().filter(|_| is_marked).ok_or(foreign)?;
    if found != version {
        return Err(BytesError::OtherVersion { version: found });
    }
    let number_size = head.whole().ok_or(foreign)?;
    Ok((number_size, head))
}

/// Whether the bytes are as long as they say, as they were written, and with numbers of this type.
pub(crate) fn check<T: Scalar>(bytes: &[u8], length: Option<usize>, number_size: u32) -> Result<(), BytesError> {
    if length != Some(bytes.len()) || bytes.len() < CHECKSUM {
        return Err(BytesError::Foreign { length: bytes.len() });
    }
    let (body, end) = bytes.split_at(bytes.len() - CHECKSUM);
    if checksum(body).to_le_bytes() != *end {
        return Err(BytesError::Damaged);
    }
    if number_size as usize != size_of::<T>() {
        return Err(BytesError::OtherPrecision { bytes: number_size });
    }
    Ok(())
}

/// Takes one number after the other; `None` behind the last.
pub(crate) struct Reader<'a> {
    pub(crate) rest: &'a [u8],
}

impl Reader<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*taken)
    }

    pub(crate) fn whole(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(crate) fn long(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(crate) fn number<T: Scalar>(&mut self) -> Option<T> {
        self.take().map(|bytes| T::of(f64::from_le_bytes(bytes)))
    }
}
