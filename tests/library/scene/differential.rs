//! The derivative of the forces against differences of forces whose contacts are found anew on both sides.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use nalgebra::Vector3;
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::force::{PenaltyLaw, Weighting, add_differential, add_forces};
use raycontact::scene::{Scene, SceneError};

type Field = [Vec<Vector3<f64>>; 2];

struct Case {
    shapes: [Shape; 2],
    law: PenaltyLaw,
    scene: Scene<f64>,
    contacts: ContactList<f64>,
}

impl Case {
    /// Two shapes whose vertices are moved a little at random: where faces lie exactly in line, forces have kinks.
    fn new(mut shapes: [Shape; 2], sampling: Sampling<f64>, weighting: Weighting, random: &mut Random) -> Self {
        for position in shapes.iter_mut().flat_map(|shape| &mut shape.positions) {
            *position = (Vector3::from(*position) + Vector3::from(random.point(0.03))).into();
        }
        let mut scene = Scene::new(1).expect("no threads are needed");
        let _ = shapes.each_ref().map(|shape| scene.add(shape.mesh()));
        let law = if sampling == Sampling::Vertices { ContactLaw::RayLength } else { ContactLaw::Pressure };
        scene.set_options(DetectionOptions { escape: false, sampling, law, ..DetectionOptions::default() });
        let law = PenaltyLaw::new(7.0, 0.3, weighting).expect("valid numbers");
        Self { shapes, law, scene, contacts: ContactList::default() }
    }

    fn fields(&self, mut at: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Field {
        self.shapes.each_ref().map(|shape| shape.positions.iter().map(|&point| at(point.into())).collect())
    }

    /// The forces at so much of these displacements.
    fn forces(&mut self, displacements: &Field, part: f64) -> Field {
        for (body, (shape, displacements)) in self.shapes.iter().zip(displacements).enumerate() {
            let moved = shape.positions.iter().zip(displacements).map(|(&x, by)| (Vector3::from(x) + by * part).into());
            let mesh = self.scene.mesh_mut(body as u32).expect("a body");
            mesh.set_positions(&moved.collect::<Vec<_>>()).expect("finite positions");
        }
        self.scene.query(&mut self.contacts);
        let mut forces = self.fields(|_| Vector3::zeros());
        add_forces::<_, Vec<_>, _>(&self.contacts, &self.law, None, None, &mut forces[..]);
        forces
    }

    /// The derivatives along these displacements of contacts that are held, and of contacts found anew.
    fn derivatives(&self, factors: [f64; 2], along: &Field) -> [Vec<Vector3<f64>>; 2] {
        let [mut held, mut anew] = [(); 2].map(|()| self.fields(|_| Vector3::zeros()));
        add_differential(&self.contacts, &self.law, factors[0], factors[1], along, &mut held[..]);
        let added = self.scene.add_differential(&self.contacts, &self.law, factors, along, &mut anew[..]);
        added.expect("contacts of where bodies are");
        [held, anew].map(|field| field.concat())
    }

    /// How far these are from differences, over these.
    fn errors(&mut self, along: &Field) -> [f64; 2] {
        // So small that hardly a ray's end passes from one triangle to the next, where the derivative has a jump.
        const STEP: f64 = 1e-8;
        let [ahead, behind] = [STEP, -STEP].map(|step| self.forces(along, step).concat());
        self.forces(along, 0.0);
        let differences: Vec<_> = ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        let size = |field: &[Vector3<f64>]| field.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        self.derivatives([1.0, 0.0], along).map(|field| {
            let off: Vec<_> = field.iter().zip(&differences).map(|(a, b)| a - b).collect();
            size(&off) / size(&differences)
        })
    }
}

fn blocks() -> [Shape; 2] {
    [shapes::block([6, 6, 6]), shapes::block([5, 5, 5]).scaled(0.6).moved([0.0, 0.0, 1.55])]
}

fn tori() -> [Shape; 2] {
    [shapes::torus(24, 12, 0.4), shapes::torus(24, 12, 0.4).turned(0.3, 0.7).moved([0.3, 0.15, 0.5])]
}

/// Along displacements that have nothing to do with one another, and along those that stretch, shear and turn the bodies.
#[test]
fn the_derivative_is_that_of_contacts_found_anew() {
    let mut random = Random::new(45);
    // Half of all are off by at most so much, and the worst. By accuracy the derivative does not know how samples come and go.
    let (exact, rough) = ([1e-6, 1e-3], [0.5, 0.9]);
    for (name, shapes, sampling, weighting, bounds) in [
        ("blocks", blocks(), Sampling::Spacing(0.1), Weighting::Area, exact),
        ("blocks", blocks(), Sampling::Spacing(0.3), Weighting::Area, exact),
        ("tori", tori(), Sampling::Spacing(0.1), Weighting::Area, exact),
        ("tori, by the paper", tori(), Sampling::Vertices, Weighting::Vertex, exact),
        ("blocks", blocks(), Sampling::Accuracy(0.01), Weighting::Area, rough),
        ("tori", tori(), Sampling::Accuracy(0.01), Weighting::Area, rough),
    ] {
        let (mut off, mut off_held) = (Vec::new(), Vec::new());
        for _ in 0..5 {
            let mut case = Case::new(shapes.clone(), sampling, weighting, &mut random);
            let noise = case.fields(|_| random.point(1.0).into());
            let [w, x, y, z] = [(); 4].map(|()| Vector3::from(random.point(1.0)));
            for along in [noise, case.fields(|at| w + x * at.x + y * at.y + z * at.z)] {
                let [held, anew] = case.errors(&along);
                off.push(anew);
                off_held.push(held);
            }
        }
        off.sort_by(f64::total_cmp);
        off_held.sort_by(f64::total_cmp);
        println!("{name}, {sampling:?}: off by {:.1e}, at most {:.1e}; held by {:.1e}", off[5], off[9], off_held[5]);
        assert!(off[5] < bounds[0] && off[9] < bounds[1], "{name}, {sampling:?}: {off:?}");
        assert!(off_held[0] > 0.1, "{name}: held contacts would do: {off_held:?}");
    }
}

/// Bodies that move together feel no change but that of their turning, all forces add up to zero, and damping is that of held
/// contacts.
#[test]
fn the_derivative_keeps_momentum_and_turns_with_the_bodies() {
    let mut random = Random::new(46);
    for sampling in [Sampling::Spacing(0.1), Sampling::Accuracy(0.01), Sampling::Vertices] {
        let mut case = Case::new(tori(), sampling, Weighting::Area, &mut random);
        let zeros = case.fields(|_| Vector3::zeros());
        let forces = case.forces(&zeros, 0.0).concat();
        let size = forces.iter().map(Vector3::norm).sum::<f64>();
        let along = case.fields(|_| random.point(1.0).into());
        let [held, anew] = case.derivatives([1.0, 0.0], &along);
        let scale = held.iter().map(Vector3::norm).sum::<f64>();
        assert!(anew.iter().sum::<Vector3<f64>>().norm() < 1e-12 * scale, "{sampling:?}");
        let by = Vector3::from(random.point(1.0));
        let [_, moved] = case.derivatives([1.0, 0.0], &case.fields(|_| by));
        assert!(moved.iter().map(Vector3::norm).sum::<f64>() < 1e-11 * size / 0.1, "{sampling:?}");
        let [_, turned] = case.derivatives([1.0, 0.0], &case.fields(|at| by.cross(&at)));
        for (turned, force) in turned.iter().zip(&forces) {
            assert!((turned - by.cross(force)).norm() < 1e-11 * size / 0.1, "{sampling:?}: {turned} for {force}");
        }
        let [held, anew] = case.derivatives([0.0, 1.0], &along);
        assert!(held.iter().zip(&anew).all(|(held, anew)| (held - anew).norm() < 1e-12 * scale), "{sampling:?}");
    }
}

#[test]
fn contacts_of_elsewhere_are_refused() {
    let mut random = Random::new(47);
    let mut case = Case::new(tori(), Sampling::Spacing(0.2), Weighting::Area, &mut random);
    let zeros = case.fields(|_| Vector3::zeros());
    case.forces(&zeros, 0.0);
    let refusal = |case: &Case| {
        let mut forces = zeros.clone();
        let along = case.fields(|_| Vector3::x());
        let refused = case.scene.add_differential(&case.contacts, &case.law, [1.0, 0.0], &along, &mut forces[..]);
        assert_eq!(forces, zeros, "nothing is added");
        refused.expect_err("not the contacts of where bodies are")
    };
    let mesh = case.scene.mesh_mut(1).expect("a body");
    mesh.set_positions(&tori()[1].positions).expect("finite positions");
    let moved = refusal(&case);
    assert!(matches!(moved, SceneError::ContactsOutdated { body: 1 }), "{moved}");
    assert!(moved.to_string().contains("a query of this scene"), "{moved}");
    let mut other = Case::new(blocks(), Sampling::Spacing(0.2), Weighting::Area, &mut random);
    other.scene.query(&mut ContactList::default());
    std::mem::swap(&mut case.scene, &mut other.scene);
    assert!(matches!(refusal(&case), SceneError::ContactsOutdated { .. }));
    case.scene.remove(1).expect("a body");
    case.scene.query(&mut ContactList::default());
    case.contacts.contacts.retain(|contact| contact.collided == 1);
    let removed = refusal(&case);
    assert!(matches!(removed, SceneError::UnknownBody { body: 1 } | SceneError::ContactsOutdated { .. }), "{removed}");
}
