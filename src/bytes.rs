//! Bytes that a host keeps or sends: numbers little-endian on every machine, with a checksum at their end.

use crate::math::Scalar;

/// How many bytes the checksum takes.
pub(crate) const CHECKSUM: usize = 8;

/// FNV-1a.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
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
