//! Holes closed when a mesh is made: against the same mesh whole, closed by hand, and against brute force over all caps.

use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions};
use raycontact::escape::query_pair;
use raycontact::mesh::{Mesh, MeshError};
use raycontact::query::Octree;
use raycontact::triangle::Ray;

/// Large enough for every hole here, and too small for a sheet.
const MOST: f64 = 0.2;

fn closing(shape: &Shape, most: f64) -> Result<Mesh<f64>, MeshError> {
    Mesh::closing_holes(&shape.positions, &shape.triangles, most)
}

/// Without the triangles around these vertices.
fn holed(shape: &Shape, vertices: &[u32]) -> Shape {
    let kept = shape.triangles.iter().filter(|corners| !corners.iter().any(|corner| vertices.contains(corner)));
    Shape { triangles: kept.copied().collect(), ..shape.clone() }
}

fn farthest(shape: &Shape, way: Point) -> u32 {
    let along = |vertex: &usize| shapes::dot(shape.positions[*vertex], way);
    (0..shape.positions.len()).max_by(|v, w| along(v).total_cmp(&along(w))).expect("it has vertices") as u32
}

fn bumpy() -> Shape {
    shapes::sphere(3).map(|[x, y, z]| {
        let radius = 1.0 + 0.15 * (5.0 * x).sin() * (4.0 * y + 1.0).cos() * (3.0 * z).sin();
        [x * radius, y * radius, 0.7 * z * radius]
    })
}

#[test]
fn holes_of_round_and_bumpy_bodies_are_closed_and_listed() {
    for whole in [shapes::sphere(3), bumpy()] {
        let volume = whole.mesh::<f64>().volume();
        for count in [1, 3] {
            let ways = [[0.0, 0.0, -1.0], [1.0, 0.2, 0.1], [-0.3, 1.0, 0.6]];
            let tops: Vec<u32> = ways[..count].iter().map(|&way| farthest(&whole, way)).collect();
            let open = holed(&whole, &tops);
            assert!(matches!(open.try_mesh::<f64>(), Err(MeshError::Open { .. })));
            let mesh = closing(&open, MOST).expect("its holes are small");
            assert!(!mesh.is_open());
            assert_eq!(mesh.holes().len(), count);
            assert_eq!(mesh.positions().len(), whole.positions.len());
            let triangles = mesh.topology().triangles();
            assert_eq!(triangles[..open.triangles.len()], open.triangles);
            let mut first = open.triangles.len() as u32;
            for hole in mesh.holes() {
                assert_eq!(hole.first_triangle, first);
                first += hole.triangle_count;
                let own = &triangles[hole.first_triangle as usize..first as usize];
                let mut around = own.concat();
                around.sort_unstable();
                around.dedup();
                assert_eq!(around.len(), hole.triangle_count as usize + 2);
                assert!(hole.area_share > 0.001 && hole.area_share < 0.01, "{hole:?}");
            }
            assert_eq!(first as usize, triangles.len());
            // What is lost are the caps of the body above the flat ones.
            assert!(mesh.volume() < volume && mesh.volume() > volume * (1.0 - 0.002 * count as f64));
            let octree = Octree::new(&mesh);
            let tracer = octree.tracer(&mesh).expect("the octree is new");
            let mut crossings = Vec::new();
            let points =
                (0..2000).map(|i| [0.618_034, 0.414_214, 0.302_776].map(|s| (f64::from(i) * s).fract() * 3.0 - 1.5));
            for point in points {
                let expected = shapes::dot(point, point) < 0.4;
                let outside = shapes::dot(point, point) > 1.5;
                let ray = Ray::new(point.into(), [3.0, 4.0, 8.7].into());
                tracer.crossings(&ray, &mut crossings);
                let found: i32 = crossings.iter().map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum();
                let sum = solid_angles(&mesh, point);
                assert!((f64::from(found) - sum).abs() < 1e-6, "{point:?}: {found}, not {sum}");
                assert!((!expected || found == 1) && (!outside || found == 0), "{point:?}: {found}");
            }
        }
    }
}

fn solid_angles(mesh: &Mesh<f64>, point: Point) -> f64 {
    use shapes::{cross, dot};
    let angle = |triangle: u32| {
        let [a, b, c] = mesh.corners(triangle).map(|p| [p.x - point[0], p.y - point[1], p.z - point[2]]);
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        2.0 * dot(a, cross(b, c)).atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    };
    let count = mesh.topology().triangles().len() as u32;
    (0..count).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// A flat hole is closed by its own plane, whatever its outline: the volume is that of the whole block.
#[test]
fn flat_holes_are_closed_exactly() {
    let whole = shapes::block([6, 6, 6]);
    let faces = [[1.0, 1.0], [4.0, 1.0], [2.0, 2.0], [5.0, 4.0], [1.0, 5.0]];
    let is_gone = |corners: &[u32; 3]| {
        let on_top = corners.iter().all(|&corner| whole.positions[corner as usize][2] == 6.0);
        on_top
            && corners.iter().any(|&corner| faces.iter().any(|&[x, y]| whole.positions[corner as usize] == [x, y, 6.0]))
    };
    let triangles = whole.triangles.iter().copied().filter(|corners| !is_gone(corners)).collect();
    let open = Shape { triangles, ..whole.clone() };
    let mesh = closing(&open, 1.0).expect("it can be closed");
    assert!((mesh.volume() / 216.0 - 1.0).abs() < 1e-12, "{}", mesh.volume());
    let area: f64 = (0..mesh.topology().triangles().len() as u32).map(|t| mesh.scaled_normal(t).norm() / 2.0).sum();
    assert!((area / 216.0 - 1.0).abs() < 1e-12, "{area}");
    let taken: f64 = mesh.holes().iter().map(|hole| hole.area_share).sum();
    let given = 216.0 / (1.0 + taken);
    let gone: f64 = (whole.triangles.len() - open.triangles.len()) as f64 / 2.0;
    assert!((given - (216.0 - gone)).abs() < 1e-9, "{taken}");
}

/// Of all triangulations of a bent loop none has less area.
#[test]
fn no_cap_has_less_area() {
    fn all_areas(at: &[Point], i: usize, j: usize) -> Vec<f64> {
        if j == i + 1 {
            return vec![0.0];
        }
        let mut areas = Vec::new();
        for k in i + 1..j {
            let side = |to: usize| [0, 1, 2].map(|axis| at[to][axis] - at[i][axis]);
            let normal = shapes::cross(side(k), side(j));
            let own = shapes::dot(normal, normal).sqrt() / 2.0;
            let (left, right) = (all_areas(at, i, k), all_areas(at, k, j));
            areas.extend(left.iter().flat_map(|&l| right.iter().map(move |&r| l + r + own)));
        }
        areas
    }
    for seed in 1..40 {
        // A cone over a bent loop.
        let count = 5 + seed % 5;
        let random = |i: usize, s: f64| ((seed * 31 + i) as f64 * s).fract();
        let mut positions: Vec<Point> = (0..count)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                let radius = 0.5 + random(i, 0.618_034);
                [radius * cos, radius * sin, 0.5 * random(i, 0.414_214)]
            })
            .collect();
        let least = all_areas(&positions, 0, count - 1).into_iter().fold(f64::INFINITY, f64::min);
        positions.push([0.0, 0.0, 5.0]);
        let triangles: Vec<[u32; 3]> = (0..count).map(|i| [i as u32, ((i + 1) % count) as u32, count as u32]).collect();
        let mesh = Mesh::<f64>::closing_holes(&positions, &triangles, 1.0).expect("it can be closed");
        let cap = (count as u32..mesh.topology().triangles().len() as u32).map(|t| mesh.scaled_normal(t).norm() / 2.0);
        let area: f64 = cap.sum();
        assert!((least * (1.0 - 1e-12)..least * (1.0 + 1e-4)).contains(&area), "{seed}: {area}, not {least}");
    }
}

#[test]
fn contacts_are_those_of_the_mesh_closed_by_hand() {
    let whole = bumpy();
    let open = holed(&whole, &[farthest(&whole, [0.0, 0.0, -1.0])]);
    let by_option = closing(&open, MOST).expect("its hole is small");
    let by_hand = Mesh::new(&open.positions, by_option.topology().triangles()).expect("it is closed");
    let other = shapes::sphere(3).moved([0.1, 0.2, -1.4]).mesh::<f64>();
    let contacts = |mesh: &mut Mesh<f64>| {
        // The cap deforms with its vertices.
        let bent: Vec<Point> = open.positions.iter().map(|&[x, y, z]| [x, y, z * 1.1 + 0.05 * x]).collect();
        mesh.set_positions(&bent).expect("they are finite");
        let octrees = [&*mesh, &other].map(Octree::new);
        let mut list = ContactList::default();
        let options = DetectionOptions::default();
        query_pair(mesh, &octrees[0], &other, &octrees[1], &options, &mut list).expect("the octrees are fresh");
        list.contacts
    };
    let [found, expected] = [by_option, by_hand].map(|mut mesh| contacts(&mut mesh));
    assert!(!expected.is_empty());
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    let caps = open.triangles.len() as u32;
    let on_cap = |triangle: u32, body: usize| body == 0 && triangle >= caps;
    assert!(
        expected
            .iter()
            .any(|c| on_cap(c.p1.triangle, c.colliding as usize) || on_cap(c.p2.triangle, c.collided as usize)),
        "no contact is on the cap"
    );
}

#[test]
fn what_is_closed_stays_as_it_is() {
    let mesh = closing(&shapes::torus(12, 8, 0.3), MOST).expect("it is closed");
    assert!(mesh.holes().is_empty());
    assert!(shapes::sphere(1).mesh::<f64>().holes().is_empty());
}

fn message(refused: Result<Mesh<f64>, MeshError>) -> (MeshError, String) {
    let error = refused.map(|_| "accepted").expect_err("it is refused");
    let message = error.to_string();
    (error, message)
}

#[test]
fn the_border_of_a_sheet_is_no_hole() {
    let whole = shapes::cube(4);
    let is_top = |corners: &[u32; 3]| corners.iter().all(|&corner| whole.positions[corner as usize][2] == 1.0);
    let sheet = Shape { triangles: whole.triangles.iter().copied().filter(is_top).collect(), ..whole.clone() };
    let (error, text) = message(closing(&sheet, MOST));
    assert!(matches!(error, MeshError::HoleTooLarge { vertex_count: 16, share, .. } if (share - 1.0).abs() < 1e-12));
    assert!(text.contains("16 vertices") && text.contains("close_holes is 0.2") && text.contains("sheet"), "{text}");
    // Beside a large body too.
    let beside = shapes::sphere(3).scaled(50.0).joined(&sheet.moved([200.0, 0.0, 0.0]));
    assert!(matches!(message(closing(&beside, MOST)).0, MeshError::HoleTooLarge { .. }));
    // A box without its lid has a fifth of its area left out.
    let lidless =
        Shape { triangles: whole.triangles.iter().copied().filter(|t| !is_top(t)).collect(), ..whole.clone() };
    assert!(matches!(message(closing(&lidless, 0.19)).0, MeshError::HoleTooLarge { .. }));
    let mesh = closing(&lidless, 0.21).expect("that is a large hole");
    assert!((mesh.holes()[0].area_share - 0.2).abs() < 1e-12 && (mesh.volume() - 8.0).abs() < 1e-12);
}

#[test]
fn seams_and_holes_that_touch_are_refused() {
    let whole = shapes::sphere(3);
    // Each triangle has vertices of its own, as in .stl files.
    let positions =
        whole.triangles.iter().flatten().map(|&corner| whole.positions[corner as usize]).collect::<Vec<_>>();
    let count = positions.len();
    let triangles = (0..count as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let (error, text) = message(closing(&Shape { positions, triangles, inside: Vec::new() }, MOST));
    let MeshError::Seam { vertices: [a, b], count: found } = error else { panic!("{text}") };
    assert!(found == count && a != b, "{found} of {count}");
    assert!(text.contains("weld") && text.contains(&count.to_string()), "{text}");

    // Opposite triangles around a vertex.
    let top = farthest(&whole, [0.3, 0.2, -1.0]);
    let around: Vec<usize> = (0..whole.triangles.len()).filter(|&t| whole.triangles[t].contains(&top)).collect();
    let other = around[1..].iter().copied().find(|&t| {
        whole.triangles[t].iter().filter(|&corner| whole.triangles[around[0]].contains(corner)).count() == 1
    });
    let gone = [around[0], other.expect("another touches it there alone")];
    let kept = whole.triangles.iter().enumerate().filter(|(t, _)| !gone.contains(t)).map(|(_, &corners)| corners);
    let (error, text) = message(closing(&Shape { triangles: kept.collect(), ..whole.clone() }, MOST));
    assert_eq!(error, MeshError::HolesTouch { vertex: top });
    assert!(text.contains(&format!("share vertex {top}")), "{text}");
}

#[test]
fn holes_without_a_cap_are_refused() {
    // A tube around 1001 vertices.
    let count = 1001;
    let ring = |z: f64| {
        (0..count).map(move |i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
            [cos, sin, z]
        })
    };
    let positions: Vec<Point> = ring(0.0).chain([[0.0, 0.0, 1.0]]).collect();
    let triangles = (0..count as u32).map(|i| [i, (i + 1) % count as u32, count as u32]).collect();
    let (error, text) = message(closing(&Shape { positions, triangles, inside: Vec::new() }, 1.0));
    assert_eq!(error, MeshError::HoleTooLong { vertex: 0, vertex_count: 1001, most: 1000 });
    assert!(text.contains("1001 vertices") && text.contains("1000"), "{text}");

    // A tetrahedron with a vertex on one edge that only one side knows: the hole has three corners on a line.
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.0, 0.0]];
    let triangles = vec![[0, 2, 1], [0, 4, 3], [4, 1, 3], [0, 3, 2], [1, 2, 3]];
    let (error, text) = message(closing(&Shape { positions, triangles, inside: Vec::new() }, MOST));
    assert_eq!(error, MeshError::HoleNotClosed { vertex: 0, vertex_count: 3 });
    assert!(text.contains("no area") && text.contains("vertex 0"), "{text}");

    for value in [-0.1, 1.5, f64::NAN] {
        let (_, text) = message(closing(&shapes::octahedron(), value));
        assert!(text.contains("close_holes is") && text.contains("from 0 to 1"), "{text}");
    }
}
