//! What is said of coordinates and sizes that no mesh can have.

use crate::common::c::{self, RAYC_STATUS_MESH_BEYOND_RANGE, RAYC_STATUS_NOT_FINITE};
use crate::common::shapes::{self, Shape};
use raycontact::math::Scalar;
use raycontact::mesh::{Mesh, MeshError};

#[track_caller]
fn check_message(message: &str, parts: &[&str], absent: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{message}' does not say '{part}'");
    }
    for part in absent {
        assert!(!message.contains(part), "'{message}' says '{part}'");
    }
}

/// Two sheets back to back enclose nothing, whichever way round.
#[test]
fn a_flat_surface_is_not_called_inside_out() {
    let leaf = |z: f64, middle: f64| Shape {
        positions: vec![[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z], [1.0, 1.0, z], [0.5, 0.5, z + middle]],
        triangles: vec![[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4], [1, 0, 2], [1, 2, 3]],
        inside: Vec::new(),
    };
    let flat = |shape: &Shape| {
        let error = shape.try_mesh::<f64>().expect_err("flat");
        assert!(matches!(error, MeshError::Flat { .. }), "{error}");
        check_message(
            &error.to_string(),
            &["flat", "encloses no volume", "triangle", "thickness"],
            &["inside out", "NaN"],
        );
    };
    flat(&leaf(0.0, 0.0));
    flat(&leaf(7.3, 0.0));
    flat(&shapes::cube(1).joined(&leaf(0.3, 0.0)));
    leaf(0.0, 1e-12).mesh::<f64>();
}

#[test]
fn a_surface_whose_areas_overflow_is_not_called_inside_out() {
    fn check<T: Scalar>(size: f64) {
        for shape in [shapes::torus(12, 6, 0.4), shapes::cube(2), shapes::tetrahedron()] {
            let error = shape.turned(0.3, 0.4).scaled(size).try_mesh::<T>().expect_err("its areas overflow");
            assert!(matches!(error, MeshError::Overflow { .. }), "{error}");
            check_message(&error.to_string(), &["largest number", "scale", "triangle"], &["inside out", "NaN"]);
        }
    }
    check::<f32>(1e22);
    check::<f32>(1e37);
    check::<f64>(1e158);
    check::<f64>(1e307);
}

/// 1e39 is a number, but no float.
#[test]
fn a_coordinate_beyond_float_is_named_with_the_largest_float() {
    let shape = shapes::octahedron();
    let mut wide = shape.map(|[x, y, z]| [x, -1e39 * y, -z]).positions;
    let parts = ["vertex 2", "-1e39", "3.4028234663852886e38", "double precision"];
    let absent = ["NaN", "infinite", "last step"];

    let Err(status) = c::Mesh::new(32, false, &c::vectors(&wide), &shape.triangles) else { panic!("accepted") };
    let message = c::last_error();
    assert_eq!(status, RAYC_STATUS_MESH_BEYOND_RANGE, "{message}");
    check_message(&message, &parts, &absent);
    c::Mesh::new(64, false, &c::vectors(&wide), &shape.triangles).expect("a double is large enough");

    let mut mesh = c::Mesh::new(32, false, &c::vectors(&shape.positions), &shape.triangles).expect("closed");
    let status = mesh.set_positions(&wide);
    check_message(&c::last_error(), &parts, &absent);
    assert_eq!(status, RAYC_STATUS_MESH_BEYOND_RANGE);

    let mut scene = c::Scene::new(32, 1).expect("a scene");
    let body = scene.add(&mesh).expect("the same precision");
    let status = scene.set_positions(body, &wide);
    check_message(&c::last_error(), &["body 0", "vertex 2", "-1e39", "double precision"], &absent);
    assert_eq!(status, RAYC_STATUS_MESH_BEYOND_RANGE);

    // Beside a NaN it is the NaN that is wrong.
    wide[2][2] = f64::NAN;
    let status = mesh.set_positions(&wide);
    check_message(&c::last_error(), &["vertex 2", "NaN or infinite"], &["double precision"]);
    assert_eq!(status, RAYC_STATUS_NOT_FINITE);
}

/// The simulation is to blame for a step's positions alone.
#[test]
fn not_a_number_at_creation_is_blamed_on_the_input() {
    let shape = shapes::octahedron();
    let mut bad = shape.positions.clone();
    bad[3][2] = f64::INFINITY;
    let error = Mesh::new(&bad, &shape.triangles).expect_err("not finite").to_string();
    check_message(&error, &["vertex 3", "NaN or infinite", "check the input"], &["last step"]);
    let error = shape.mesh::<f64>().set_positions(&bad).expect_err("not finite").to_string();
    check_message(&error, &["vertex 3", "NaN or infinite", "the simulation's last step"], &["input"]);

    let mut mesh = c::Mesh::new(64, false, &c::vectors(&shape.positions), &shape.triangles).expect("closed");
    let status = mesh.set_positions(&bad);
    check_message(&c::last_error(), &["vertex 3", "the simulation's last step"], &[]);
    assert_eq!(status, RAYC_STATUS_NOT_FINITE);
}
