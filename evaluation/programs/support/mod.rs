//! What the measuring programs share: shapes, exact answers, and one way to ask the library for a net force.

#![allow(dead_code)] // what has it uses a part

pub mod arguments;
pub mod limits;
pub mod shapes;

use nalgebra::Vector3;
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::mesh::Mesh;
use raycontact::query::Octree;

/// A vector of measured quantities.
pub type Vector = Vector3<f64>;

/// Where rays start and what they weigh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// From the vertices, not weighted by area: the paper's law.
    Paper,
    /// From the vertices, weighted by area, with the library's own law.
    Vertices,
    /// The library's defaults, but with the paper's law, weighted by area.
    RayLength,
    /// The library's defaults.
    Default,
    /// The same, ten times as accurate.
    Accurate,
}

impl Mode {
    /// As it is written in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Vertices => "vertices",
            Self::RayLength => "ray length",
            Self::Default => "default",
            Self::Accurate => "accuracy 0.001",
        }
    }

    /// What it asks of detection.
    pub fn options(self) -> DetectionOptions<f64> {
        match self {
            Self::Paper => DetectionOptions::paper(),
            Self::Vertices => DetectionOptions { law: ContactLaw::default(), ..DetectionOptions::paper() },
            Self::RayLength => DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() },
            Self::Default => DetectionOptions::default(),
            Self::Accurate => DetectionOptions { sampling: Sampling::Accuracy(0.001), ..DetectionOptions::default() },
        }
    }

    fn weighting(self) -> Weighting {
        match self {
            Self::Paper => Weighting::Vertex,
            Self::Vertices | Self::RayLength | Self::Default | Self::Accurate => Weighting::Area,
        }
    }
}

/// The net force and moment on the first of two bodies, for stiffness 1.
#[derive(Clone, Copy, Debug)]
pub struct Net {
    /// Sum of all forces.
    pub force: Vector,
    /// Their moment about the point asked for.
    pub torque: Vector,
    /// The sum of their lengths.
    pub load: f64,
    /// Rays traced, both ways.
    pub rays: u64,
}

/// Detects the contacts of two meshes and sums up what they do to the first.
pub fn net_force(mode: Mode, a: &Mesh<f64>, b: &Mesh<f64>, about: &Vector) -> Net {
    net_force_by(&mode.options(), mode.weighting(), a, b, about)
}

/// The same with another sampling.
pub fn sampled_net_force(sampling: Sampling<f64>, a: &Mesh<f64>, b: &Mesh<f64>) -> Net {
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    net_force_by(&options, Weighting::Area, a, b, &Vector::zeros())
}

fn net_force_by(
    options: &DetectionOptions<f64>,
    weighting: Weighting,
    a: &Mesh<f64>,
    b: &Mesh<f64>,
    about: &Vector,
) -> Net {
    let mut contacts = ContactList::default();
    query_pair(a, &Octree::new(a), b, &Octree::new(b), options, &mut contacts)
        .expect("the octrees belong to the meshes");
    let law = PenaltyLaw::new(1.0, 0.0, weighting).expect("a valid law");
    let mut forces = [a, b].map(|mesh| vec![Vector::zeros(); mesh.positions().len()]);
    add_forces(&contacts, &law, None::<&[Vec<Vector>]>, None, &mut forces);
    let (force, torque, rays) = (Vector::zeros(), Vector::zeros(), contacts.statistics.rays);
    let mut net = Net { force, torque, load: 0.0, rays };
    for (force, position) in forces[0].iter().zip(a.positions()) {
        net.force += force;
        net.load += force.norm();
        net.torque += (position - about).cross(force);
    }
    net
}

/// Numbers in [−1, 1), the same for a seed everywhere: SplitMix64 (Steele, Lea and Flood 2014).
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 * (-52f64).exp2() - 1.0
    }
}
