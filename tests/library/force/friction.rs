//! Friction without memory, and a wrench for each rigid body, against closed forms and the laws of motion.

use crate::common::shapes::{self, Shape};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use raycontact::contact::{Contact, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::force::{LawError, PenaltyLaw, RigidMotion, Weighting, add_differential, add_forces, add_wrenches};
use raycontact::math::{Pose, Scalar, Vector3};
use raycontact::query::Octree;
use raycontact::scene::Scene;

type V3 = Vector3<f64>;

const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.5;
const MASS: f64 = 32.0;
/// Half its edges, in m.
const HALF: [f64; 3] = [0.2, 0.2, 0.1];
/// A block at rest sinks in by 1 mm.
const SINK: f64 = 0.001;

fn law(friction: f64, slip_speed: f64, damping_time: f64) -> PenaltyLaw {
    let stiffness = MASS * GRAVITY / (SINK * 4.0 * HALF[0] * HALF[1]);
    let law = PenaltyLaw::new(stiffness, damping_time, Weighting::Area).expect("a valid law");
    law.with_friction(friction, slip_speed).expect("valid friction")
}

/// A block around the origin.
fn block(half: [f64; 3], cells: [usize; 3]) -> Shape {
    let edge = |axis: usize| 2.0 * half[axis] / cells[axis] as f64;
    shapes::block(cells).map(|point| std::array::from_fn(|axis| point[axis] * edge(axis) - half[axis]))
}

/// Position, rotation, velocity, angular velocity.
#[derive(Clone, Copy)]
struct State(V3, Quaternion<f64>, V3, V3);

impl State {
    fn plus(&self, rate: &Self, dt: f64) -> Self {
        Self(self.0 + rate.0 * dt, self.1 + rate.1 * dt, self.2 + rate.2 * dt, self.3 + rate.3 * dt)
    }

    fn motion(&self) -> RigidMotion {
        RigidMotion { point: self.0, velocity: [self.2, self.3] }
    }
}

const AT_REST: RigidMotion = RigidMotion { point: V3::new(0.0, 0.0, 0.0), velocity: [V3::new(0.0, 0.0, 0.0); 2] };

/// A block on a floor that reaches up to z = 0.
struct World {
    scene: Scene<f64>,
    list: ContactList<f64>,
    law: PenaltyLaw,
    gravity: V3,
}

impl World {
    fn new(law: PenaltyLaw, gravity: V3) -> Self {
        let mut scene = Scene::new(1).expect("no threads are needed");
        scene.add(block([4.0, 4.0, 0.5], [8, 8, 1]).moved([0.0, 0.0, -0.5]).mesh());
        scene.add(block(HALF, [4, 4, 2]).mesh());
        Self { scene, list: ContactList::default(), law, gravity }
    }

    fn rate(&mut self, state: &State) -> State {
        let rotation = UnitQuaternion::from_quaternion(state.1).to_rotation_matrix().into_inner();
        let rows = std::array::from_fn(|row| std::array::from_fn(|column| rotation[(row, column)]));
        self.scene.set_pose(1, &Pose { position: state.0.into(), rotation: rows }).expect("it is a pose");
        self.scene.query(&mut self.list);
        let mut sum = [V3::zeros(); 2];
        add_wrenches(
            &self.list,
            &self.law,
            |body| if body == 1 { state.motion() } else { AT_REST },
            |body, wrench| {
                if body == 1 {
                    sum = [0, 1].map(|k| sum[k] + wrench[k]);
                }
            },
        );
        let third = MASS / 3.0;
        let own =
            Vector3::from_fn(|axis, _| third * (0..3).filter(|&k| k != axis).map(|k| HALF[k] * HALF[k]).sum::<f64>());
        let inertia = rotation * Matrix3::from_diagonal(&own) * rotation.transpose();
        let turning = sum[1] - state.3.cross(&(inertia * state.3));
        let spin = Quaternion::from_imag(state.3) * state.1 * 0.5;
        State(state.2, spin, sum[0] / MASS + self.gravity, inertia.try_inverse().expect("it has mass") * turning)
    }

    /// Classical Runge-Kutta.
    fn run(&mut self, mut state: State, dt: f64, steps: usize) -> State {
        for _ in 0..steps {
            let a = self.rate(&state);
            let b = self.rate(&state.plus(&a, 0.5 * dt));
            let c = self.rate(&state.plus(&b, 0.5 * dt));
            let d = self.rate(&state.plus(&c, dt));
            state =
                [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)].iter().fold(state, |sum, (k, w)| sum.plus(k, w * dt / 6.0));
            state.1 = state.1.normalize();
        }
        state
    }
}

fn standing(velocity: V3) -> State {
    State(V3::new(0.0, 0.0, HALF[2] - SINK), Quaternion::identity(), velocity, V3::zeros())
}

#[test]
fn a_block_is_braked_by_the_textbooks_acceleration() {
    let mut world = World::new(law(0.3, 0.01, 0.02), V3::new(0.0, 0.0, -GRAVITY));
    let [start, end] = [0.1, 0.4];
    let before = world.run(standing(V3::new(2.0, 0.5, 0.0)), 0.001, (start / 0.001) as usize);
    let after = world.run(before, 0.001, ((end - start) / 0.001) as usize);
    let ratio = (before.2 - after.2).norm() / (0.3 * GRAVITY * (end - start));
    println!("braked by {ratio:.4} of the textbook's acceleration");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    assert!(after.2.normalize().dot(&before.2.normalize()) > 0.9999, "it goes straight on");
}

#[test]
fn a_block_on_a_slope_creeps_as_fast_as_the_slip_speed_says() {
    let slope: f64 = 0.2;
    for (slip_speed, dt) in [(0.01, 0.001), (0.001, 0.0002)] {
        let down = V3::new(slope.sin(), 0.0, -slope.cos()) * GRAVITY;
        let mut world = World::new(law(FRICTION, slip_speed, 0.02), down);
        let state = world.run(standing(V3::zeros()), dt, (0.4 / dt) as usize);
        let borne = slope.tan();
        let expected = slip_speed * borne / (FRICTION * FRICTION - borne * borne).sqrt();
        println!("creeps at {:.4e} m/s, predicted {expected:.4e}", state.2.x);
        assert!((state.2.x / expected - 1.0).abs() < 0.01, "{} against {expected}", state.2.x);
        assert!(state.3.norm() * HALF[0] < 0.01 * expected, "it stands: {}", state.3.norm());
    }
}

/// An even pressure under a disk of radius R turns it by 2/3 μ N R.
#[test]
fn a_spinning_disk_is_braked_by_two_thirds() {
    let cells = 16;
    let disk = block([1.0, 1.0, 0.1], [cells, cells, 1])
        .map(|[x, y, z]| [x * (1.0 - 0.5 * y * y).sqrt(), y * (1.0 - 0.5 * x * x).sqrt(), z + 0.1 - SINK]);
    let floor = block([4.0, 4.0, 0.5], [8, 8, 1]).moved([0.0, 0.0, -0.5]);
    let list: ContactList<f64> = found([&floor, &disk], Sampling::default());
    let motion = |body| RigidMotion { velocity: [V3::zeros(), V3::z() * f64::from(body) * 3.0], ..AT_REST };
    let mut sum = [V3::zeros(); 2];
    add_wrenches(&list, &law(FRICTION, 1e-9, 0.0), motion, |body, wrench| {
        if body == 1 {
            sum = [0, 1].map(|k| sum[k] + wrench[k]);
        }
    });
    let ratio = -sum[1].z / (2.0 / 3.0 * FRICTION * sum[0].z);
    println!("braked by {ratio:.4} of 2/3 μ N R");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

fn found<T: Scalar>(shapes: [&Shape; 2], sampling: Sampling<T>) -> ContactList<T> {
    let meshes = shapes.map(|shape| shape.mesh::<T>());
    let octrees = meshes.each_ref().map(Octree::new);
    let mut list = ContactList::default();
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], &options, &mut list).expect("octrees are new");
    list
}

fn tori() -> [Shape; 2] {
    [shapes::torus(24, 12, 0.4), shapes::torus(24, 12, 0.4).turned(0.4, 0.7).moved([0.3, 0.15, 0.5])]
}

/// Numbers between −1 and 1 without a pattern, the same in every run.
fn noise(count: &mut f64) -> V3 {
    *count += 1.0;
    V3::from_fn(|axis, _| (*count * 12.9898 + axis as f64 * 78.233).sin())
}

fn motions(seed: f64) -> [RigidMotion; 2] {
    let mut count = seed;
    [0, 1].map(|_| RigidMotion { point: noise(&mut count), velocity: [noise(&mut count), noise(&mut count)] })
}

/// By body.
fn wrenches<T: Scalar>(list: &ContactList<T>, law: &PenaltyLaw, motions: &[RigidMotion; 2]) -> [[V3; 2]; 2] {
    let mut sums = [[V3::zeros(); 2]; 2];
    add_wrenches(
        list,
        law,
        |body| motions[body as usize],
        |body, wrench| {
            let own = &mut sums[body as usize];
            *own = [0, 1].map(|k| own[k] + wrench[k]);
        },
    );
    sums
}

fn momentum_is_kept<T: Scalar>() {
    let list: ContactList<T> = found(tori().each_ref(), Sampling::default());
    assert!(list.len() > 40);
    for seed in 0..10 {
        let motions = motions(f64::from(10 * seed));
        let [mut force, mut torque, mut size] = [V3::zeros(), V3::zeros(), V3::zeros()];
        add_wrenches(
            &list,
            &law(FRICTION, 0.1, 0.05),
            |body| motions[body as usize],
            |body, wrench| {
                let moment = motions[body as usize].point.cross(&wrench[0]) + wrench[1];
                (force, torque) = (force + wrench[0], torque + moment);
                size += V3::new(wrench[0].norm(), wrench[1].norm(), 0.0);
            },
        );
        assert!(force.norm() <= 1e-12 * size.x, "{} of {}", force.norm(), size.x);
        assert!(torque.norm() <= 1e-12 * size.y, "{} of {}", torque.norm(), size.y);
    }
}

#[test]
fn wrenches_keep_momentum_and_angular_momentum() {
    momentum_is_kept::<f64>();
    momentum_is_kept::<f32>();
}

/// Each contact of a list alone.
fn alone(list: &ContactList<f64>) -> impl Iterator<Item = (Contact<f64>, ContactList<f64>)> + '_ {
    list.contacts.iter().map(|contact| {
        let mut one = list.clone();
        one.contacts = vec![*contact];
        (*contact, one)
    })
}

fn power(wrenches: &[[V3; 2]; 2], motions: &[RigidMotion; 2]) -> f64 {
    let of = |body: usize| (0..2).map(|k| wrenches[body][k].dot(&motions[body].velocity[k])).sum::<f64>();
    of(0) + of(1)
}

#[test]
fn friction_of_rigid_bodies_takes_energy_from_each_contact_and_stays_in_its_cone() {
    let list = found(tori().each_ref(), Sampling::default());
    let mut pushing = 0;
    for seed in 0..4 {
        let motions = motions(f64::from(10 * seed));
        for (contact, one) in alone(&list) {
            let [smooth, rough] = [0.0, FRICTION].map(|friction| wrenches(&one, &law(friction, 0.1, 0.05), &motions));
            let push = smooth[0][0].norm();
            pushing += usize::from(push > 0.0);
            let friction = rough[0][0] - smooth[0][0];
            assert!(friction.norm() <= FRICTION * contact.cos_alpha * push * (1.0 + 1e-9));
            assert!(friction.dot(&contact.direction).abs() <= 1e-9 * push);
            let size =
                push * motions.iter().map(|motion| motion.velocity[0].norm() + motion.velocity[1].norm()).sum::<f64>();
            let by_friction = power(&rough, &motions) - power(&smooth, &motions);
            assert!(by_friction <= 1e-12 * size, "{by_friction}");
            // What damping adds to the spring takes energy too, and no contact pulls.
            assert!(smooth[contact.colliding as usize][0].dot(&contact.direction) >= 0.0);
            let spring = wrenches(&one, &law(0.0, 0.0, 0.0), &motions);
            assert!(power(&smooth, &motions) - power(&spring, &motions) <= 1e-12 * size);
        }
    }
    assert!(pushing > 100, "{pushing}");
}

/// The judge of wrenches without friction: forces at the vertices, added up.
#[test]
fn wrenches_are_what_vertex_forces_add_up_to() {
    let shapes = tori();
    let list = found(shapes.each_ref(), Sampling::Vertices);
    let motions = motions(3.0);
    let vertices = shapes.each_ref().map(|shape| shape.positions.iter().map(|&x| V3::from(x)).collect::<Vec<_>>());
    // So little damping that no contact pulls.
    let law = law(0.0, 0.0, 1e-3);
    let [mut velocities, mut forces] = [vertices.clone(), vertices.clone()];
    for body in 0..2 {
        let RigidMotion { point, velocity: [linear, angular] } = motions[body];
        velocities[body].iter_mut().for_each(|x| *x = linear + angular.cross(&(*x - point)));
        forces[body].fill(V3::zeros());
    }
    let pulls =
        alone(&list).filter(|(contact, one)| wrenches(one, &law, &motions)[0][0].dot(&contact.direction) == 0.0);
    assert_eq!(pulls.filter(|(contact, _)| contact.depth > 0.0).count(), 0);
    add_forces(&list, &law, None, Some(&velocities), &mut forces);
    for (body, wrench) in wrenches(&list, &law, &motions).iter().enumerate() {
        let force: V3 = forces[body].iter().sum();
        let arms = vertices[body].iter().map(|x| x - motions[body].point);
        let torque: V3 = arms.zip(&forces[body]).map(|(arm, force)| arm.cross(force)).sum();
        assert!((force - wrench[0]).norm() <= 1e-12 * force.norm(), "{force} {}", wrench[0]);
        assert!((torque - wrench[1]).norm() <= 1e-12 * force.norm(), "{torque} {}", wrench[1]);
    }
}

#[test]
fn friction_at_vertices_takes_energy_and_keeps_momentum() {
    let shapes = tori();
    for sampling in [Sampling::Vertices, Sampling::default(), Sampling::Accuracy(0.05)] {
        let list = found(shapes.each_ref(), sampling);
        let mut count = 0.5;
        let velocities =
            shapes.each_ref().map(|shape| shape.positions.iter().map(|_| noise(&mut count)).collect::<Vec<_>>());
        let zero = velocities.each_ref().map(|body| vec![V3::zeros(); body.len()]);
        let mut sums = 0;
        for (contact, one) in alone(&list) {
            let [smooth, rough] = [0.0, FRICTION].map(|friction| {
                let mut forces = zero.clone();
                add_forces(&one, &law(friction, 0.1, 0.01), None, Some(&velocities), &mut forces);
                forces
            });
            let all = |field: &[Vec<V3>; 2]| field.concat();
            let friction: Vec<V3> = all(&rough).iter().zip(all(&smooth)).map(|(a, b)| a - b).collect();
            let (net, size) = friction.iter().fold((V3::zeros(), 0.0), |(net, size), f| (net + f, size + f.norm()));
            assert!(net.norm() <= 1e-12 * size.max(all(&smooth).iter().map(|f| f.norm()).sum()));
            let power: f64 = friction.iter().zip(all(&velocities)).map(|(force, velocity)| force.dot(&velocity)).sum();
            assert!(power <= 1e-12 * size, "{power}");
            let on_first: V3 = (0..shapes[0].positions.len())
                .map(|k| if contact.colliding == 0 { friction[k] } else { -friction[k] })
                .sum();
            assert!(on_first.dot(&contact.direction).abs() <= 1e-9 * size.max(1.0));
            sums += usize::from(size > 0.0);
        }
        assert!(sums > list.len() / 2, "{sums} of {}", list.len());
        // It is not in the derivative.
        let differentials = [0.0, FRICTION].map(|friction| {
            let mut forces = zero.clone();
            add_differential(&list, &law(friction, 0.1, 0.01), 1.0, 0.5, &velocities, &mut forces);
            forces
        });
        assert_eq!(differentials[0], differentials[1]);
    }
}

#[test]
fn bad_friction_is_refused() {
    let law = law(0.0, 0.0, 0.0);
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(law.with_friction(bad, 0.1), Err(LawError::Friction(_))), "{bad}");
        assert!(matches!(law.with_friction(0.5, bad), Err(LawError::SlipSpeed(_))), "{bad}");
        assert!(matches!(law.with_friction(0.0, bad), Err(LawError::SlipSpeed(_))), "{bad}");
    }
    assert_eq!(law.with_friction(0.5, 0.0), Err(LawError::SlipSpeed(0.0)));
    assert!(law.with_friction(0.5, 0.0).unwrap_err().to_string().contains("slip_speed is 0; it must be"));
    assert_eq!(law.with_friction(0.0, 0.0), Ok(law));
}
