//! The contact patch test: two elastic blocks, flush on one another, are pressed together. The stress is the same everywhere,
//! whatever their meshes; what differs comes from the contact.

use super::Row;
use crate::support::shapes::Shape;
use crate::support::{Mode, Vector};
use nalgebra::{Matrix3, Matrix6, SMatrix, SVector};
use raycontact::contact::ContactList;
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, add_differential, add_forces};
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use std::collections::HashMap;

/// Of both blocks: Young's modulus 1, a height of half the width 1, and so much less when pressed.
const POISSON: f64 = 0.3;
const HEIGHT: f64 = 0.5;
const PRESSED: f64 = 0.01;
/// Ten times a block's own stiffness per area.
const STIFFNESS: f64 = 10.0 / HEIGHT;
/// Newton's method stops where this part of the force is left, or after so many steps: where samples move, no more is to be had.
const SOLVED: f64 = 1e-9;
const STEPS: usize = 8;

/// The deviation from the mean of the stress in all elements, for some pairs of meshes; where the host says that the vertices are
/// nodes, and where it does not.
pub fn measure(_poses: usize, _seed: u64) -> Vec<Row> {
    let row = |[lower, upper]: [usize; 2], mode: Mode, is_said: bool| Row {
        bodies: format!(
            "flush blocks of {lower} and {upper} elements a side{}",
            if is_said { " (said to be nodes)" } else { "" }
        ),
        mode,
        errors: deviations([lower, upper], mode, is_said),
        targets: [0.01; 3],
    };
    let pairs = [[5, 8], [10, 13], [10, 25], [20, 13]];
    let modes = [(Mode::Default, true), (Mode::Default, false), (Mode::Accurate, false)];
    pairs.into_iter().flat_map(|sides| modes.map(|(mode, is_said)| row(sides, mode, is_said))).collect()
}

/// Cubes of six tetrahedra each, whose faces are the surface's triangles.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// A block of linear tetrahedra.
struct Block {
    shape: Shape,
    /// All nodes, those of the surface first and in its order.
    nodes: Vec<Vector>,
    elements: Vec<[usize; 4]>,
    /// Of the six in a cube, in turn.
    stiffness: [SMatrix<f64, 12, 12>; 6],
    /// The stress along the height, by the motions of the corners.
    stress: [SVector<f64, 12>; 6],
}

impl Block {
    fn new(side: usize, bottom: f64) -> Self {
        let counts = [side, side, side.div_ceil(2)];
        let size = Vector::new(1.0 / side as f64, 1.0 / side as f64, HEIGHT / counts[2] as f64);
        let mut numbers = HashMap::new();
        let mut nodes = Vec::new();
        let mut number = |at: [usize; 3]| {
            *numbers.entry(at).or_insert_with(|| {
                let [x, y, z] = std::array::from_fn(|axis| at[axis] as f64 * size[axis]);
                nodes.push(Vector::new(x, y, z + bottom));
                nodes.len() - 1
            })
        };
        let mut triangles = Vec::new();
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for (top, i, j) in [0, counts[axis]]
                .into_iter()
                .flat_map(|top| (0..counts[u]).flat_map(move |i| (0..counts[v]).map(move |j| (top, i, j))))
            {
                let mut corner = |i: usize, j: usize| {
                    let mut at = [0; 3];
                    (at[axis], at[u], at[v]) = (top, i, j);
                    number(at) as u32
                };
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                let both = [[a, b, c], [a, c, d]];
                triangles.extend(both.map(|[a, b, c]| if top == 0 { [a, c, b] } else { [a, b, c] }));
            }
        }
        let surface = triangles.iter().flatten().max().map_or(0, |last| *last as usize + 1);
        let mut elements = Vec::new();
        for (i, j, k) in
            (0..counts[0]).flat_map(|i| (0..counts[1]).flat_map(move |j| (0..counts[2]).map(move |k| (i, j, k))))
        {
            let corners: [usize; 8] =
                std::array::from_fn(|corner| number([i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)]));
            elements.extend(TETRAHEDRA.map(|tetrahedron| tetrahedron.map(|corner| corners[corner])));
        }
        let shape = Shape { points: nodes[..surface].to_vec(), triangles };
        let law = elasticity();
        let corner = |corner: usize| Vector::from_fn(|axis, _| (corner >> axis & 1) as f64 * size[axis]);
        let strains = TETRAHEDRA.map(|tetrahedron| strain(&tetrahedron.map(corner)));
        let stiffness = strains.map(|strain| strain.transpose() * law * strain * (size.product() / 6.0));
        let stress = strains.map(|strain| (law * strain).row(2).transpose());
        Self { shape, nodes, elements, stiffness, stress }
    }

    /// Adds the elements' forces by these motions of the nodes, turned around.
    fn add_product(&self, motions: &[Vector], forces: &mut [Vector]) {
        for (element, stiffness) in self.elements.iter().zip(self.stiffness.iter().cycle()) {
            let product = stiffness * corners_of(element, motions);
            for (corner, &node) in element.iter().enumerate() {
                forces[node] += product.fixed_rows::<3>(3 * corner);
            }
        }
    }
}

fn corners_of(element: &[usize; 4], motions: &[Vector]) -> SVector<f64, 12> {
    SVector::from_fn(|row, _| motions[element[row / 3]][row % 3])
}

/// Hooke's law for the strains xx, yy, zz, yz, zx, xy.
fn elasticity() -> Matrix6<f64> {
    let shear = 0.5 / (1.0 + POISSON);
    let lame = POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    Matrix6::from_fn(|row, column| {
        let is_normal = row < 3 && column < 3;
        let own = if row == column { if row < 3 { 2.0 * shear } else { shear } } else { 0.0 };
        own + if is_normal { lame } else { 0.0 }
    })
}

/// The strains by the motions of the corners.
fn strain(corners: &[Vector; 4]) -> SMatrix<f64, 6, 12> {
    let edges = Matrix3::from_columns(&[1, 2, 3].map(|corner| corners[corner] - corners[0]));
    let inverse = edges.try_inverse().expect("it has a volume");
    let gradients = [1, 2, 3].map(|corner| inverse.row(corner - 1).transpose());
    let first = -(gradients[0] + gradients[1] + gradients[2]);
    let mut strain = SMatrix::zeros();
    for (corner, gradient) in [first].into_iter().chain(gradients).enumerate() {
        let [x, y, z] = gradient.into();
        let rows = [(0, 0, x), (1, 1, y), (2, 2, z), (3, 1, z), (3, 2, y), (4, 2, x), (4, 0, z), (5, 0, y), (5, 1, x)];
        rows.into_iter().for_each(|(row, axis, number)| strain[(row, 3 * corner + axis)] = number);
    }
    strain
}

/// Two blocks one on the other, as one vector of motions.
struct Pressed {
    blocks: [Block; 2],
    /// What does not move: the planes x = 0 and y = 0 within themselves, bottom and top along the height.
    held: Vec<[bool; 3]>,
    mode: Mode,
    /// Whether the library is told that vertices are nodes.
    is_said: bool,
}

impl Pressed {
    fn new(sides: [usize; 2], mode: Mode, is_said: bool) -> Self {
        let blocks = [Block::new(sides[0], -HEIGHT), Block::new(sides[1], 0.0)];
        let nodes = blocks.iter().flat_map(|block| &block.nodes);
        let held = nodes.map(|node| [node.x == 0.0, node.y == 0.0, node.z.abs() == HEIGHT]).collect();
        Self { blocks, held, mode, is_said }
    }

    fn split<'a>(&self, vectors: &'a [Vector]) -> [&'a [Vector]; 2] {
        vectors.split_at(self.blocks[0].nodes.len()).into()
    }

    fn zeros(&self) -> Vec<Vector> {
        vec![Vector::zeros(); self.held.len()]
    }

    fn let_go_of_held(&self, vectors: &mut [Vector]) {
        for (vector, held) in vectors.iter_mut().zip(&self.held) {
            (0..3).filter(|&axis| held[axis]).for_each(|axis| vector[axis] = 0.0);
        }
    }

    fn contacts(&self, motions: &[Vector]) -> ContactList<f64> {
        let motions = self.split(motions);
        let meshes: [Mesh<f64>; 2] = std::array::from_fn(|block| {
            let Shape { points, triangles } = &self.blocks[block].shape;
            let points = motions[block].iter().zip(points).map(|(motion, point)| point + motion).collect();
            let mut mesh = Shape { points, triangles: triangles.clone() }.mesh(|point| *point);
            if self.is_said {
                mesh.set_carrier_spacing(0.0).expect("0 is allowed");
            }
            mesh
        });
        let mut contacts = ContactList::default();
        let [lower, upper] = meshes.each_ref().map(Octree::new);
        query_pair(&meshes[0], &lower, &meshes[1], &upper, &self.mode.options(), &mut contacts)
            .expect("the octrees belong to the meshes");
        contacts
    }

    /// Adds something of the contacts' forces to vectors of all nodes.
    fn add_of_surfaces(&self, forces: &mut [Vector], add: impl FnOnce(&mut [Vec<Vector>; 2])) {
        let mut of_surfaces = [0, 1].map(|block| vec![Vector::zeros(); self.blocks[block].shape.points.len()]);
        add(&mut of_surfaces);
        let first = self.blocks[0].nodes.len();
        for (begin, of_surface) in [0, first].into_iter().zip(of_surfaces) {
            forces[begin..].iter_mut().zip(of_surface).for_each(|(force, other)| *force += other);
        }
    }

    /// The motions at rest.
    fn solve(&self) -> Vec<Vector> {
        let law = PenaltyLaw::new(STIFFNESS, 0.0, Default::default()).expect("a valid law");
        let mut motions = self.zeros();
        let upper = self.blocks[0].nodes.len();
        // The top goes down, and all of the upper block with it.
        motions[upper..].iter_mut().for_each(|motion| motion.z = -PRESSED * HEIGHT);
        for _ in 0..STEPS {
            let contacts = self.contacts(&motions);
            let mut left = self.zeros();
            for (block, (motions, begin)) in self.blocks.iter().zip(self.split(&motions).into_iter().zip([0, upper])) {
                block.add_product(motions, &mut left[begin..]);
            }
            left.iter_mut().for_each(|force| *force = -*force);
            let mut pushes = self.zeros();
            self.add_of_surfaces(&mut pushes, |forces| {
                add_forces(&contacts, &law, None::<&[Vec<Vector>]>, None, forces);
            });
            let force = norm(&pushes);
            left.iter_mut().zip(&pushes).for_each(|(left, push)| *left += push);
            self.let_go_of_held(&mut left);
            if norm(&left) < SOLVED * force {
                return motions;
            }
            let change = self.conjugate_gradients(&contacts, &law, left);
            motions.iter_mut().zip(change).for_each(|(motion, change)| *motion += change);
        }
        motions
    }

    fn conjugate_gradients(&self, contacts: &ContactList<f64>, law: &PenaltyLaw, mut left: Vec<Vector>) -> Vec<Vector> {
        let upper = self.blocks[0].nodes.len();
        let (mut change, mut search) = (self.zeros(), left.clone());
        let (start, mut square) = (dot(&left, &left), dot(&left, &left));
        while square > SOLVED * SOLVED * start {
            let mut product = self.zeros();
            for (block, (motions, begin)) in self.blocks.iter().zip(self.split(&search).into_iter().zip([0, upper])) {
                block.add_product(motions, &mut product[begin..]);
            }
            let moved = self.split(&search);
            let of_surfaces = [0, 1].map(|block| moved[block][..self.blocks[block].shape.points.len()].to_vec());
            self.add_of_surfaces(&mut product, |forces| {
                add_differential(contacts, law, -1.0, 0.0, &of_surfaces, forces);
            });
            self.let_go_of_held(&mut product);
            let step = square / dot(&search, &product);
            change.iter_mut().zip(&search).for_each(|(change, search)| *change += search * step);
            left.iter_mut().zip(&product).for_each(|(left, product)| *left -= product * step);
            let before = std::mem::replace(&mut square, dot(&left, &left));
            search.iter_mut().zip(&left).for_each(|(search, left)| *search = left + *search * (square / before));
        }
        change
    }
}

fn dot(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn norm(vectors: &[Vector]) -> f64 {
    dot(vectors, vectors).sqrt()
}

fn deviations(sides: [usize; 2], mode: Mode, is_said: bool) -> Vec<f64> {
    let pressed = Pressed::new(sides, mode, is_said);
    let motions = pressed.solve();
    let motions = pressed.split(&motions);
    let stresses = pressed.blocks.iter().zip(motions).flat_map(|(block, motions)| {
        let stresses = block.elements.iter().zip(block.stress.iter().cycle());
        stresses.map(|(element, stress)| stress.dot(&corners_of(element, motions)))
    });
    let stresses: Vec<f64> = stresses.collect();
    let mean = stresses.iter().sum::<f64>() / stresses.len() as f64;
    stresses.iter().map(|stress| (stress - mean).abs() / mean.abs()).collect()
}
