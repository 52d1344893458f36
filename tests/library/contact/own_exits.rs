//! The ways out of a body that overlaps itself: what is inside against solid angles, the ends against every triangle, and the
//! ways against those out of two bodies in place of two lobes, and out of the other end of a bar.

use crate::common::STRIDE;
use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::own_exits::{OwnExit, OwnExits, OwnExitsError};
use raycontact::query::{Layout, Octree, OctreeError};
use std::f64::consts::{PI, TAU};

/// What is found, which must be the same in either layout.
fn own_exits<T: Scalar>(mesh: &Mesh<T>) -> Vec<OwnExit<T>> {
    let [wide, classic] = [Layout::Bvh, Layout::PaperOctree].map(|layout| {
        let mut own_exits = OwnExits::default();
        own_exits.find(mesh, &Octree::with_layout(mesh, layout)).expect("the octree is new");
        own_exits.exits().to_vec()
    });
    assert_eq!(wide, classic);
    assert!(wide.is_sorted_by(|a, b| a.vertex < b.vertex));
    wide
}

/// The sum of the solid angles of all triangles (van Oosterom and Strackee 1983), in spheres.
fn winding_number(mesh: &Mesh<f64>, point: &Vector3<f64>) -> f64 {
    let of_triangle = |triangle: u32| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| (corner - point).normalize());
        a.dot(&b.cross(&c)).atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a)) / TAU
    };
    (0..mesh.topology().triangles().len() as u32).map(of_triangle).sum()
}

/// How far a point is from a triangle, by projection and by edges.
fn distance_to(point: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    let [a, b, c] = corners;
    let to_edge = |p: &Vector3<f64>, q: &Vector3<f64>| {
        let along = (point - p).dot(&(q - p)) / (q - p).norm_squared();
        (p + (q - p) * along.clamp(0.0, 1.0) - point).norm()
    };
    let normal = (b - a).cross(&(c - a)).normalize();
    let foot = point - normal * (point - a).dot(&normal);
    let is_left = |p: &Vector3<f64>, q: &Vector3<f64>| (q - p).cross(&(foot - p)).dot(&normal) >= 0.0;
    if is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return (foot - point).norm();
    }
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

/// The part inside of each vertex, named by its smallest; of those outside none.
fn parts(mesh: &Mesh<f64>, is_inside: &[bool]) -> Vec<Option<u32>> {
    let mut parts: Vec<_> = (0..).zip(is_inside).map(|(vertex, inside)| inside.then_some(vertex)).collect();
    loop {
        let before = parts.clone();
        for edge in mesh.topology().edges() {
            let [a, b] = edge.vertices.map(|vertex| vertex as usize);
            if let (Some(one), Some(other)) = (parts[a], parts[b]) {
                (parts[a], parts[b]) = (Some(one.min(other)), Some(one.min(other)));
            }
        }
        if parts == before {
            return parts;
        }
    }
}

/// Holds what is found, of a shape at other positions, to solid angles and to all triangles; gives how many vertices are inside, and how many lie so near to
/// other triangles that no judge can tell.
fn assert_judged<T: Scalar>(shape: &Shape, positions: &[Point]) -> [usize; 2] {
    let (mut mesh, mut judge) = (shape.mesh::<T>(), shape.mesh::<f64>());
    let rounded: Vec<_> = positions.iter().map(|point| point.map(T::of)).collect();
    mesh.set_positions(&rounded).expect("finite");
    let exact: Vec<_> = rounded.iter().map(|point| point.map(T::to_f64)).collect();
    judge.set_positions(&exact).expect("finite");
    let found = own_exits(&mesh);
    let size = judge.aabb().longest_side();
    // No triangle within so far is there but those around a vertex.
    let apart = size * if T::ROUNDING_UNIT.to_f64() < 1e-10 { 1e-9 } else { 1e-5 };
    let mut is_inside = vec![false; exact.len()];
    found.iter().for_each(|exit| is_inside[exit.vertex as usize] = true);
    let mut unsure = 0;
    for &vertex in judge.topology().surface_vertices() {
        let Some(normal) = judge.vertex_normal(vertex) else {
            assert!(!is_inside[vertex as usize]);
            continue;
        };
        let point = judge.positions()[vertex as usize];
        let mut others = (0..).zip(judge.topology().triangles()).filter(|(_, corners)| !corners.contains(&vertex));
        if others.any(|(t, _)| distance_to(&point, &judge.corners(t)) < apart) {
            unsure += 1;
            continue;
        }
        let number = winding_number(&judge, &(point - normal.normal * (0.5 * apart)));
        if (number - number.round()).abs() < 0.1 {
            assert_eq!(is_inside[vertex as usize], number > 1.5, "vertex {vertex}: {number}");
        } else {
            unsure += 1;
        }
    }
    let parts = parts(&judge, &is_inside);
    for exit in &found {
        assert_nearest(&judge, &parts, exit);
    }
    [found.len(), unsure]
}

/// Holds an exit to all triangles but those of the vertex' part, which grows while the nearest point is its own too.
fn assert_nearest<T: Scalar>(judge: &Mesh<f64>, parts: &[Option<u32>], exit: &OwnExit<T>) {
    let (point, triangles) = (judge.positions()[exit.vertex as usize], judge.topology().triangles());
    let rounding = 64.0 * T::ROUNDING_UNIT.to_f64() * judge.aabb().longest_side();
    let mut is_own: Vec<bool> = parts.iter().map(|part| *part == parts[exit.vertex as usize]).collect();
    let distances: Vec<_> = (0..triangles.len() as u32).map(|t| distance_to(&point, &judge.corners(t))).collect();
    loop {
        let of_part = |corners: &[u32; 3]| corners.iter().any(|&corner| is_own[corner as usize]);
        let others = (0..).zip(triangles).filter(|(_, corners)| !of_part(corners));
        let nearest = others.map(|(t, _)| t).min_by(|&a: &usize, &b| distances[a].total_cmp(&distances[b]));
        let Some(end) = exit.exit else {
            assert_eq!(nearest, None, "{exit:?}");
            return;
        };
        let nearest = nearest.expect("there is one");
        let position = end.position.map(T::to_f64);
        if !of_part(&triangles[end.triangle as usize]) && (end.distance.to_f64() - distances[nearest]).abs() <= rounding
        {
            assert!(((position - point).norm() - distances[nearest]).abs() <= 2.0 * rounding, "{exit:?}");
            assert!(distance_to(&position, &judge.corners(end.triangle)) <= rounding, "{exit:?}");
            return;
        }
        // Farther than what there is: because that belongs to a triangle of the part too.
        assert!(distances[nearest] <= end.distance.to_f64() + rounding, "{exit:?}");
        let corners = triangles[nearest];
        let beside = |t: &u32| {
            let other = triangles[*t as usize];
            of_part(&other) && (distances[*t as usize] - distances[nearest]) <= rounding
        };
        let mut around = corners.iter().flat_map(|&corner| judge.topology().triangles_around(corner));
        assert!(around.any(beside), "{exit:?}: triangle {nearest} at {}", distances[nearest]);
        let before = is_own.clone();
        for edge in judge.topology().edges() {
            let [a, b] = edge.vertices.map(|vertex| vertex as usize);
            is_own[a] |= before[b];
            is_own[b] |= before[a];
        }
    }
}

/// A bar of `cells`, bent so that the share s of its length goes along a curve; and of each vertex its share.
fn bent(cells: [usize; 3], sides: [f64; 2], curve: impl Fn(f64) -> Vector3<f64>) -> (Shape, Vec<f64>) {
    let mut bar = shapes::block(cells);
    let shares = bar.positions.iter().map(|p| p[0] / cells[0] as f64).collect();
    let mut random = Random::new(7);
    for p in &mut bar.positions {
        // Uneven, so that nothing lies in one plane.
        let [s, across, up] = [0, 1, 2].map(|axis| (p[axis] + 0.05 * random.signed()) / cells[axis] as f64 - 0.5);
        let along = (curve(s + 0.501) - curve(s + 0.499)).normalize();
        let beside = Vector3::z().cross(&along).normalize();
        *p = (curve(s + 0.5) + beside * (sides[0] * across) + along.cross(&beside) * (sides[1] * up)).into();
    }
    (bar, shares)
}

/// A little more than one turn, as a screw.
fn ring(turns: f64) -> impl Fn(f64) -> Vector3<f64> {
    move |s| Vector3::new((TAU * turns * s).cos(), (TAU * turns * s).sin(), 0.12 * s)
}

/// A U so narrow that its arms cross.
fn hairpin(s: f64) -> Vector3<f64> {
    let (radius, half) = (0.3, 0.3 * 0.62 * PI);
    let way = (2.0 * s - 1.0) * (half + 1.2);
    let turn = way.clamp(-half, half) / radius;
    let beyond = way - radius * turn;
    Vector3::new(radius * turn.cos() - beyond * turn.sin(), radius * turn.sin() + beyond * turn.cos(), 0.05 * s)
}

fn bars() -> [(Shape, Vec<f64>); 3] {
    [
        bent([36, 3, 3], [0.25, 0.25], ring(1.13)),
        bent([36, 4, 4], [0.25, 0.25], hairpin),
        bent([24, 1, 7], [0.08, 1.0], hairpin),
    ]
}

#[test]
fn bars_that_overlap_themselves_are_judged_right() {
    for (bar, _) in bars() {
        for turn in (0..8).step_by(STRIDE) {
            let bar = bar.turned(0.7 * f64::from(turn as u32), 1.3 * f64::from(turn as u32));
            let [inside, unsure] = assert_judged::<f64>(&bar, &bar.positions);
            assert!(inside > 15 && unsure < 2, "{inside}, {unsure}");
            let [inside, unsure] = assert_judged::<f32>(&bar, &bar.positions);
            assert!(inside > 15 && unsure < 5, "{inside}, {unsure}");
        }
    }
}

/// Of a bar's other end, and of the other arm, every point is half the bar away along it, and no other point inside is.
#[test]
fn ways_lead_out_of_the_other_end_of_the_bar() {
    for (bar, shares) in bars() {
        let mesh = bar.mesh::<f64>();
        let found = own_exits(&mesh);
        for exit in &found {
            let point = mesh.positions()[exit.vertex as usize];
            let own = shares[exit.vertex as usize];
            let is_far = |corners: &[u32; 3]| (shares[corners[0] as usize] - own).abs() > 0.25;
            let far = (0..).zip(mesh.topology().triangles()).filter(|(_, corners)| is_far(corners));
            let nearest = far.map(|(t, _)| distance_to(&point, &mesh.corners(t))).fold(f64::INFINITY, f64::min);
            let distance = exit.exit.expect("there is another end").distance;
            assert!((distance - nearest).abs() < 1e-12, "vertex {}: {distance}, not {nearest}", exit.vertex);
        }
        assert!(found.len() > 15);
    }
}

/// One mesh of two bodies: the vertices of either that lie inside the other, and the nearest points of that.
#[test]
fn two_lobes_have_the_ways_out_of_two_bodies() {
    let mut inside = 0;
    for step in (0..48).step_by(STRIDE) {
        let mut random = Random::new(step);
        let a = shapes::torus(24, 12, 0.35);
        let b = if step % 2 == 0 { a.clone() } else { shapes::sphere(2).scaled(0.6) };
        let b = b.turned(3.0 * random.signed(), 3.0 * random.signed()).moved(random.point(1.0));
        let joined = a.joined(&b).mesh::<f64>();
        let lobes = [a.mesh::<f64>(), b.mesh()];
        let octrees = lobes.each_ref().map(Octree::new);
        let tracers = [0, 1].map(|lobe| octrees[lobe].tracer(&lobes[lobe]).expect("it is new"));
        let (found, mut expected) = (own_exits(&joined), Vec::new());
        for (vertex, point) in (0..).zip(joined.positions()) {
            let other = tracers[usize::from((vertex as usize) < a.positions.len())];
            if other.winding_number(point, &mut Vec::new()) == Some(1) {
                let nearest = other.closest_point_of_all(point, f64::INFINITY).expect("there is one");
                expected.push((vertex, nearest.distance));
            }
        }
        assert_eq!(found.len(), expected.len(), "step {step}");
        for (exit, (vertex, distance)) in found.iter().zip(expected) {
            assert_eq!(exit.vertex, vertex, "step {step}");
            let found = exit.exit.expect("there is another lobe").distance;
            assert!((found - distance).abs() < 1e-12, "step {step}, vertex {vertex}: {found}, not {distance}");
        }
        inside += found.len();
    }
    assert!(inside > 50, "{inside}");
}

/// Coordinates on a grid: rays along the axes meet edges and vertices.
#[test]
fn blocks_on_one_grid_are_judged_right() {
    let block = shapes::block([4, 3, 5]);
    let mut inside = 0;
    for [x, y, z] in [[2.0, 1.0, 2.0], [1.5, 0.5, 0.5], [2.0, 0.5, 1.0], [0.5, 0.0, 0.0], [3.5, 2.5, 4.5]] {
        let two = block.joined(&block.moved([x, y, z]));
        inside += assert_judged::<f64>(&two, &two.positions)[0] + assert_judged::<f32>(&two, &two.positions)[0];
    }
    assert!(inside > 30, "{inside}");
}

/// Surfaces with folds and spikes, up to pure garbage.
#[test]
fn garbage_is_judged_right() {
    for step in (0..40).step_by(STRIDE) {
        let mut random = Random::new(step);
        let noise = [0.05, 0.2, 0.6, 2.0][step as usize % 4];
        let shape = shapes::sphere(2);
        let mut positions = shape.positions.clone();
        positions.iter_mut().flatten().for_each(|x| *x += noise * random.signed());
        let [inside, _] = assert_judged::<f64>(&shape, &positions);
        assert!(inside > 0 || noise < 0.3, "{step}");
        assert_judged::<f32>(&shape, &positions);
    }
}

#[test]
fn what_cannot_be_asked_is_said() {
    let shape = shapes::torus(12, 6, 0.4);
    let mut mesh = shape.mesh::<f64>();
    let octree = Octree::new(&mesh);
    let mut own_exits = OwnExits::default();
    assert_eq!(own_exits.find(&mesh, &octree), Ok(&[][..]), "it overlaps nowhere");
    let refused = own_exits.find(&shape.mesh(), &octree).map(<[_]>::len);
    assert_eq!(refused, Err(OwnExitsError::Octree(OctreeError::OtherMesh)));
    mesh.set_positions(&shape.positions).expect("finite");
    let refused = own_exits.find(&mesh, &octree).map(<[_]>::len);
    assert_eq!(refused, Err(OwnExitsError::Octree(OctreeError::Stale)));
    let open = Mesh::open(&shape.positions, &shape.triangles[1..]).expect("it has a border");
    let refused = own_exits.find(&open, &Octree::new(&open)).map(<[_]>::len);
    assert_eq!(refused, Err(OwnExitsError::Open));
    assert!(own_exits.exits().is_empty() && OwnExitsError::Open.to_string().contains("open"));
}
