//! Which way the closed parts of a surface face. The judge is the winding number, by solid angles (van Oosterom and
//! Strackee 1983): nowhere may it be negative.

use crate::common::shapes::{self, Point, Shape};
use proptest::prelude::*;
use raycontact::math::Scalar;
use raycontact::mesh::{Mesh, MeshError};

/// With every triangle turned around.
fn inside_out(shape: &Shape) -> Shape {
    Shape { triangles: shape.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..shape.clone() }
}

fn cube_at(middle: Point, half: f64) -> Shape {
    shapes::cube(1).scaled(half).moved(middle)
}

fn joined(parts: &[Shape]) -> Shape {
    parts[1..].iter().fold(parts[0].clone(), |all, part| all.joined(part))
}

fn winding_number(shape: &Shape, point: Point) -> f64 {
    use shapes::{cross, dot};
    let solid_angle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| {
            let position = shape.positions[vertex as usize];
            [0, 1, 2].map(|axis| position[axis] - point[axis])
        });
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * dot(a, cross(b, c)).atan2(denominator)
    };
    shape.triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// The refusal of an inward part, and the triangle it names.
fn inward_triangle<T: Scalar>(refused: Result<Mesh<T>, MeshError>) -> usize {
    let Err(error @ MeshError::Inward { .. }) = refused else { panic!("{:?}", refused.map(|_| "accepted")) };
    let message = error.to_string();
    assert!(message.contains("inside out"), "{message}");
    let (_, number) = message.split_once("triangle ").expect("it names a triangle");
    let number: String = number.chars().take_while(char::is_ascii_digit).collect();
    number.parse().expect("a number")
}

#[test]
fn a_part_that_is_inside_out_is_refused_though_the_sum_of_volumes_is_positive() {
    fn check<T: Scalar>() {
        let shape = joined(&[cube_at([0.0; 3], 2.0), inside_out(&cube_at([5.0, 0.0, 0.0], 1.0))]);
        let named = inward_triangle(shape.try_mesh::<T>());
        assert!((12..24).contains(&named), "triangle {named}");
        let first = joined(&[inside_out(&cube_at([5.0, 0.0, 0.0], 1.0)), cube_at([0.0; 3], 2.0)]);
        let named = inward_triangle(first.try_mesh::<T>());
        assert!((0..12).contains(&named), "triangle {named}");
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn a_cavity_is_accepted_and_so_is_a_body_in_it() {
    let [a, b, c, d] = [4.0, 3.0, 2.0, 1.0].map(|half| cube_at([20.0, 20.3, 19.7], half));
    for turn in [0.0, 0.3] {
        let accepted = |parts: &[Shape]| {
            joined(parts).turned(turn, turn).mesh::<f64>();
            joined(parts).turned(turn, turn).mesh::<f32>();
        };
        accepted(&[a.clone(), inside_out(&b)]);
        accepted(&[inside_out(&b), a.clone(), c.clone()]);
        accepted(&[a.clone(), inside_out(&b), c.clone(), inside_out(&d)]);
        // A body that overlaps itself, with cavities up to twice.
        accepted(&[a.clone(), b.clone(), inside_out(&c), inside_out(&d)]);
        let refused = [a.clone(), inside_out(&b), inside_out(&c)];
        let named = inward_triangle(joined(&refused).turned(turn, turn).try_mesh::<f64>());
        assert!((12..36).contains(&named), "triangle {named}");
    }
}

/// Its part outside is what counts, however small.
#[test]
fn an_inward_part_that_sticks_out_is_refused() {
    let outer = cube_at([0.0; 3], 2.0);
    let named = inward_triangle(joined(&[outer.clone(), inside_out(&cube_at([1.5, 0.0, 0.0], 1.0))]).try_mesh::<f64>());
    assert!((12..24).contains(&named), "triangle {named}");
    // A cavity against the wall, with a face in common with it: nowhere is the winding number negative.
    joined(&[outer.clone(), inside_out(&cube_at([1.0, 0.0, 0.0], 1.0))]).mesh::<f64>();
    // Two outward parts that cross.
    joined(&[outer, cube_at([1.5, 0.0, 0.0], 1.0)]).mesh::<f64>();
}

#[test]
fn a_closed_part_of_an_open_mesh_is_judged() {
    let sheet = Shape {
        positions: vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        inside: Vec::new(),
    };
    let open = |shape: Shape| Mesh::<f64>::open(&shape.positions, &shape.triangles);
    let (above, around) = (cube_at([0.0, 0.0, 3.0], 1.0), cube_at([0.0, 0.0, 3.0], 2.0));
    assert!(open(sheet.joined(&above)).expect("an outward cube").is_open());
    let named = inward_triangle(open(sheet.joined(&inside_out(&above))));
    assert!((1..13).contains(&named), "triangle {named}");
    open(sheet.joined(&inside_out(&above)).joined(&around)).expect("a cavity");
    open(inside_out(&sheet)).expect("a sheet has no inside");
}

#[test]
fn ten_thousand_parts_are_judged_without_a_square_of_that() {
    let tetrahedra = |count: usize, width: f64| {
        let mut all = Shape { positions: Vec::new(), triangles: Vec::new(), inside: Vec::new() };
        for i in 0..count {
            let place = [i % 22, i / 22 % 22, i / 484].map(|i| (i as f64 / 21.0 - 0.5) * width);
            all = Shape { inside: Vec::new(), ..all };
            let one = inside_out(&shapes::tetrahedron().scaled(0.2 * width / 22.0).moved(place));
            let first = all.positions.len() as u32;
            all.positions.extend(one.positions);
            all.triangles.extend(one.triangles.iter().map(|corners| corners.map(|vertex| vertex + first)));
        }
        all
    };
    let alone = tetrahedra(10_000, 1.0);
    inward_triangle(alone.try_mesh::<f64>());
    // As cavities of one fine sphere, and the last of them outside.
    let (count, levels) = if cfg!(debug_assertions) { (200, 3) } else { (10_000, 6) };
    let sphere = shapes::sphere(levels);
    let cavities = tetrahedra(count, 1.0);
    sphere.joined(&cavities).mesh::<f64>();
    let all = sphere.joined(&cavities).joined(&inside_out(&shapes::tetrahedron().scaled(0.01).moved([0.8; 3])));
    assert!(inward_triangle(all.try_mesh::<f64>()) >= all.triangles.len() - 4);
}

/// A torus, whose middle is outside, and a thin plate, each with a tiny part in the middle that faces inward.
#[test]
fn size_and_thinness_do_not_matter() {
    fn check<T: Scalar>(sizes: &[f64]) {
        for &size in sizes {
            let torus = shapes::torus(12, 6, 0.4).turned(0.4, 0.7);
            let thin = shapes::cube(1).map(|[x, y, z]| [x, y, z * 1e-5]);
            for shape in [torus, thin] {
                shape.scaled(size).mesh::<T>();
                inward_triangle(inside_out(&shape).scaled(size).try_mesh::<T>());
                let with_cavity = shape.joined(&inside_out(&shapes::cube(1).scaled(1e-7)));
                let is_inside = winding_number(&shape, [0.0; 3]) > 0.5;
                assert_eq!(with_cavity.scaled(size).try_mesh::<T>().is_ok(), is_inside, "{size:e}");
            }
        }
    }
    check::<f64>(&[1e-120, 1e-60, 1.0, 1e60, 1e120]);
    check::<f32>(&[1e-8, 1.0, 1e12, 1e15]);
}

/// One cube, as half a side and a place on a line; whether it is turned inside out.
fn some_cube() -> impl Strategy<Value = (f64, f64, bool)> {
    (prop_oneof![0.3..1.0, 1.0..6.0f64], -6.0..6.0f64, any::<bool>())
}

proptest! {
    #[test]
    fn a_mesh_is_refused_where_its_winding_number_is_negative(cubes in prop::collection::vec(some_cube(), 1..6)) {
        let parts: Vec<Shape> = cubes
            .iter()
            .map(|&(half, x, is_inward)| {
                let cube = cube_at([x, 0.01 * x, 0.02 * half], half);
                if is_inward { inside_out(&cube) } else { cube }
            })
            .collect();
        // Of parts that cross, a few points are looked at; here all lie one inside the other, or beside it.
        for (i, &(half, x, _)) in cubes.iter().enumerate() {
            for &(other, y, _) in &cubes[i + 1..] {
                let (apart, difference) = ((x - y).abs(), (half - other).abs());
                prop_assume!(apart > half + other + 0.1 || apart * 1.1 < difference - 0.1);
            }
        }
        let shape = joined(&parts);
        // Under the skin of each part, beyond all that lies in it.
        let lowest = parts.iter().flat_map(|part| &part.positions).map(|corner| {
            let nearby = [0, 1, 2].map(|axis| corner[axis] + 1e-3 * if axis == 0 { 1.0 } else { 0.5 });
            let farther = [0, 1, 2].map(|axis| corner[axis] - 1e-3 * if axis == 0 { 1.0 } else { 0.5 });
            winding_number(&shape, nearby).min(winding_number(&shape, farther))
        });
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let made = shape.try_mesh::<f64>();
        prop_assert_eq!(made.is_ok(), lowest > -0.5, "{}: {:?}", lowest, made.err());
    }
}
