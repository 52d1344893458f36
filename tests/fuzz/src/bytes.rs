//! Inputs, and what targets read from them.

/// Bytes taken one after the other; behind the end there are zeros.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub fn are_left(&self) -> bool {
        !self.0.is_empty()
    }

    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }

    pub fn byte(&mut self) -> u8 {
        let first = self.0.first().copied().unwrap_or(0);
        self.0 = self.0.get(1..).unwrap_or_default();
        first
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.byte() as usize % end
    }

    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// Mostly a small coarse number, so that things meet exactly; now and then any at all.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            0..=7 => f64::from_le_bytes([0; 8].map(|_: u8| self.byte())),
            8..=11 => f64::from(f32::from_le_bytes([0; 4].map(|_: u8| self.byte()))),
            other => f64::from(other as i8) / 32.0,
        }
    }

    pub fn point(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.number())
    }
}
