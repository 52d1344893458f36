//! Products spring by spring, for those that are not assembled.

use super::lines::{Four, Lines};
use super::row::{Entry, Row, Spring};
use super::twist::V3;
use crate::memory::{self, Room};
use crate::simd::{Kernel, Lanes, dispatch};
use std::ops::Range;

/// A spring as products read it; its entries are those of [`Lines`].
#[derive(Clone, Copy, Debug)]
struct Packed {
    direction: Four,
    normal: f64,
    tangential: f64,
    begin: u32,
    end: u32,
    row: u32,
}

/// The springs that are not in the matrix.
#[derive(Debug, Default)]
pub(super) struct RowByRow {
    /// Those that act on nodes alone, and those that act on rigid bodies too.
    alone: Vec<Packed>,
    coupled: Vec<Packed>,
    /// How nodes move the coupled ones, by the weights along and by those across; in a product.
    motions: Vec<[Four; 2]>,
}

impl RowByRow {
    pub(super) fn clear(&mut self, springs: usize) {
        for list in [&mut self.alone, &mut self.coupled] {
            list.clear();
            list.room_for(springs);
        }
    }

    /// Adds a spring with these entries of the lines.
    pub(super) fn add(&mut self, spring: &Spring, entries: Range<u32>) {
        let Spring { direction: d, normal, tangential, row, has_rigid_ends, .. } = *spring;
        let (begin, end) = (entries.start, entries.end);
        let packed = Packed { direction: [d.x, d.y, d.z, 0.0], normal, tangential, begin, end, row: row as u32 };
        let list = if has_rigid_ends { &mut self.coupled } else { &mut self.alone };
        list.room_for(1).push(packed);
    }

    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.alone.len() + self.coupled.len()
    }

    /// Adds the products of the springs on nodes alone, and finds how nodes move the others.
    pub(super) fn start_product(&mut self, lines: &mut Lines) {
        let Self { alone, coupled, motions } = self;
        memory::refill_with(motions, [[0.0; 4]; 2], coupled.len());
        dispatch::<f64, _>(Start { alone, coupled, motions, lines });
    }

    /// Adds `scale` times the loads on rigid bodies by the change of the nodes' velocities.
    pub(super) fn add_to_rigid(&self, rows: &[Row], scale: f64, loads: &mut [f64]) {
        for (spring, motion) in self.coupled.iter().zip(&self.motions) {
            let [push, pull] = spring.forces(motion);
            let force: [f64; 3] = std::array::from_fn(|axis| -scale * (push[axis] + pull[axis]));
            rows[spring.row as usize].add_rigid_loads(&force.into(), loads);
        }
    }

    /// Adds the products of the others to the nodes, where rigid bodies change by `twists`.
    pub(super) fn finish_product(&mut self, rows: &[Row], twists: &[f64], lines: &mut Lines) {
        for (spring, motion) in self.coupled.iter().zip(&mut self.motions) {
            let rigid = rows[spring.row as usize].rigid.iter().flatten();
            let velocity = rigid.fold(V3::zeros(), |sum, end| sum + end.velocity(twists));
            for of_weights in motion {
                (0..3).for_each(|axis| of_weights[axis] += velocity[axis]);
            }
        }
        let Self { coupled, motions, .. } = self;
        dispatch::<f64, _>(Finish { coupled, motions, lines });
    }
}

impl Packed {
    /// How nodes move the spring's points, by the weights along its direction and by those across; those only where they
    /// count.
    #[inline(always)]
    fn motion(&self, entries: &[Entry], change: &[Four]) -> [Four; 2] {
        let [mut along, mut across] = [[0.0; 4]; 2];
        if self.tangential == 0.0 {
            for entry in entries {
                let v = &change[entry.node as usize];
                for axis in 0..4 {
                    along[axis] += v[axis] * entry.along;
                }
            }
        } else {
            for entry in entries {
                let v = &change[entry.node as usize];
                for axis in 0..4 {
                    along[axis] += v[axis] * entry.along;
                    across[axis] += v[axis] * entry.across;
                }
            }
        }
        [along, across]
    }

    /// The forces along the direction and across it.
    #[inline(always)]
    fn forces(&self, [along, across]: &[Four; 2]) -> [Four; 2] {
        let d = &self.direction;
        // The last term is zero, but with it all four are summed at once.
        let dot = |v: &Four| d[0] * v[0] + d[1] * v[1] + (d[2] * v[2] + d[3] * v[3]);
        let (by, out) = (self.normal * dot(along), dot(across));
        let [mut push, mut pull] = [[0.0; 4]; 2];
        for axis in 0..4 {
            push[axis] = d[axis] * by;
            pull[axis] = (across[axis] - d[axis] * out) * self.tangential;
        }
        [push, pull]
    }

    #[inline(always)]
    fn scatter(&self, entries: &[Entry], [push, pull]: &[Four; 2], result: &mut [Four]) {
        if self.tangential == 0.0 {
            for entry in entries {
                let sum = &mut result[entry.node as usize];
                for axis in 0..4 {
                    sum[axis] += push[axis] * entry.along;
                }
            }
        } else {
            for entry in entries {
                let sum = &mut result[entry.node as usize];
                for axis in 0..4 {
                    sum[axis] += push[axis] * entry.along + pull[axis] * entry.across;
                }
            }
        }
    }
}

struct Start<'a> {
    alone: &'a [Packed],
    coupled: &'a [Packed],
    motions: &'a mut [[Four; 2]],
    lines: &'a mut Lines,
}

impl Kernel<f64> for Start<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let Lines { entries, change, result, .. } = self.lines;
        for spring in self.alone {
            let own = &entries[spring.begin as usize..spring.end as usize];
            let forces = spring.forces(&spring.motion(own, change));
            spring.scatter(own, &forces, result);
        }
        for (spring, motion) in self.coupled.iter().zip(self.motions) {
            *motion = spring.motion(&entries[spring.begin as usize..spring.end as usize], change);
        }
    }
}

struct Finish<'a> {
    coupled: &'a [Packed],
    motions: &'a [[Four; 2]],
    lines: &'a mut Lines,
}

impl Kernel<f64> for Finish<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let Lines { entries, result, .. } = self.lines;
        for (spring, motion) in self.coupled.iter().zip(self.motions) {
            let own = &entries[spring.begin as usize..spring.end as usize];
            spring.scatter(own, &spring.forces(motion), result);
        }
    }
}
