//! What a pair remembers, as bytes: to be saved with the host's own state, or sent to another process.

use crate::bytes::Reader;
use crate::escape::pair_memory::{PairMemory, Record};
use crate::math::{Scalar, Vector3, margins};

/// How many bytes a memory takes: three whole numbers, and nine others always in double precision, which holds either.
pub(crate) const MEMORY_BYTES: usize = 3 * 4 + 9 * 8;

impl<T: Scalar> PairMemory<T> {
    /// Numbers little-endian on every machine.
    pub(crate) fn to_bytes(self) -> [u8; MEMORY_BYTES] {
        let Self { escape, lowest, halved, net_push, mean_depth } = &self;
        let (away, overlaps) = (escape.unwrap_or_default(), [lowest.value, halved.value]);
        let whole = [u32::from(escape.is_some()), lowest.steps, halved.steps];
        let numbers = away.iter().chain(&overlaps).chain(net_push.iter()).chain([mean_depth]);
        let (mut bytes, mut count) = ([0; MEMORY_BYTES], 0);
        let mut put = |number: &[u8]| {
            bytes[count..count + number.len()].copy_from_slice(number);
            count += number.len();
        };
        whole.into_iter().for_each(|number| put(&number.to_le_bytes()));
        numbers.for_each(|number| put(&number.to_f64().to_le_bytes()));
        bytes
    }

    /// `None` where the bytes end too soon, or hold what no pair could have remembered.
    pub(crate) fn from_bytes(bytes: &mut Reader) -> Option<Self> {
        let escaping = bytes.whole()?;
        let steps = [bytes.whole()?, bytes.whole()?];
        let away = Vector3::new(bytes.number()?, bytes.number()?, bytes.number()?);
        let lowest = Record { value: bytes.number()?, steps: steps[0] };
        let halved = Record { value: bytes.number()?, steps: steps[1] };
        let net_push = Vector3::new(bytes.number()?, bytes.number()?, bytes.number()?);
        let mean_depth = bytes.number()?;
        let escape = (escaping == 1).then_some(away);
        let memory = Self { escape, lowest, halved, net_push, mean_depth };
        (escaping <= 1 && memory.is_possible()).then_some(memory)
    }

    /// Whether a pair could have remembered this.
    pub(crate) fn is_possible(&self) -> bool {
        let is_direction = |away: Vector3<T>| (away.norm_squared() - T::one()).abs() < T::of(margins::UNIT_SQUARE);
        // Written so that NaN is refused.
        self.escape.is_none_or(is_direction)
            && self.lowest.value >= T::zero()
            && self.halved.value >= T::zero()
            && self.net_push.norm_squared() < T::of(1.0 + margins::UNIT_SQUARE)
            && self.mean_depth >= T::zero()
            && self.mean_depth.is_finite()
    }
}
