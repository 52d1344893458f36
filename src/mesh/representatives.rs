use super::{Mesh, Patches};
use crate::math::Scalar;
use crate::memory;
use crate::memory::Room;

/// The triangles that stand for the patches of at most one area, group by group, so that what casts fewer rays than there
/// are triangles looks at fewer too.
#[derive(Clone, Debug)]
pub(crate) struct Representatives {
    triangles: Vec<u32>,
    /// Those of group g are at the places `starts[g]..starts[g + 1]`.
    starts: Vec<u32>,
    /// The sides along which a patch ends, each as its triangle has it; none where the patch is one triangle.
    border: Vec<[u32; 2]>,
    /// Those of the patch at place p are `border[border_starts[p]..border_starts[p + 1]]`.
    border_starts: Vec<u32>,
}

impl Representatives {
    /// Those of the mesh's patches of at most this area; `groups` offers the triangles of each group in turn, of each
    /// triangle once.
    pub(crate) fn new<T: Scalar>(
        mesh: &Mesh<T>,
        area: T,
        group_count: u32,
        mut group: impl FnMut(u32, &mut dyn FnMut(u32)),
    ) -> Self {
        let patches = mesh.patches();
        let is_inner = inner_sides(mesh, patches, area);
        let corners = mesh.topology().triangles();
        let (mut triangles, mut starts) = (Vec::new(), memory::filled(0, 1));
        let (mut border, mut border_starts) = (Vec::new(), memory::filled(0, 1));
        for number in 0..group_count {
            group(number, &mut |triangle| {
                let patch = patches.around(triangle, area);
                if patches.triangle(patch) != triangle {
                    return;
                }
                triangles.room_for(1).push(triangle);
                let patch = patches.triangles_of(patch);
                let sides =
                    patch.iter().filter(|_| patch.len() > 1).flat_map(|&part| (0..3).map(move |side| (part, side)));
                let outer = sides.filter(|&(part, side)| !is_inner[part as usize][side]);
                let edges = outer.map(|(part, side)| {
                    let corners = corners[part as usize];
                    [corners[side], corners[(side + 1) % 3]]
                });
                memory::append(&mut border, edges);
                border_starts.room_for(1).push(border.len() as u32);
            });
            starts.room_for(1).push(triangles.len() as u32);
        }
        Self { triangles, starts, border, border_starts }
    }

    /// Adds the places of a group's triangles.
    pub(crate) fn add_places_in(&self, group: u32, places: &mut Vec<u32>) {
        let group = group as usize;
        memory::append(places, self.starts[group]..self.starts[group + 1]);
    }

    /// The triangle at a place.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn triangle(&self, place: u32) -> u32 {
        self.triangles[place as usize]
    }

    /// The border of the patch that the triangle at a place stands for; empty where it stands for itself alone.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn border(&self, place: u32) -> &[[u32; 2]] {
        let place = place as usize;
        &self.border[self.border_starts[place] as usize..self.border_starts[place + 1] as usize]
    }
}

/// By triangle and side, from each corner to the next: whether the same patch lies beyond.
fn inner_sides<T: Scalar>(mesh: &Mesh<T>, patches: &Patches<T>, area: T) -> Vec<[bool; 3]> {
    let corners = mesh.topology().triangles();
    let patch_of = memory::listed((0..corners.len() as u32).map(|triangle| patches.around(triangle, area)));
    let mut is_inner = memory::filled([false; 3], corners.len());
    for edge in mesh.topology().edges() {
        let [a, b] = edge.triangles;
        if patch_of[a as usize] != patch_of[b as usize] {
            continue;
        }
        for triangle in edge.triangles {
            let corners = corners[triangle as usize];
            let is_edge = |side: &usize| {
                let [from, to] = [corners[*side], corners[(side + 1) % 3]];
                [from.min(to), from.max(to)] == edge.vertices
            };
            let side = (0..3).find(is_edge).expect("an edge is a side of its triangles");
            is_inner[triangle as usize][side] = true;
        }
    }
    is_inner
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vector3;
    use crate::simd::{Kernel, Lanes, dispatch};

    /// A bent sheet of 2 · 12 · 9 triangles, open at its border.
    fn sheet() -> Mesh<f64> {
        let (rows, columns) = (13, 10);
        let quads = (0..rows - 1).flat_map(|i| (0..columns - 1).map(move |j| i * columns + j));
        let two = |at: u32| [[at, at + columns, at + columns + 1], [at, at + columns + 1, at + 1]];
        let point = |at: u32| {
            let [x, y] = [f64::from(at / columns), f64::from(at % columns)];
            [x, y, (0.4 * x).sin() + 0.1 * y * y]
        };
        let points: Vec<_> = (0..rows * columns).map(point).collect();
        Mesh::open(&points, &quads.flat_map(two).collect::<Vec<_>>()).expect("valid")
    }

    struct Sums<'a>(&'a Mesh<f64>, &'a [[u32; 2]]);

    impl Kernel<f64> for Sums<'_> {
        type Output = Vector3<f64>;

        fn run<L: Lanes<f64>>(self) -> Vector3<f64> {
            self.0.doubled_area_within::<L>(self.1)
        }
    }

    #[test]
    fn a_border_has_the_area_of_the_triangles_within() {
        let mesh = sheet();
        let count = mesh.topology().triangles().len() as u32;
        for area in [1.5, 4.0, 50.0] {
            // Groups of ten.
            let representatives = Representatives::new(&mesh, area, count.div_ceil(10), |group, offer| {
                (group * 10..count.min(group * 10 + 10)).for_each(offer);
            });
            let mut places = Vec::new();
            (0..count.div_ceil(10)).for_each(|group| representatives.add_places_in(group, &mut places));
            let patches = mesh.patches();
            let patch_of = |triangle: u32| patches.triangles_of(patches.around(triangle, area));
            let stand = |triangle: &u32| patches.triangle(patches.around(*triangle, area)) == *triangle;
            let expected: Vec<u32> = (0..count).filter(stand).collect();
            assert_eq!(places.iter().map(|&place| representatives.triangle(place)).collect::<Vec<_>>(), expected);
            assert!(places.len() * 2 < count as usize + places.len());
            for place in places {
                let patch = patch_of(representatives.triangle(place));
                let border = representatives.border(place);
                assert_eq!(border.is_empty(), patch.len() == 1);
                if patch.len() > 1 {
                    let sum: Vector3<f64> = patch.iter().map(|&triangle| mesh.scaled_normal(triangle)).sum();
                    let found = dispatch::<f64, _>(Sums(&mesh, border));
                    assert!((found - sum).norm() < 1e-13 * sum.norm(), "{found} {sum}");
                }
            }
        }
    }
}
