//! Memory that ends: creation says so before it begins and can be asked again; a steady step asks for none; and where an
//! allocation fails within any other call, the process ends by abort and in no other way.
#![cfg(unix)]
#![allow(unsafe_code)] // an allocator that fails

mod common;

use common::c::{Contacts, Mesh, Octree, RAYC_STATUS_OK, RAYC_STATUS_OUT_OF_MEMORY, Scene, vectors};
use common::shapes::{self, Shape};
use raycontact::capi::rayc_status;
use std::alloc::{GlobalAlloc, Layout, System};
use std::os::unix::process::ExitStatusExt;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};

/// Counts what lives, and fails beyond a limit or at the n-th allocation.
struct Failing;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
static ALLOCATIONS_BEFORE: AtomicUsize = AtomicUsize::new(usize::MAX);
static HAS_FAILED: AtomicBool = AtomicBool::new(false);

impl Failing {
    fn refuses(&self, bytes: usize) -> bool {
        let count_down = |before: usize| (before != usize::MAX).then(|| before.wrapping_sub(1));
        let is_nth = ALLOCATIONS_BEFORE.fetch_update(SeqCst, SeqCst, count_down) == Ok(0);
        let fails = is_nth || LIVE.load(SeqCst).saturating_add(bytes) > LIMIT.load(SeqCst);
        if fails {
            HAS_FAILED.store(true, SeqCst);
        } else {
            PEAK.fetch_max(LIVE.fetch_add(bytes, SeqCst) + bytes, SeqCst);
        }
        fails
    }
}

// SAFETY: all memory is the system's; null is a failure.
unsafe impl GlobalAlloc for Failing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: by the trait's contract.
        if self.refuses(layout.size()) { std::ptr::null_mut() } else { unsafe { System.alloc(layout) } }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), SeqCst);
        // SAFETY: by the trait's contract.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Failing = Failing;

/// Two bodies that overlap, from shapes to contacts.
fn step(shapes: &[Shape; 2], precision: u32) -> Result<Contacts, rayc_status> {
    let mut contacts = Contacts::new();
    let make = |shape: &Shape| Mesh::new(precision, false, &vectors(&shape.positions), &shape.triangles);
    let meshes = [make(&shapes[0])?, make(&shapes[1])?];
    let octrees = [Octree::new(&meshes[0])?, Octree::new(&meshes[1])?];
    let mut scene = Scene::new(precision, 1)?;
    for mesh in &meshes {
        scene.add(mesh)?;
    }
    assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
    let status = contacts.query_pair((&meshes[0], &octrees[0]), (&meshes[1], &octrees[1]));
    assert_eq!(status, RAYC_STATUS_OK);
    Ok(contacts)
}

/// Work with no more than so many bytes beyond those that live now.
fn within<R>(bytes: usize, work: impl FnOnce() -> R) -> R {
    LIMIT.store(LIVE.load(SeqCst) + bytes, SeqCst);
    let result = work();
    LIMIT.store(usize::MAX, SeqCst);
    result
}

/// Creation with any amount of memory, from none: a status or a handle, and the next try with enough works.
fn creation_is_refused_or_works() -> (usize, usize) {
    let (mut refused, mut worked) = (0, 0);
    let mut shapes = vec![shapes::tetrahedron(), shapes::cube(4), shapes::star(), shapes::torus(24, 12, 0.4)];
    // Vertices that no triangle uses, and one vertex that hundreds of triangles share.
    shapes[0].positions.extend([[0.0; 3]; 5000]);
    shapes.push(shapes::fan(600));
    for (shape, precision) in shapes.iter().flat_map(|shape| [(shape, 32), (shape, 64)]) {
        let positions = vectors(&shape.positions);
        let make = || Mesh::new(precision, false, &positions, &shape.triangles);
        let mesh = make().expect("enough memory");
        let mut scene = Scene::new(precision, 1).expect("no threads");
        let mut sweep = |make: &mut dyn FnMut() -> Result<(), rayc_status>| {
            let mut bytes = 1 << 12;
            loop {
                // No allocation but the one that is asked for beforehand fails: that would end this process.
                let result = within(bytes, &mut *make);
                assert_eq!(make(), Ok(()), "the next try, with enough memory");
                if result.is_ok() {
                    worked += 1;
                    break;
                }
                assert_eq!(result, Err(RAYC_STATUS_OUT_OF_MEMORY));
                refused += 1;
                bytes += bytes / 4;
            }
        };
        sweep(&mut || make().map(drop));
        sweep(&mut || Octree::new(&mesh).map(drop));
        sweep(&mut || scene.add(&mesh).map(drop));
    }
    (refused, worked)
}

const CHILD: &str = "RAYCONTACT_TEST_FAILING_ALLOCATION";
const NONE_FAILED: i32 = 10;
const REPORTED: i32 = 11;

/// In a process of its own: the n-th allocation fails; afterwards the same step, whole, gives what it should.
fn child(n: usize) {
    let shapes = [shapes::octahedron(), shapes::octahedron().moved([0.9, 0.1, 0.2])];
    ALLOCATIONS_BEFORE.store(n, SeqCst);
    let result = step(&shapes, 64);
    ALLOCATIONS_BEFORE.store(usize::MAX, SeqCst);
    let expected = step(&shapes, 64).expect("enough memory").digest();
    assert!(!expected.is_empty());
    match result {
        Ok(contacts) => assert_eq!(contacts.digest(), expected),
        Err(status) => assert_eq!(status, RAYC_STATUS_OUT_OF_MEMORY),
    }
    std::process::exit(if HAS_FAILED.load(SeqCst) { REPORTED } else { NONE_FAILED });
}

#[test]
fn memory_that_ends_is_reported_or_ends_the_process() {
    if let Ok(n) = std::env::var(CHILD) {
        child(n.parse().expect("a number"));
    }
    let (refused, worked) = creation_is_refused_or_works();
    println!("creation: {refused} times too little memory, refused; {worked} times enough");
    assert!(refused > 30 * 5);

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
        n += 1;
    }
    println!("one failing allocation of {n}: {reported} reported by a status, {aborted} ended the process");
    assert!(reported > 0);
}
