//! A small simulator on the contact system alone: points with masses and springs, rigid bodies, implicit Euler, conjugate
//! gradients.

use nalgebra::{Matrix3, Vector3};
use raycontact::scene::Scene;
use raycontact::system::{ContactSystem, Motion, RigidUnknowns};

type V3 = Vector3<f64>;

/// A rigid body of the host.
#[derive(Clone, Debug)]
pub struct Rigid {
    pub body: u32,
    pub mass: f64,
    pub inertia: Matrix3<f64>,
    pub position: V3,
    pub rotation: Matrix3<f64>,
    pub velocity: [f64; 6],
    /// In N, at the centre.
    pub push: V3,
}

#[derive(Clone, Copy, Debug)]
pub struct Spring {
    pub ends: [usize; 2],
    pub length: f64,
    pub stiffness: f64,
}

pub struct Host {
    pub scene: Scene<f64>,
    pub system: ContactSystem<f64>,
    pub masses: Vec<f64>,
    pub x: Vec<f64>,
    pub v: Vec<f64>,
    pub springs: Vec<Spring>,
    pub rigids: Vec<Rigid>,
    pub gravity: V3,
    /// In N, on every node.
    pub push: V3,
    /// How often a step may be solved, and the part of the force predicted wrongly that is good enough.
    pub solves: usize,
    pub goal: f64,
    /// That part in the last step.
    pub wrong: f64,
    /// Springs are held as stiff across their direction as along it. What they then store is never less than what springs
    /// that turn with their ends do, and as much at the start of the step: so they cannot gain energy, however long it is.
    pub holds_springs: bool,
    pub detects_again: bool,
    /// Whether steps whose energy would rise are cut short.
    pub is_guarded: bool,
    /// In J, at the end of the last guarded step.
    pub energy: Option<f64>,
    /// How many steps were cut short, and how many were slowed.
    pub cuts: [usize; 2],
    pub iterations: usize,
}

pub fn at(field: &[f64], node: usize) -> V3 {
    V3::new(field[3 * node], field[3 * node + 1], field[3 * node + 2])
}

fn add(field: &mut [f64], node: usize, value: V3) {
    (0..3).for_each(|axis| field[3 * node + axis] += value[axis]);
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The inertia of a box with these edges.
pub fn box_inertia(mass: f64, edges: [f64; 3]) -> [[f64; 3]; 3] {
    let square = edges.map(|edge| edge * edge);
    let sum: f64 = square.iter().sum();
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { mass / 12.0 * (sum - square[i]) } else { 0.0 }))
}

pub fn rows_of(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

pub fn rotation(angle: &V3) -> Matrix3<f64> {
    *nalgebra::Rotation3::new(*angle).matrix()
}

impl Host {
    pub fn new(rigid_unknowns: RigidUnknowns) -> Self {
        Self {
            scene: Scene::new(1).expect("no thread is started"),
            system: ContactSystem::new(rigid_unknowns),
            masses: Vec::new(),
            x: Vec::new(),
            v: Vec::new(),
            springs: Vec::new(),
            rigids: Vec::new(),
            gravity: V3::zeros(),
            push: V3::zeros(),
            solves: 5,
            goal: 1e-3,
            wrong: 0.0,
            holds_springs: false,
            detects_again: true,
            is_guarded: false,
            energy: None,
            cuts: [0; 2],
            iterations: 0,
        }
    }

    /// Adds nodes of these positions; gives their numbers.
    pub fn add_nodes(&mut self, positions: &[[f64; 3]], mass: f64) -> std::ops::Range<u32> {
        let first = self.masses.len() as u32;
        self.x.extend(positions.iter().flatten());
        self.v.extend(positions.iter().flatten().map(|_| 0.0));
        self.masses.extend(positions.iter().map(|_| mass));
        self.system.set_node_masses(&self.masses).expect("masses are fine");
        first..self.masses.len() as u32
    }

    pub fn set_motions(&mut self, dt: f64) {
        for rigid in &self.rigids {
            let mut free = rigid.velocity;
            let gain = (self.gravity + rigid.push / rigid.mass) * dt;
            (0..3).for_each(|axis| free[axis] += gain[axis]);
            let motion = Motion {
                position: rigid.position.into(),
                rotation: rows_of(&rigid.rotation),
                velocity: rigid.velocity,
                free_velocity: free,
            };
            self.system.set_motion(rigid.body, &motion).expect("it is rigid");
        }
    }

    /// Forces of the springs at positions, and their stiffness times a displacement where one is given.
    fn springs(&self, x: &[f64], displacement: Option<&[f64]>, out: &mut [f64]) {
        for Spring { ends: [a, b], length, stiffness } in &self.springs {
            let way = at(x, *b) - at(x, *a);
            let now = way.norm();
            let along = way / now;
            let force = match displacement {
                None => along * (stiffness * (now - length)),
                Some(d) => {
                    let d = at(d, *b) - at(d, *a);
                    let across = if self.holds_springs { 1.0 } else { (1.0 - length / now).max(0.0) };
                    (along * along.dot(&d) * (1.0 - across) + d * across) * *stiffness
                }
            };
            add(out, *a, force);
            add(out, *b, -force);
        }
    }

    /// One step; all rigid unknowns are eliminated.
    pub fn step(&mut self, dt: f64) {
        self.set_motions(dt);
        let count = self.x.len();
        let mut free = self.v.clone();
        let mut own = vec![0.0; count];
        self.springs(&self.x, None, &mut own);
        for node in 0..self.masses.len() {
            if self.masses[node].is_finite() {
                add(&mut own, node, self.gravity * self.masses[node] + self.push);
                add(&mut free, node, self.gravity * dt + self.push * (dt / self.masses[node]));
            }
        }
        self.system.begin(&mut self.scene, dt, &self.x, &self.v, &free).expect("a step");
        let mut v = self.v.clone();
        for solve in 0..self.solves {
            // M (v' − v0) = dt · (own + K_s dt v' + contact(v')), solved for the change of v.
            let mut right = vec![0.0; count];
            let mut contact = vec![0.0; count];
            self.system.add_forces(&v, &mut contact).expect("a step is under way");
            let moved: Vec<f64> = v.iter().map(|v| v * dt).collect();
            let mut stretched = vec![0.0; count];
            self.springs(&self.x, Some(&moved), &mut stretched);
            for k in 0..count {
                let mass = self.masses[k / 3];
                if mass.is_finite() {
                    right[k] = dt * (own[k] + stretched[k] + contact[k]) - mass * (v[k] - self.v[k]);
                }
            }
            self.conjugate_gradients(dt, &right, &mut v);
            self.wrong = self.system.linearise(&v).expect("a step is under way");
            let more = self.detects_again
                && solve + 2 < self.solves
                && self.system.detect_again(&mut self.scene, &v).expect("a step is under way");
            if !more && self.wrong <= self.goal {
                break;
            }
        }
        let start = self.x.clone();
        let [part, kept] = if self.is_guarded { self.guarded(dt, &start, &v) } else { [1.0; 2] };
        self.system.finish(&v).expect("a step is under way");
        self.move_on(part * dt, &start, &v);
        for rigid in &mut self.rigids {
            rigid.velocity = self.system.rigid_velocity(rigid.body).expect("it is rigid");
            let [a, b, c, d, e, f] = rigid.velocity;
            rigid.position += V3::new(a, b, c) * (part * dt);
            rigid.rotation = rotation(&(V3::new(d, e, f) * (part * dt))) * rigid.rotation;
            rigid.velocity.iter_mut().for_each(|velocity| *velocity *= kept);
        }
        self.v.iter_mut().for_each(|velocity| *velocity *= kept);
    }

    fn move_on(&mut self, time: f64, start: &[f64], v: &[f64]) {
        self.v.copy_from_slice(v);
        self.x.iter_mut().zip(start).zip(v).for_each(|((x, start), v)| *x = start + time * v);
    }

    /// How much of the step can be taken before what is stored alone is more than all energy was, and the part of the
    /// velocities that the rest of it leaves.
    fn guarded(&mut self, dt: f64, start: &[f64], v: &[f64]) -> [f64; 2] {
        let most = match self.energy {
            Some(energy) => energy,
            None => self.kinetic() + self.stored() + self.trial(v, 0.0),
        };
        let (mut part, mut tries) = (1.0, 0);
        let stored = loop {
            let contact = self.trial(v, part);
            self.move_on(part * dt, start, v);
            let stored = self.stored() + contact + self.lifted(part * dt);
            if stored <= most || part == 0.0 {
                break stored;
            }
            tries += 1;
            part = if tries < 8 { 0.5 * part } else { 0.0 };
        };
        let moving = {
            let before: Vec<_> = self.rigids.iter().map(|rigid| rigid.velocity).collect();
            for rigid in &mut self.rigids {
                rigid.velocity = self.system.rigid_velocity(rigid.body).expect("it is rigid");
            }
            let moving = self.kinetic();
            self.rigids.iter_mut().zip(before).for_each(|(rigid, velocity)| rigid.velocity = velocity);
            moving
        };
        let kept = if stored + moving > most { ((most - stored).max(0.0) / moving).sqrt() } else { 1.0 };
        self.energy = Some(stored + kept * kept * moving);
        self.cuts[0] += usize::from(part < 1.0);
        self.cuts[1] += usize::from(kept < 0.999);
        [part, kept]
    }

    fn trial(&mut self, v: &[f64], part: f64) -> f64 {
        self.system.potential(&mut self.scene, v, part).expect("a step is under way")
    }

    /// In J: of springs and height.
    fn stored(&self) -> f64 {
        let nodes = (0..self.masses.len()).filter(|&node| self.masses[node].is_finite());
        let of_nodes = nodes.map(|node| at(&self.x, node).dot(&(self.gravity * self.masses[node] + self.push)));
        let of_rigids = self.rigids.iter().map(|rigid| rigid.position.dot(&(self.gravity * rigid.mass + rigid.push)));
        self.elastic() - of_nodes.sum::<f64>() - of_rigids.sum::<f64>()
    }

    /// What rigid bodies gain by height in that time, as they answered to the last trial.
    fn lifted(&self, time: f64) -> f64 {
        let gained = |rigid: &Rigid| {
            let velocity = self.system.rigid_velocity(rigid.body).expect("it is rigid");
            -V3::new(velocity[0], velocity[1], velocity[2]).dot(&(self.gravity * rigid.mass + rigid.push)) * time
        };
        self.rigids.iter().map(gained).sum()
    }

    /// One step of the implicit midpoint rule: the step to its middle, and as far again.
    pub fn midpoint_step(&mut self, dt: f64) {
        let (x, v, rigids) = (self.x.clone(), self.v.clone(), self.rigids.clone());
        self.step(0.5 * dt);
        self.x.iter_mut().zip(&x).for_each(|(middle, start)| *middle += *middle - start);
        self.v.iter_mut().zip(&v).for_each(|(middle, start)| *middle += *middle - start);
        for (rigid, start) in self.rigids.iter_mut().zip(&rigids) {
            let [a, b, c, d, e, f] = rigid.velocity;
            rigid.position = start.position + V3::new(a, b, c) * dt;
            rigid.rotation = rotation(&(V3::new(d, e, f) * dt)) * start.rotation;
            rigid.velocity.iter_mut().zip(start.velocity).for_each(|(middle, start)| *middle += *middle - start);
        }
    }

    fn conjugate_gradients(&mut self, dt: f64, right: &[f64], v: &mut [f64]) {
        let count = right.len();
        let mut residual = right.to_vec();
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        let goal = 1e-20 * square;
        for _ in 0..4 * count + 10 {
            if square <= goal || square == 0.0 {
                break;
            }
            self.iterations += 1;
            let mut product = vec![0.0; count];
            let moved: Vec<f64> = direction.iter().map(|d| -d * dt * dt).collect();
            self.springs(&self.x, Some(&moved), &mut product);
            self.system.add_product(dt, &direction, &mut product).expect("a step is under way");
            for k in 0..count {
                let mass = self.masses[k / 3];
                product[k] = if mass.is_finite() { product[k] + mass * direction[k] } else { 0.0 };
            }
            let alpha = square / dot(&direction, &product);
            for k in 0..count {
                v[k] += alpha * direction[k];
                residual[k] -= alpha * product[k];
            }
            let next = dot(&residual, &residual);
            let beta = next / square;
            square = next;
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + beta * *d);
        }
    }

    /// In J: of motion.
    pub fn kinetic(&self) -> f64 {
        let finite = |k: usize| if self.masses[k / 3].is_finite() { self.masses[k / 3] } else { 0.0 };
        let nodes: f64 = self.v.iter().enumerate().map(|(k, v)| 0.5 * finite(k) * v * v).sum();
        let rigids = self.rigids.iter().map(|rigid| {
            let [a, b, c, d, e, f] = rigid.velocity;
            let (linear, angular) = (V3::new(a, b, c), V3::new(d, e, f));
            let inertia = rigid.rotation * rigid.inertia * rigid.rotation.transpose();
            0.5 * (rigid.mass * linear.norm_squared() + angular.dot(&(inertia * angular)))
        });
        nodes + rigids.sum::<f64>()
    }

    /// In J: of the springs.
    pub fn elastic(&self) -> f64 {
        let stored = |s: &Spring| {
            let stretch = (at(&self.x, s.ends[1]) - at(&self.x, s.ends[0])).norm() - s.length;
            0.5 * s.stiffness * stretch * stretch
        };
        self.springs.iter().map(stored).sum()
    }
}
