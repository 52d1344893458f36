use super::*;
use crate::octree::test_mesh::torus;
use std::collections::BTreeSet;

/// A surface so large that nodes have nodes under them, and what was found near of it; `offer`
/// as in the search.
fn search(
    [part_margin, margin]: [f64; 2],
    mut offer: impl FnMut(u32, u32, bool) -> f64,
) -> (Mesh<f64>, Wide<f64>, NearTiles<f64>) {
    let (mesh, mut near) = (torus([48, 12]), NearTiles::default());
    let cells = Wide::new(&mesh);
    assert!(cells.nodes.len() > 2 && !cells.nodes[0].is_leaf);
    let reach = Reach { touch: 0.0, margin, part_margin, most_pairs: usize::MAX };
    cells.search_near(&mesh, &reach, &mut near, &mut |a, b, is_steep| Some(offer(a, b, is_steep)));
    (mesh, cells, near)
}

/// The two places of each pair, the smaller first, in their order.
fn sorted(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut pairs: Vec<_> = pairs.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort();
    pairs
}

/// Along each axis how far apart two boxes are, at least 0.
fn gaps(cells: &Wide<f64>, [a, b]: [u32; 2]) -> Vector3<f64> {
    let (a, b) = (&cells.outlines[a as usize].aabb, &cells.outlines[b as usize].aabb);
    (a.lower - b.upper).sup(&(b.lower - a.upper)).sup(&Vector3::zeros())
}

#[test]
fn the_pairs_of_tiles_are_those_whose_boxes_are_near() {
    for distance in [0.0, 0.03, 0.29, 4.0] {
        let (_, cells, near) = search([distance, 0.0], |_, _, _| 0.0);
        let count = cells.tiles.len() as u32;
        let all = (0..count).flat_map(|a| (a..count).map(move |b| [a, b]));
        let expected: Vec<_> = all.filter(|&pair| gaps(&cells, pair).max() <= distance).collect();
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
    let (_, cells, near) = search([0.3, margin], |a, b, is_steep| {
        offered.push((a, b, is_steep));
        clearance(a, b)
    });
    let mut tile_of = vec![0; cells.tiles.iter().map(|tile| tile.triangles().len()).sum()];
    for (number, tile) in cells.tiles.iter().enumerate() {
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
        let most = gaps(&cells, pair).norm().max(if is_sheltered { 2.0 * margin } else { margin });
        let key = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        assert_eq!(found, least.get(&key).copied().unwrap_or(most).min(most), "{pair:?}");
    }
}

/// A pair has lapsed where the box around all differences of two vertices' moves, one of either tile, reaches beyond what
/// is allowed. A turn of the whole does not count.
#[test]
fn pairs_lapse_where_vertices_have_moved_against_each_other() {
    let (mut mesh, cells, mut near) = search([0.3, 0.02], |a, b, _| clearance(a, b));
    let (then, count) = (mesh.positions().to_vec(), mesh.positions().len());
    cells.keep(&mesh, &vec![1e3; count], &mut near);
    for turn in [0.0, 0.4, 2.0f64] {
        let moved = |p: &Vector3<f64>| {
            let wave = Vector3::new(0.03 * (3.0 * p.y).sin(), 0.02 * (4.0 * p.z + p.x).cos(), 0.05 * p.x * p.y);
            let [x, y, z] = (p + wave).into();
            Vector3::new(5.0 + turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y - 7.0, z)
        };
        mesh.set_positions_with(count, |vertex| moved(&then[vertex])).expect("finite");
        // A large turn takes some steps to be followed.
        (0..4).for_each(|_| assert!(cells.find_lapsed(&mesh, f64::INFINITY, &mut near).part > 0.0));
        let part = cells.find_lapsed(&mesh, f64::INFINITY, &mut near).part;
        let (back, centre) = (near.rest.back(), mesh.aabb().centre());
        let move_of = |v: u32| back * (mesh.positions()[v as usize] - centre) - then[v as usize];
        let moves = |tile: u32| cells.outlines[tile as usize].vertices.map(move_of);
        let has_lapsed = |&(&[a, b], &allowed): &(&[u32; 2], &f64)| {
            let (mut farthest, moves_of_b) = (Vector3::zeros(), moves(b));
            for of_a in moves(a) {
                moves_of_b.iter().for_each(|of_b| farthest = farthest.sup(&(of_a - of_b).abs()));
            }
            farthest.norm() > allowed
        };
        let expected: Vec<_> =
            near.tile_pairs.iter().zip(&near.clearances).filter(has_lapsed).map(|(pair, _)| *pair).collect();
        assert!(expected.len() > 50 && expected.len() < near.tile_pairs.len() / 2, "{turn}: {}", expected.len());
        assert!(near.lapsed == expected, "{turn}");
        assert_eq!(part, expected.len() as f64 / near.tile_pairs.len() as f64);
    }
}

/// Where triangles are strained by more than they may be, they are told, and two tiles have lapsed that may be sheltered and
/// are both so near one of theirs that a path may lead over it; the strain of each is found from its gradient here.
#[test]
fn what_is_near_a_triangle_strained_by_more_than_it_may_be_has_lapsed() {
    let (allowed, margin) = (0.3, 0.02);
    let mut strained_ways = 0;
    for way in 0..40 {
        let (mut mesh, cells, mut near) = search([0.3, margin], |_, _, _| 1.0);
        let (then, count) = (mesh.positions().to_vec(), mesh.positions().len());
        cells.keep(&mesh, &vec![allowed; count], &mut near);
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
        cells.find_lapsed(&mesh, f64::INFINITY, &mut near);
        let mut told: Vec<u32> = cells.strained(&near).collect();
        told.sort();
        assert_eq!(told, expected, "vertex {vertex}");
        strained_ways += u32::from(!expected.is_empty());

        // The tiles' outlines are still those of the search.
        let tile_of = |&triangle: &u32| {
            let tile = cells.tiles.iter().position(|tile| tile.triangles().contains(&triangle));
            tile.expect("each triangle is in one") as u32
        };
        let strained: BTreeSet<u32> = expected.iter().map(tile_of).collect();
        let is_by_one = |tile: u32| strained.iter().any(|&other| gaps(&cells, [tile, other]).norm() <= 4.0 * margin);
        let has_lapsed = |&(&[a, b], &clearance): &(&[u32; 2], &f64)| {
            let moves = [a, b].map(|tile| cells.outlines[tile as usize].vertices.contains(&(vertex as u32)));
            let has_moved = moves.contains(&true) && by.norm() > clearance;
            has_moved || clearance <= 2.0 * margin && is_by_one(a) && is_by_one(b)
        };
        let pairs = near.tile_pairs.iter().zip(&near.clearances);
        let expected: Vec<_> = pairs.filter(has_lapsed).map(|(pair, _)| *pair).collect();
        assert!(near.lapsed == expected, "vertex {vertex}: {} for {}", near.lapsed.len(), expected.len());
        assert!(expected.len() < near.tile_pairs.len() / 2);
    }
    assert!((5..40).contains(&strained_ways), "{strained_ways}");
}
