//! The main figures of docs/accuracy.md, from closed forms: the paper's Figure 8, Archimedes, two spheres.

use crate::support::shapes::Shape;
use crate::support::{Mode, Vector, limits, net_force, shapes};
use std::f64::consts::{PI, TAU};

/// The largest tangential force over the normal one, of a cylinder on a plane turned through one side.
fn worst_ratio(mode: Mode, sides: usize) -> f64 {
    let plane = shapes::cuboid([-5.0, -5.0, -3.0], [5.0, 5.0, 0.0]).mesh(|point| *point);
    let shape = shapes::cylinder(sides);
    // Debug builds are some thirty times as slow.
    let rotations = if cfg!(debug_assertions) { 4 } else { 10 };
    (0..rotations)
        .map(|rotation| {
            let turn = shapes::turn([0.0, 1.0, 0.0], TAU / sides as f64 * rotation as f64 / rotations as f64);
            let cylinder = shape.mesh(|point| turn * point + Vector::z() * 0.7);
            let force = net_force(mode, &cylinder, &plane, &Vector::zeros()).force;
            assert!(force.z > 0.0, "the plane carries the cylinder");
            force.xy().norm() / force.z
        })
        .fold(0.0, f64::max)
}

#[test]
fn the_tangential_force_on_a_cylinder_is_small() {
    for (mode, sides, limit) in [(Mode::Default, 10, 0.01), (Mode::Default, 150, 0.001), (Mode::Accurate, 150, 0.0005)]
    {
        let worst = worst_ratio(mode, sides);
        println!("{mode:?}, {sides} sides: {worst}");
        assert!(worst < limit, "{mode:?}, {sides} sides: {worst}, not below {limit}");
    }
}

#[test]
fn the_papers_law_shows_the_papers_tangential_force() {
    let worst = worst_ratio(Mode::Paper, 10);
    assert!((0.07..0.095).contains(&worst), "{worst}");
}

/// The unit sphere of 1620 triangles, enlarged until it encloses as much as the smooth one.
fn sphere() -> Shape {
    let sphere = shapes::icosphere(9);
    let factor = (4.0 * PI / 3.0 / sphere.volume()).cbrt();
    sphere.scaled(factor)
}

#[test]
fn bodies_on_a_slab_feel_archimedes() {
    let slab = shapes::cuboid([-5.0, -5.0, -3.0], [5.0, 5.0, 0.0]).mesh(|point| *point);
    let cases = [
        ("ball", Vector::repeat(1.0), 0.5, 0.6),
        ("ellipsoid", Vector::new(1.3, 0.9, 0.6), 0.5, 0.5),
        ("lens", Vector::new(1.0, 1.0, 0.25), 0.1, 0.15),
    ];
    for (name, radii, tilt, height) in cases {
        let turn = shapes::turn([0.3, 1.0, 0.2], tilt);
        let body = sphere().mesh(|point| turn * point.component_mul(&radii) + Vector::z() * height);
        // Stretched to a unit ball, the ellipsoid is cut at `height` over its reach downwards.
        let reach = (turn.inverse() * Vector::z()).component_mul(&radii).norm();
        let sunk = 1.0 - height / reach;
        let volume = radii.product() * PI * sunk * sunk * (3.0 - sunk) / 3.0;
        let mesh_volume = limits::volume_below_zero(&body);
        assert!((mesh_volume / volume - 1.0).abs() < 0.005, "{name}: {mesh_volume} of {volume} lie below the top");

        let force = net_force(Mode::Default, &body, &slab, &Vector::zeros()).force;
        assert!((force.z / volume - 1.0).abs() < 0.01, "{name}: {}, not {volume}", force.z);
        assert!(force.xy().norm() < 0.002 * force.z, "{name}: tangential part in {force:?}");
    }
}

#[test]
fn two_spheres_feel_the_law_on_smooth_spheres() {
    let distance = 1.5;
    let turns = [shapes::turn([0.3, 1.0, 0.2], 0.5), shapes::turn([-0.3, 0.4, 0.7], 1.5)];
    let a = sphere().mesh(|point| turns[0] * point);
    let b = sphere().mesh(|point| turns[1] * point + Vector::x() * distance);
    let force = net_force(Mode::Default, &a, &b, &Vector::zeros()).force;
    let exact = Vector::x() * limits::spheres(distance);
    assert!((force - exact).norm() < 0.01 * exact.norm(), "{force:?}, not {exact:?}");
}
