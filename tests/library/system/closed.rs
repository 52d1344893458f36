//! Closed systems from random starts, and their energy: of motion, of springs, and of contact, whose potential is the volume
//! integral of the pressure law. Of the library it takes positions, nearest points, and how two bodies share their load.

use super::bodies::{add_box, add_cage, add_rigid, add_soft};
use crate::common::host::{Host, rotation};
use crate::common::random::Random;
use crate::common::shapes;
use nalgebra::Vector3;
use raycontact::contact::{ContactList, DetectionOptions};
use raycontact::distributed::look_ahead;
use raycontact::escape::query_pair;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;

/// Bodies that nothing but one another and still walls acts on.
pub struct Closed {
    pub host: Host,
    pub dt: f64,
    pub description: String,
    materials: Vec<Material>,
    /// Of each two bodies in order, the part of the load that the rays of the first carry.
    shares: Vec<f64>,
}

/// What starts are to have, whatever their numbers say.
#[derive(Clone, Copy, Default)]
pub struct Wanted {
    /// Rigid cubes in a narrow room, and no damping.
    pub cubes: bool,
    /// The length of steps, in s; 0 for any.
    pub dt: f64,
}

impl Closed {
    /// Any.
    pub fn new(seed: u64, start: u64) -> Self {
        Self::wanted(seed, start, Wanted::default())
    }

    /// Two to four bodies of any kind, in any pose, inside one another or some way apart, at rest or not; every second start
    /// in a room that is hardly wide enough.
    pub fn wanted(seed: u64, start: u64, wanted: Wanted) -> Self {
        let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(start));
        let mut choice = |count: usize| ((random.signed() + 1.0) * 0.5 * count as f64) as usize;
        let (count, has_walls) = (2 + choice(3), choice(2) == 1 || wanted.cubes);
        let (is_deep, is_fast, rubs) = (choice(3) > 0, choice(2) == 1, choice(2) == 1);
        let is_fast = is_fast || !is_deep;
        let dt = [1.0 / 240.0, 1.0 / 60.0, 0.05][choice(3)];
        let dt = if wanted.dt > 0.0 { wanted.dt } else { dt };
        let damping_time = [0.0, 0.0, 0.01][choice(3)] * f64::from(u8::from(!wanted.cubes));
        let depth_cap = [f64::INFINITY, f64::INFINITY, 0.03][choice(3)];
        let kinds: Vec<usize> = (0..count).map(|_| choice(5) * usize::from(!wanted.cubes)).collect();
        let mut host = Host::new(RigidUnknowns::Eliminated);
        // An escape is a push from outside.
        host.scene.set_options(DetectionOptions { escape: false, ..DetectionOptions::default() });
        (host.holds_springs, host.solves, host.goal) = (true, 60, 1e-7);
        let material = |random: &mut Random| Material {
            stiffness: 2e4 * 4f64.powf(random.signed()),
            damping_time,
            friction: if rubs { 0.4 + 0.3 * random.signed() } else { 0.0 },
            depth_cap,
            restitution: 0.0,
        };
        let mut materials = Vec::new();
        for (k, kind) in kinds.iter().enumerate() {
            let (turn, material) = (rotation(&V3::from(random.point(1.8))), material(&mut random));
            materials.push(material);
            let apart = if is_deep { 0.0 } else { 0.55 };
            let corner =
                V3::new((k & 1) as f64, (k >> 1) as f64, 0.0) - V3::new(0.5, if count > 2 { 0.5 } else { 0.0 }, 0.0);
            let by = corner * apart + V3::from(random.point(0.15));
            let speed = V3::from(random.point(if is_fast { 1.5 } else { 0.0 })) - by * if is_fast { 3.0 } else { 0.0 };
            let nodes = host.masses.len();
            match kind {
                0 => add_box(&mut host, material, by, turn),
                1 => add_rigid(&mut host, &shapes::sphere(1).scaled(0.22), material, by, turn),
                2 => add_soft(&mut host, &shapes::cube(2).scaled(0.2), material, turn),
                3 => add_soft(&mut host, &shapes::sphere(1).scaled(0.22), material, turn),
                _ => add_cage(&mut host, material, turn),
            }
            for node in nodes..host.masses.len() {
                (0..3).for_each(|axis| host.x[3 * node + axis] += by[axis]);
                (0..3).for_each(|axis| host.v[3 * node + axis] = speed[axis]);
            }
            if *kind < 2 {
                let spin = random.point(if is_fast { 5.0 } else { 0.0 });
                let rigid = host.rigids.last_mut().expect("it was added");
                rigid.velocity = std::array::from_fn(|k| if k < 3 { speed[k] } else { spin[k - 3] });
            }
        }
        if has_walls {
            let (reach, material) =
                (0.25 + 0.1 * random.signed() + if is_deep { 0.0 } else { 0.3 }, material(&mut random));
            let (outside, inside) = (shapes::cube(1).scaled(reach + 1.0), shapes::cube(1).map(|[x, y, z]| [-x, y, z]));
            let body = host.scene.add(outside.joined(&inside.scaled(reach)).mesh());
            host.system.add_moved(&host.scene, body, material).expect("a room");
            materials.push(material);
        }
        let names = ["box", "ball", "soft box", "soft ball", "cage"];
        let description = format!(
            "{}{}{}, {}, dt {dt:.4}, damping time {damping_time}, depth cap {depth_cap}{}",
            kinds.iter().map(|&kind| names[kind]).collect::<Vec<_>>().join(", "),
            if has_walls { " in a room" } else { "" },
            if is_deep { ", deep" } else { "" },
            if is_fast { "moving" } else { "at rest" },
            if rubs { ", friction" } else { "" },
        );
        let mut closed = Self { host, dt, description, materials, shares: Vec::new() };
        closed.place();
        closed.shares = (closed.pairs().map(|(a, b)| share(closed.mesh(a), closed.mesh(b)))).collect();
        closed
    }

    /// In J: of motion, springs and contact.
    pub fn energy(&mut self) -> f64 {
        self.moving() + self.contact()
    }

    /// In J: of motion and of springs.
    pub fn moving(&self) -> f64 {
        self.host.kinetic() + self.host.elastic()
    }

    /// In J: the potential of the pressure, k ∫ φ dV over what two bodies share, φ the depth below the one or the other
    /// surface.
    pub fn contact(&mut self) -> f64 {
        self.place();
        let bodies: Vec<_> = (0..self.materials.len()).map(|k| (self.mesh(k), Octree::new(self.mesh(k)))).collect();
        let of_pair = |((a, b), share): ((usize, usize), &f64)| {
            let Material { stiffness, depth_cap, .. } = self.materials[a].combined(&self.materials[b]);
            stiffness * both(&bodies[a], &bodies[b], depth_cap, *share)
        };
        self.pairs().zip(&self.shares).map(of_pair).sum()
    }

    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let count = self.materials.len();
        (0..count).flat_map(move |a| (a + 1..count).map(move |b| (a, b)))
    }

    fn mesh(&self, body: usize) -> &Mesh<f64> {
        self.host.scene.mesh(body as u32).expect("it is there")
    }

    /// Puts the scene's bodies where they are now.
    fn place(&mut self) {
        let now = 1e-12;
        self.host.set_motions(now);
        let Host { system, scene, x, v, .. } = &mut self.host;
        look_ahead(system, scene, now, x, v, Some(v)).expect("no step is under way");
    }
}

/// The part of the load that the first body's rays carry, by a pose in which the two overlap a little: the surface inside the
/// other body is one side of what they share, so without shares the area vectors of both sides would be opposite.
fn share(a: &Mesh<f64>, b: &Mesh<f64>) -> f64 {
    let middle = |mesh: &Mesh<f64>| (mesh.aabb().lower + mesh.aabb().upper) * 0.5;
    let options = DetectionOptions { escape: false, ..DetectionOptions::default() };
    let octree_a = Octree::new(a);
    for overlap in [0.05, 0.1, 0.15, 0.2] {
        let mut by = middle(a) - middle(b) + V3::new(0.0, 0.013, 0.007);
        by.x = a.aabb().upper.x - b.aabb().lower.x - overlap;
        let moved: Vec<[f64; 3]> = b.positions().iter().map(|point| (point + by).into()).collect();
        let b = Mesh::new(&moved, b.topology().triangles()).expect("it is only moved");
        let mut contacts = ContactList::default();
        query_pair(a, &octree_a, &b, &Octree::new(&b), &options, &mut contacts).expect("octrees of these meshes");
        let side = |body: u32| -> f64 {
            let own = contacts.contacts.iter().filter(|contact| contact.colliding == body);
            own.fold(V3::zeros(), |sum, contact| sum + contact.direction * contact.area).norm()
        };
        let [first, second] = [0, 1].map(side);
        if first + second > 1e-3 {
            return first / (first + second);
        }
    }
    panic!("they do not overlap");
}

/// Evenly spread, the same each time: an additive recurrence (Roberts 2018).
fn points(low: &V3, size: &V3) -> Vec<V3> {
    let golden: f64 = 1.220_744_084_605_759_5;
    let step = V3::new(1.0 / golden, 1.0 / golden.powi(2), 1.0 / golden.powi(3));
    (1..=POINTS).map(|k| low + size.component_mul(&(step * k as f64).map(f64::fract))).collect()
}

/// Of an integral.
const POINTS: usize = 4000;

/// ∫ min(φ, cap) dV over what two bodies share, where `share` of φ is the depth below the second's surface.
fn both(a: &(&Mesh<f64>, Octree<f64>), b: &(&Mesh<f64>, Octree<f64>), cap: f64, share: f64) -> f64 {
    let overlap = a.0.aabb().intersection(b.0.aabb());
    let size = overlap.upper - overlap.lower;
    if size.iter().any(|&side| side <= 0.0) {
        return 0.0;
    }
    let points = points(&overlap.lower, &size);
    let [below_a, below_b] = [a, b].map(|body| depths(body, &points));
    let pressure = |(below_a, below_b): (Option<f64>, Option<f64>)| {
        Some((1.0 - share) * below_a?.min(cap) + share * below_b?.min(cap))
    };
    below_a.into_iter().zip(below_b).filter_map(pressure).sum::<f64>() * size.product() / POINTS as f64
}

/// How deep points lie in a body; none outside.
fn depths((mesh, octree): &(&Mesh<f64>, Octree<f64>), points: &[V3]) -> Vec<Option<f64>> {
    let tracer = octree.tracer(mesh).expect("it is new");
    let (mut found, mut crossings) = (Vec::new(), Vec::new());
    tracer.closest_points(points, &vec![f64::INFINITY; points.len()], &mut found);
    let mut depth = |k: usize| match tracer.winding_number(&points[k], &mut crossings) {
        Some(inside) if inside > 0 => found[k].as_ref().map(|point| point.distance),
        _ => None,
    };
    (0..points.len()).map(&mut depth).collect()
}
