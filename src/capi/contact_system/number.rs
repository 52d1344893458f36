use crate::capi::ffi::Failure;
use crate::memory;

/// What the host's arrays of unknowns hold. The system computes with doubles.
pub(super) trait Number: Sized {
    /// The same as doubles: where they lie, or in `room`.
    fn read<'a>(given: &'a [Self], room: &'a mut Vec<f64>) -> &'a [f64];

    /// Adds to `sums` what a call adds to doubles, rounded once; nothing where the call fails.
    fn add(
        sums: &mut [Self],
        room: &mut Vec<f64>,
        call: impl FnOnce(&mut [f64]) -> Result<(), Failure>,
    ) -> Result<(), Failure>;
}

impl Number for f64 {
    fn read<'a>(given: &'a [Self], _: &'a mut Vec<f64>) -> &'a [f64] {
        given
    }

    fn add(
        sums: &mut [Self],
        _: &mut Vec<f64>,
        call: impl FnOnce(&mut [f64]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        call(sums)
    }
}

impl Number for f32 {
    fn read<'a>(given: &'a [Self], room: &'a mut Vec<f64>) -> &'a [f64] {
        memory::refill(room, given.iter().copied().map(f64::from));
        room
    }

    fn add(
        sums: &mut [Self],
        room: &mut Vec<f64>,
        call: impl FnOnce(&mut [f64]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        memory::refill(room, sums.iter().copied().map(f64::from));
        call(room)?;
        sums.iter_mut().zip(&*room).for_each(|(sum, &found)| *sum = found as f32);
        Ok(())
    }
}
