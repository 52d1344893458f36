//! The blocks of the rows' matrix between nodes and rigid bodies.

use super::lines::Lines;
use super::row::{RigidEnd, Row, Spring};
use super::twist::V3;
use crate::memory::{self, Room};

/// The force on a node for each of the six velocities of a rigid body, in N s/m and N s.
type Columns = [V3; 6];

/// The blocks of springs that are in the matrix on nodes. Bodies are named by their index among the rigid ones.
#[derive(Debug, Default)]
pub(super) struct RigidCoupling {
    /// The rigid ends of the springs in the matrix on nodes: body, spring, and which of its ends; by body.
    ends: Vec<(usize, u32, usize)>,
    /// Each body that shares springs with nodes, and where its blocks end.
    bodies: Vec<(usize, usize)>,
    /// The line of each block.
    lines: Vec<u32>,
    blocks: Vec<Columns>,
    /// Scratch memory: of each line its block of the body under way.
    block_of_line: Vec<u32>,
}

impl RigidCoupling {
    /// Finds the blocks of these springs between nodes and rigid bodies, without their numbers; gives how many.
    pub(super) fn find_blocks(
        &mut self,
        taken: impl Iterator<Item = u32>,
        springs: &[Spring],
        rows: &[Row],
        all: &Lines,
    ) -> usize {
        let Self { ends, bodies, lines, block_of_line, .. } = self;
        ends.clear();
        for index in taken {
            let spring = &springs[index as usize];
            let rigid = if spring.has_rigid_ends { &rows[spring.row].rigid[..] } else { &[] };
            for (side, end) in rigid.iter().enumerate() {
                ends.room_for(1).extend(end.iter().map(|end| (end.index, index, side)));
            }
        }
        ends.sort_unstable();
        bodies.clear();
        lines.clear();
        memory::refill_with(block_of_line, u32::MAX, all.count());
        for of_body in ends.chunk_by(|one, next| one.0 == next.0) {
            let first = lines.len() as u32;
            for entry in of_body.iter().flat_map(|&(_, index, _)| all.entries_of(index)) {
                // It may be a block of an earlier body.
                let block = &mut block_of_line[entry.node as usize];
                if *block == u32::MAX || *block < first {
                    *block = lines.len() as u32;
                    lines.room_for(1).push(entry.node);
                }
            }
            bodies.room_for(1).push((of_body[0].0, lines.len()));
        }
        lines.len()
    }

    /// Computes the numbers of these blocks.
    pub(super) fn add_up(&mut self, springs: &[Spring], rows: &[Row], all: &Lines) {
        let Self { ends, bodies, lines, blocks, block_of_line, .. } = self;
        memory::refill_with(blocks, [V3::zeros(); 6], lines.len());
        let mut first = 0;
        for (of_body, &(_, last)) in ends.chunk_by(|one, next| one.0 == next.0).zip(&*bodies) {
            for block in first..last {
                block_of_line[lines[block] as usize] = block as u32;
            }
            for &(_, index, side) in of_body {
                let spring = &springs[index as usize];
                let Some(RigidEnd { sign, arm, .. }) = &rows[spring.row].rigid[side] else { continue };
                let d = spring.direction;
                // d · J and J of the body's six velocities.
                let turned = [V3::new(0.0, -arm.z, arm.y), V3::new(arm.z, 0.0, -arm.x), V3::new(-arm.y, arm.x, 0.0)];
                let moves = [V3::x(), V3::y(), V3::z(), turned[0], turned[1], turned[2]].map(|column| column * *sign);
                for entry in all.entries_of(index) {
                    let (along, across) = (spring.normal * entry.along, spring.tangential * entry.across);
                    let block = &mut blocks[block_of_line[entry.node as usize] as usize];
                    for (column, moves) in block.iter_mut().zip(&moves) {
                        *column += d * ((along - across) * d.dot(moves)) + moves * across;
                    }
                }
            }
            first = last;
        }
    }

    /// Forgets the blocks between nodes and rigid bodies.
    pub(super) fn clear_blocks(&mut self) {
        self.bodies.clear();
        self.lines.clear();
        self.blocks.clear();
    }

    fn of_bodies(&self) -> impl Iterator<Item = (usize, impl Iterator<Item = (u32, &Columns)>)> {
        let mut first = 0;
        self.bodies.iter().map(move |&(index, last)| {
            let range = std::mem::replace(&mut first, last)..last;
            (index, self.lines[range.clone()].iter().copied().zip(&self.blocks[range]))
        })
    }

    /// Adds the forces on nodes for these velocities of rigid bodies to the sums of lines.
    pub(super) fn add_to_lines(&self, twists: &[f64], all: &mut Lines) {
        for (index, blocks) in self.of_bodies() {
            let twist = &twists[6 * index..6 * index + 6];
            for (line, block) in blocks {
                let force = block.iter().zip(twist).fold(V3::zeros(), |sum, (column, by)| sum + column * *by);
                let to = &mut all.result[line as usize];
                (0..3).for_each(|axis| to[axis] += force[axis]);
            }
        }
    }

    /// Adds `scale` times the loads on rigid bodies for the change of lines.
    pub(super) fn add_to_rigid(&self, all: &Lines, scale: f64, loads: &mut [f64]) {
        for (index, blocks) in self.of_bodies() {
            let mut sum = [0.0; 6];
            for (line, block) in blocks {
                let [x, y, z, _] = all.change[line as usize];
                let v = V3::new(x, y, z);
                (0..6).for_each(|k| sum[k] += block[k].dot(&v));
            }
            (0..6).for_each(|k| loads[6 * index + k] += scale * sum[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::system::row::LinearForce;
    use crate::system::rows::{Rows, Velocities};
    use crate::system::twist::Inertia;
    use nalgebra::{Matrix3, Matrix6};

    const NODES: usize = 9;
    const BODIES: usize = 3;
    /// What a joint adds, which couples moving along one axis with turning about another.
    const JOINT: f64 = 5.0;

    /// Rows between nodes, between nodes and rigid bodies, between two of these, and long ones; some rub, some do not push.
    fn rows(numbers: &mut Random) -> Rows {
        let mut rows = Rows::default();
        for index in 0..90 {
            let count = [4, 4, 0, 5, 40][index % 5];
            for k in 0..count {
                rows.add_distinct(((5 * index + 7 * k) % NODES) as u32, numbers.signed(), numbers.signed());
            }
            let mut end = |is_there: bool, index, sign| {
                let arm = V3::from(numbers.point(0.5));
                is_there.then_some(RigidEnd { index, sign, arm })
            };
            let rigid = [
                end(matches!(index % 5, 1 | 2), index % BODIES, -1.0),
                end(matches!(index % 5, 2..=4), (index + 1) % BODIES, 1.0),
            ];
            let (normal, tangential) =
                (1.5 + numbers.signed(), if index % 2 == 0 { 1.1 + numbers.signed() } else { 0.0 });
            let linear = LinearForce { pushes: index % 7 != 0, normal, tangential, ..LinearForce::default() };
            let direction = V3::from(numbers.point(1.0)).normalize();
            rows.rows.push(Row { direction, rigid, end: rows.entries.len(), linear, ..Row::default() });
        }
        let mut added = Matrix6::zeros();
        [(1, 1), (1, 5), (5, 1), (5, 5)].iter().for_each(|index| added[*index] = JOINT);
        rows.masses = vec![Inertia { mass: 2.0, about: Matrix3::identity() * 0.3, added }; BODIES];
        rows
    }

    /// From the forces that the rows exert: those against a change, turned around.
    fn expected(rows: &mut Rows, of: Velocities<'_>, scale: f64) -> [Vec<f64>; 2] {
        let [mut nodes, mut twists] = [vec![0.0; 3 * NODES], vec![0.0; 6 * BODIES]];
        rows.find_motions(of.nodes);
        rows.add_forces(of.twists, -scale, &mut nodes, Some(&mut twists));
        [nodes, twists]
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let error = found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(error < 1e-12 * largest && largest > 0.0, "{error} of {largest}");
    }

    #[test]
    fn products_are_the_forces_of_the_rows_on_nodes_and_rigid_bodies() {
        let mut numbers = Random::new(1);
        let mut rows = rows(&mut numbers);
        let change: Vec<f64> = (0..3 * NODES).map(|_| numbers.signed()).collect();
        let twists: Vec<f64> = (0..6 * BODIES).map(|_| numbers.signed()).collect();
        let of = Velocities { nodes: &change, twists: &twists };
        let [on_nodes, on_rigid] = expected(&mut rows, of, 0.7);
        let [mut nodes, mut loads] = [vec![0.0; 3 * NODES], vec![0.0; 6 * BODIES]];
        rows.forget_products();
        rows.add_product(of, 0.7, &mut nodes, &mut loads);
        let [chunk] = &rows.chunks[..] else { panic!("{} chunks", rows.chunks.len()) };
        assert!(chunk.coupling.bodies.len() == BODIES && chunk.apart.count() > 0);
        assert_near(&nodes, &on_nodes);
        assert_near(&loads, &on_rigid);
    }

    /// Rigid bodies answer so that mass times change is the load over the time.
    #[test]
    fn eliminated_bodies_answer_the_nodes() {
        let mut numbers = Random::new(2);
        let mut rows = rows(&mut numbers);
        let change: Vec<f64> = (0..3 * NODES).map(|_| numbers.signed()).collect();
        let dt = 0.05;
        rows.forget_products();
        rows.factor_rigid(dt);
        let mut found = vec![0.0; 3 * NODES];
        rows.add_answered_product(&change, 0.7, dt, &mut found);
        let answer = rows.response.clone();
        let of = Velocities { nodes: &change, twists: &answer };
        let [on_nodes, _] = expected(&mut rows, of, 0.7);
        assert_near(&found, &on_nodes);
        let [_, loads] = expected(&mut rows, of, -dt);
        let mut momenta: Vec<f64> =
            answer.iter().enumerate().map(|(k, x)| x * if k % 6 < 3 { 2.0 } else { 0.3 }).collect();
        (0..BODIES).for_each(|body| momenta[6 * body + 1] += JOINT * (answer[6 * body + 1] + answer[6 * body + 5]));
        (0..BODIES).for_each(|body| momenta[6 * body + 5] += JOINT * (answer[6 * body + 1] + answer[6 * body + 5]));
        assert_near(&momenta, &loads);
    }
}
