use super::*;
use crate::query::{Octree, Tracer, Tree};
use crate::random::Random;
use crate::shapes::{self, Shape};
use crate::simd::on_every_path;

/// The tiles of one body that may have something inside another, in the overlap box.
#[derive(Clone, Copy)]
struct Asked<'a, T: Scalar> {
    own: &'a Bvh<T>,
    other: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    region: &'a Aabb<T>,
}

impl<T: Scalar> Kernel<T> for Asked<'_, T> {
    type Output = (Vec<u32>, bool);

    fn run<L: Lanes<T>>(self) -> Self::Output {
        let Self { own, other, mesh, region } = self;
        let (mut tiles, mut scratch) = (Vec::new(), SidesScratch::default());
        TilesNotOutside { own, other, mesh, region, tiles: &mut tiles, scratch: &mut scratch }.run::<L>();
        (tiles, MayMeet { own, other, mesh, region }.run::<L>())
    }
}

fn tree<'a, T: Scalar>(tracer: &Tracer<'a, T>) -> &'a Bvh<T> {
    match tracer.tree {
        Tree::Bvh(tree) => tree,
        Tree::PaperOctree(_) => panic!("wide is the default"),
    }
}

/// What was kept and left out of the first body's tiles in the overlap box, and whether the surfaces may meet there.
struct Found {
    kept: usize,
    left_out: usize,
    may_meet: bool,
}

/// Holds every vertex of what is left out against the winding number of the second body there.
fn judged<T: Scalar>(first: &Shape, second: &Shape) -> Found {
    let meshes = [first.mesh::<T>(), second.mesh()];
    let octrees = meshes.each_ref().map(Octree::new);
    let tracers = [0, 1].map(|side| octrees[side].tracer(&meshes[side]).expect("it is new"));
    let [own, other] = tracers.each_ref().map(tree);
    let region = meshes[0].aabb().intersection(meshes[1].aabb());
    let asked = Asked { own, other, mesh: &meshes[1], region: &region };
    let mut all = on_every_path::<T, _>(asked);
    let (kept, may_meet) = all.pop().expect("one path is always there");
    assert!(all.iter().all(|found| *found == (kept.clone(), may_meet)), "all paths find the same");
    assert!(kept.is_sorted());
    let (mut in_region, mut crossings, mut left_out) = (Vec::new(), Vec::new(), 0);
    own.tiles_in(&region, &mut in_region);
    assert!(kept.iter().all(|tile| in_region.contains(tile)));
    for tile in in_region.into_iter().filter(|tile| !kept.contains(tile)) {
        left_out += 1;
        for &vertex in own.vertices_of(tile) {
            let point = meshes[0].position(vertex);
            if region.contains(&point) {
                let number = tracers[1].winding_number(&point, &mut crossings).expect("it is closed");
                assert!(number <= 0, "tile {tile}, vertex {vertex}: {number}");
            }
        }
    }
    if !may_meet {
        for [a, b] in [[0, 1], [1, 0]] {
            for [from, to] in meshes[a].topology().edges().map(|edge| edge.vertices.map(|v| meshes[a].position(v))) {
                tracers[b].crossings(&Ray { t_max: T::one(), ..Ray::new(from, to - from) }, &mut crossings);
                assert!(crossings.is_empty(), "an edge of {a} crosses");
            }
        }
    }
    Found { kept: kept.len(), left_out, may_meet }
}

fn in_both_precisions(first: &Shape, second: &Shape) -> Found {
    judged::<f32>(first, second);
    judged::<f64>(first, second)
}

#[test]
fn what_is_left_out_has_no_vertex_inside() {
    let mut random = Random::new(7);
    let bodies =
        [shapes::torus(96, 48, 0.4), shapes::sphere(5), shapes::cube(24), shapes::block([6, 40, 40]).scaled(0.05)];
    let (mut kept, mut left_out) = (0, 0);
    for first in &bodies {
        for second in &bodies {
            let [about_z, about_x] = [random.signed() * 3.0, random.signed() * 3.0];
            let second = second.turned(about_z, about_x).moved(random.point(0.5));
            let found = in_both_precisions(first, &second);
            (kept, left_out) = (kept + found.kept, left_out + found.left_out);
        }
    }
    assert!(left_out > 300 && kept > 300, "{kept} kept, {left_out} left out");
}

/// Far from the origin coordinates are coarse, and boxes keep a larger distance.
#[test]
fn what_is_left_out_far_from_the_origin_has_no_vertex_inside() {
    let torus = shapes::torus(96, 48, 0.4);
    let found = [1.0, 30.0, 1000.0].map(|far| {
        let [first, second] = [torus.clone(), torus.turned(0.3, 1.2).moved([0.3, 0.2, 0.1])];
        judged::<f32>(&first.moved([far; 3]), &second.moved([far; 3])).left_out
    });
    assert!(found[0] > 30 && found[0] >= found[1] && found[1] >= found[2], "{found:?}");
}

/// Of two spheres that overlap, the winding number is 2 where both are: inside. In a cavity it is 0: outside.
#[test]
fn folds_are_inside_and_cavities_outside() {
    let probe = shapes::sphere(4).scaled(0.3);
    let sphere = shapes::sphere(4);
    let twice = sphere.joined(&sphere.moved([0.5, 0.0, 0.0]));
    let found = in_both_precisions(&probe.moved([0.2, 0.0, 0.0]), &twice);
    assert!(found.kept > 0 && found.left_out == 0 && !found.may_meet);
    let mut inner = sphere.scaled(0.6);
    inner.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let found = in_both_precisions(&probe, &sphere.joined(&inner));
    assert!(found.kept == 0 && found.left_out > 0 && !found.may_meet);
}

#[test]
fn surfaces_that_pass_one_another_do_not_meet() {
    let torus = shapes::torus(96, 48, 0.4);
    // In the hole, and a swallowed one.
    let found = in_both_precisions(&shapes::sphere(4).scaled(0.3), &torus);
    assert!(found.kept == 0 && !found.may_meet);
    let found = in_both_precisions(&shapes::sphere(4).scaled(0.2).moved([1.0, 0.0, 0.0]), &torus);
    assert!(found.left_out == 0 && found.kept > 0 && !found.may_meet);
    let found = in_both_precisions(&shapes::sphere(4).scaled(0.3).moved([0.4, 0.0, 0.0]), &torus);
    assert!(found.left_out > 0 && found.kept > 0 && found.may_meet);
}
