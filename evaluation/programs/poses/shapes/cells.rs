//! Bodies made of boxes: the boundary of the filled cells of a small grid.

use super::Surface;
use nalgebra::Vector3;
use std::collections::HashMap;

/// A C whose jaws nearly close.
pub fn c_clamp() -> Surface {
    let filled = |[i, j, _]: [usize; 3]| i == 0 || j == 0 || j == 4 || (i == 2 && j != 2);
    boundary([&[0.0, 0.25, 0.8, 1.0], &[0.0, 0.2, 0.38, 0.62, 0.8, 1.0], &[0.0, 0.3]], filled)
}

/// Five teeth on a back.
pub fn comb() -> Surface {
    let columns = [0.0, 0.1, 0.225, 0.325, 0.45, 0.55, 0.675, 0.775, 0.9, 1.0];
    boundary([&columns, &[0.0, 0.2, 0.9], &[0.0, 0.15]], |[i, j, _]| j == 0 || i % 2 == 0)
}

/// Three bars through one another.
pub fn cross() -> Surface {
    let line = [0.0, 0.36, 0.64, 1.0];
    boundary([&line; 3], |cell| cell.into_iter().filter(|&index| index == 1).count() >= 2)
}

/// Two bars at a right angle.
pub fn l_beam() -> Surface {
    boundary([&[0.0, 0.25, 1.0], &[0.0, 0.25, 0.8], &[0.0, 0.25]], |[i, j, _]| i == 0 || j == 0)
}

/// `lines` are the grid's planes along each axis. Filled cells must not meet along an edge alone.
fn boundary(lines: [&[f64]; 3], filled: impl Fn([usize; 3]) -> bool) -> Surface {
    let counts = lines.map(|line| line.len() - 1);
    let mut surface = Surface::default();
    let mut numbers = HashMap::new();
    let every_cell = (0..counts[0])
        .flat_map(|i| (0..counts[1]).map(move |j| (i, j)))
        .flat_map(|(i, j)| (0..counts[2]).map(move |k| [i, j, k]));
    for cell in every_cell.filter(|&cell| filled(cell)) {
        for (axis, far) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
            let mut neighbour = cell;
            neighbour[axis] = if far { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
            if neighbour[axis] < counts[axis] && filled(neighbour) {
                continue;
            }
            let mut corner = |across: usize, up: usize| {
                let mut node = cell;
                node[axis] += usize::from(far);
                node[(axis + 1) % 3] += across;
                node[(axis + 2) % 3] += up;
                *numbers.entry(node).or_insert_with(|| {
                    surface.positions.push(Vector3::from_fn(|axis, _| lines[axis][node[axis]]));
                    surface.positions.len() as u32 - 1
                })
            };
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            surface.triangles.extend(if far { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    surface
}
