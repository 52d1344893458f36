use crate::bvh::node::Node;
use crate::bvh::tile::Outline;
use crate::bvh::tile_cylinder::TileCylinder;
use crate::bvh::tree::Bvh;
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;
use crate::simd::{Kernel, Lanes};

/// Renews the boxes, from the tiles upward. The tiles that are needed have to be loaded afterwards.
pub(crate) struct Refit<'a, T: Scalar> {
    pub(crate) tree: &'a mut Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    /// A leaf whose runs of vertices meet none of these gets the box around the runs for all its tiles. `None`: all boxes become
    /// the tightest.
    pub(crate) regions: Option<&'a [Aabb<T>]>,
}

impl<T: Scalar> Kernel<T> for Refit<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Bvh { outlines, nodes, runs, is_tight, .. } = self.tree;
        let positions = self.mesh.positions();
        // A leaf alone meets every region.
        let regions = self.regions.filter(|_| !nodes[0].is_leaf);
        if regions.is_some() {
            runs.renew::<L>(positions);
        }
        *is_tight = true;
        for (leaf, node) in nodes.iter_mut().enumerate().filter(|(_, node)| node.is_leaf) {
            let outlines = &mut outlines[node.tiles()];
            if let Some(regions) = regions
                && let Some(around) = runs.around::<L>(leaf)
                && !regions.iter().any(|region| region.overlaps(&around))
            {
                *is_tight = false;
                (0..outlines.len()).for_each(|place| node.set_box(place, &around));
                if !std::mem::replace(&mut node.is_far, true) {
                    outlines.iter_mut().for_each(Outline::forget);
                }
                continue;
            }
            node.is_far = false;
            for (place, outline) in outlines.iter_mut().enumerate() {
                // No closures here: they would be compiled for any processor.
                let (lower, upper) = L::bounds(positions, &outline.vertices);
                outline.aabb = Aabb { lower, upper };
                node.set_box(place, &outline.aabb);
            }
        }
        for index in (0..nodes.len()).rev() {
            let Node { first, count, is_leaf, .. } = nodes[index];
            for place in 0..if is_leaf { 0 } else { count as usize } {
                let aabb = nodes[first as usize + place].aabb::<L>();
                nodes[index].set_box(place, &aabb);
            }
        }
    }
}

/// Loads the positions of tiles whose positions are out of date.
pub(crate) struct Load<'a, T: Scalar> {
    pub(crate) tree: &'a mut Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    /// `None`: all tiles.
    pub(crate) tiles: Option<&'a [u32]>,
    /// Whether cylinders are made: rays have no use for them.
    pub(crate) for_distances: bool,
}

impl<T: Scalar> Kernel<T> for Load<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Bvh { tiles, outlines, cylinders, loading, .. } = self.tree;
        let count = self.tiles.map_or(tiles.len(), <[u32]>::len);
        for place in 0..count {
            let index = self.tiles.map_or(place, |chosen| chosen[place] as usize);
            let tile = &mut tiles[index];
            if tile.loaded_at != *loading {
                self.mesh.gather::<L>(&outlines[index].vertices).store(&mut tile.positions);
                if self.for_distances {
                    cylinders.set(index, TileCylinder::around::<L>(tile));
                }
                tile.loaded_at = *loading;
            }
        }
    }
}

impl<T: Scalar> Bvh<T> {
    /// Follows the mesh to its present positions; no tile is loaded then. Given regions in which rays mostly stay, boxes far from
    /// these may be wider than they need be.
    pub(crate) fn refit(&mut self, mesh: &Mesh<T>, regions: Option<&[Aabb<T>]>) {
        self.loading += 1;
        self.cylinders.forget();
        self.leave_pose();
        crate::simd::dispatch::<T, _>(Refit { tree: self, mesh, regions });
    }

    /// Loads these tiles, or all, so that each ray need not gather their positions; for distances, with their cylinders.
    pub(crate) fn load(&mut self, mesh: &Mesh<T>, tiles: Option<&[u32]>, for_distances: bool) {
        crate::simd::dispatch::<T, _>(Load { tree: self, mesh, tiles, for_distances });
    }
}

#[cfg(test)]
mod tests {
    use crate::math::Vector3;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::{cube_about, torus, torus_positions};
    use crate::query::{Octree, OctreeError};
    use crate::triangle::Ray;

    const SIDES: [u32; 2] = [96, 24];

    /// Rays near the region and far from it meet what they meet of all triangles.
    fn assert_same_hits(octree: &Octree<f64>, mesh: &Mesh<f64>) {
        let tracer = octree.tracer(mesh).expect("it is up to date");
        let origins = mesh.positions().iter().step_by(37);
        let rays: Vec<_> = origins.map(|&p| Ray::new(p * 0.9, Vector3::new(p.y, 0.3 - p.x, p.z + 0.1))).collect();
        let mut hits = Vec::new();
        tracer.nearest_hits(&rays, &mut hits);
        assert!(hits.iter().flatten().count() > rays.len() / 2);
        for (ray, hit) in rays.iter().zip(&hits) {
            let expected = tracer.nearest_hit_of_all(ray);
            assert_eq!((*hit, tracer.nearest_hit(ray)), (expected, expected), "{ray:?}");
        }
    }

    #[test]
    fn boxes_far_from_the_regions_are_wide_and_hold() {
        let mut mesh = torus(SIDES);
        let mut octree = Octree::new(&mesh);
        let (mut tiles, not_tight) = (Vec::new(), |octree: &Octree<f64>, mesh: &Mesh<f64>| {
            octree.validate(mesh).is_err_and(|what| what.contains("box"))
        });
        for step in 1..8 {
            mesh.set_positions(&torus_positions(SIDES, step)).expect("finite");
            // Round the torus, so that what was far comes near.
            let (y, x) = f64::from(step).sin_cos();
            let regions = [cube_about([x, y, 0.0], 0.2), cube_about([-y, x, 0.3], 0.1)];
            octree.update_in(&mut mesh, &regions, usize::MAX, true, &mut tiles).expect("its own");
            assert!(!tiles.is_empty() && not_tight(&octree, &mesh), "step {step}");
            assert_same_hits(&octree, &mesh);
            match step % 3 {
                0 => octree.update(&mesh).expect("its own"),
                // At rest: the regions may be others.
                1 => octree
                    .update_in(&mut mesh, &[cube_about([-x, -y, 0.0], 0.2)], usize::MAX, true, &mut tiles)
                    .expect("its own"),
                _ => continue,
            }
            assert_eq!(octree.validate(&mesh), Ok(()), "step {step}");
            assert_same_hits(&octree, &mesh);
        }
        mesh.set_positions(&torus_positions(SIDES, 0)).expect("finite");
        let whole = *mesh.aabb();
        octree.update_in(&mut mesh, &[whole], usize::MAX, true, &mut tiles).expect("its own");
        assert_eq!(octree.validate(&mesh), Ok(()), "all is near");
        let refused = octree.update_in(&mut torus(SIDES), &[whole], usize::MAX, true, &mut tiles);
        assert_eq!(refused, Err(OctreeError::OtherMesh));
    }

    /// Vertices numbered at random tell nothing of where a leaf is: all boxes are tight then.
    #[test]
    fn vertices_in_no_order_are_all_looked_at() {
        let torus = torus(SIDES);
        let count = torus.positions().len() as u32;
        let scattered = |vertex: u32| (vertex * 1009) % count;
        let mut positions = vec![[0.0; 3]; count as usize];
        for (vertex, position) in torus.positions().iter().enumerate() {
            positions[scattered(vertex as u32) as usize] = (*position).into();
        }
        let triangles: Vec<_> = torus.topology().triangles().iter().map(|corners| corners.map(scattered)).collect();
        let mut mesh = Mesh::new(&positions, &triangles).expect("it is closed");
        let (mut octree, mut tiles) = (Octree::new(&mesh), Vec::new());
        mesh.set_positions(&positions).expect("finite");
        octree
            .update_in(&mut mesh, &[cube_about([1.3, 0.0, 0.0], 0.1)], usize::MAX, true, &mut tiles)
            .expect("its own");
        assert!(!tiles.is_empty());
        assert_eq!(octree.validate(&mesh), Ok(()));
    }
}
