//! Sheets: what closed bodies find behind them, against closed forms; and what is left out, counted.

use crate::common::shapes::{self, Shape};
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::{Mesh, MeshError};
use raycontact::query::{Layout, Octree};
use raycontact::scene::Scene;

/// The square from −3 to 3 at z = 0, cut into `cells` × `cells` squares of two triangles, facing up.
fn sheet(cells: usize) -> Shape {
    let width = cells as u32 + 1;
    let place = |index: u32| f64::from(index) * 6.0 / cells as f64 - 3.0;
    let positions = (0..width * width).map(|i| [place(i % width), place(i / width), 0.0]).collect();
    let corners = (0..width * width).filter(|i| i % width + 1 < width && i / width + 1 < width);
    let squares = corners.flat_map(|i| [[i, i + 1, i + width + 1], [i, i + width + 1, i + width]]);
    Shape { positions, triangles: squares.collect(), inside: Vec::new() }
}

fn open<T: Scalar>(shape: &Shape) -> Mesh<T> {
    Mesh::open(&shape.rounded(), &shape.triangles).expect("a sheet may be open")
}

/// Contacts between the body (0) and the sheet (1), and the force on the body for stiffness 1.
fn pressed<T: Scalar>(body: &Shape, sheet: &Mesh<T>, layout: Layout) -> (ContactList<T>, Vector3<f64>) {
    let body = body.mesh::<T>();
    let octrees = [&body, sheet].map(|mesh| Octree::with_layout(mesh, layout));
    let mut contacts = ContactList::default();
    let options = DetectionOptions::default();
    query_pair(&body, &octrees[0], sheet, &octrees[1], &options, &mut contacts).expect("the octrees are fresh");
    let force = contacts.contacts.iter().fold(Vector3::zeros(), |sum, contact| {
        let strength = (contact.area * contact.depth * contact.cos_alpha).to_f64();
        sum + contact.direction.map(T::to_f64) * if contact.colliding == 0 { strength } else { -strength }
    });
    (contacts, force)
}

/// The volume of the part of a closed shape below z = 0, exact: −∮ min(z, 0) n_z over its surface, each triangle cut at
/// zero.
fn volume_below_zero(shape: &Shape) -> f64 {
    let mut volume = 0.0;
    for triangle in &shape.triangles {
        let corners = triangle.map(|vertex| Vector3::from(shape.positions[vertex as usize]));
        let mut below: Vec<Vector3<f64>> = Vec::new();
        for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
            if from.z <= 0.0 {
                below.push(from);
            }
            if from.z * to.z < 0.0 {
                below.push(from + (to - from) * (from.z / (from.z - to.z)));
            }
        }
        for i in 2..below.len() {
            let [a, b, c] = [below[0], below[i - 1], below[i]];
            volume += (b - a).cross(&(c - a)).z / 2.0 * (a.z + b.z + c.z) / 3.0;
        }
    }
    volume
}

/// A strip has more vertices than triangles: 18 and 16, of which one group of sixteen holds all.
#[test]
fn a_strip_of_few_triangles_bears_a_ball_in_either_layout() {
    let positions = (0..18).map(|i| [f64::from(i / 2) - 4.0, f64::from(i % 2) * 4.0 - 2.0, 0.0]).collect();
    let squares = (0..8).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]);
    let strip = open::<f64>(&Shape { positions, triangles: squares.collect(), inside: Vec::new() });
    let ball = shapes::sphere(2).moved([0.13, -0.21, 0.7]);
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let (_, force) = pressed(&ball, &strip, layout);
        assert!((force.z / volume_below_zero(&ball) - 1.0).abs() < 0.03, "{layout:?}: {force:?}");
    }
}

/// Archimedes: the force is the volume behind the sheet, straight up.
#[test]
fn a_ball_on_a_sheet_is_borne_by_the_volume_behind_it() {
    fn check<T: Scalar>() {
        for (layout, cells) in [(Layout::Bvh, 1), (Layout::Bvh, 12), (Layout::PaperOctree, 5)] {
            let sheet = open::<T>(&sheet(cells));
            assert!(sheet.is_open());
            for depth in [0.1, 0.3, 0.6] {
                let ball = shapes::sphere(2).moved([0.13, -0.21, 1.0 - depth]);
                let (contacts, force) = pressed(&ball, &sheet, layout);
                let volume = volume_below_zero(&ball);
                assert!((force.z / volume - 1.0).abs() < 0.03, "{layout:?}, depth {depth}: {force:?}, not {volume}");
                assert!(force.xy().norm() < 0.02 * volume, "{force:?}");
                assert_eq!((contacts.statistics.pairs, contacts.statistics.open_pairs), (1, 1));
            }
        }
    }
    check::<f64>();
    check::<f32>();
}

/// A cube of side 2, sunk by a tenth: 4 · 0.1.
#[test]
fn a_cube_on_a_sheet_is_borne_by_the_volume_behind_it() {
    let (_, force) = pressed(&shapes::cube(3).moved([0.1, 0.2, 0.9]), &open::<f64>(&sheet(4)), Layout::Bvh);
    assert!((force.z - 0.4).abs() < 0.4 * 0.02 && force.xy().norm() < 1e-3, "{force:?}");
}

/// In front, behind, and beside: no ray leaves through the sheet before its own body.
#[test]
fn nothing_is_found_where_the_sheet_does_not_cut_the_body() {
    // Tilted, so that the boxes overlap.
    let tilted = |shape: &Shape| shape.turned(0.0, 0.7);
    let sheet = open::<f64>(&tilted(&sheet(4)));
    for at in [[0.0, 0.0, 0.5], [0.0, 0.0, -0.5], [3.2, 0.0, 0.0]] {
        let (contacts, _) = pressed(&tilted(&shapes::sphere(2).scaled(0.15).moved(at)), &sheet, Layout::Bvh);
        assert!(contacts.is_empty(), "{at:?}");
    }
    let (contacts, _) = pressed(&tilted(&shapes::sphere(2).scaled(0.15).moved([0.0, 0.0, 0.1])), &sheet, Layout::Bvh);
    assert!(!contacts.is_empty());
}

/// A body the sheet cuts deep, or a needle through it, step after step: it never escapes, and no edge is traced.
#[test]
fn a_pair_with_a_sheet_never_escapes() {
    for sampling in [Sampling::default(), Sampling::Vertices] {
        for body in
            [shapes::sphere(1).moved([0.0, 0.0, -0.7]), shapes::cube(1).map(|[x, y, z]| [0.01 * x, 0.01 * y, z])]
        {
            let mut scene = Scene::new(1).expect("no threads are needed");
            scene.add(open::<f64>(&sheet(2)));
            scene.add(body.mesh());
            scene.set_options(DetectionOptions { sampling, ..DetectionOptions::default() });
            let mut contacts = ContactList::default();
            for _ in 0..3 {
                scene.query(&mut contacts);
                crate::common::assert_every_ray_is_counted(&contacts);
                let found = contacts.statistics;
                assert_eq!((found.open_pairs, found.escaping_pairs, found.edge_contacts), (1, 0, 0));
            }
            assert!(scene.pair_memories().iter().all(|(_, memory)| *memory == Default::default()));
        }
    }
}

#[test]
fn two_sheets_are_counted_and_left_alone() {
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.add(open::<f64>(&sheet(2)));
    scene.add(open::<f64>(&sheet(2).turned(0.0, 1.0)));
    let mut contacts = ContactList::default();
    scene.query(&mut contacts);
    let found = contacts.statistics;
    assert_eq!((contacts.len(), found.pairs, found.open_pairs, found.rays), (0, 1, 1, 0));
}

/// The permission to be open is one for a border alone.
#[test]
fn creation_still_checks_all_else() {
    let sheet = sheet(1);
    assert!(matches!(sheet.try_mesh::<f64>(), Err(MeshError::Open { .. })));
    let flipped = [[0, 1, 3], [0, 2, 3]];
    let refused = Mesh::open(&sheet.positions, &flipped);
    assert!(matches!(refused, Err(MeshError::InconsistentOrientation { .. })), "{refused:?}");
    let fan = [[0, 1, 3], [3, 1, 2], [1, 3, 4]];
    let mut positions = sheet.positions.clone();
    positions.push([0.0, 0.0, 1.0]);
    assert!(matches!(Mesh::open(&positions, &fan), Err(MeshError::NonManifold { .. })));
    // One that is closed after all is a closed mesh, and must face outward.
    let cube = shapes::cube(1);
    assert!(!open::<f64>(&cube).is_open());
    let inward: Vec<_> = cube.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(matches!(Mesh::open(&cube.positions, &inward), Err(MeshError::Inward { .. })));
}
