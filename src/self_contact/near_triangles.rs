use crate::math::{Aabb, Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;

/// Whether two corners of a triangle are one point: no ray meets it, and it casts none.
pub(crate) fn is_merged<T: Scalar>([a, b, c]: &[Vector3<T>; 3]) -> bool {
    a == b || b == c || c == a
}

/// Offers each two triangles that have no vertex in common and whose boxes are at most `distance` apart along every axis, by
/// boxes sorted along the mesh's longest axis. Ends with false where `offer` gives false.
pub(crate) fn sweep<T: Scalar>(
    mesh: &Mesh<T>,
    distance: T,
    sorted: &mut Vec<(Aabb<T>, u32)>,
    mut offer: impl FnMut(u32, u32) -> bool,
) -> bool {
    let axis = (mesh.aabb().upper - mesh.aabb().lower).imax();
    let triangles = mesh.topology().triangles();
    sorted.clear();
    let boxed = |triangle: u32| {
        let corners = mesh.corners(triangle);
        (!is_merged(&corners)).then(|| (Aabb::of_triangle(&corners), triangle))
    };
    memory::append(sorted, (0..triangles.len() as u32).filter_map(boxed));
    sorted.sort_unstable_by(|(a, i), (b, j)| {
        a.lower[axis].partial_cmp(&b.lower[axis]).expect("positions are finite").then(i.cmp(j))
    });
    for (place, (aabb, a)) in sorted.iter().enumerate() {
        let around = aabb.grown(distance);
        for (other, b) in sorted[place + 1..].iter().take_while(|(other, _)| other.lower[axis] <= around.upper[axis]) {
            let shares_a_vertex = || {
                let [a, b] = [a, b].map(|&triangle| triangles[triangle as usize]);
                a.iter().any(|vertex| b.contains(vertex))
            };
            if around.overlaps(other) && !shares_a_vertex() && !offer(*a, *b) {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_mesh::torus;
    use crate::query::{Layout, Octree};
    use crate::self_contact::certificate::NearTiles;
    use crate::self_contact::certificate::reach::Reach;
    use std::collections::BTreeSet;

    /// How far apart the boxes of two triangles are along the axis that parts them most.
    fn gap(boxes: &[Aabb<f64>], [a, b]: [usize; 2]) -> f64 {
        let (a, b) = (&boxes[a], &boxes[b]);
        (a.lower - b.upper).sup(&(b.lower - a.upper)).max()
    }

    fn boxes(mesh: &Mesh<f64>) -> Vec<Aabb<f64>> {
        let triangles = 0..mesh.topology().triangles().len() as u32;
        triangles.map(|triangle| Aabb::of_triangle(&mesh.corners(triangle))).collect()
    }

    /// All pairs of triangles without a common vertex whose boxes are at most so far apart.
    fn pairs_within(mesh: &Mesh<f64>, distance: f64) -> BTreeSet<[u32; 2]> {
        let (boxes, triangles) = (boxes(mesh), mesh.topology().triangles());
        let count = triangles.len();
        let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        let is_apart = |&[a, b]: &[usize; 2]| !triangles[a].iter().any(|vertex| triangles[b].contains(vertex));
        let near = all.filter(|&pair| is_apart(&pair) && gap(&boxes, pair) <= distance);
        near.map(|pair| pair.map(|triangle| triangle as u32)).collect()
    }

    /// What is offered, each pair once and with the smaller number first.
    fn collect(search: impl FnOnce(&mut dyn FnMut(u32, u32))) -> BTreeSet<[u32; 2]> {
        let mut offered = BTreeSet::new();
        search(&mut |a, b| assert!(offered.insert([a.min(b), a.max(b)]), "{a} and {b} twice"));
        offered
    }

    /// Narrow numbers round outward by a few millionths of the mesh's size.
    const ROUNDING: f64 = 2e-5;

    /// Of each triangle, whether one within the distance faces away by more than 60°.
    fn are_steep(mesh: &Mesh<f64>, distance: f64) -> Vec<bool> {
        let boxes = boxes(mesh);
        let count = boxes.len();
        let normal = |triangle: usize| mesh.scaled_normal(triangle as u32).normalize();
        let is_steep =
            |a: usize| (0..count).any(|b| gap(&boxes, [a, b]) <= distance && normal(a).dot(&normal(b)) < 0.5);
        (0..count).map(is_steep).collect()
    }

    #[test]
    fn near_triangles_are_offered_once_and_far_ones_never() {
        let mesh = torus([16, 8]);
        for (layout, touch, margin) in [
            (Layout::PaperOctree, 0.0, 0.0),
            (Layout::PaperOctree, 0.07, 0.0),
            (Layout::PaperOctree, 3.0, 0.0),
            (Layout::Bvh, 0.0, 0.0),
            (Layout::Bvh, 0.07, 0.0),
            (Layout::Bvh, 0.001, 0.02),
            (Layout::Bvh, 0.001, 0.06),
            (Layout::Bvh, 3.0, 0.0),
        ] {
            let (octree, mut near) = (Octree::with_layout(&mesh, layout), NearTiles::default());
            // What lies in the same part, or in one that is listed, is offered by its own distance.
            let reach = Reach { touch, margin, tile_margin: margin, most_pairs: usize::MAX };
            let offered = collect(|offer| {
                octree.search_near(&mesh, &reach, &mut near, |a, b, _| {
                    offer(a, b);
                    Some(0.0)
                });
            });
            assert!(offered.is_superset(&pairs_within(&mesh, reach.of_sheltered())), "{layout:?} {touch} {margin}");
            assert!(offered.is_subset(&pairs_within(&mesh, touch + margin + ROUNDING)), "{layout:?} {touch} {margin}");
            if margin > 0.0 {
                let steep = are_steep(&mesh, 2.0 * (touch + margin));
                let mut both = pairs_within(&mesh, touch + margin);
                both.retain(|pair| pair.iter().all(|&triangle| steep[triangle as usize]));
                assert!(!both.is_empty() && offered.is_superset(&both), "{touch} {margin}");
            }
        }
    }

    /// Triangles that come to touch are among what has lapsed, if no two vertices move against each other by more than the
    /// margin of parts.
    #[test]
    fn what_comes_near_has_lapsed() {
        let (touch, margin, tile_margin) = (0.01, 0.04, 0.2);
        for left in [0.1, 0.05, 0.0] {
            // A flat torus that gets flatter on its way.
            let mut mesh = torus([24, 8]);
            let rest = mesh.positions().to_vec();
            let at = |vertex: usize, by: f64, height: f64| {
                rest[vertex].component_mul(&Vector3::new(1.0, 1.0, height)).add_scalar(by)
            };
            mesh.set_positions_with(rest.len(), |vertex| at(vertex, 0.0, 0.3)).expect("finite");
            let (mut octree, mut near) = (Octree::new(&mesh), NearTiles::default());
            let (boxes, known) = (boxes(&mesh), pairs_within(&mesh, touch));
            let reach = Reach { touch, margin, tile_margin, most_pairs: usize::MAX };
            octree.search_near(&mesh, &reach, &mut near, |a, b, _| Some(gap(&boxes, [a as usize, b as usize]) - touch));
            // Strain shall not tell.
            octree.keep(&mesh, &vec![1e3; rest.len()], &mut near);
            mesh.set_positions_with(rest.len(), |vertex| at(vertex, 5.0, 0.3 * left)).expect("finite");
            let part = octree.find_lapsed(&mesh, f64::INFINITY, &mut near).part;
            if left > 0.0 {
                octree.update(&mesh).expect("its own");
            }
            let offered = collect(|offer| {
                octree.search_lapsed(&mesh, touch, &mut near, |a, b| {
                    offer(a, b);
                    true
                });
            });
            let come_near: BTreeSet<_> = pairs_within(&mesh, touch).difference(&known).copied().collect();
            assert!(!come_near.is_empty() && offered.is_superset(&come_near), "{left}");
            assert!(offered.is_subset(&pairs_within(&mesh, touch + ROUNDING)), "{left}");
            assert!(part > 0.0 && part <= 1.0, "{part}");
        }
    }
}
