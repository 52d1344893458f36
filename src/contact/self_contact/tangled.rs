//! Bodies in which everything touches everything: garbage positions of a simulation gone wrong. Pairs of triangles that
//! touch are then quadratically many, each ray crosses a part of the whole surface, and no inside is left to tell.

use super::nearness::{Nearness, nearness};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::octree::is_merged;

/// Fewer triangles are looked at pair by pair, whatever they do: of so few a tenth may touch in a body that is only crumpled.
const FEWEST_TRIANGLES: usize = 512;
/// A body is tangled where its triangles touch so many others each, on average. A torus flattened to a plane has 13.
const TOUCHING: usize = 24;
/// Or so many where they are close, in boxes that overlap, to as many as this: the long triangles of garbage. Long
/// triangles in order are close to as many, but do not touch.
const TOUCHING_OF_CLOSE: usize = 6;
const CLOSE: usize = 96;
/// So many pairs are tried for each triangle, and so many parts of that to see whether the body is in order.
const PAIRS_TRIED: usize = 2;
const FIRST_PART: usize = 4;
/// A body whose triangles are each close to fewer is in order.
const FEWEST_CLOSE: usize = 12;

/// Whether a body is tangled, by pairs of its triangles thrown together; it depends on nothing but the mesh and its numbering. A body in
/// order takes a pair for every two triangles, one that is all tangled few pairs in all.
pub(super) fn is_tangled<T: Scalar>(mesh: &Mesh<T>) -> bool {
    let count = mesh.topology().triangles().len();
    if count < FEWEST_TRIANGLES {
        return false;
    }
    let most_tried = count * PAIRS_TRIED;
    let (mut close, mut touching) = (0, 0);
    let mut state = 0u64;
    for tried in 0..most_tried {
        if tried == most_tried / FIRST_PART && close * FIRST_PART < FEWEST_CLOSE * PAIRS_TRIED {
            return false;
        }
        // Every second, those between, and so on, and any other: Knuth's linear congruential generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let other = ((state >> 32) * count as u64) >> 32;
        let one = (2 * tried + 2 * tried / count) % count;
        let found = nearness(mesh, [one as u32, other as u32]);
        close += usize::from(found != Nearness::Apart);
        touching += usize::from(found == Nearness::Touching);
        let are_close = close >= CLOSE * PAIRS_TRIED && touching >= TOUCHING_OF_CLOSE * PAIRS_TRIED;
        if are_close || touching >= TOUCHING * PAIRS_TRIED {
            return true;
        }
    }
    false
}

/// Whether no triangle is left that casts a ray or is met by one.
pub(super) fn is_collapsed<T: Scalar>(mesh: &Mesh<T>) -> bool {
    (0..mesh.topology().triangles().len() as u32).all(|triangle| is_merged(&mesh.corners(triangle)))
}

#[cfg(test)]
mod tests {
    use crate::contact::{ContactList, DetectionOptions, detect_self, query_self_with_all_rays};
    use crate::octree::test_mesh::{torus, torus_positions};
    use crate::octree::{Layout, Octree};

    const SIDES: [u32; 2] = [64, 24];

    /// A torus whose vertices are moved; gives its contacts with itself, and how many pairs of triangles were held against
    /// each other, for each triangle.
    fn found(layout: Layout, place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]) -> (ContactList<f64>, f64) {
        let mut mesh = torus(SIDES);
        let positions: Vec<_> = torus_positions(SIDES, 0).into_iter().enumerate().map(|(i, p)| place(i, p)).collect();
        mesh.set_positions(&positions).expect("finite");
        let (octree, mut contacts) = (Octree::with_layout(&mesh, layout), ContactList::default());
        detect_self(0, &mesh, &octree, &DetectionOptions::default(), None, &mut contacts).expect("it is new");
        let tried = contacts.workspace.own.touching.tried as f64 / mesh.topology().triangles().len() as f64;
        (contacts, tried)
    }

    /// Anywhere in a box, by Knuth's linear congruential generator.
    fn anywhere(vertex: usize) -> [f64; 3] {
        let mut state = vertex as u64 + 1;
        [(); 3].map(|()| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 * (-53f64).exp2()
        })
    }

    #[test]
    fn garbage_takes_no_more_pairs_than_so_many_for_each_triangle() {
        for layout in [Layout::Classic, Layout::Wide] {
            let (point, collapsed) = found(layout, &|_, _| [1.0, 2.0, 3.0]);
            let (near, nearly) = found(layout, &|_, p| p.map(|x| 1.0 + 1e-15 * x));
            let (box_, thrown) = found(layout, &|vertex, _| anywhere(vertex));
            let (partly, tenth) = found(layout, &|vertex, p| if vertex % 10 == 0 { anywhere(vertex) } else { p });
            let tried = [collapsed, nearly, thrown, tenth];
            assert_eq!(tried, [0.0; 4], "{layout:?}: pairs for each triangle");
            let tangled = [&point, &near, &box_, &partly].map(|list| list.statistics.tangled_bodies);
            assert_eq!(tangled, [0, 1, 1, 1], "what has collapsed has no contacts");
            assert!([&point, &near, &box_, &partly].iter().all(|list| list.is_empty() && list.statistics.rays == 0));
        }
    }

    /// Flat, folded or with a ring of its vertices in one point, a body is not tangled: it has the contacts of every ray.
    #[test]
    fn what_is_not_tangled_has_the_contacts_of_every_ray() {
        let flat = |_: usize, [x, y, _]: [f64; 3]| [x, y, 0.25];
        let pinched = |vertex: usize, p: [f64; 3]| if vertex / 24 == 8 { [0.4, 0.1, 0.0] } else { p };
        // Pushed together in the middle, until the inner sides pass through each other.
        let folded = |_: usize, [x, y, z]: [f64; 3]| [x, y * (1.0 - 0.87 * (-4.0 * x * x).exp() / y.hypot(0.3)), z];
        let places: [&dyn Fn(usize, [f64; 3]) -> [f64; 3]; 3] = [&flat, &pinched, &folded];
        for (number, place) in places.into_iter().enumerate() {
            let mut mesh = torus(SIDES);
            let positions = torus_positions(SIDES, 0).into_iter().enumerate();
            let positions: Vec<_> = positions.map(|(i, p)| place(i, p)).collect();
            mesh.set_positions(&positions).expect("finite");
            let mut all = ContactList::default();
            query_self_with_all_rays(&mesh, &Octree::new(&mesh), &DetectionOptions::default(), &mut all).expect("new");
            let (culled, tried) = found(Layout::Wide, place);
            assert_eq!(culled.contacts, all.contacts, "{number}");
            assert!(culled.statistics.tangled_bodies == 0 && tried < 200.0, "{number}: {tried}");
            assert!(number != 2 || !all.is_empty());
        }
    }
}
