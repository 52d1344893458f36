use super::*;
use crate::mesh::test_mesh::torus;
use std::collections::BTreeSet;

/// A surface so large that nodes have nodes under them, and what was found near of it; `offer`
/// as in the search.
fn search(
    [tile_margin, margin]: [f64; 2],
    mut offer: impl FnMut(u32, u32, bool) -> f64,
) -> (Mesh<f64>, Octree<f64>, NearTiles<f64>) {
    let (mesh, mut near) = (torus([48, 12]), NearTiles::default());
    let octree = Octree::new(&mesh);
    let tree = tree_of(&octree);
    assert!(tree.nodes.len() > 2 && !tree.nodes[0].is_leaf);
    let reach = Reach { touch: 0.0, margin, tile_margin, most_pairs: usize::MAX };
    octree.search_near(&mesh, &reach, &mut near, |a, b, is_steep| Some(offer(a, b, is_steep)));
    (mesh, octree, near)
}

fn tree_of(octree: &Octree<f64>) -> &Bvh<f64> {
    let Tree::Bvh(tree) = &octree.tree else { panic!("the default layout") };
    tree
}

/// The two places of each pair, the smaller first, in their order.
fn sorted(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut pairs: Vec<_> = pairs.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort();
    pairs
}

/// Along each axis how far apart two boxes are, at least 0.
fn gaps(tree: &Bvh<f64>, [a, b]: [u32; 2]) -> Vector3<f64> {
    let (a, b) = (&tree.outlines[a as usize].aabb, &tree.outlines[b as usize].aabb);
    (a.lower - b.upper).sup(&(b.lower - a.upper)).sup(&Vector3::zeros())
}

#[test]
fn the_pairs_of_tiles_are_those_whose_boxes_are_near() {
    for distance in [0.0, 0.03, 0.29, 4.0] {
        let (_, octree, near) = search([distance, 0.0], |_, _, _| 0.0);
        let tree = tree_of(&octree);
        let count = tree.tiles.len() as u32;
        let all = (0..count).flat_map(|a| (a..count).map(move |b| [a, b]));
        let expected: Vec<_> = all.filter(|&pair| gaps(tree, pair).max() <= distance).collect();
        assert!(sorted(&near.tile_pairs) == expected, "{distance}");
    }
}

/// Some number for two triangles, from 0 to 0.09.
fn clearance(a: u32, b: u32) -> f64 {
    f64::from((7 * a.min(b) + 13 * a.max(b)) % 10) / 100.0
}

/// The least that steep triangles may, and no more than the margin where boxes are not farther apart: twice the margin where
/// one of the tiles lies in surroundings that face alike.
#[test]
fn a_pair_of_tiles_may_come_nearer_by_what_its_triangles_may() {
    let (mut offered, margin) = (Vec::new(), 0.07);
    let (_, octree, near) = search([0.3, margin], |a, b, is_steep| {
        offered.push((a, b, is_steep));
        clearance(a, b)
    });
    let tree = tree_of(&octree);
    let mut tile_of = vec![0; tree.tiles.iter().map(|tile| tile.triangles().len()).sum()];
    for (number, tile) in tree.tiles.iter().enumerate() {
        tile.triangles().iter().for_each(|&triangle| tile_of[triangle as usize] = number as u32);
    }
    let mut least = std::collections::HashMap::new();
    for (a, b, _) in offered.into_iter().filter(|&(.., is_steep)| is_steep) {
        let [first, second] = [a, b].map(|triangle| tile_of[triangle as usize]);
        let least = least.entry([first.min(second), first.max(second)]).or_insert(f64::INFINITY);
        *least = f64::min(*least, clearance(a, b));
    }
    assert!(least.len() > 100 && least.len() < near.tile_pairs.len());
    assert_eq!(near.clearances.len(), near.tile_pairs.len());
    for (&pair, &found) in near.tile_pairs.iter().zip(&near.clearances) {
        let is_sheltered = pair.iter().any(|&tile| near.steep_wide[tile as usize] == 0);
        let most = gaps(tree, pair).norm().max(if is_sheltered { 2.0 * margin } else { margin });
        let key = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        assert_eq!(found, least.get(&key).copied().unwrap_or(most).min(most), "{pair:?}");
    }
}

/// By how much the distance of two vertices, one of either tile, has changed at most.
fn change_of_distances(tree: &Bvh<f64>, [a, b]: [u32; 2], [then, now]: [&[Vector3<f64>]; 2]) -> f64 {
    let [a, b] = [a, b].map(|tile| &tree.outlines[tile as usize].vertices);
    let pairs = a.iter().flat_map(|&a| b.iter().map(move |&b| [a as usize, b as usize]));
    pairs.map(|[a, b]| ((now[a] - now[b]).norm() - (then[a] - then[b]).norm()).abs()).fold(0.0, f64::max)
}

/// A pair has lapsed where the distance of two vertices, one of either tile, has changed by more than allowed, and has not where
/// no two have moved against each other by half of it. A turn of the whole does not count.
#[test]
fn pairs_lapse_where_vertices_have_moved_against_each_other() {
    let (mut mesh, octree, mut near) = search([0.3, 0.02], |a, b, _| clearance(a, b));
    let tree = tree_of(&octree);
    let (then, count) = (mesh.positions().to_vec(), mesh.positions().len());
    octree.keep(&mesh, &vec![1e3; count], &mut near);
    let wave =
        |p: &Vector3<f64>| Vector3::new(0.03 * (3.0 * p.y).sin(), 0.02 * (4.0 * p.z + p.x).cos(), 0.05 * p.x * p.y);
    for turn in [0.0, 0.4, 2.0f64] {
        let moved = |p: &Vector3<f64>| {
            let [x, y, z] = (p + wave(p)).into();
            Vector3::new(5.0 + turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y - 7.0, z)
        };
        mesh.set_positions_with(count, |vertex| moved(&then[vertex])).expect("finite");
        // A large turn takes some steps to be followed.
        (0..4).for_each(|_| assert!(octree.find_lapsed(&mesh, f64::INFINITY, &mut near).part > 0.0));
        let part = octree.find_lapsed(&mesh, f64::INFINITY, &mut near).part;
        assert_eq!(part, near.lapsed.len() as f64 / near.tile_pairs.len() as f64);
        let waves = |tile: u32| tree.outlines[tile as usize].vertices.map(|v| wave(&then[v as usize]));
        let (mut far, mut calm) = (0, 0);
        for (&[a, b], &allowed) in near.tile_pairs.iter().zip(&near.clearances) {
            let has_lapsed = near.lapsed.contains(&[a, b]);
            let is_far = change_of_distances(tree, [a, b], [&then, mesh.positions()]) > allowed;
            let (of_a, of_b) = (waves(a), waves(b));
            let is_calm = of_a.iter().all(|a| of_b.iter().all(|b| (a - b).norm() <= 0.5 * allowed));
            assert!(if has_lapsed { !is_calm } else { !is_far }, "{turn}: {a}, {b}, {allowed}");
            (far, calm) = (far + u32::from(is_far), calm + u32::from(is_calm));
        }
        assert!(far > 50 && calm > 50, "{turn}: {far} far, {calm} calm");
    }
}

/// Where triangles are strained by more than they may be, they are told; the strain of each is found from its gradient here.
/// Two tiles have lapsed that may be sheltered and between which a short path leads over one of those, and none that the
/// vertex does not belong to and between which only long ones do.
#[test]
fn what_is_near_a_triangle_strained_by_more_than_it_may_be_has_lapsed() {
    let (allowed, margin) = (0.3, 0.02);
    let mut strained_ways = 0;
    for way in 0..40 {
        let (mut mesh, octree, mut near) = search([0.3, margin], |_, _, _| 1.0);
        let tree = tree_of(&octree);
        let (then, count) = (mesh.positions().to_vec(), mesh.positions().len());
        octree.keep(&mesh, &vec![allowed; count], &mut near);
        let vertex = 13 * way as usize;
        let by = Vector3::from_fn(|axis, _| 0.04 * (way as f64 * (axis as f64 + 1.3)).sin());
        mesh.set_positions_with(count, |v| if v == vertex { then[v] + by } else { then[v] }).expect("finite");
        let strain = |triangle: u32| {
            let corners = mesh.topology().triangles()[triangle as usize].map(|v| v as usize);
            let sides = |of: &dyn Fn(usize) -> Vector3<f64>| {
                nalgebra::Matrix3x2::from_columns(&[of(corners[1]) - of(corners[0]), of(corners[2]) - of(corners[0])])
            };
            let (rest, moved) = (sides(&|v| then[v]), sides(&|v| mesh.positions()[v] - then[v]));
            (moved * rest.pseudo_inverse(1e-12).expect("it has a size")).norm()
        };
        let around = mesh.topology().triangles_around(vertex as u32).iter().copied();
        let mut expected: Vec<u32> = around.filter(|&triangle| strain(triangle) > allowed).collect();
        expected.sort();
        octree.find_lapsed(&mesh, f64::INFINITY, &mut near);
        let mut told: Vec<u32> = octree.strained(&near).collect();
        told.sort();
        assert_eq!(told, expected, "vertex {vertex}");
        strained_ways += u32::from(!expected.is_empty());

        // The tiles' outlines are still those of the search.
        let tile_of = |&triangle: &u32| {
            let tile = tree.tiles.iter().position(|tile| tile.triangles().contains(&triangle));
            tile.expect("each triangle is in one") as u32
        };
        let strained: BTreeSet<u32> = expected.iter().map(tile_of).collect();
        let to_strained = |tile: u32| {
            let gaps_to = strained.iter().map(|&other| gaps(tree, [tile, other]).norm());
            gaps_to.fold(f64::INFINITY, f64::min)
        };
        let path = |[a, b]: [u32; 2]| to_strained(a) + to_strained(b);
        for (&pair, &clearance) in near.tile_pairs.iter().zip(&near.clearances) {
            let is_moved = pair.iter().any(|&tile| tree.outlines[tile as usize].vertices.contains(&(vertex as u32)));
            let is_far = change_of_distances(tree, pair, [&then, mesh.positions()]) > clearance;
            let must = is_far || clearance <= 2.0 * margin && path(pair) <= 4.0 * margin;
            let may = is_moved || path(pair) <= 8.0 * margin;
            let has_lapsed = near.lapsed.contains(&pair);
            assert!(if has_lapsed { may } else { !must }, "vertex {vertex}: {pair:?}, {clearance}");
        }
        assert!(near.lapsed.len() < near.tile_pairs.len() / 2);
    }
    assert!((5..40).contains(&strained_ways), "{strained_ways}");
}
