//! Numbers that are the same for a seed everywhere and for ever.

use std::f64::consts::TAU;

/// SplitMix64 (Steele, Lea and Flood 2014). Written out, because a recorded run must stay repeatable whatever
/// generator crates change.
pub struct Random(u64);

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// The numbers of one batch: independent of all other batches, so that threads may share them out as they like.
    pub fn new(seed: u64, batch: u64) -> Self {
        let mut seeds = Self(seed);
        let start = seeds.bits() ^ batch.wrapping_mul(0xd134_2543_de82_ef95);
        Self(Self(start).bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Evenly in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (-53f64).exp2()
    }

    /// Evenly in [from, to).
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// One of 0, …, count − 1.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// A whole number in from..=to.
    pub fn whole(&mut self, from: i32, to: i32) -> f64 {
        f64::from(from + self.below((to - from + 1) as usize) as i32)
    }

    pub fn pick<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }

    /// True once in `count` times.
    pub fn once_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// A point in the cube from −size to size.
    pub fn point(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-size, size))
    }

    /// A unit vector, all directions alike.
    pub fn direction(&mut self) -> [f64; 3] {
        let z = self.between(-1.0, 1.0);
        let angle = self.between(0.0, TAU);
        let out = (1.0 - z * z).sqrt();
        [out * angle.cos(), out * angle.sin(), z]
    }
}
