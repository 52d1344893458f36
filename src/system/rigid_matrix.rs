use super::row::{RigidEnd, Row};
use super::twist::V3;
use crate::memory::Room;
use nalgebra::{Matrix3, Matrix6, Vector6};

/// The rows' matrix among rigid bodies, JᵀDJ for rows that push. Bodies are named by their index among the rigid ones.
#[derive(Debug, Default)]
pub(super) struct RigidMatrix {
    /// Those between two bodies.
    blocks: Vec<((usize, usize), Matrix6<f64>)>,
}

impl RigidMatrix {
    /// Assembles the blocks of the rows that push.
    pub(super) fn gather(&mut self, rows: &[Row]) {
        let among = &mut self.blocks;
        among.clear();
        for row in rows.iter().filter(|row| row.linear.pushes) {
            let stiffness = stiffness(&row.direction, row.linear.normal, row.linear.tangential);
            for a in row.rigid.iter().flatten() {
                for b in row.rigid.iter().flatten() {
                    let key = (a.index, b.index);
                    let index = among.binary_search_by_key(&key, |(key, _)| *key).unwrap_or_else(|index| {
                        among.room_for(1).insert(index, (key, Matrix6::zeros()));
                        index
                    });
                    among[index].1 += between(a, &stiffness, b);
                }
            }
        }
    }

    /// Calls `use_number(row, column, number)` with the numbers of the matrix, each once.
    pub(super) fn for_each_number(&self, mut use_number: impl FnMut(usize, usize, f64)) {
        for ((a, b), block) in &self.blocks {
            for (row, column) in (0..36).map(|k| (k / 6, k % 6)) {
                use_number(6 * a + row, 6 * b + column, block[(row, column)]);
            }
        }
    }

    /// Adds `scale` times the product of the matrix.
    pub(super) fn add_product(&self, twists: &[f64], scale: f64, result: &mut [f64]) {
        for ((a, b), block) in &self.blocks {
            let loads = block * Vector6::from_column_slice(&twists[6 * b..6 * b + 6]);
            result[6 * a..6 * a + 6].iter_mut().zip(&loads).for_each(|(sum, load)| *sum += scale * load);
        }
    }
}

/// The derivative of a row's force by its slip.
fn stiffness(direction: &V3, normal: f64, tangential: f64) -> Matrix3<f64> {
    let outer = direction * direction.transpose();
    outer * normal + (Matrix3::identity() - outer) * tangential
}

/// J of the one end, transposed, times the stiffness times J of the other.
fn between(a: &RigidEnd, stiffness: &Matrix3<f64>, b: &RigidEnd) -> Matrix6<f64> {
    let [left, right] = [a, b].map(|end| end.arm.cross_matrix());
    let upper = stiffness * (a.sign * b.sign);
    let turned = -upper * right;
    let mut block = Matrix6::zeros();
    block.fixed_view_mut::<3, 3>(0, 0).copy_from(&upper);
    block.fixed_view_mut::<3, 3>(0, 3).copy_from(&turned);
    block.fixed_view_mut::<3, 3>(3, 0).copy_from(&(left * upper));
    block.fixed_view_mut::<3, 3>(3, 3).copy_from(&(left * turned));
    block
}
