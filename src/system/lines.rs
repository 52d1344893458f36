//! The nodes that springs act on, numbered without gaps, so that products read and write numbers that lie side by side.

use super::row::{Entry, Spring};
use crate::memory::{self, Room};
use std::ops::Range;

/// Three numbers, padded to four.
pub(super) type Four = [f64; 4];

/// A line for each node that a spring acts on, in the order in which springs name them.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// The node of each line.
    nodes: Vec<u32>,
    /// The entries of all springs, which name lines instead of nodes, and where those of each spring end.
    pub(super) entries: Vec<Entry>,
    ends: Vec<u32>,
    /// Scratch memory: of each node its line.
    of_node: Vec<u32>,
    /// Of each line, in a product: what is multiplied, and the sum.
    pub(super) change: Vec<Four>,
    pub(super) result: Vec<Four>,
}

impl Lines {
    pub(super) fn find(&mut self, springs: &[Spring], all: &[Entry], node_count: usize) {
        let Self { nodes, entries, ends, of_node, .. } = self;
        if of_node.len() == node_count {
            nodes.iter().for_each(|&node| of_node[node as usize] = u32::MAX);
        } else {
            memory::refill_with(of_node, u32::MAX, node_count);
        }
        nodes.clear();
        entries.clear();
        ends.clear();
        ends.room_for(springs.len());
        for spring in springs {
            for entry in &all[spring.begin..spring.end] {
                let line = &mut of_node[entry.node as usize];
                if *line == u32::MAX {
                    // First, since only listed nodes are forgotten again.
                    nodes.room_for(1).push(entry.node);
                    *line = nodes.len() as u32 - 1;
                }
                entries.room_for(1).push(Entry { node: *line, ..*entry });
            }
            ends.push(entries.len() as u32);
        }
    }

    pub(super) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Where the entries of a spring begin and end.
    pub(super) fn range(&self, spring: u32) -> Range<u32> {
        let begin = spring.checked_sub(1).map_or(0, |before| self.ends[before as usize]);
        begin..self.ends[spring as usize]
    }

    pub(super) fn entries_of(&self, spring: u32) -> &[Entry] {
        let Range { start, end } = self.range(spring);
        &self.entries[start as usize..end as usize]
    }

    /// Takes over what is to be multiplied.
    pub(super) fn start_product(&mut self, change: &[f64]) {
        let of_nodes = change.as_chunks::<3>().0;
        let of_line = |&node: &u32| {
            let [x, y, z] = of_nodes[node as usize];
            [x, y, z, 0.0]
        };
        memory::refill(&mut self.change, self.nodes.iter().map(of_line));
        memory::refill_with(&mut self.result, [0.0; 4], self.nodes.len());
    }

    /// Adds `scale` times the sums.
    pub(super) fn finish_product(&self, scale: f64, result: &mut [f64]) {
        let of_nodes = result.as_chunks_mut::<3>().0;
        for (&node, sum) in self.nodes.iter().zip(&self.result) {
            let to = &mut of_nodes[node as usize];
            (0..3).for_each(|axis| to[axis] += scale * sum[axis]);
        }
    }
}
