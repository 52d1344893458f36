//! Faults on purpose, for tests of this crate alone: a panic within every export, and on every thread that works.

use super::ffi::{Mode, Options};
use super::*;
use crate::shapes::{self, Shape};
use crate::threads::faults;
use std::cell::Cell;
use std::ffi::CStr;
use std::fs;
use std::ptr::{null, null_mut};
use std::sync::{LazyLock, Mutex, PoisonError};

/// Held by tests that panic on purpose, one at a time.
static QUIET: Mutex<()> = Mutex::new(());

thread_local! {
    static STRIKES: Cell<bool> = const { Cell::new(false) };
}

/// Called by the guard within each call.
pub(super) fn strike() {
    if STRIKES.get() {
        assert!(Mode::now().is_default(), "the call works in its caller's mode");
        panic!("on purpose");
    }
}

/// The result of a call that panics, made in another mode than the default.
fn struck<V>(call: impl FnOnce() -> V) -> V {
    STRIKES.set(true);
    let result = in_other_mode(call);
    STRIKES.set(false);
    result
}

/// Holds the call to giving the mode back.
fn in_other_mode<V>(call: impl FnOnce() -> V) -> V {
    let before = Mode::now();
    Mode::OTHER.set();
    let result = call();
    let left = Mode::now();
    before.set();
    assert_eq!(left, Mode::OTHER);
    result
}

fn last_error() -> String {
    // SAFETY: it is never NULL, and ends in zero.
    unsafe { CStr::from_ptr(rayc_last_error_message()) }.to_str().expect("UTF-8").to_owned()
}

/// The names of all functions that the headers declare, each from the start of a line.
fn exports() -> Vec<String> {
    let files =
        fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/include/raycontact")).expect("the headers are there");
    let paths = files.map(|file| file.expect("it can be read").path());
    let headers = paths.filter(|path| path.extension().is_some_and(|end| end == "h"));
    let header: String = headers.map(|path| fs::read_to_string(path).expect("it can be read")).collect();
    let name = |line: &str| {
        let declared = line.split_once('(')?.0.rsplit([' ', '*']).next()?;
        let is_declaration = !line.starts_with([' ', '/', '#']) && !line.starts_with("typedef");
        (is_declaration && declared.starts_with("rayc_")).then(|| declared.to_owned())
    };
    let mut names: Vec<String> = header.lines().filter_map(name).collect();
    names.sort();
    names
}

/// The same arguments as for a caller who knows nothing: a panic comes before any of them is looked at.
#[test]
fn a_panic_in_any_export_becomes_a_status() {
    let (mut count, mut called) = (0, Vec::new());
    macro_rules! check {
        ($($name:ident($($argument:expr),*);)*) => {$(
            let status = struck(|| {
                // SAFETY: nothing is read or written after the panic.
                unsafe { $name($($argument),*) }
            });
            assert_eq!(status, rayc_status::RAYC_STATUS_PANIC, stringify!($name));
            assert!(last_error().contains("on purpose"), "{}: {}", stringify!($name), last_error());
            called.push(stringify!($name).to_owned());
            count += 1;
        )*};
    }
    let _alone = QUIET.lock().unwrap_or_else(PoisonError::into_inner);
    check! {
        rayc_default_mesh_options(0, null_mut());
        rayc_default_detection_options(0, null_mut());
        rayc_default_response_options(0, null_mut());
        rayc_paper_detection_options(0, null_mut());
        rayc_default_scene_options(0, null_mut());
        rayc_default_contact_system_options(0, null_mut());
        rayc_bearing_material(0.0, 0.0, 0, null_mut());
        rayc_elastic_material(0.0, 0.0, 0.0, 0, null_mut());
        rayc_contact_system_create(null(), null_mut());
        rayc_contact_system_destroy(null_mut());
        rayc_contact_system_set_node_masses(null_mut(), 0, null());
        rayc_contact_system_add_deformable(null_mut(), null(), 0, 0, 0, null(), 0, null(), null(), null());
        rayc_contact_system_add_rigid(null_mut(), null(), 0, 0.0, null(), null());
        rayc_contact_system_add_moved(null_mut(), null(), 0, null());
        rayc_contact_system_add_half_space(null_mut(), null(), 0.0, null());
        rayc_contact_system_remove_body(null_mut(), 0);
        rayc_contact_system_set_pair_material(null_mut(), 0, 0, null());
        rayc_contact_system_set_motion(null_mut(), 0, null());
        rayc_contact_system_set_added_inertia(null_mut(), 0, null());
        rayc_contact_system_unknown_count(null(), null_mut());
        rayc_contact_system_begin(null_mut(), null_mut(), 0.0, 0, null(), null(), null());
        rayc_contact_system_add_forces(null_mut(), 0, null(), null_mut());
        rayc_contact_system_add_product(null_mut(), 0.0, 0, null(), null_mut());
        rayc_contact_system_block_count(null(), null_mut());
        rayc_contact_system_copy_blocks(null(), 0.0, 0, null_mut(), null_mut(), null_mut());
        rayc_contact_system_csr(null_mut(), 0.0, null_mut());
        rayc_contact_systems_begin(0, null(), null(), 0.0, 0, null(), null(), null(), null_mut());
        rayc_contact_systems_detect_again(0, null(), null(), 0, null(), null_mut(), null_mut());
        rayc_scenes_query(0, null(), null(), null_mut());
        rayc_contact_system_begin_f32(null_mut(), null_mut(), 0.0, 0, null(), null(), null());
        rayc_contact_system_add_forces_f32(null_mut(), 0, null(), null_mut());
        rayc_contact_system_add_product_f32(null_mut(), 0.0, 0, null(), null_mut());
        rayc_contact_system_energy_f32(null_mut(), 0, null(), null_mut());
        rayc_contact_system_linearise_f32(null_mut(), 0, null(), null_mut());
        rayc_contact_system_misjudged_f32(null_mut(), 0, null(), null_mut());
        rayc_contact_system_detect_again_f32(null_mut(), null_mut(), 0, null(), null_mut());
        rayc_contact_system_finish_f32(null_mut(), 0, null());
        rayc_contact_system_explicit_step_f32(null_mut(), null_mut(), 0.0, 0, null(), null(), 0, null_mut(), null_mut());
        rayc_contact_system_energy(null_mut(), 0, null(), null_mut());
        rayc_contact_system_potential(null_mut(), null_mut(), 0, null(), 0.0, null_mut());
        rayc_contact_system_linearise(null_mut(), 0, null(), null_mut());
        rayc_contact_system_detect_again(null_mut(), null_mut(), 0, null(), null_mut());
        rayc_contact_system_finish(null_mut(), 0, null());
        rayc_contact_system_cancel(null_mut());
        rayc_contact_system_rigid_velocity(null(), 0, null_mut());
        rayc_contact_system_explicit_step(null_mut(), null_mut(), 0.0, 0, null(), null(), 0, null_mut(), null_mut());
        rayc_contact_system_look_ahead(null_mut(), null_mut(), 0.0, 0, null(), null(), null());
        rayc_contact_system_part_count(null_mut(), null_mut(), null_mut());
        rayc_contact_system_copy_parts(null_mut(), 0, null_mut(), 0, null_mut());
        rayc_contact_system_part_forces(null_mut(), 0, null(), 0, null_mut());
        rayc_contact_system_part_products(null_mut(), 0.0, 0, null(), 0, null_mut());
        rayc_contact_system_off_course(null_mut(), null(), 0, null(), null_mut(), null_mut());
        rayc_contact_system_look_again(null_mut(), null_mut(), 0, null());
        rayc_contact_system_detect_among(null_mut(), null_mut(), 0, null(), null(), 0, null(), null_mut());
        rayc_contact_system_look_explicit(null_mut(), null_mut(), 0.0, 0, null(), null());
        rayc_contact_system_begin_explicit(null_mut(), null_mut(), 0.0, 0, null(), null());
        rayc_contact_system_part_couplings(null_mut(), 0, null_mut());
        rayc_contact_system_largest_coupling(null(), 0, null(), null_mut(), null_mut());
        rayc_contact_system_part_energies(null_mut(), 0, null(), 0, null_mut());
        rayc_contact_system_part_block_count(null_mut(), null_mut());
        rayc_contact_system_copy_part_blocks(null_mut(), 0.0, 0, null_mut(), null_mut(), null_mut(), null_mut());
        rayc_contact_system_memory_count(null(), null_mut());
        rayc_contact_system_copy_memories(null(), 0, null_mut());
        rayc_contact_system_pack_memory(null(), null(), null_mut());
        rayc_contact_system_put_memory(null_mut(), null(), null());
        rayc_contact_system_set_half_space_material(null_mut(), 0, 0, null());
        rayc_contact_system_copy_contacts(null(), null_mut());
        rayc_contact_system_misjudged(null_mut(), 0, null(), null_mut());
        rayc_contact_system_pair_force(null(), 0, 0, 0, null_mut());
        rayc_mesh_create(null(), null(), null(), 0, null_mut());
        rayc_mesh_create_from_obj(null(), null(), null_mut());
        rayc_mesh_packed_length(null(), null_mut());
        rayc_mesh_pack(null(), 0, null_mut());
        rayc_mesh_unpack(0, null(), null_mut());
        rayc_mesh_destroy(null_mut());
        rayc_mesh_set_positions(null_mut(), null());
        rayc_mesh_vertex_count(null(), null_mut());
        rayc_mesh_triangle_count(null(), null_mut());
        rayc_mesh_copy_positions(null(), null());
        rayc_mesh_copy_triangles(null(), 0, null_mut());
        rayc_mesh_hole_count(null(), null_mut());
        rayc_mesh_copy_holes(null(), 0, null_mut());
        rayc_octree_create(null(), null(), null_mut());
        rayc_default_octree_options(0, null_mut());
        rayc_octree_destroy(null_mut());
        rayc_octree_update(null_mut(), null());
        rayc_octree_trace_ray(null(), null(), null(), null_mut());
        rayc_octree_trace_rays(null(), null(), null(), 0, null_mut());
        rayc_octree_closest_points(null(), null(), null(), null(), null_mut());
        rayc_octree_winding_numbers(null(), null(), null(), null_mut());
        rayc_octree_own_exits(null_mut(), null(), 0, null_mut(), null_mut());
        rayc_contacts_create(null_mut());
        rayc_contacts_destroy(null_mut());
        rayc_query_pair(null(), null(), null(), null(), null(), null_mut());
        rayc_query_self(null(), null(), null(), null_mut());
        rayc_contacts_count(null(), null_mut());
        rayc_contacts_copy(null(), 0, 0, null_mut());
        rayc_contacts_statistics(null(), 0, null_mut());
        rayc_contacts_escape_push_count(null(), null_mut());
        rayc_contacts_copy_escape_pushes(null(), 0, 0, 0, null_mut());
        rayc_contacts_copy_coefficients(null(), null(), 0, 0, null_mut());
        rayc_contacts_add_forces(null(), null(), 0, null(), null(), null());
        rayc_contacts_add_wrenches(null(), null(), 0, null(), null(), null_mut());
        rayc_contacts_add_differential(null(), null(), 0.0, 0.0, 0, null(), null());
        rayc_contacts_sum_pair_forces(null_mut(), null(), 0, null(), null(), null_mut(), null_mut());
        rayc_contacts_copy_pair_forces(null(), 0, null_mut(), 0, null_mut());
        rayc_contacts_energy(null(), null(), 0, null(), null_mut());
        rayc_scene_create(null(), null_mut());
        rayc_scene_destroy(null_mut());
        rayc_scene_add_mesh(null_mut(), null(), null_mut());
        rayc_scene_add_mesh_with_key(null_mut(), null(), 0, null_mut());
        rayc_scene_share_body(null_mut(), 0, 0, 0, 0);
        rayc_finds_pair(0, 1, null_mut());
        rayc_scene_find_self_contacts(null_mut());
        rayc_scene_body_state(null(), 0, 0, null_mut());
        rayc_scene_pair_cost_count(null(), null_mut());
        rayc_scene_copy_pair_costs(null(), 0, 0, 0, null_mut());
        rayc_scene_set_pair_memory(null_mut(), 0, null());
        rayc_scene_remove_body(null_mut(), 0);
        rayc_scene_release_body_numbers(null_mut());
        rayc_scene_set_positions(null_mut(), 0, null());
        rayc_scene_set_pose(null_mut(), 0, null());
        rayc_scene_set_detection_options(null_mut(), null());
        rayc_scene_set_self_collision(null_mut(), 0, 0);
        rayc_scene_set_carrier_spacing(null_mut(), 0, 0.0);
        rayc_scene_set_pair_collision(null_mut(), 0, 0, 0);
        rayc_scene_advance(null_mut(), 0.0);
        rayc_scene_query(null_mut(), null_mut());
        rayc_scene_potential(null_mut(), null(), null_mut(), null_mut());
        rayc_scene_add_differential(null(), null(), null(), 1.0, 0.0, 0, null(), null());
        rayc_scene_allow_escape(null_mut(), 0, 0, 0);
        rayc_scene_may_escape(null(), 0, 0, null_mut());
        rayc_scene_pair_memory_count(null(), null_mut());
        rayc_scene_copy_pair_memories(null(), 0, 0, 0, null_mut());
        rayc_scene_saved_length(null(), null_mut());
        rayc_scene_save_pair_memories(null(), 0, null_mut());
        rayc_scene_restore_pair_memories(null_mut(), 0, null());
    }
    // Those that give a plain value give one that harms nobody.
    assert_eq!(struck(|| rayc_version()), 0);
    assert_eq!(struck(|| rayc_abi_version()), 0);
    // SAFETY: both are never NULL.
    let texts =
        unsafe { [struck(|| rayc_status_name(0)), struck(|| rayc_last_error_message())].map(|t| CStr::from_ptr(t)) };
    assert_eq!(texts, [c""; 2]);
    called
        .extend(["rayc_version", "rayc_abi_version", "rayc_status_name", "rayc_last_error_message"].map(String::from));
    called.sort();
    assert_eq!(called, exports(), "exports that are not tried, or gone");
    assert_eq!(count + 4, called.len());
}

/// Four cubes that overlap, the k-th at 0.6 k along the diagonal, so fine that threads share the work.
fn cubes(options: *const rayc_scene_options) -> *mut rayc_scene {
    static CUBES: LazyLock<[Shape; 4]> = LazyLock::new(|| {
        let cube = shapes::cube(10);
        std::array::from_fn(|k| cube.moved([0.6 * k as f64; 3]))
    });
    let (mut scene, mut body) = (null_mut(), 0);
    // SAFETY: all arrays are as they say.
    unsafe {
        assert_eq!(rayc_scene_create(options, &mut scene), rayc_status::RAYC_STATUS_OK);
        // Rays from corners alone: enough, and quick in a debug build.
        let few = rayc_detection_options {
            sampling: rayc_sampling::RAYC_SAMPLING_VERTICES as u32,
            ..rayc_detection_options::defaults()
        };
        assert_eq!(rayc_scene_set_detection_options(scene, &few), rayc_status::RAYC_STATUS_OK);
        for Shape { positions, triangles, .. } in &*CUBES {
            let (data, count) = (positions.as_ptr().cast(), positions.len());
            let vectors = rayc_vectors { data, count, stride: 0, scalar: rayc_scalar::RAYC_SCALAR_F64 as u32 };
            let (corners, mut mesh) = (triangles.as_ptr().cast(), null_mut());
            let status = rayc_mesh_create(null(), &vectors, corners, triangles.len(), &mut mesh);
            assert_eq!(status, rayc_status::RAYC_STATUS_OK);
            assert_eq!(rayc_scene_add_mesh(scene, mesh, &mut body), rayc_status::RAYC_STATUS_OK);
            assert_eq!(rayc_mesh_destroy(mesh), rayc_status::RAYC_STATUS_OK);
        }
    }
    scene
}

/// The status of one query, and how many contacts of what depth in all the list then holds.
fn query(scene: *mut rayc_scene, contacts: *mut rayc_contacts) -> (rayc_status, usize, u64) {
    let (mut count, mut joules) = (0, 0.0);
    // SAFETY: the handles are valid.
    unsafe {
        let status = rayc_scene_query(scene, contacts);
        assert_eq!(rayc_contacts_count(contacts, &mut count), rayc_status::RAYC_STATUS_OK);
        assert_eq!(rayc_contacts_energy(contacts, null(), 0, null(), &mut joules), rayc_status::RAYC_STATUS_OK);
        (status, count, joules.to_bits())
    }
}

/// A host that works alone, but by its function.
unsafe extern "C-unwind" fn one_by_one(_: *mut libc::c_void, count: usize, task: rayc_task, data: *mut libc::c_void) {
    for index in 0..count {
        // SAFETY: as rayc_parallel_for says.
        in_other_mode(|| unsafe { task(data, index) });
    }
}

#[test]
fn a_panic_on_any_thread_becomes_a_status_and_the_next_scene_works() {
    let _alone = QUIET.lock().unwrap_or_else(PoisonError::into_inner);
    let mut options = rayc_scene_options::defaults();
    let mut contacts = null_mut();
    // SAFETY: the place is writable.
    assert_eq!(unsafe { rayc_contacts_create(&mut contacts) }, rayc_status::RAYC_STATUS_OK);
    let sound = cubes(&options);
    let expected = query(sound, contacts);
    assert_eq!(expected.0, rayc_status::RAYC_STATUS_OK);
    assert!(expected.1 > 0, "the cubes overlap");
    for (threads, host) in [(1, None), (3, None), (1, Some(one_by_one as _))] {
        (options.threads, options.parallel_for) = (threads, host);
        let mut struck = 0;
        loop {
            let scene = cubes(&options);
            faults::strike_after(struck);
            let (status, ..) = query(scene, contacts);
            let is_past_the_end = faults::call_off();
            assert_eq!(status == rayc_status::RAYC_STATUS_OK, is_past_the_end, "item {struck}");
            if !is_past_the_end {
                assert_eq!(status, rayc_status::RAYC_STATUS_PANIC);
            }
            // Nothing is lost: other scenes go on with the same list, and so does even this one.
            assert_eq!(query(sound, contacts), expected, "item {struck}, {threads} threads");
            assert_eq!(query(scene, contacts), expected, "item {struck}, {threads} threads");
            // SAFETY: it is not used again.
            assert_eq!(unsafe { rayc_scene_destroy(scene) }, rayc_status::RAYC_STATUS_OK);
            if is_past_the_end {
                break;
            }
            struck += 1;
        }
        let has_helpers = threads > 1 || host.is_some();
        assert!(struck >= if has_helpers { 10 } else { 4 }, "four bodies and six pairs, {struck} items");
    }
    // SAFETY: they are not used again.
    unsafe {
        rayc_scene_destroy(sound);
        rayc_contacts_destroy(contacts);
    }
}
