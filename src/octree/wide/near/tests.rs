use super::*;
use crate::octree::test_mesh::torus;

/// A surface so large that nodes have nodes under them, and what was found near of it; `offer`
/// as in the search.
fn search(
    [tile_distance, distance, margin]: [f64; 3],
    mut offer: impl FnMut(u32, u32) -> f64,
) -> (Mesh<f64>, Wide<f64>, NearTiles<f64>) {
    let (mesh, mut near) = (torus([48, 12]), NearTiles::default());
    let cells = Wide::new(&mesh);
    assert!(cells.nodes.len() > 2 && !cells.nodes[0].is_leaf);
    cells.search_near(&mesh, [tile_distance, distance, margin], usize::MAX, &mut near, &mut |a, b| Some(offer(a, b)));
    (mesh, cells, near)
}

/// The two places of each pair, the smaller first, in their order.
fn sorted(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut pairs: Vec<_> = pairs.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort();
    pairs
}

#[test]
fn the_pairs_of_tiles_are_those_whose_boxes_are_near() {
    for distance in [0.0, 0.03, 0.29, 4.0] {
        let (_, cells, near) = search([distance, 0.0, 0.0], |_, _| 0.0);
        let is_near = |a: usize, b: usize| {
            let (a, b) = (&cells.outlines[a].aabb, &cells.outlines[b].aabb);
            (a.lower - b.upper).sup(&(b.lower - a.upper)).max() <= distance
        };
        let count = cells.tiles.len();
        let all = (0..count).flat_map(|a| (a..count).map(move |b| (a, b)));
        let expected: Vec<_> = all.filter(|&(a, b)| is_near(a, b)).map(|(a, b)| [a as u32, b as u32]).collect();
        assert!(sorted(&near.tile_pairs) == expected, "{distance}");
    }
}

/// Some number for two triangles, from 0 to 0.09.
fn clearance(a: u32, b: u32) -> f64 {
    f64::from((7 * a.min(b) + 13 * a.max(b)) % 10) / 100.0
}

#[test]
fn a_pair_of_tiles_may_come_nearer_by_the_least_that_its_triangles_may() {
    let (mut offered, margin) = (Vec::new(), 0.065);
    let (_, cells, near) = search([0.05, 0.02, margin], |a, b| {
        offered.push((a, b));
        clearance(a, b)
    });
    let mut tile_of = vec![0; cells.tiles.iter().map(|tile| tile.triangles().len()).sum()];
    for (number, tile) in cells.tiles.iter().enumerate() {
        tile.triangles().iter().for_each(|&triangle| tile_of[triangle as usize] = number as u32);
    }
    let mut expected = std::collections::HashMap::new();
    for (a, b) in offered {
        let [first, second] = [a, b].map(|triangle| tile_of[triangle as usize]);
        let least = expected.entry([first.min(second), first.max(second)]).or_insert(margin);
        *least = f64::min(*least, clearance(a, b));
    }
    assert!(expected.len() > 100 && expected.len() < near.tile_pairs.len());
    assert_eq!(near.clearances.len(), near.tile_pairs.len());
    for (pair, &found) in near.tile_pairs.iter().zip(&near.clearances) {
        let key = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        assert_eq!(found, expected.get(&key).copied().unwrap_or(margin), "{pair:?}");
    }
}

/// A pair has lapsed where the box around all differences of two vertices' moves, one of either tile, reaches beyond what
/// is allowed.
#[test]
fn pairs_lapse_where_vertices_have_moved_against_each_other() {
    let (mesh, cells, mut near) = search([0.3, 0.02, 0.065], clearance);
    let then = mesh.positions();
    let moved = |p: &Vector3<f64>| {
        p + Vector3::new(5.0 + 0.03 * (3.0 * p.y).sin(), 0.02 * (4.0 * p.z + p.x).cos() - 7.0, 0.05 * p.x * p.y)
    };
    let now: Vec<_> = then.iter().map(moved).collect();
    let part = cells.find_lapsed(&mut near, then, &now);
    let moves = |tile: u32| cells.outlines[tile as usize].vertices.map(|v| now[v as usize] - then[v as usize]);
    let has_lapsed = |&(&[a, b], &allowed): &(&[u32; 2], &f64)| {
        let (mut farthest, moves_of_b) = (Vector3::zeros(), moves(b));
        for of_a in moves(a) {
            moves_of_b.iter().for_each(|of_b| farthest = farthest.sup(&(of_a - of_b).abs()));
        }
        farthest.norm() > allowed
    };
    let expected: Vec<_> =
        near.tile_pairs.iter().zip(&near.clearances).filter(has_lapsed).map(|(pair, _)| *pair).collect();
    assert!(expected.len() > 100 && expected.len() < near.tile_pairs.len() / 2);
    assert!(near.lapsed == expected);
    assert_eq!(part, expected.len() as f64 / near.tile_pairs.len() as f64);
}
