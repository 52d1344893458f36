//! What the pairs of a scene remember: read, saved and restored; and escapes that are forbidden, or turn.

use crate::common::shapes::{self, Shape};
use raycontact::contact::{ContactKind, ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::math::{Scalar, Vector3};
use raycontact::scene::{BytesError, Scene, SceneError};

/// Quasi-static motion of free bodies: each goes along the mean of its contacts' pushes, a little beyond touching.
struct Motion<T: Scalar> {
    rest: Vec<Vec<Vector3<T>>>,
    offsets: Vec<Vector3<T>>,
    scene: Scene<T>,
    contacts: ContactList<T>,
}

impl<T: Scalar> Motion<T> {
    fn new(shapes: &[Shape]) -> Self {
        let mut scene = Scene::new(1).expect("no threads are needed");
        // Few rays are enough here.
        scene.set_options(DetectionOptions { sampling: Sampling::Spacing(T::of(0.5)), ..DetectionOptions::default() });
        let meshes: Vec<_> = shapes.iter().map(Shape::mesh::<T>).collect();
        let rest = meshes.iter().map(|mesh| mesh.positions().to_vec()).collect();
        for mesh in meshes {
            scene.add(mesh);
        }
        Self { rest, offsets: vec![Vector3::zeros(); shapes.len()], scene, contacts: ContactList::default() }
    }

    fn query(&mut self) {
        for (body, (rest, offset)) in self.rest.iter().zip(&self.offsets).enumerate() {
            let mesh = self.scene.mesh_mut(body as u32).expect("it was added");
            mesh.set_positions_with(rest.len(), |vertex| rest[vertex] + offset).expect("finite");
        }
        self.scene.query(&mut self.contacts);
        crate::common::assert_every_ray_is_counted(&self.contacts);
    }

    fn step(&mut self) {
        self.query();
        for (body, offset) in self.offsets.iter_mut().enumerate() {
            let (mut push, mut weight) = (Vector3::zeros(), T::zero());
            for contact in &self.contacts.contacts {
                let signs = [(contact.colliding, T::one()), (contact.collided, -T::one())];
                for (_, sign) in signs.into_iter().filter(|(which, _)| *which == body as u32) {
                    push += contact.direction * (sign * (contact.depth + T::of(0.01)) * contact.area);
                    weight += contact.area;
                }
            }
            if weight > T::zero() {
                *offset += push / weight * T::of(0.2);
            }
        }
        self.scene.advance(1.0 / 60.0).expect("a length");
    }

    fn saved(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.scene.save_pair_memories(&mut bytes);
        assert_eq!(bytes.len(), self.scene.saved_length());
        bytes
    }
}

/// A block swallowed by a larger one, and two that only lean on one another.
fn swallowed() -> Vec<Shape> {
    let block = |scale: f64, at| shapes::cube(1).scaled(scale).moved(at);
    vec![block(1.0, [0.0; 3]), block(0.2, [0.1, 0.3, -0.2]), block(0.5, [9.0, 0.0, 0.0]), block(0.5, [9.8, 0.05, 0.02])]
}

/// A scene restored in the middle of an escape, as after a host's restart, goes on as the saved one, to the bit; and a
/// scene that is not given its memory does not, so that the test would see it.
#[test]
fn a_restored_scene_goes_on_to_the_bit() {
    fn check<T: Scalar>() {
        let mut first = Motion::<T>::new(&swallowed());
        (0..3).for_each(|_| first.step());
        let (saved, offsets) = (first.saved(), first.offsets.clone());
        let escaping = first.scene.pair_memories().iter().filter(|(_, memory)| memory.escape.is_some()).count();
        assert!(escaping > 0 && first.scene.pair_memories().len() > escaping, "{:?}", first.scene.pair_memories());
        let expected: Vec<_> = (0..20)
            .map(|_| {
                first.step();
                (first.contacts.clone(), first.offsets.clone())
            })
            .collect();
        for restore in [true, false] {
            let mut second = Motion::<T>::new(&swallowed());
            second.offsets = offsets.clone();
            if restore {
                second.scene.restore_pair_memories(&saved).expect("they were saved");
                assert_eq!(second.saved(), saved);
            }
            let mut same = 0;
            for expected in &expected {
                second.step();
                same += usize::from((&second.contacts, &second.offsets) == (&expected.0, &expected.1));
            }
            assert_eq!(same == expected.len(), restore, "restored: {restore}, {same} steps are the same");
        }
    }
    check::<f64>();
    check::<f32>();
}

/// FNV-1a, as at the end of saved bytes.
fn with_checksum(mut body: Vec<u8>) -> Vec<u8> {
    let fold = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    let sum = body.iter().fold(0xcbf2_9ce4_8422_2325, fold);
    body.extend(sum.to_le_bytes());
    body
}

/// Each with its own error, and the scene remembers what it did.
#[test]
fn bad_bytes_are_refused_and_change_nothing() {
    let mut motion = Motion::<f64>::new(&swallowed());
    (0..5).for_each(|_| motion.step());
    let saved = motion.saved();
    let mut refuse = |bytes: &[u8], expected: BytesError| {
        match motion.scene.restore_pair_memories(bytes) {
            Err(SceneError::SavedState(error)) => assert_eq!(error, expected),
            other => panic!("{expected:?} was expected, not {other:?}"),
        }
        assert_eq!(motion.saved(), saved);
    };
    for length in 0..saved.len() {
        refuse(&saved[..length], BytesError::Foreign { length });
    }
    let length = saved.len() + 1;
    refuse(&[&saved[..], &[0]].concat(), BytesError::Foreign { length });
    // The mark, the version and the count are looked at first; any other change shows in the checksum.
    for place in (0..saved.len()).filter(|place| !(8..12).contains(place)) {
        let mut bytes = saved.clone();
        bytes[place] ^= 0x10;
        let is_frame = place < 8 || (28..44).contains(&place);
        let length = saved.len();
        refuse(&bytes, if is_frame { BytesError::Foreign { length } } else { BytesError::Damaged });
    }
    let body = &saved[..saved.len() - 8];
    let changed = |place: usize, bytes: &[u8]| {
        let mut body = body.to_vec();
        body[place..place + bytes.len()].copy_from_slice(bytes);
        with_checksum(body)
    };
    refuse(&changed(8, &1u32.to_le_bytes()), BytesError::OtherVersion { version: 1 });
    refuse(&changed(12, &4u32.to_le_bytes()), BytesError::OtherPrecision { bytes: 4 });
    // Made-up bytes with the right checksum: pairs out of order, a third kind of escaping, a number below zero, NaN.
    // And before them flags that there are not, and more of a step than there is.
    refuse(&changed(16, &8u32.to_le_bytes()), BytesError::Damaged);
    refuse(&changed(20, &1f64.to_le_bytes()), BytesError::Damaged);
    let first_entry = 44;
    refuse(&changed(first_entry, &7u32.to_le_bytes()), BytesError::Damaged);
    refuse(&changed(first_entry + 8, &2u32.to_le_bytes()), BytesError::Damaged);
    refuse(&changed(first_entry + 52, &(-1f64).to_le_bytes()), BytesError::Damaged);
    refuse(&changed(first_entry + 44, &f64::NAN.to_le_bytes()), BytesError::Damaged);
    refuse(&changed(first_entry + 60, &2f64.to_le_bytes()), BytesError::Damaged);
    refuse(&changed(first_entry + 84, &f64::INFINITY.to_le_bytes()), BytesError::Damaged);
    let far = first_entry + 92 * (motion.scene.pair_memories().len() - 1) + 4;
    let unknown = changed(far, &42u32.to_le_bytes());
    assert!(matches!(motion.scene.restore_pair_memories(&unknown), Err(SceneError::UnknownBody { body: 42 })));
    assert_eq!(motion.saved(), saved);
}

#[test]
fn an_escape_is_forbidden_for_one_pair_alone() {
    let mut motion = Motion::<f64>::new(&[
        shapes::cube(2),
        shapes::cube(1).scaled(0.2).moved([0.1, 0.3, -0.2]),
        shapes::cube(1).scaled(0.1).moved([-0.5, -0.3, 0.4]),
    ]);
    // Under the paper's law nothing else pushes what is swallowed.
    motion.scene.set_options(DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() });
    motion.scene.allow_escape(1, 0, false).expect("both are there");
    assert!(!motion.scene.may_escape(0, 1).expect("both are there"));
    assert!(motion.scene.may_escape(0, 2).expect("both are there"));
    let escaping = |motion: &Motion<f64>| -> Vec<[u32; 2]> {
        let memories = motion.scene.pair_memories().iter();
        memories.filter(|(_, memory)| memory.escape.is_some()).map(|(pair, _)| *pair).collect()
    };
    for _ in 0..50 {
        motion.query();
        assert_eq!(escaping(&motion), [[0, 2]]);
        assert_eq!(motion.contacts.statistics.escapes_forbidden, 1);
        assert!(motion.contacts.contacts.iter().all(|contact| ![contact.colliding, contact.collided].contains(&1)));
    }
    motion.scene.allow_escape(0, 1, true).expect("both are there");
    motion.query();
    assert_eq!(escaping(&motion), [[0, 1], [0, 2]]);
    // Forbidden on its way, it ends.
    motion.scene.allow_escape(0, 1, false).expect("both are there");
    motion.query();
    assert_eq!(escaping(&motion), [[0, 2]]);
    assert!(matches!(motion.scene.allow_escape(0, 0, false), Err(SceneError::SameBody { body: 0 })));
    assert!(matches!(motion.scene.allow_escape(0, 3, false), Err(SceneError::UnknownBody { body: 3 })));
    // A body that takes the number of one removed is another.
    let mesh = motion.scene.remove(1).expect("it is there");
    motion.scene.release_body_numbers();
    assert_eq!(motion.scene.add(mesh), 1);
    assert!(motion.scene.may_escape(0, 1).expect("both are there"));
}

/// The first body above the second, the second above the third, the third above the first, all in the same place: no
/// motion obeys all three. The directions turn, and the bodies part.
#[test]
fn directions_that_run_in_a_circle_turn() {
    let mut bytes = b"raycpair".to_vec();
    [3u32, 8, 0].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes.extend(0f64.to_le_bytes());
    [3u64, 0].iter().for_each(|count| bytes.extend(count.to_le_bytes()));
    for ([first, second], along) in [([0u32, 1u32], 1.0f64), ([0, 2], -1.0), ([1, 2], 1.0)] {
        [first, second, 1, 0, 0].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        let numbers = [along, 0.0, 0.0, f64::INFINITY, f64::INFINITY, 0.0, 0.0, 0.0, 0.0];
        numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    let bytes = with_checksum(bytes);
    for offsets in [[[0.0; 3]; 3], [[0.0; 3], [0.1, 0.2, 0.0], [-0.1, 0.1, 0.3]]] {
        let mut motion = Motion::<f64>::new(&offsets.map(|at| shapes::cube(1).moved(at)));
        motion.query();
        motion.scene.restore_pair_memories(&bytes).expect("they are as if saved");
        let (mut turned, mut steps) = (0, 0);
        loop {
            motion.step();
            turned += motion.contacts.statistics.escapes_turned;
            if motion.contacts.is_empty() {
                break;
            }
            assert!(motion.contacts.contacts.iter().all(|contact| contact.kind == ContactKind::Escape));
            steps += 1;
            assert!(steps < 150, "they hold one another");
        }
        assert!((1..=3 * steps).contains(&turned), "{turned}");
    }
}

/// A plate between two slabs of one body, both pressed into it by 0.1, which push against each other and do not move: where
/// that is more than half as thick as a slab they are stuck after 8 steps, else only jammed after 16.
#[test]
fn deep_contacts_that_hold_each_other_part_sooner() {
    let cuboid = |half: [f64; 3], z: f64| {
        shapes::cube(1).map(|point| std::array::from_fn(|axis| half[axis] * point[axis])).moved([0.0, 0.0, z])
    };
    // The last plate lies in the slabs' box, but that is no reason to part them while there are contacts.
    for (width, thickness, steps) in [(2.0, 0.15, 8), (2.0, 0.19, 8), (2.0, 0.21, 16), (2.0, 0.5, 16), (0.9, 0.5, 16)] {
        let plate = cuboid([width, width, 0.5], 0.0);
        let [upper, lower] =
            [1.0, -1.0].map(|side| cuboid([1.0, 1.0, 0.5 * thickness], side * (0.4 + 0.5 * thickness)));
        for bodies in [[&plate, &upper.joined(&lower)], [&upper.joined(&lower), &plate]] {
            let mut scene = Scene::<f64>::new(1).expect("no threads are needed");
            scene.set_options(DetectionOptions { sampling: Sampling::Vertices, ..DetectionOptions::default() });
            for body in bodies {
                scene.add(body.mesh());
            }
            let mut contacts = ContactList::default();
            let started = (0..20).position(|_| {
                scene.query(&mut contacts);
                scene.advance(1.0 / 60.0).expect("a length");
                contacts.statistics.escapes_started > 0
            });
            assert_eq!(started, Some(steps), "{thickness}");
        }
    }
}

/// A ball in the hole of a ring need not escape, and so is not forbidden to.
#[test]
fn nothing_is_forbidden_to_what_lies_in_a_hole() {
    let mut motion = Motion::<f64>::new(&[shapes::torus(24, 12, 0.4), shapes::sphere(1).scaled(0.3)]);
    motion.scene.allow_escape(0, 1, false).expect("both are there");
    motion.query();
    let counts = &motion.contacts.statistics;
    assert_eq!((counts.pairs, counts.escapes_forbidden, motion.contacts.len()), (1, 0, 0));
}
