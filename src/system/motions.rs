//! How the nodes' velocities move the points of all rows, computed in one pass: forces, linearisations and the end of a step
//! need it for the same rows, often at the same velocities.

use super::lines::Four;
use super::row::{Entry, Row, Slip};
use super::twist::V3;
use crate::memory;
use crate::simd::{Kernel, Lanes, dispatch};

#[derive(Debug, Default)]
pub(super) struct Motions {
    /// The velocities of nodes, padded.
    nodes: Vec<Four>,
    /// Of each row, with bodies moved by the host: by the weights along its direction, and by those across.
    of_rows: Vec<[Four; 2]>,
}

impl Motions {
    /// To be called when there are no rows any more.
    pub(super) fn clear(&mut self) {
        self.of_rows.clear();
    }

    /// Finds what [`slip`](Self::slip) needs to know of the nodes' velocities; `entries` are those of all rows.
    pub(super) fn find(&mut self, rows: &[Row], entries: &[Entry], velocities: &[f64]) {
        let Self { nodes, of_rows } = self;
        let velocities = velocities.as_chunks::<3>().0;
        let is_same =
            |(padded, of_node): (&Four, &[f64; 3])| (0..3).all(|k| padded[k].to_bits() == of_node[k].to_bits());
        let are_known = of_rows.len() == rows.len() && nodes.len() == velocities.len();
        if are_known && nodes.iter().zip(velocities).all(is_same) {
            return;
        }
        memory::refill(nodes, velocities.iter().map(|&[x, y, z]| [x, y, z, 0.0]));
        memory::refill_with(of_rows, [[0.0; 4]; 2], rows.len());
        dispatch::<f64, _>(Pass { rows, entries, nodes, of_rows });
    }

    /// How the two points of a row move, at the velocities of nodes for which motions were found.
    pub(super) fn slip(&self, row: &Row, index: usize, twists: &[f64]) -> Slip {
        let [mut along, mut across] = self.of_rows[index].map(|[x, y, z, _]| V3::new(x, y, z));
        for end in row.rigid.iter().flatten() {
            let v = end.velocity(twists);
            along += v;
            across += v;
        }
        Slip { along: row.direction.dot(&along), across: row.across(&across) }
    }
}

struct Pass<'a> {
    rows: &'a [Row],
    entries: &'a [Entry],
    nodes: &'a [Four],
    of_rows: &'a mut [[Four; 2]],
}

impl Kernel<f64> for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let mut begin = 0;
        for (row, motion) in self.rows.iter().zip(self.of_rows) {
            let given = [row.given.x, row.given.y, row.given.z, 0.0];
            let [mut along, mut across] = [given; 2];
            for entry in &self.entries[begin..row.end] {
                let v = &self.nodes[entry.node as usize];
                for axis in 0..4 {
                    along[axis] += v[axis] * entry.along;
                    across[axis] += v[axis] * entry.across;
                }
            }
            *motion = [along, across];
            begin = row.end;
        }
    }
}
