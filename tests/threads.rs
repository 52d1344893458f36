//! Whose threads work makes no difference to what is found, and none of them outlives its scene.

mod common;

use common::shapes;
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::scene::Scene;
use raycontact::system::{Carriers, ContactSystem, Material, RigidUnknowns};
use raycontact::threads::ParallelFor;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A host with threads that start for each call and take turns; it cannot nest.
#[derive(Default)]
struct Host {
    busy: AtomicBool,
    calls: AtomicUsize,
    /// So many of the last numbers of each call are left out, and so many called twice.
    left_out: usize,
    twice: usize,
}

impl ParallelFor for Host {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        assert!(!self.busy.swap(true, Ordering::SeqCst), "called from within one of its own calls");
        self.calls.fetch_add(1, Ordering::SeqCst);
        std::thread::scope(|scope| {
            for thread in 0..3 {
                scope.spawn(move || (thread..count - self.left_out.min(count)).step_by(3).rev().for_each(task));
            }
        });
        (0..self.twice.min(count)).for_each(task);
        self.busy.store(false, Ordering::SeqCst);
    }
}

/// Tori in a row, each overlapping its neighbours; `fine` ones cast their rays in several chunks.
fn contacts_in(scene: &mut Scene<f64>, bodies: usize, fine: bool) -> ContactList<f64> {
    let torus = if fine { shapes::torus(64, 32, 0.4) } else { shapes::torus(12, 8, 0.4) };
    for k in 0..bodies {
        let k = k as f64;
        scene.add(torus.turned(0.3 * k, 0.2 * k).moved([0.1 * k, 0.05 * k, 0.6 * k]).mesh());
    }
    let mut contacts = ContactList::default();
    scene.query(&mut contacts);
    contacts
}

#[test]
fn results_do_not_depend_on_whose_threads_work() {
    for (bodies, fine) in [(2, true), (3, true), (12, false)] {
        let expected = contacts_in(&mut Scene::new(1).expect("no thread is started"), bodies, fine);
        assert!(expected.len() > 10 * bodies, "the tori overlap");
        for threads in [2, 5, 0] {
            let mut scene = Scene::new(threads).expect("the threads start");
            assert_eq!(contacts_in(&mut scene, bodies, fine), expected, "{bodies} bodies, {threads} threads");
        }
        let host = Arc::new(Host::default());
        let mut scene = Scene::with_host_threads(host.clone());
        assert_eq!(contacts_in(&mut scene, bodies, fine), expected, "{bodies} bodies, the host's threads");
        assert!(host.calls.load(Ordering::SeqCst) > 1, "the host was asked");
    }
}

/// A host's mistake in counting costs nothing but time.
#[test]
fn every_item_is_worked_on_once_whatever_the_host_calls() {
    let expected = contacts_in(&mut Scene::new(1).expect("no thread is started"), 3, true);
    for (left_out, twice) in [(2, 0), (usize::MAX, 0), (0, usize::MAX)] {
        let host = Host { left_out, twice, ..Host::default() };
        let mut scene = Scene::with_host_threads(Arc::new(host));
        assert_eq!(contacts_in(&mut scene, 3, true), expected, "left out: {left_out}, twice: {twice}");
    }
}

/// Threads of this process whose name is that of a pool's.
#[cfg(target_os = "linux")]
fn pool_threads(name: &str) -> usize {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux lists threads");
    let names = tasks.filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("comm")).ok());
    names.filter(|comm| comm.trim_end() == name).count()
}

/// Within ten seconds.
#[cfg(target_os = "linux")]
fn becomes_true(is_true: impl Fn() -> bool) -> bool {
    (0..10_000).any(|_| {
        let truth = is_true();
        if !truth {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        truth
    })
}

#[cfg(target_os = "linux")]
#[test]
fn threads_have_ended_when_the_scene_is_dropped() {
    // No other test here starts so many.
    let last = "raycontact-16";
    for _ in 0..20 {
        let mut scene = Scene::new(17).expect("the threads start");
        assert!(!contacts_in(&mut scene, 2, false).is_empty());
        // A thread names itself when it first runs, which on a busy machine may be late.
        assert!(becomes_true(|| pool_threads(last) == 1), "the last thread was never seen");
        drop(scene);
        // Linux wakes who waits for a thread's end before it takes the thread off its list.
        assert!(becomes_true(|| pool_threads(last) == 0), "the last thread never ended");
    }
}

/// Velocities after products of a step of two deep tori in a floor whose vertices are nodes, and of one whose other body is
/// rigid; the judge is the matrix block by block.
fn products(mut scene: Scene<f64>, is_rigid: bool) -> Vec<f64> {
    scene.set_options(DetectionOptions { sampling: Sampling::Vertices, ..DetectionOptions::default() });
    let torus = shapes::torus(128, 64, 0.4);
    let other = torus.turned(0.3, 0.2).moved([0.1, 0.05, 0.3]);
    for shape in [&torus, &other] {
        scene.add(shape.mesh());
    }
    let mut positions = torus.positions.as_flattened().to_vec();
    let own = positions.len() as u32 / 3;
    let material = Material { stiffness: 1e5, damping_time: 0.01, friction: 0.5, depth_cap: 0.01, restitution: 0.0 };
    let mut system = ContactSystem::new(RigidUnknowns::Kept);
    if !is_rigid {
        positions.extend_from_slice(other.positions.as_flattened());
    }
    system.set_node_masses(&vec![1e-3; positions.len() / 3]).expect("they are masses");
    system.add_deformable(&scene, 0, 0..own, Carriers::Nodes, material).expect("it is new");
    if is_rigid {
        let inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        system.add_rigid(&scene, 1, 1.0, inertia, material).expect("it is new");
    } else {
        system.add_deformable(&scene, 1, own..2 * own, Carriers::Nodes, material).expect("it is new");
    }
    system.add_half_space([0.0, 0.0, 1.0], -0.2, material).expect("a floor");
    let (at_rest, count) = (vec![0.0; positions.len()], system.unknown_count());
    system.begin(&mut scene, 0.01, &positions, &at_rest, &at_rest).expect("the step begins");
    let change: Vec<f64> = (0..count).map(|k| (k as f64).sin()).collect();
    let mut found = vec![0.0; count];
    for factor in [0.5, 2.0] {
        system.add_product(factor, &change, &mut found).expect("a step is under way");
    }
    let mut judge = vec![0.0; count];
    let add = |row: usize, column: usize, block: [f64; 9]| {
        (0..9).for_each(|k| judge[3 * row + k / 3] += block[k] * change[3 * column + k % 3]);
    };
    system.for_each_block(2.5, add).expect("a step is under way");
    let largest = judge.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let error = judge.iter().zip(&found).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(error < 1e-12 * largest && largest > 0.0, "{error} of {largest}");
    // Else threads do not share it.
    assert!(system.contacts().len() > 4000, "{} contacts", system.contacts().len());
    found
}

#[test]
fn products_do_not_depend_on_whose_threads_work() {
    for is_rigid in [false, true] {
        let expected = products(Scene::new(1).expect("no thread is started"), is_rigid);
        for threads in [2, 5] {
            let scene = Scene::new(threads).expect("the threads start");
            assert_eq!(products(scene, is_rigid), expected, "{threads} threads");
        }
        let host = Arc::new(Host::default());
        let of_query = {
            let mut scene = Scene::with_host_threads(host.clone());
            contacts_in(&mut scene, 2, true);
            host.calls.swap(0, Ordering::SeqCst)
        };
        assert_eq!(products(Scene::with_host_threads(host.clone()), is_rigid), expected, "the host's threads");
        assert!(
            host.calls.load(Ordering::SeqCst) >= of_query + 4,
            "the host was asked to move bodies, for what lies in the floor and for products too"
        );
    }
}
