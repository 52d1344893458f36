//! Inputs, and what targets read from them.

use std::collections::HashSet;

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

/// Makes inputs: new ones, and changes of those whose outcome was new. SplitMix64 (Steele, Lea and Flood 2014).
pub struct Mutator {
    state: u64,
    known: Vec<Vec<u8>>,
    outcomes: HashSet<u64>,
}

/// Inputs that are kept to be changed.
const KEPT: usize = 4096;

impl Mutator {
    pub fn new(seed: u64) -> Self {
        Self { state: seed, known: Vec::new(), outcomes: HashSet::new() }
    }

    pub fn outcomes(&self) -> usize {
        self.outcomes.len()
    }

    fn random(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ bits >> 31
    }

    fn below(&mut self, end: usize) -> usize {
        (self.random() % end as u64) as usize
    }

    pub fn next(&mut self) -> Vec<u8> {
        if self.known.is_empty() || self.below(4) == 0 {
            let length = self.below(300);
            return (0..length).map(|_| self.random() as u8).collect();
        }
        let from = self.below(self.known.len());
        let mut input = self.known[from].clone();
        for _ in 0..=self.below(4) {
            let place = self.below(input.len() + 1);
            match self.below(4) {
                0 => input.insert(place, self.random() as u8),
                1 if place < input.len() => drop(input.remove(place)),
                2 if place < input.len() => input[place] ^= 1 << self.below(8),
                _ if place < input.len() => input[place] = self.random() as u8,
                _ => input.push(self.random() as u8),
            }
        }
        input
    }

    pub fn learn(&mut self, input: &[u8], outcome: u64) {
        if self.outcomes.insert(outcome) && self.known.len() < KEPT {
            self.known.push(input.to_vec());
        }
    }
}
