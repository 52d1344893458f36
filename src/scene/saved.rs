//! What the pairs of a scene remember, as bytes that a host saves with its own state.

use super::pairs::{History, Remembered};
use crate::bytes::{self, BytesError, CHECKSUM, Reader, checksum};
use crate::escape::{MEMORY_BYTES, PairMemory};
use crate::math::Scalar;
use crate::memory::{self, Room};

const MARK: [u8; 8] = *b"raycpair";
/// The form of the bytes.
const VERSION: u32 = 3;
const HEAD: usize = 44;
/// Flags of the history.
const IS_QUERIED: u32 = 1;
const IS_ADVANCED: u32 = 2;
/// A flag of the history: no position has changed since the newest query.
const IS_AT_QUERY: u32 = 4;
/// The pair's two bodies and what it remembers.
const ENTRY: usize = 2 * 4 + MEMORY_BYTES;

/// How many bytes the history takes.
pub(super) fn saved_length<T: Scalar>(history: &History<T>) -> usize {
    let after = if history.is_queried { history.after.len() } else { 0 };
    HEAD + (history.before.len() + after) * ENTRY + CHECKSUM
}

/// Appends the history, numbers little-endian on every machine. `stamp` is that of the bodies' newest positions.
pub(super) fn save<T: Scalar>(history: &History<T>, stamp: u64, bytes: &mut Vec<u8>) {
    let start = bytes.len();
    let History { before, after, is_queried, queried_at, is_advanced, passed } = history;
    let after = if *is_queried { after.as_slice() } else { &[] };
    bytes.room_for(saved_length(history));
    bytes.extend(MARK);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((size_of::<T>() as u32).to_le_bytes());
    let flags = [(*is_queried, IS_QUERIED), (*is_advanced, IS_ADVANCED), (stamp == *queried_at, IS_AT_QUERY)];
    let flags = flags.iter().fold(0, |flags, (is_set, flag)| if *is_set { flags | flag } else { flags });
    bytes.extend(flags.to_le_bytes());
    bytes.extend(passed.to_le_bytes());
    bytes.extend((before.len() as u64).to_le_bytes());
    bytes.extend((after.len() as u64).to_le_bytes());
    for ([first, second], memory) in before.iter().chain(after) {
        [first, second].iter().for_each(|body| bytes.extend(body.to_le_bytes()));
        bytes.extend(memory.to_bytes());
    }
    let checksum = checksum(&bytes[start..]);
    bytes.extend(checksum.to_le_bytes());
}

/// The history that was saved. `stamp` is that of the bodies' newest positions, which are the same as when it was saved.
pub(super) fn restore<T: Scalar>(bytes: &[u8], stamp: u64) -> Result<History<T>, BytesError> {
    let foreign = BytesError::Foreign { length: bytes.len() };
    let (number_size, mut head) = bytes::opened(bytes, MARK, VERSION)?;
    let flags = head.whole().ok_or(foreign)?;
    let passed = head.number().ok_or(foreign)?;
    let mut count = || head.long().ok_or(foreign);
    let counts = [count()?, count()?];
    let entries = counts[0].checked_add(counts[1]).and_then(|count| usize::try_from(count).ok());
    let length = entries.and_then(|count| count.checked_mul(ENTRY)?.checked_add(HEAD + CHECKSUM));
    bytes::check::<T>(bytes, length, number_size)?;
    let [before, after] = [memories(&mut head, counts[0])?, memories(&mut head, counts[1])?];
    let is_set = |flag| flags & flag != 0;
    let (is_queried, is_advanced) = (is_set(IS_QUERIED), is_set(IS_ADVANCED));
    // Saved bytes always pass; forged ones with a fitting checksum may not.
    if flags > IS_QUERIED | IS_ADVANCED | IS_AT_QUERY
        || !(0.0..1.0).contains(&passed)
        || !(is_queried || after.is_empty())
    {
        return Err(BytesError::Damaged);
    }
    let queried_at = if is_set(IS_AT_QUERY) { stamp } else { 0 };
    Ok(History { before, after, is_queried, queried_at, is_advanced, passed })
}

/// Reads this many memories; only the scene can tell whether they are in order.
fn memories<T: Scalar>(bytes: &mut Reader, count: u64) -> Result<Vec<Remembered<T>>, BytesError> {
    let mut memories = memory::with_room(count as usize);
    for _ in 0..count {
        memories.push(entry(bytes).ok_or(BytesError::Damaged)?);
    }
    Ok(memories)
}

fn entry<T: Scalar>(bytes: &mut Reader) -> Option<Remembered<T>> {
    let pair = [bytes.whole()?, bytes.whole()?];
    Some((pair, PairMemory::from_bytes(bytes)?))
}
