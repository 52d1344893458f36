//! Fault 7 of the method's original code: its cells were allocated and freed every step.

mod common;

use allocation_counter::measure;
use common::c::RAYC_STATUS_OK;
use common::shapes::{self, Shape};
use raycontact::capi::*;
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::Pose;
use raycontact::own_exits::OwnExits;
use raycontact::query::{Layout, Octree};
use raycontact::scene::Scene;
use raycontact::system::{Carriers, ContactSystem, Material, Motion, RigidUnknowns};
use raycontact::threads::ParallelFor;
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The torus after some steps of a motion that comes back to where it was.
fn moved(torus: &Shape, step: usize) -> Vec<[f64; 3]> {
    let turn = [0.0, 0.1, 0.2, 0.1][step % 4];
    torus.turned(turn, 0.5 * turn).positions
}

#[test]
fn a_steady_step_allocates_nothing() {
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let mut a = shapes::torus(16, 8, 0.4).mesh::<f64>();
        let b = shapes::torus(16, 8, 0.4).turned(0.4, 0.9).moved([0.25, 0.1, 0.3]).mesh::<f64>();
        let (mut octree_a, octree_b) = (Octree::with_layout(&a, layout), Octree::with_layout(&b, layout));
        let with = |sampling| DetectionOptions { sampling, ..DetectionOptions::default() };
        let triangles = [DetectionOptions::paper(), DetectionOptions::default()].map(|options| (options, false));
        let patches = [Sampling::Spacing(0.6), Sampling::Accuracy(0.5)].map(|sampling| (with(sampling), true));
        for (options, has_patches) in triangles.into_iter().chain(patches) {
            let mut contacts = ContactList::default();
            for step in 0..12 {
                let positions = moved(&shapes::torus(16, 8, 0.4), step);
                let allocations = measure(|| {
                    a.set_positions(&positions).expect("positions are finite");
                    octree_a.update(&a).expect("the octree is the mesh's own");
                    query_pair(&a, &octree_a, &b, &octree_b, &options, &mut contacts).expect("the octrees are fresh");
                });
                // The first round of the motion finds out how much memory it needs.
                assert!(
                    step < 4 || allocations.count_total == 0,
                    "{layout:?}, {options:?}, step {step}: {allocations:?}"
                );
            }
            assert!(!contacts.is_empty());
            assert_eq!(contacts.statistics.patches > 0, has_patches);
        }
    }
}

/// Neighbours, and points that are none.
#[test]
fn asking_for_closest_points_again_allocates_nothing() {
    let mesh = shapes::torus(32, 16, 0.4).mesh::<f64>();
    let mut points: Vec<_> = mesh.positions().iter().map(|position| position * 0.95).collect();
    points.extend(mesh.positions().iter().step_by(37).map(|position| position * 1e9));
    let bounds = vec![f64::INFINITY; points.len()];
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let mut found = Vec::new();
        tracer.closest_points(&points, &bounds, &mut found);
        let allocations = measure(|| tracer.closest_points(&points, &bounds, &mut found));
        assert_eq!(allocations.count_total, 0, "{layout:?}: {allocations:?}");
        assert_eq!(found.iter().flatten().count(), points.len());
    }
}

#[test]
fn asking_for_own_exits_again_allocates_nothing() {
    let a = shapes::torus(32, 16, 0.4);
    let mut mesh = a.joined(&a.turned(0.4, 0.9).moved([0.25, 0.1, 0.3])).mesh::<f64>();
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let (mut octree, mut own_exits) = (Octree::with_layout(&mesh, layout), OwnExits::default());
        for step in 0..12 {
            let other = a.turned(0.4, 0.9 + 0.1 * f64::from(step % 3)).moved([0.25, 0.1, 0.3]);
            let positions = a.joined(&other).positions;
            let allocations = measure(|| {
                mesh.set_positions(&positions).expect("positions are finite");
                octree.update(&mesh).expect("the octree is the mesh's own");
                assert!(!own_exits.find(&mesh, &octree).expect("the octree is fresh").is_empty());
            });
            assert!(step < 3 || allocations.count_total == 0, "{layout:?}, step {step}: {allocations:?}");
        }
    }
}

/// A host that has one thread only, where allocations are counted, and how often it was called.
#[derive(Default)]
struct OneThread(AtomicUsize);

impl ParallelFor for OneThread {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        self.0.fetch_add(1, Ordering::Relaxed);
        (0..count).for_each(task);
    }
}

#[test]
fn a_steady_step_of_a_scene_allocates_nothing() {
    check_steady_steps(Scene::new(1).expect("no thread is started"), 3, &shapes::torus(16, 8, 0.4));
}

#[test]
fn a_steady_step_on_threads_of_the_host_allocates_nothing() {
    for bodies in [3, 12] {
        let host = Arc::new(OneThread::default());
        // Fine enough to be shared.
        check_steady_steps(Scene::with_host_threads(host.clone()), bodies, &shapes::torus(64, 32, 0.4));
        assert!(host.0.load(Ordering::Relaxed) > 12, "the host is asked in each step");
    }
}

/// Where each step asks anew whether the pair must escape.
#[test]
fn a_steady_step_of_a_body_on_its_spikes_allocates_nothing() {
    let mut scene = Scene::new(1).expect("no thread is started");
    scene.add(shapes::cube(1).map(|[x, y, z]| [5.0 * x, 5.0 * y, z - 1.0]).mesh::<f64>());
    let (spikes, mut contacts) = (shapes::spikes(0.12), ContactList::default());
    let body = scene.add(spikes.mesh());
    for step in 0..40 {
        let positions = spikes.moved([0.0, 0.0, [-0.02, -0.021][step % 2]]).positions;
        let allocations = measure(|| {
            scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("positions are finite");
            scene.query(&mut contacts);
        });
        assert!(step < 4 || allocations.count_total == 0, "step {step}: {allocations:?}");
        assert!(contacts.statistics.escaping_pairs == 0 && contacts.statistics.estimate_rays > 0, "step {step}");
    }
}

fn check_steady_steps(mut scene: Scene<f64>, bodies: usize, torus: &Shape) {
    for k in 0..bodies {
        scene.add(torus.moved([0.0, 0.1, 0.6 * k as f64]).mesh());
    }
    let mut contacts = ContactList::default();
    for step in 0..12 {
        let positions = moved(torus, step);
        let allocations = measure(|| {
            scene.mesh_mut(0).expect("body 0 is there").set_positions(&positions).expect("positions are finite");
            scene.query(&mut contacts);
        });
        assert!(step < 4 || allocations.count_total == 0, "step {step}: {allocations:?}");
    }
    assert!(!contacts.is_empty());
}

/// Moved by poses, and by positions in between.
#[test]
fn a_steady_step_of_rigid_bodies_allocates_nothing() {
    let torus = shapes::torus(64, 32, 0.4);
    let mut scene = Scene::new(1).expect("no thread is started");
    for k in 0..3 {
        scene.add(torus.moved([0.0, 0.1, 0.6 * f64::from(k)]).mesh());
    }
    let mut contacts = ContactList::default();
    for step in 0..24 {
        let (sin, cos) = [0.0_f64, 0.1, 0.2, 0.1][step % 4].sin_cos();
        let rotation = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let pose = Pose { position: [0.1 * sin, 0.0, 0.0], rotation };
        let positions = moved(&torus, step);
        let allocations = measure(|| {
            scene.set_pose(0, &pose).expect("it is a pose");
            if step % 8 == 7 {
                scene.mesh_mut(1).expect("body 1 is there").set_positions(&positions).expect("positions are finite");
            } else {
                scene.set_pose(1, &pose).expect("it is a pose");
            }
            scene.query(&mut contacts);
        });
        assert!(step < 9 || allocations.count_total == 0, "step {step}: {allocations:?}");
    }
    assert!(!contacts.is_empty());
}

/// A body that touches nothing of itself, and remembers it, and one that does.
#[test]
fn a_steady_step_with_self_collision_allocates_nothing() {
    let torus = shapes::torus(16, 8, 0.4);
    for (shape, touches) in [(torus.clone(), false), (torus.joined(&shapes::sphere(1).moved([1.0, 0.9, 0.0])), true)] {
        let mut scene = Scene::new(1).expect("no thread is started");
        let body = scene.add(shape.mesh::<f64>());
        scene.set_self_collision(body, true).expect("it was added");
        let mut contacts = ContactList::default();
        for step in 0..80 {
            let positions = shape.turned(0.01 * (step % 4) as f64, 0.0).positions;
            let allocations = measure(|| {
                scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("positions are finite");
                scene.query(&mut contacts);
            });
            // What is remembered is looked for at first, and again after a pause.
            assert!(step < 40 || allocations.count_total == 0, "touches: {touches}, step {step}: {allocations:?}");
        }
        assert_eq!(contacts.is_empty(), !touches);
    }
}

/// What an integrator asks of the C interface once per iteration, with the arrays of many bodies.
#[test]
#[allow(unsafe_code)] // the C interface
fn forces_and_differential_allocate_nothing() {
    let torus = shapes::torus(16, 8, 0.4);
    let mut scene = common::c::Scene::new(64, 1).expect("no thread is started");
    let positions: Vec<_> = (0..20).map(|k| torus.moved([0.0, 0.1, 0.6 * f64::from(k)]).positions).collect();
    for positions in &positions {
        let mesh = common::c::Mesh::new(64, false, &common::c::vectors(positions), &torus.triangles).expect("closed");
        scene.add(&mesh).expect("the same precision");
    }
    let mut contacts = common::c::Contacts::new();
    assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
    assert!(!contacts.all().is_empty());

    let scalar = rayc_scalar::RAYC_SCALAR_F64 as u32;
    let mut forces = vec![vec![[0.0f64; 3]; torus.positions.len()]; positions.len()];
    let mut array = |forces: &mut Vec<[f64; 3]>| rayc_vectors_mut {
        data: forces.as_mut_ptr().cast(),
        count: forces.len(),
        stride: 0,
        scalar,
    };
    let out: Vec<_> = forces.iter_mut().map(&mut array).collect();
    let given: Vec<_> = positions.iter().map(|positions| common::c::vectors(positions)).collect();
    let [zeros, mut wrenches] = [(); 2].map(|()| vec![0.0; 6 * given.len()]);
    for step in 0..3 {
        let allocations = measure(|| {
            let (mut joules, options, count, read) = (0.0, null(), out.len(), given.as_ptr());
            let still = zeros.as_ptr();
            // SAFETY: the arrays are as they say.
            let statuses = unsafe {
                [
                    rayc_contacts_add_forces(contacts.0, options, count, read, read, out.as_ptr()),
                    rayc_contacts_add_differential(contacts.0, options, 1.0, 1.0, count, read, out.as_ptr()),
                    rayc_scene_add_differential(scene.0, contacts.0, options, 1.0, 1.0, count, read, out.as_ptr()),
                    rayc_contacts_energy(contacts.0, options, count, read, &mut joules),
                    rayc_contacts_add_wrenches(contacts.0, options, count, still, still, wrenches.as_mut_ptr()),
                ]
            };
            assert_eq!(statuses, [RAYC_STATUS_OK; 5]);
        });
        // The first call keeps the memory in reserve by which the thread could say that there is none.
        assert!(step < 1 || allocations.count_total == 0, "step {step}: {allocations:?}");
    }
}

/// All that a solver asks of a step, of nodes, a rigid body and a floor, with friction.
#[test]
fn a_steady_step_of_a_contact_system_allocates_nothing() {
    for rigid_unknowns in [RigidUnknowns::Eliminated, RigidUnknowns::Kept] {
        check_steady_steps_of_a_system(rigid_unknowns);
    }
}

fn check_steady_steps_of_a_system(rigid_unknowns: RigidUnknowns) {
    let (torus, mut scene) = (shapes::torus(16, 8, 0.4), Scene::<f64>::new(1).expect("no thread is started"));
    let mut system = ContactSystem::new(rigid_unknowns);
    let material = Material { stiffness: 1e3, damping_time: 0.01, friction: 0.5, depth_cap: 0.01, restitution: 0.0 };
    let count = torus.positions.len() as u32;
    system.set_node_masses(&vec![0.1; 2 * count as usize]).expect("masses");
    for body in 0..2 {
        scene.add(torus.mesh());
        let nodes = body * count..(body + 1) * count;
        system.add_deformable(&scene, body, nodes, Carriers::Nodes, material).expect("a body");
    }
    let rigid = scene.add(shapes::cube(2).mesh());
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    system.add_rigid(&scene, rigid, 1.0, unit, material).expect("a body");
    system.add_half_space([0.0, 0.0, 1.0], -0.3, material).expect("a floor");
    let (mut forces, mut wrong, mut joules) = (vec![0.0; system.unknown_count()], 0.0, 0.0);
    for step in 0..16 {
        let ends = [moved(&torus, step), torus.moved([0.1, 0.2, 0.6]).positions].concat();
        let positions: Vec<f64> = ends.into_iter().flatten().collect();
        let fall = if step % 4 < 2 { -2.0 } else { 2.0 };
        let velocities: Vec<f64> = (0..positions.len()).map(|k| if k % 3 == 2 { fall } else { 0.3 }).collect();
        let still = vec![0.0; system.unknown_count()];
        let change: Vec<f64> = (0..still.len()).map(|k| (k as f64).sin()).collect();
        let velocity = [0.0, 0.0, fall, 0.0, 0.0, 0.0];
        let motion = Motion { position: [0.0, 0.0, 1.6], rotation: unit, velocity, free_velocity: velocity };
        let allocations = measure(|| {
            system.set_motion(rigid, &motion).expect("it is rigid");
            system.begin(&mut scene, 0.02, &positions, &velocities, &velocities).expect("a step");
            system.add_forces(&still, &mut forces).expect("a step is under way");
            system.add_product(0.02, &change, &mut forces).expect("a step is under way");
            if rigid_unknowns == RigidUnknowns::Kept {
                let matrix = system.compressed_rows(0.02).expect("a step is under way");
                assert!(matrix.values.len() > 100);
            }
            wrong += system.linearise(&still).expect("a step is under way");
            system.detect_again(&mut scene, &still).expect("a step is under way");
            joules += system.potential(&mut scene, &still, 0.5).expect("a step is under way");
            system.finish(&still).expect("a step is under way");
        });
        assert!(step < 8 || allocations.count_total == 0, "step {step}: {allocations:?}");
    }
    assert!(!system.contacts().is_empty() && forces.iter().any(|&force| force != 0.0) && wrong > 0.0);
    assert!(joules > 0.0);
}

/// Scenes in one call, and floats in place of doubles.
#[test]
#[allow(unsafe_code)] // the C interface
fn a_steady_step_in_floats_or_of_many_scenes_allocates_nothing() {
    let (torus, masses) = (shapes::torus(16, 8, 0.4), [0.1; 256]);
    let count = torus.positions.len();
    let mut scenes: Vec<_> = (0..3).map(|_| common::c::Scene::new(64, 1).expect("no thread is started")).collect();
    let mesh =
        common::c::Mesh::new(64, false, &common::c::vectors(&torus.positions), &torus.triangles).expect("closed");
    let material = rayc_material {
        struct_size: size_of::<rayc_material>(),
        stiffness: 1e3,
        damping_time: 0.01,
        friction: 0.5,
        depth_cap: 0.01,
        restitution: 0.0,
    };
    let systems: Vec<_> =
        scenes.iter_mut().map(|scene| system_of_two(scene, &mesh, &masses[..2 * count], &material)).collect();
    let handles: Vec<_> = scenes.iter().map(|scene| scene.0).collect();
    let mut statuses = [0; 3];
    let (numbers, mut sums) = (6 * count, vec![0.0_f32; 6 * count]);
    for step in 0..16 {
        let ends = [moved(&torus, step), torus.moved([0.1, 0.2, 0.6]).positions].concat();
        let positions: Vec<f64> = ends.into_iter().flatten().collect();
        let (each, velocities) = (positions.repeat(3), vec![0.1_f32; numbers]);
        let doubles = vec![0.1; each.len()];
        let single: Vec<f32> = positions.iter().map(|&x| x as f32).collect();
        let allocations = measure(|| {
            let (scenes, begun) = (handles.as_ptr(), systems.as_ptr());
            let (x, v) = (each.as_ptr(), doubles.as_ptr());
            let (mut wrong, mut is_more) = (0.0, [0; 3]);
            // SAFETY: the arrays are as they say.
            let found = unsafe {
                let places = statuses.as_mut_ptr();
                let begin = rayc_contact_systems_begin(3, begun, scenes, 0.02, numbers, x, v, v, places);
                let again =
                    rayc_contact_systems_detect_again(3, begun, scenes, numbers, v, is_more.as_mut_ptr(), places);
                let of_first = [
                    rayc_contact_system_add_forces_f32(systems[0], numbers, velocities.as_ptr(), sums.as_mut_ptr()),
                    rayc_contact_system_linearise_f32(systems[0], numbers, velocities.as_ptr(), &mut wrong),
                ];
                let finish =
                    systems.iter().map(|&system| rayc_contact_system_finish_f32(system, numbers, velocities.as_ptr()));
                let is_done = finish.chain(of_first).all(|status| status == RAYC_STATUS_OK);
                let (v, free) = (velocities.as_ptr(), velocities.as_ptr());
                let in_floats =
                    rayc_contact_system_begin_f32(systems[0], handles[0], 0.02, numbers, single.as_ptr(), v, free);
                [begin, again, in_floats, rayc_contact_system_finish_f32(systems[0], numbers, v)]
                    .map(|status| status == RAYC_STATUS_OK && is_done)
            };
            assert_eq!(found, [true; 4]);
        });
        assert!(step < 8 || allocations.count_total == 0, "step {step}: {allocations:?}");
    }
    assert!(sums.iter().any(|&sum| sum != 0.0) && statuses == [0; 3]);
    for system in systems {
        // SAFETY: it is not used again.
        assert_eq!(unsafe { rayc_contact_system_destroy(system) }, RAYC_STATUS_OK);
    }
}

/// Two bodies of the mesh, whose vertices are nodes.
#[allow(unsafe_code)] // the C interface
fn system_of_two(
    scene: &mut common::c::Scene,
    mesh: &common::c::Mesh,
    masses: &[f64],
    material: &rayc_material,
) -> *mut rayc_contact_system {
    let (mut system, count) = (null_mut(), masses.len() as u32 / 2);
    // SAFETY: the arrays are as they say.
    unsafe {
        assert_eq!(rayc_contact_system_create(null(), &mut system), RAYC_STATUS_OK);
        assert_eq!(rayc_contact_system_set_node_masses(system, masses.len(), masses.as_ptr()), RAYC_STATUS_OK);
        for body in 0..2 {
            assert_eq!(scene.add(mesh), Ok(body));
            let first = body * count;
            let (none, no_weights) = (null(), null());
            let added = rayc_contact_system_add_deformable(
                system, scene.0, body, first, count, none, 0, none, no_weights, material,
            );
            assert_eq!(added, RAYC_STATUS_OK);
        }
    }
    system
}

/// A body in a scene, in single precision, in contact with another by rays from all vertices.
#[test]
fn a_triangle_takes_at_most_160_bytes() {
    let mut contacts = ContactList::default();
    let mut triangles = 0;
    let mut scene = None;
    let allocations = measure(|| {
        let mut filled = Scene::<f32>::new(1).expect("no thread is started");
        filled.set_options(DetectionOptions::paper());
        for k in 0..2 {
            let mesh = shapes::torus(160, 80, 0.4).moved([0.0, 0.1, 0.6 * f64::from(k)]).mesh();
            triangles += mesh.topology().triangles().len();
            filled.add(mesh);
        }
        filled.query(&mut contacts);
        scene = Some(filled);
    });
    assert!(contacts.len() > 1000);
    let contacts = size_of_val(contacts.contacts.as_slice()) as i64;
    let bytes = allocations.bytes_current - contacts;
    assert!(bytes <= 160 * triangles as i64, "{} bytes", bytes as f64 / triangles as f64);
}
