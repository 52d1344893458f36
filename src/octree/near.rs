use super::{Cells, Octree, wide};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;

/// Which parts of a mesh are near each other, and by how much they may come nearer; kept by the caller, so that a steady
/// step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearParts<T: Scalar> {
    tiles: wide::NearTiles<T>,
    /// For the layout without tiles: the triangles' boxes in the order of their lower sides along one axis.
    sorted: Vec<(Aabb<T>, u32)>,
}

/// How far apart is near.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<T: Scalar> {
    /// Boxes that are farther apart along any axis do not touch.
    pub(crate) touch: T,
    /// Triangles are offered whose boxes are that and this much apart.
    pub(crate) margin: T,
    /// Parts are listed whose boxes are that and this much apart.
    pub(crate) part_margin: T,
}

impl<T: Scalar> Octree<T> {
    /// Offers each two triangles that have no vertex in common and are near each other, and perhaps others; `offer` gives
    /// how much nearer they may come.
    pub(crate) fn search_near(
        &self,
        mesh: &Mesh<T>,
        reach: &Reach<T>,
        near: &mut NearParts<T>,
        mut offer: impl FnMut(u32, u32) -> T,
    ) {
        match &self.cells {
            Cells::Wide(cells) => {
                let distances = [reach.touch + reach.part_margin, reach.touch + reach.margin, reach.margin];
                cells.search_near(mesh, distances, &mut near.tiles, &mut offer);
            }
            Cells::Classic(_) => sweep(mesh, reach.touch, &mut near.sorted, |a, b| _ = offer(a, b)),
        }
    }

    /// Finds what [`search_near`](Self::search_near) has listed at the positions `then` and has come nearer by more than it
    /// may: gives which part of all that is. Parts that it has not listed may come nearer by its `part_margin`.
    pub(crate) fn find_lapsed(&self, near: &mut NearParts<T>, [then, now]: [&[Vector3<T>]; 2]) -> f64 {
        match &self.cells {
            Cells::Wide(cells) => cells.find_lapsed(&mut near.tiles, then, now),
            Cells::Classic(_) => 1.0,
        }
    }

    /// Offers, of what [`find_lapsed`](Self::find_lapsed) has found, each two triangles that have no vertex in common and
    /// whose boxes are at most `distance` apart along every axis. The octree follows the mesh.
    pub(crate) fn search_lapsed(
        &self,
        mesh: &Mesh<T>,
        distance: T,
        near: &mut NearParts<T>,
        mut offer: impl FnMut(u32, u32),
    ) {
        if let Cells::Wide(cells) = &self.cells {
            cells.search_lapsed(mesh, distance, &mut near.tiles, &mut offer);
        }
    }
}

/// Offers each two triangles that have no vertex in common and whose boxes are at most `distance` apart along every axis:
/// the boxes are sorted along the mesh's longest axis.
fn sweep<T: Scalar>(mesh: &Mesh<T>, distance: T, sorted: &mut Vec<(Aabb<T>, u32)>, mut offer: impl FnMut(u32, u32)) {
    let axis = (mesh.aabb().upper - mesh.aabb().lower).imax();
    let triangles = mesh.topology().triangles();
    sorted.clear();
    let boxed = |triangle: u32| (Aabb::of_triangle(&mesh.corners(triangle)), triangle);
    memory::append(sorted, (0..triangles.len() as u32).map(boxed));
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
            if around.overlaps(other) && !shares_a_vertex() {
                offer(*a, *b);
            }
        }
    }
}
