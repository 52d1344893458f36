//! What the pairs of a scene remember, as bytes that a host saves with its own state.

use super::SceneError;
use super::pairs::Remembered;
use crate::contact::{PairMemory, Record};
use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use std::fmt;

/// Why saved bytes were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SavedStateError {
    /// They do not start as saved bytes do, or their length does not fit their own count.
    NotSavedState {
        /// How many bytes there are.
        length: usize,
    },
    /// Another version of the library wrote them in another form.
    OtherVersion {
        /// The form's number.
        version: u32,
    },
    /// They come from a scene of the other precision.
    OtherPrecision {
        /// Bytes of one number of that scene.
        bytes: u32,
    },
    /// They have been changed since they were saved.
    Damaged,
}

impl fmt::Display for SavedStateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSavedState { length } => {
                write!(f, "the {length} bytes are not a scene's saved pair memories; pass all that were saved")
            }
            Self::OtherVersion { version } => {
                write!(f, "the saved pair memories have form {version}, this library reads {VERSION}; save them anew")
            }
            Self::OtherPrecision { bytes } => write!(
                f,
                "the saved pair memories are of a scene with {bytes}-byte numbers; restore them in one of that precision"
            ),
            Self::Damaged => write!(f, "the saved pair memories have been changed since; save them anew"),
        }
    }
}

impl std::error::Error for SavedStateError {}

const MARK: [u8; 8] = *b"raycpair";
const VERSION: u32 = 1;
const HEAD: usize = 24;
/// Five whole numbers and eight others, these always in double precision, which holds both.
const ENTRY: usize = 5 * 4 + 8 * 8;
const CHECKSUM: usize = 8;

/// How many bytes `count` memories take.
pub(super) fn saved_length(count: usize) -> usize {
    HEAD + count * ENTRY + CHECKSUM
}

/// Appends the memories, numbers little-endian on every machine.
pub(super) fn save<T: Scalar>(memories: &[Remembered<T>], bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.room_for(saved_length(memories.len()));
    bytes.extend(MARK);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((size_of::<T>() as u32).to_le_bytes());
    bytes.extend((memories.len() as u64).to_le_bytes());
    for ([first, second], memory) in memories {
        let PairMemory { escape, lowest, halved, net_push } = memory;
        for number in [*first, *second, u32::from(escape.is_some()), lowest.steps, halved.steps] {
            bytes.extend(number.to_le_bytes());
        }
        let away = escape.unwrap_or_default();
        for number in [away.x, away.y, away.z, lowest.value, halved.value, net_push.x, net_push.y, net_push.z] {
            bytes.extend(number.to_f64().to_le_bytes());
        }
    }
    let checksum = checksum(&bytes[start..]);
    bytes.extend(checksum.to_le_bytes());
}

/// The memories that were saved, in ascending order of their pairs.
pub(super) fn restore<T: Scalar>(bytes: &[u8]) -> Result<Vec<Remembered<T>>, SceneError> {
    let mut head = Reader { rest: bytes };
    let not_saved = SavedStateError::NotSavedState { length: bytes.len() };
    if head.take::<8>() != Some(MARK) {
        return Err(not_saved.into());
    }
    let (version, number_size) = (head.whole().ok_or(not_saved)?, head.whole().ok_or(not_saved)?);
    if version != VERSION {
        return Err(SavedStateError::OtherVersion { version }.into());
    }
    let count = head.take().map(u64::from_le_bytes).ok_or(not_saved)?;
    let length = (count as usize).checked_mul(ENTRY).and_then(|entries| entries.checked_add(HEAD + CHECKSUM));
    if length != Some(bytes.len()) {
        return Err(not_saved.into());
    }
    let (body, end) = bytes.split_at(bytes.len() - CHECKSUM);
    if checksum(body).to_le_bytes() != *end {
        return Err(SavedStateError::Damaged.into());
    }
    if number_size as usize != size_of::<T>() {
        return Err(SavedStateError::OtherPrecision { bytes: number_size }.into());
    }
    let mut memories = memory::with_room(count as usize);
    for _ in 0..count {
        memories.push(entry(&mut head).ok_or(SavedStateError::Damaged)?);
    }
    // Nothing that was saved is otherwise; bytes made up with a fitting checksum may be.
    let in_order = memories.windows(2).all(|pair| pair[0].0 < pair[1].0);
    if in_order && memories.iter().all(|([first, second], memory)| first < second && is_possible(memory)) {
        Ok(memories)
    } else {
        Err(SavedStateError::Damaged.into())
    }
}

fn entry<T: Scalar>(bytes: &mut Reader) -> Option<Remembered<T>> {
    let pair = [bytes.whole()?, bytes.whole()?];
    let escaping = bytes.whole()?;
    let steps = [bytes.whole()?, bytes.whole()?];
    let away = Vector3::new(bytes.number()?, bytes.number()?, bytes.number()?);
    let lowest = Record { value: bytes.number()?, steps: steps[0] };
    let halved = Record { value: bytes.number()?, steps: steps[1] };
    let net_push = Vector3::new(bytes.number()?, bytes.number()?, bytes.number()?);
    (escaping <= 1).then_some((pair, PairMemory { escape: (escaping == 1).then_some(away), lowest, halved, net_push }))
}

fn is_possible<T: Scalar>(memory: &PairMemory<T>) -> bool {
    let is_direction = |away: Vector3<T>| (away.norm_squared() - T::one()).abs() < T::of(1e-3);
    // In this form NaN is not.
    memory.escape.is_none_or(is_direction)
        && memory.lowest.value >= T::zero()
        && memory.halved.value >= T::zero()
        && memory.net_push.norm_squared() < T::of(1.001)
}

/// FNV-1a.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*taken)
    }

    fn whole(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn number<T: Scalar>(&mut self) -> Option<T> {
        self.take().map(|bytes| T::of(f64::from_le_bytes(bytes)))
    }
}
