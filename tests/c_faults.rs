//! What a host may do wrong, or the system refuse: each ends in a status, and what comes next works.
#![allow(unsafe_code)] // the C interface

mod common;

use common::c::{Contacts, Mesh, Octree, RAYC_STATUS_OK, RAYC_STATUS_THREADS_NOT_STARTED, Scene, vectors};
use common::shapes::{self, Shape};

fn mesh(shape: &Shape) -> Mesh {
    Mesh::new(64, false, &vectors(&shape.positions), &shape.triangles).expect("a closed surface")
}

fn two_octahedra() -> [Shape; 2] {
    [shapes::octahedron(), shapes::octahedron().moved([0.9, 0.1, 0.2])]
}

/// A handle, whichever kind it is of, that its drop destroys.
type Any = Box<dyn std::any::Any>;

/// Every order of the numbers below `count`.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let shorter = orders(count - 1);
    let with_last = |order: &Vec<usize>, place: usize| {
        let mut order = order.clone();
        order.insert(place, count - 1);
        order
    };
    shorter.iter().flat_map(|order| (0..count).map(move |place| with_last(order, place))).collect()
}

#[test]
fn handles_may_be_destroyed_in_any_order() {
    let shapes = two_octahedra();
    let all = orders(6);
    assert_eq!(all.len(), 720);
    for order in all.into_iter().step_by(common::STRIDE) {
        let meshes = shapes.each_ref().map(mesh);
        let octrees = meshes.each_ref().map(|mesh| Octree::new(mesh).expect("memory"));
        let (mut scene, mut contacts) = (Scene::new(64, 2).expect("two threads"), Contacts::new());
        for mesh in &meshes {
            scene.add(mesh).expect("the same precision");
        }
        let [a, b] = [0, 1].map(|k| (&meshes[k], &octrees[k]));
        assert_eq!(contacts.query_pair(a, b), RAYC_STATUS_OK);
        let of_pair = contacts.digest();
        assert!(!of_pair.is_empty());
        let ([mesh_a, mesh_b], [octree_a, octree_b]) = (meshes, octrees);
        let mut handles: Vec<Option<Any>> = vec![
            Some(Box::new(mesh_a)),
            Some(Box::new(mesh_b)),
            Some(Box::new(octree_a)),
            Some(Box::new(octree_b)),
            Some(Box::new(contacts)),
            Some(Box::new(scene)),
        ];
        for gone in order {
            handles[gone] = None;
            // What is left still answers.
            let contacts = handles[4].as_ref().and_then(|handle| handle.downcast_ref::<Contacts>());
            assert!(contacts.is_none_or(|contacts| contacts.digest() == of_pair));
            if let Some(scene) = handles[5].as_mut().and_then(|handle| handle.downcast_mut::<Scene>()) {
                let mut own = Contacts::new();
                assert_eq!(scene.query(&mut own), RAYC_STATUS_OK);
                assert_eq!(own.digest(), of_pair);
            }
        }
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use super::*;
    use std::process::Command;

    const CHILD: &str = "RAYCONTACT_TEST_FEW_THREADS";

    fn number_in_status(name: &str) -> usize {
        let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
        let line = status.lines().find(|line| line.starts_with(name)).expect("it is there");
        line.split_whitespace().nth(1).and_then(|number| number.parse().ok()).expect("a number")
    }

    /// Room for the stacks of a few threads, not of a thousand.
    fn with_little_room(work: impl FnOnce()) {
        let bytes = (number_in_status("VmSize") * 1024 + (64 << 20)) as u64;
        let mut before = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        // SAFETY: the places are this function's own.
        unsafe {
            assert_eq!(libc::getrlimit(libc::RLIMIT_AS, &mut before), 0);
            assert_eq!(libc::setrlimit(libc::RLIMIT_AS, &libc::rlimit { rlim_cur: bytes, ..before }), 0);
            work();
            assert_eq!(libc::setrlimit(libc::RLIMIT_AS, &before), 0);
        }
    }

    #[test]
    fn threads_that_cannot_be_started_are_reported_and_none_stays() {
        let name = "linux::threads_that_cannot_be_started_are_reported_and_none_stays";
        if std::env::var_os(CHILD).is_none() {
            // In a process of its own, as the limit holds for all of it.
            let program = std::env::current_exe().expect("the test knows itself");
            let output = Command::new(program).args(["--exact", name]).env(CHILD, "1").output().expect("it starts");
            assert!(output.status.success(), "{output:?}");
            return;
        }
        let before = number_in_status("Threads:");
        with_little_room(|| assert_eq!(Scene::new(64, 1024).map(drop), Err(RAYC_STATUS_THREADS_NOT_STARTED)));
        assert_eq!(number_in_status("Threads:"), before, "those that had started have ended");
        let mut scene = Scene::new(64, 3).expect("there is room again");
        for shape in two_octahedra() {
            scene.add(&mesh(&shape)).expect("the same precision");
        }
        let mut contacts = Contacts::new();
        assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
        assert!(!contacts.digest().is_empty());
    }

    /// RAYCONTACT_SOAK_STEPS: how many; the default is short.
    #[test]
    fn memory_stays_flat_over_many_steps() {
        let steps = std::env::var("RAYCONTACT_SOAK_STEPS")
            .ok()
            .and_then(|steps| steps.parse().ok())
            .unwrap_or(2000 / common::STRIDE);
        // Large enough to be shared between the threads.
        let shapes = [0.0, 0.2].map(|shift| shapes::torus(32, 24, 0.4).moved([shift, 0.1, 0.1]));
        let (mut scene, mut contacts) = (Scene::new(64, 2).expect("two threads"), Contacts::new());
        for shape in &shapes {
            scene.add(&mesh(shape)).expect("the same precision");
        }
        scene.set_self_collision(0);
        let (mut settled, mut found) = (0, 0);
        for step in 0..steps {
            let turn = 0.01 * (step % 100) as f64;
            assert_eq!(scene.set_positions(0, &shapes[0].turned(turn, 0.5 * turn).positions), RAYC_STATUS_OK);
            assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
            found += contacts.digest().len();
            // Bodies come and go, too.
            if step % 10 == 0 {
                let body = scene.add(&mesh(&shapes[1].moved([-1.8, 0.0, 0.0]))).expect("the same precision");
                assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
                scene.remove(body);
            }
            if step == steps / 10 {
                settled = number_in_status("VmRSS:");
            }
        }
        let grown = number_in_status("VmRSS:").saturating_sub(settled);
        println!("{steps} steps, {found} contacts, {settled} KiB after a tenth, {grown} KiB more at the end");
        // Other tests run beside; in a long run a leak of four bytes a step would show.
        assert!(grown < 2048 + steps / 256, "{grown} KiB more");
        assert!(found > steps, "the bodies overlap");
    }
}
