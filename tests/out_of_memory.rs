//! Memory that ends: whichever allocation of whole steps fails, and whether or not memory stays short, the call says so,
//! nothing is lost, and the same call then does what it should. Of a pool's own allocations some end the process, by abort
//! and in no other way.
#![cfg(unix)]
#![allow(unsafe_code)] // an allocator that fails, and the C interface

mod common;

use common::shapes::{self, Point, Shape};
use raycontact::capi::rayc_status::{self, *};
use raycontact::capi::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::ffi::CStr;
use std::os::unix::process::ExitStatusExt;
use std::process::Command;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};

/// Counts what lives, and fails at the n-th allocation; if asked, no more memory is given from there on.
struct Failing;

static IS_ARMED: AtomicBool = AtomicBool::new(false);
static STAYS_SHORT: AtomicBool = AtomicBool::new(false);
static BEFORE: AtomicUsize = AtomicUsize::new(usize::MAX);
static LIVE: AtomicUsize = AtomicUsize::new(0);
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// How much the last call gave back, if the next one may have it.
static GIVEN_BACK: AtomicUsize = AtomicUsize::new(0);

impl Failing {
    fn refuses(&self, bytes: usize) -> bool {
        // What has just been given back is there.
        let is_there = bytes <= GIVEN_BACK.swap(0, SeqCst);
        if IS_ARMED.load(SeqCst) && !is_there {
            let count_down = |before: usize| (before != usize::MAX).then(|| before.wrapping_sub(1));
            if BEFORE.fetch_update(SeqCst, SeqCst, count_down) == Ok(0) {
                if STAYS_SHORT.load(SeqCst) {
                    LIMIT.store(LIVE.load(SeqCst), SeqCst);
                }
                return true;
            }
            if LIVE.load(SeqCst) + bytes > LIMIT.load(SeqCst) {
                return true;
            }
        }
        LIVE.fetch_add(bytes, SeqCst);
        false
    }
}

// SAFETY: all memory is the system's; null is a failure.
unsafe impl GlobalAlloc for Failing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: by the trait's contract.
        if self.refuses(layout.size()) { null_mut() } else { unsafe { System.alloc(layout) } }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), SeqCst);
        GIVEN_BACK.store(layout.size(), SeqCst);
        // SAFETY: by the trait's contract.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Failing = Failing;

/// What a run is to survive, and what it did.
struct Run {
    expected_failure: Option<usize>,
    reported: usize,
    digest: Vec<u64>,
}

impl Run {
    fn new(expected_failure: Option<usize>, stays_short: bool) -> Self {
        BEFORE.store(expected_failure.unwrap_or(usize::MAX), SeqCst);
        STAYS_SHORT.store(stays_short, SeqCst);
        Self { expected_failure, reported: 0, digest: Vec::new() }
    }

    fn has_failed(&self) -> bool {
        self.expected_failure.is_some() && BEFORE.load(SeqCst) == usize::MAX
    }

    /// A call that ends as expected, if need be after it has said once that there is no memory.
    fn call(&mut self, expected: rayc_status, mut call: impl FnMut() -> rayc_status) {
        loop {
            IS_ARMED.store(self.expected_failure.is_some(), SeqCst);
            let status = call();
            IS_ARMED.store(false, SeqCst);
            LIMIT.store(usize::MAX, SeqCst);
            if status == expected {
                return;
            }
            assert_eq!(status, RAYC_STATUS_OUT_OF_MEMORY, "allocation {:?}", self.expected_failure);
            assert!(self.has_failed() && self.reported == 0, "one failure only");
            // SAFETY: it is never NULL.
            let message = unsafe { CStr::from_ptr(rayc_last_error_message()) };
            assert!(message.to_str().expect("UTF-8").contains("no memory"));
            self.reported += 1;
        }
    }

    fn ok(&mut self, call: impl FnMut() -> rayc_status) {
        self.call(RAYC_STATUS_OK, call);
    }

    /// A handle or number that a call gives.
    fn given<V: Copy>(&mut self, nothing: V, mut call: impl FnMut(&mut V) -> rayc_status) -> V {
        let mut given = nothing;
        self.ok(|| call(&mut given));
        given
    }

    fn read(&mut self, contacts: *const rayc_contacts) -> usize {
        let mut count = 0;
        // SAFETY: the array is as long as is said, and numbers alone may be anything.
        unsafe {
            self.ok(|| rayc_contacts_count(contacts, &mut count));
            let mut all: Vec<rayc_contact> = vec![std::mem::zeroed(); count];
            self.ok(|| rayc_contacts_copy(contacts, 0, count, all.as_mut_ptr()));
            self.digest.push(count as u64);
            for contact in &all {
                self.digest.extend([contact.depth, contact.area, contact.cos_alpha].map(f64::to_bits));
                self.digest.extend([contact.p1.triangle, contact.p2.triangle].map(u64::from));
            }
        }
        count
    }
}

const F64: u32 = rayc_scalar::RAYC_SCALAR_F64 as u32;

fn vectors(points: &[Point]) -> rayc_vectors {
    rayc_vectors { data: points.as_ptr().cast(), count: points.len(), stride: 0, scalar: F64 }
}

unsafe extern "C-unwind" fn one_by_one(_: *mut libc::c_void, count: usize, task: rayc_task, data: *mut libc::c_void) {
    // SAFETY: as rayc_parallel_for says.
    (0..count).for_each(|index| unsafe { task(data, index) });
}

fn mesh(run: &mut Run, shape: &Shape) -> *mut rayc_mesh {
    let positions = vectors(&shape.positions);
    let (indices, count) = (shape.triangles.as_ptr().cast(), shape.triangles.len());
    // SAFETY: the arrays are as they say.
    run.given(null_mut(), |mesh| unsafe { rayc_mesh_create(null(), &positions, indices, count, mesh) })
}

/// Two bodies that overlap, one within another, one that overlaps itself.
fn bodies() -> [Shape; 4] {
    let folded = shapes::octahedron().joined(&shapes::octahedron().moved([0.7, 0.2, 0.1])).moved([0.0, 3.0, 0.0]);
    let small = shapes::octahedron().scaled(0.25).moved([0.1, 0.1, 0.1]);
    [shapes::octahedron(), shapes::octahedron().moved([0.9, 0.1, 0.2]), small, folded]
}

/// Handles of their own: pairs, rays, forces.
fn without_a_scene(run: &mut Run) {
    let shapes = bodies();
    let meshes = [0, 1, 3].map(|k| mesh(run, &shapes[k]));
    // SAFETY: the handles are valid, the arrays are as they say.
    unsafe {
        let octrees = meshes.map(|mesh| run.given(null_mut(), |octree| rayc_octree_create(null(), mesh, octree)));
        let contacts = run.given(null_mut(), |contacts| rayc_contacts_create(contacts));
        let mut options: rayc_detection_options = std::mem::zeroed();
        run.ok(|| rayc_default_detection_options(size_of::<rayc_detection_options>(), &mut options));
        for (sampling, value) in [
            (rayc_sampling::RAYC_SAMPLING_ACCURACY, 0.0),
            (rayc_sampling::RAYC_SAMPLING_VERTICES, 0.0),
            (rayc_sampling::RAYC_SAMPLING_SPACING, 0.5),
            (rayc_sampling::RAYC_SAMPLING_ACCURACY, 0.1),
        ] {
            (options.sampling, options.sampling_value, options.past_folds) = (sampling as u32, value, 1);
            run.ok(|| rayc_query_pair(&options, meshes[0], octrees[0], meshes[1], octrees[1], contacts));
            assert!(run.read(contacts) > 0);
        }
        let arrays = [0, 1].map(|k| vectors(&shapes[k].positions));
        let mut forces = [0, 1].map(|k| vec![[0.0f64; 3]; shapes[k].positions.len()]);
        let outputs = forces.each_mut().map(|forces| rayc_vectors_mut {
            data: forces.as_mut_ptr().cast(),
            count: forces.len(),
            stride: 0,
            scalar: F64,
        });
        run.ok(|| rayc_contacts_add_forces(contacts, null(), 2, arrays.as_ptr(), arrays.as_ptr(), outputs.as_ptr()));
        run.ok(|| rayc_contacts_add_differential(contacts, null(), 1.0, 1.0, 2, arrays.as_ptr(), outputs.as_ptr()));
        run.digest.extend(forces.iter().flatten().flatten().map(|x| x.to_bits()));
        let joules = run.given(0.0, |joules| rayc_contacts_energy(contacts, null(), 2, arrays.as_ptr(), joules));
        run.digest.push(joules.to_bits());
        run.ok(|| rayc_query_self(null(), meshes[2], octrees[2], contacts));
        assert!(run.read(contacts) > 0);
        let moved = shapes[1].moved([0.01, 0.0, 0.0]).positions;
        run.ok(|| rayc_mesh_set_positions(meshes[1], &vectors(&moved)));
        run.call(RAYC_STATUS_OCTREE_STALE, || {
            rayc_query_pair(null(), meshes[0], octrees[0], meshes[1], octrees[1], contacts)
        });
        run.ok(|| rayc_octree_update(octrees[1], meshes[1]));
        run.call(RAYC_STATUS_MESH_OPEN, || {
            let positions = vectors(&shapes[0].positions);
            rayc_mesh_create(null(), &positions, shapes[0].triangles.as_ptr().cast(), 3, &mut null_mut())
        });
        octrees.into_iter().for_each(|octree| run.ok(|| rayc_octree_destroy(octree)));
        meshes.into_iter().for_each(|mesh| run.ok(|| rayc_mesh_destroy(mesh)));
        run.ok(|| rayc_contacts_destroy(contacts));
    }
}

/// Two bodies whose rays are worth sharing among threads.
fn large_bodies() -> [Shape; 2] {
    let torus = shapes::torus(32, 24, 0.4);
    [torus.moved([9.0, 0.0, 0.0]), torus.moved([9.1, 0.0, 0.0])]
}

/// Steps of a scene, in which bodies move, escape, overlap themselves, are left out, saved, removed and added again, and
/// `more` bodies are there.
fn steps(run: &mut Run, scene: *mut rayc_scene, more: &[Shape]) {
    let shapes = bodies();
    // SAFETY: the handles are valid, the arrays are as they say.
    unsafe {
        let contacts = run.given(null_mut(), |contacts| rayc_contacts_create(contacts));
        let meshes = shapes.each_ref().map(|shape| mesh(run, shape));
        let numbers = meshes.map(|mesh| run.given(u32::MAX, |body| rayc_scene_add_mesh(scene, mesh, body)));
        assert_eq!(numbers, [0, 1, 2, 3]);
        for shape in more {
            let mesh = mesh(run, shape);
            run.given(u32::MAX, |body| rayc_scene_add_mesh(scene, mesh, body));
            run.ok(|| rayc_mesh_destroy(mesh));
        }
        let mut options: rayc_detection_options = std::mem::zeroed();
        run.ok(|| rayc_default_detection_options(size_of::<rayc_detection_options>(), &mut options));
        // Few rays, so that there is time for many steps.
        options.sampling = rayc_sampling::RAYC_SAMPLING_VERTICES as u32;
        run.ok(|| rayc_scene_set_detection_options(scene, &options));
        run.ok(|| rayc_scene_set_self_collision(scene, 3, 1));
        run.ok(|| rayc_scene_allow_escape(scene, 0, 1, 0));
        let mut total = 0;
        for step in 0..6 {
            let shift = 0.02 * f64::from(step);
            let positions = shapes[3].map(|[x, y, z]| [x * (1.0 - shift), y, z]).positions;
            run.ok(|| rayc_scene_set_positions(scene, 3, &vectors(&positions)));
            let positions = shapes[1].moved([-shift, 0.0, 0.0]).positions;
            run.ok(|| rayc_scene_set_positions(scene, 1, &vectors(&positions)));
            if step == 3 {
                run.ok(|| rayc_scene_set_pair_collision(scene, 1, 2, 0));
                run.ok(|| rayc_scene_remove_body(scene, 0));
                run.ok(|| rayc_scene_add_mesh(scene, meshes[0], &mut 0));
                let length = run.given(0, |length| rayc_scene_saved_length(scene, length));
                let mut saved = vec![0; length];
                run.ok(|| rayc_scene_save_pair_memories(scene, length, saved.as_mut_ptr()));
                run.ok(|| rayc_scene_restore_pair_memories(scene, length, saved.as_ptr()));
            }
            run.ok(|| rayc_scene_query(scene, contacts));
            total += run.read(contacts);
        }
        assert!(total > 20, "{total}");
        let count = run.given(0, |count| rayc_scene_pair_memory_count(scene, count));
        let mut memories: Vec<rayc_pair_memory> = vec![std::mem::zeroed(); count];
        let size = size_of::<rayc_pair_memory>();
        run.ok(|| rayc_scene_copy_pair_memories(scene, 0, count, size, memories.as_mut_ptr()));
        assert!(memories.iter().any(|memory| memory.escaping == 1), "the small body is on its way out");
        run.digest.extend(memories.iter().flat_map(|memory| memory.state.map(u64::from)));
        meshes.into_iter().for_each(|mesh| run.ok(|| rayc_mesh_destroy(mesh)));
        run.ok(|| rayc_contacts_destroy(contacts));
        run.ok(|| rayc_scene_destroy(scene));
    }
}

/// A scene and a contact system of two bodies whose vertices are nodes and a rigid one; with the nodes' positions, the rigid
/// body's number, and the bodies' material.
fn bodies_in_contact(run: &mut Run) -> (*mut rayc_scene, *mut rayc_contact_system, Vec<f64>, u32, rayc_material) {
    let shapes = bodies();
    let scene = scene(run, 1, None);
    // SAFETY: the handles are valid, the arrays are as they say.
    unsafe {
        let numbers = [&shapes[0], &shapes[1], &shapes[0]].map(|shape| {
            let mesh = mesh(run, shape);
            let number = run.given(u32::MAX, |body| rayc_scene_add_mesh(scene, mesh, body));
            run.ok(|| rayc_mesh_destroy(mesh));
            number
        });
        let mut options: rayc_detection_options = std::mem::zeroed();
        run.ok(|| rayc_default_detection_options(size_of::<rayc_detection_options>(), &mut options));
        // Few rays, so that there is time for each allocation.
        options.sampling = rayc_sampling::RAYC_SAMPLING_VERTICES as u32;
        run.ok(|| rayc_scene_set_detection_options(scene, &options));
        let system = run.given(null_mut(), |system| rayc_contact_system_create(null(), system));
        let each = shapes[0].positions.len();
        let masses = vec![1.0; 2 * each];
        run.ok(|| rayc_contact_system_set_node_masses(system, 2 * each, masses.as_ptr()));
        let mut material: rayc_material = std::mem::zeroed();
        run.ok(|| rayc_bearing_material(1e4, 0.1, size_of::<rayc_material>(), &mut material));
        material.friction = 0.5;
        for (body, first) in numbers.into_iter().zip([0, each as u32]) {
            let (none, nodes) = (null(), each as u32);
            run.ok(|| {
                rayc_contact_system_add_deformable(system, scene, body, first, nodes, none, 0, none, null(), &material)
            });
        }
        let inertia = [0.1, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1];
        run.ok(|| rayc_contact_system_add_rigid(system, scene, numbers[2], 5.0, inertia.as_ptr(), &material));
        let positions = [0, 1].map(|k| shapes[k].positions.as_flattened().to_vec()).concat();
        (scene, system, positions, numbers[2], material)
    }
}

/// Its steps, over a floor.
fn contact_system(run: &mut Run) {
    let (scene, system, mut positions, rigid, material) = bodies_in_contact(run);
    let count = positions.len();
    // SAFETY: the handles are valid, the arrays are as they say.
    unsafe {
        let turned = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let motion = rayc_motion {
            position: [0.0, 0.3, 1.1],
            rotation: turned,
            velocity: [0.0, 0.0, -1.0, 0.0, 0.0, 0.0],
            free_velocity: [0.0, 0.0, -1.0, 0.1, 0.0, 0.0],
        };
        run.ok(|| rayc_contact_system_add_half_space(system, [0.0, 0.0, 1.0].as_ptr(), -0.9, &material));
        let mut velocities = vec![0.0; count];
        for _ in 0..2 {
            let free: Vec<f64> = velocities.iter().enumerate().map(|(k, v)| v - 0.1 * f64::from(k % 3 == 2)).collect();
            let [at, v, ahead] = [positions.as_ptr(), velocities.as_ptr(), free.as_ptr()];
            run.ok(|| rayc_contact_system_set_motion(system, rigid, &motion));
            run.ok(|| rayc_contact_system_begin(system, scene, 0.01, count, at, v, ahead));
            let [mut forces, mut product] = [0, 1].map(|_| vec![0.0; count]);
            run.ok(|| rayc_contact_system_add_forces(system, count, ahead, forces.as_mut_ptr()));
            run.ok(|| rayc_contact_system_add_product(system, 0.01, count, ahead, product.as_mut_ptr()));
            let new: Vec<f64> = (0..count).map(|k| free[k] + 1e-3 * (forces[k] - product[k])).collect();
            run.given(0.0, |change| rayc_contact_system_linearise(system, count, new.as_ptr(), change));
            run.ok(|| rayc_contact_system_add_product(system, 0.01, count, new.as_ptr(), product.as_mut_ptr()));
            let energy = run.given(0.0, |joules| rayc_contact_system_energy(system, count, new.as_ptr(), joules));
            let at = new.as_ptr();
            let potential =
                run.given(0.0, |joules| rayc_contact_system_potential(system, scene, count, at, 1.0, joules));
            run.ok(|| rayc_contact_system_add_product(system, 0.01, count, at, product.as_mut_ptr()));
            run.digest.extend([energy.to_bits(), potential.to_bits()]);
            run.ok(|| rayc_contact_system_finish(system, count, new.as_ptr()));
            assert!(forces.iter().chain(&product).any(|x| *x != 0.0));
            run.digest.extend(forces.iter().chain(&product).map(|x| x.to_bits()));
            positions.iter_mut().zip(&new).for_each(|(x, v)| *x += 0.01 * v);
            velocities = new;
        }
        run.ok(|| rayc_contact_system_destroy(system));
        run.ok(|| rayc_scene_destroy(scene));
    }
}

/// A second detection for which memory ends while it looks cancels the step, since only some of its rows may be there; before, it
/// can be made again. Gives whether memory ended.
fn second_detection(n: usize) -> bool {
    let mut run = Run::new(None, false);
    let (scene, system, mut positions, rigid, _) = bodies_in_contact(&mut run);
    let count = positions.len();
    positions[count / 2..].iter_mut().for_each(|x| *x += 10.0);
    let velocities = vec![0.0; count];
    let together: Vec<f64> = (0..count).map(|k| if k < count / 2 { 0.0 } else { -1000.0 }).collect();
    let turned = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let motion = rayc_motion { position: [-9.0; 3], rotation: turned, velocity: [0.0; 6], free_velocity: [0.0; 6] };
    // SAFETY: the handles are valid, the arrays are as they say.
    unsafe {
        run.ok(|| rayc_contact_system_set_motion(system, rigid, &motion));
        let [at, v] = [positions.as_ptr(), velocities.as_ptr()];
        run.ok(|| rayc_contact_system_begin(system, scene, 0.01, count, at, v, v));
        BEFORE.store(n, SeqCst);
        IS_ARMED.store(true, SeqCst);
        let mut is_more = 0;
        let mut look = || rayc_contact_system_detect_again(system, scene, count, together.as_ptr(), &mut is_more);
        let mut status = look();
        IS_ARMED.store(false, SeqCst);
        let has_failed = status == RAYC_STATUS_OUT_OF_MEMORY;
        if has_failed {
            status = look();
        }
        let is_cancelled = has_failed && status == RAYC_STATUS_OUT_OF_ORDER;
        assert!(is_cancelled || (status == RAYC_STATUS_OK && is_more == 1), "allocation {n}: {status:?}, {is_more}");
        run.call(status, || rayc_contact_system_finish(system, count, together.as_ptr()));
        run.ok(|| rayc_contact_system_destroy(system));
        run.ok(|| rayc_scene_destroy(scene));
        has_failed
    }
}

fn scene(run: &mut Run, threads: u32, host: rayc_parallel_for) -> *mut rayc_scene {
    // SAFETY: the places are writable.
    unsafe {
        let mut options = std::mem::zeroed();
        run.ok(|| rayc_default_scene_options(size_of::<rayc_scene_options>(), &mut options));
        (options.threads, options.parallel_for) = (threads, host);
        run.given(null_mut(), |scene| rayc_scene_create(&options, scene))
    }
}

fn on_one_thread(run: &mut Run) {
    without_a_scene(run);
    let scene = scene(run, 1, None);
    steps(run, scene, &[]);
}

/// The pointer by which a scene knows its host is one of the standard library's, which cannot say that there is no memory.
fn on_host_threads(run: &mut Run) {
    let scene = scene(&mut Run { expected_failure: None, reported: 0, digest: Vec::new() }, 1, Some(one_by_one));
    steps(run, scene, &large_bodies());
}

fn on_a_pool(run: &mut Run) {
    let scene = scene(run, 2, None);
    steps(run, scene, &large_bodies());
}

/// Each allocation of the work fails once; gives how many there are. The thread is a new one each time.
fn every_allocation(work: fn(&mut Run), stays_short: bool) -> usize {
    let run = |failing: Option<usize>| {
        let own = move || {
            let mut run = Run::new(failing, stays_short);
            work(&mut run);
            let has_failed = run.has_failed();
            BEFORE.store(usize::MAX, SeqCst);
            (run, has_failed)
        };
        std::thread::spawn(own).join().expect("no panic passes")
    };
    let (undisturbed, _) = run(None);
    let mut n = 0;
    loop {
        // What is left is left each time. The threads of the test harness also allocate, but now and then.
        let has_failed = (0..3).find_map(|_| {
            let before = LIVE.load(SeqCst);
            let (disturbed, has_failed) = run(Some(n));
            assert_eq!(disturbed.digest, undisturbed.digest, "allocation {n}");
            drop(disturbed);
            (LIVE.load(SeqCst) == before).then_some(has_failed)
        });
        if !has_failed.unwrap_or_else(|| panic!("allocation {n}: something is left")) {
            return n;
        }
        n += common::STRIDE;
    }
}

#[test]
fn any_failing_allocation_is_reported_and_the_call_can_be_made_again() {
    if let Ok(n) = std::env::var(CHILD) {
        child(n.parse().expect("a number"));
    }
    let count = (0..).take_while(|&n| second_detection(n)).count();
    println!("a second detection: each of {count} allocations failed; none was silent");
    assert!(count > 10, "{count}");
    let works: [(_, fn(&mut Run)); 3] =
        [("one thread", on_one_thread), ("the host's threads", on_host_threads), ("a contact system", contact_system)];
    for (name, work) in works {
        for stays_short in [false, true] {
            let count = every_allocation(work, stays_short);
            let then = if stays_short { "and all after it" } else { "alone" };
            println!("{name}: each of {count} allocations failed {then}; every one reported");
            assert!(count > 200, "{count}");
        }
    }
    pool();
}

const CHILD: &str = "RAYCONTACT_TEST_FAILING_ALLOCATION";
const NONE_FAILED: i32 = 10;
const REPORTED: i32 = 11;
/// Processes take long: of a pool's allocations only some fail.
const POOL_STRIDE: usize = 16;

/// In a process of its own.
fn child(n: usize) {
    let mut run = Run::new(Some(n), false);
    on_a_pool(&mut run);
    std::process::exit(if run.has_failed() { REPORTED } else { NONE_FAILED });
}

fn pool() {
    let program = std::env::current_exe().expect("the test knows itself");
    let (mut reported, mut aborted, mut n) = (0, 0, 0);
    loop {
        let output = Command::new(&program).env(CHILD, n.to_string()).output().expect("the test starts itself");
        match (output.status.code(), output.status.signal()) {
            (Some(NONE_FAILED), _) => break,
            (Some(REPORTED), _) => reported += 1,
            (_, Some(libc::SIGABRT)) => aborted += 1,
            _ => panic!("allocation {n}: {output:?}"),
        }
        n += POOL_STRIDE * common::STRIDE;
    }
    println!("a pool of two: {n} allocations, of those tried {reported} reported, {aborted} ended the process");
    assert!(reported > 0);
}
