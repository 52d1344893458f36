//! What a query says it did, where the number is known beforehand.

use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions, Sampling, Statistics};
use raycontact::escape::query_pair;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};

const LAYOUTS: [Layout; 2] = [Layout::Bvh, Layout::PaperOctree];

fn detect(meshes: [&Mesh<f64>; 2], layout: Layout, options: &DetectionOptions<f64>) -> ContactList<f64> {
    let octrees = meshes.map(|mesh| Octree::with_layout(mesh, layout));
    let mut list = ContactList::default();
    query_pair(meshes[0], &octrees[0], meshes[1], &octrees[1], options, &mut list).expect("the octrees are fresh");
    crate::common::assert_every_ray_is_counted(&list);
    list
}

/// The box from one corner to the other.
fn cuboid(lower: Point, upper: Point) -> Shape {
    shapes::block([1; 3]).map(|p| std::array::from_fn(|axis| lower[axis] + (upper[axis] - lower[axis]) * p[axis]))
}

/// A ball in a block, and with it an octahedron that has shrunk to a line: all its 6 vertices and 8 triangles are without a
/// normal. They are counted where they lie in the overlap box, and cast no rays.
#[test]
fn what_has_no_normal_is_counted_and_casts_nothing() {
    let (block, ball) = (shapes::cube(1).scaled(3.0).mesh(), shapes::sphere(1));
    for sampling in [Sampling::Vertices, Sampling::default()] {
        let options = DetectionOptions { sampling, ..DetectionOptions::paper() };
        let counts = |body: &Mesh<f64>, layout| {
            let Statistics { rays, without_normal, .. } = detect([body, &block], layout, &options).statistics;
            [rays, without_normal]
        };
        for layout in LAYOUTS {
            let [rays, without] = counts(&ball.mesh(), layout);
            assert!(rays >= 42 && without == 0, "{rays} rays, {without} without normal");
            let octahedron = shapes::octahedron();
            let mut mesh = ball.joined(&octahedron.scaled(0.5)).mesh::<f64>();
            let count = if sampling == Sampling::Vertices { 6 } else { 8 };
            // In the ball; below the block and beyond its overlap with the ball.
            for (middle, expected) in [(0.0, count), (-9.0, 0)] {
                let line = octahedron.map(|[x, y, _]| [0.5 * x + middle, 0.25 * y + middle, middle - 0.125 * y]);
                let flat = line.map(|[x, _, _]| [x, middle, middle]);
                mesh.set_positions(&ball.joined(&flat).positions).expect("finite");
                let [found, without] = counts(&mesh, layout);
                assert_eq!(without, expected, "{sampling:?}, {layout:?}, at {middle}");
                assert!(found == rays || middle != 0.0, "{found} rays, not {rays}");
            }
        }
    }
}

/// A slab pressed into a body with a flat fold within it. Nine of the slab's rays enter the fold on their way out, where there
/// are nine vertices above it; and four from the fold's lower vertices leave the fold, but not the body.
#[test]
fn rays_past_folds_are_counted() {
    let slab = shapes::block([10, 10, 1]).map(|[x, y, z]| [0.5 + 0.5 * x, 0.5 + 0.5 * y, z - 0.5]).mesh();
    let folded = cuboid([0.0; 3], [6.0; 3]).joined(&cuboid([2.2, 2.2, 0.1], [3.8, 3.8, 0.3])).mesh();
    for (past_folds, expected) in [(true, 9 + 4), (false, 0)] {
        let options = DetectionOptions { past_folds, ..DetectionOptions::paper() };
        for layout in LAYOUTS {
            for meshes in [[&slab, &folded], [&folded, &slab]] {
                assert_eq!(detect(meshes, layout, &options).statistics.past_folds, expected, "{layout:?}");
            }
        }
    }
}

/// The same for rays from edges. A bar with a flat fold within it, under a bar across it: of that one two edges and the
/// diagonal between them lie in the first, and their rays enter the fold. Of the first bar two edges and the diagonal lie
/// in the other, and the diagonal's ray goes through the fold, as do those of the fold's own two upper edges and their diagonal.
#[test]
fn rays_from_edges_past_folds_are_counted() {
    let first = cuboid([-1.0, -0.1, -0.1], [1.0, 0.1, 0.1]);
    let folded = first.joined(&cuboid([-0.2, -0.04, 0.05], [0.2, 0.04, 0.08])).mesh();
    let across = cuboid([-0.09, -1.0, 0.03], [0.13, 1.0, 0.27]).mesh();
    for (past_folds, expected) in [(true, 2 + 2), (false, 0)] {
        let options = DetectionOptions { past_folds, edges: true, ..DetectionOptions::paper() };
        for meshes in [[&folded, &across], [&across, &folded]] {
            let counts = detect(meshes, Layout::Bvh, &options).statistics;
            assert_eq!(counts.past_folds, expected, "{counts:?}");
        }
    }
}

/// A slab of needles within a block: each needle is longer than the spacing, but stands with others for a patch, and is not cut.
/// Patches have one ray each, also where the triangle in their middle has lost its area, but not where the patch has.
#[test]
fn patches_cast_one_ray_each_whatever_the_shape_of_their_triangles() {
    // More patches than make a packet worth its while, and fewer.
    for rows in [32, 6] {
        let slab = shapes::block([1, rows, 1]).map(|[x, y, z]| [4.0 * x, y / 8.0, z / 8.0]);
        let block = shapes::cube(1).scaled(9.0).mesh();
        let mut mesh = slab.mesh::<f64>();
        let mut octree = Octree::new(&mesh);
        let around = Octree::new(&block);
        let options = DetectionOptions { sampling: Sampling::Spacing(2.0), ..DetectionOptions::paper() };
        let mut list = ContactList::default();
        let mut counts = |map: &dyn Fn(Point) -> Point| {
            mesh.set_positions(&slab.map(map).positions).expect("finite");
            octree.update(&mesh).expect("its own");
            query_pair(&mesh, &octree, &block, &around, &options, &mut list).expect("up to date");
            let Statistics { rays, patches, without_normal, uncut_pieces, .. } = list.statistics;
            [rays, patches, without_normal, uncut_pieces]
        };
        let [rays, patches, ..] = counts(&|p| p);
        assert!(patches == rays && (4..64).contains(&rays), "{patches} patches, {rays} rays");
        assert_eq!(counts(&|p| p), [rays, rays, 0, 0]);
        // Every second row of vertices moves onto the one before.
        assert_eq!(counts(&|[x, y, z]| [x, (4.0 * y).floor() / 4.0, z]), [rays, rays, 0, 0]);
        // The two needles at an end turn over, so that one faces in and the other out: their patch has no area then.
        for [x_end, y_end] in [[0.0, 0.0], [4.0, 0.0], [0.0, rows as f64 / 8.0], [4.0, rows as f64 / 8.0]] {
            let turned = |[x, y, z]: Point| [x, y, if x == x_end && y == y_end { 0.125 - z } else { z }];
            assert_eq!(counts(&turned), [rays - 1, rays - 1, 1, 0]);
        }
    }
}

/// A thin plate, aslant through the floor of a body, with a small block aside that makes the overlap box wide: of its four
/// vertices inside, the two above cast rays that leave it before the body, the two below rays that meet nothing. Where
/// any ray leaves its own body first, no edges are traced.
///
/// The pair escapes in the direction that leads all points inside out, also where another part of the body lies on the way out of
/// each.
#[test]
fn own_surfaces_settle_what_rays_tell_and_points_behind_other_parts_escape() {
    let half = 0.5f64.sqrt();
    let plate = cuboid([-1.0, -1.0, -0.02], [1.0, 1.0, 0.02]);
    let plate = plate.map(|[x, y, z]| [x + 4.5, half * (y - z) - 1.0, half * (y + z)]);
    let aside = cuboid([4.4, 3.9, -5.0], [4.6, 4.1, -4.8]);
    let plate = plate.joined(&aside).mesh();
    let body = cuboid([-8.0, -8.0, 0.0], [8.0, 8.0, 9.0]);
    let fold = cuboid([-7.0, -7.0, 1.0], [7.0, 7.0, 2.0]);
    let options = DetectionOptions { edges: true, ..DetectionOptions::paper() };
    for body in [body.mesh(), body.joined(&fold).mesh()] {
        let counts = detect([&plate, &body], Layout::Bvh, &options).statistics;
        assert_eq!([counts.rays, counts.misses, counts.own_surface_hits, counts.edge_contacts], [4, 2, 2, 0]);
        let found = detect([&plate, &body], Layout::Bvh, &DetectionOptions { escape: true, ..options });
        assert_eq!([found.statistics.escapes_started, found.pushes().len() as u64], [1; 2]);
    }
}

/// A cube swallowed by another: the overlap box is its own box, on whose faces all its samples lie but for rounding. None is
/// lost: the contacts of each of its six faces have the same area.
fn every_face_casts<T: Scalar>(random: &mut Random) {
    let (cells, outer) = (2, shapes::cube(1).scaled(5.0).mesh::<T>());
    for _ in 0..100 {
        let inner = shapes::cube(cells).scaled(0.3).moved(random.point(2.0)).mesh::<T>();
        let octrees = [&inner, &outer].map(Octree::new);
        for sampling in [Sampling::default(), Sampling::Spacing(T::of(0.07)), Sampling::Accuracy(T::of(0.1))] {
            let (mut list, mut areas) = (ContactList::default(), [0.0; 6]);
            let options = DetectionOptions { sampling, escape: false, ..DetectionOptions::default() };
            query_pair(&inner, &octrees[0], &outer, &octrees[1], &options, &mut list).expect("the octrees are new");
            for contact in &list.contacts {
                areas[contact.p1.triangle as usize / (2 * cells * cells)] += contact.area.to_f64();
            }
            let [least, most] = [f64::min, f64::max].map(|of| areas.into_iter().reduce(of).expect("six"));
            assert!(least > 0.0 && most / least < 1.0 + 1e-4, "{sampling:?} at {:?}: {areas:?}", inner.positions()[0]);
        }
    }
}

#[test]
fn samples_on_faces_of_the_overlap_box_are_not_lost_by_rounding() {
    let mut random = Random::new(11);
    every_face_casts::<f32>(&mut random);
    every_face_casts::<f64>(&mut random);
}

/// A plate of 2 m and 0.2 m on a thicker slab, and a ball of 1 m: their volumes over their areas are 1/12 and about 1/3 m. Which of
/// the two bodies is the thin one does not matter. A sheet has no thickness.
#[test]
fn pairs_deeper_than_half_a_thickness_are_counted() {
    let slab = cuboid([-9.0, -9.0, -5.0], [9.0, 9.0, 0.0]).mesh();
    let plate = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 0.2]);
    let ball = shapes::sphere(3).moved([0.0, 0.0, 1.0]);
    let deep_pairs = |body: &Shape, depth: f64, layout| {
        let body = body.moved([0.3, 0.2, -depth]).mesh();
        [[&body, &slab], [&slab, &body]]
            .map(|meshes| detect(meshes, layout, &DetectionOptions::default()).statistics.deep_pairs)
    };
    for layout in LAYOUTS {
        for (body, half_thickness) in [(&plate, 1.0 / 12.0), (&ball, 1.0 / 3.0)] {
            assert_eq!(deep_pairs(body, 0.97 * half_thickness, layout), [0, 0]);
            assert_eq!(deep_pairs(body, 1.03 * half_thickness, layout), [1, 1]);
        }
    }
    let sheet = cuboid([-1.0, -1.0, -0.15], [1.0, 1.0, 0.05]);
    let lower = Mesh::open(&sheet.positions, &sheet.triangles[..10]).expect("an open sheet");
    let octrees = [&lower, &slab].map(Octree::new);
    let mut list = ContactList::default();
    query_pair(&lower, &octrees[0], &slab, &octrees[1], &DetectionOptions::default(), &mut list).expect("fresh");
    assert!(!list.is_empty() && list.statistics.deep_pairs == 0, "{:?}", list.statistics);
}
