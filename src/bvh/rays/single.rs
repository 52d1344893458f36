use crate::bvh::node::CHILD_COUNT;
use crate::bvh::rays::slabs::RaySlabs;
use crate::bvh::tile::TILE_SIZE;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of, smallest_of};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask};
use crate::triangle::{Hit, ProjectedTriangles, Ray, ShearedRay};

/// One ray's way to where it first meets the mesh: the nearest boxes first, none beyond the nearest hit known.
pub(crate) struct NearestOfRay<'a, T: Scalar, R, F> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    // Becomes a ray only in the kernel, where its hit is used too: numbers that are read right after they were written in pieces
    // of another size make the processor wait.
    pub(crate) ray: R,
    pub(crate) then: F,
}

impl<T, R, F, O> Kernel<T> for NearestOfRay<'_, T, R, F>
where
    T: Scalar,
    R: Into<Ray<T>>,
    F: FnOnce(Option<Hit<T>>) -> O,
{
    type Output = O;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> O {
        let Self { tree, mesh, ray, then } = self;
        let ray = &ray.into();
        let (slabs, sheared) = (RaySlabs::new(ray, mesh.aabb()), ShearedRay::new(ray));
        let (end, room) = (ray.t_max, &mut [[T::zero(); LANE_COUNT]; 3]);
        let mut nearest = Nearest { tree, mesh, slabs, ray: sheared, end, hit: None, room };
        Way::new([T::zero(); CHILD_COUNT]).walk::<T, L>(&mut nearest);
        then(nearest.hit)
    }
}

/// The search for the nearest hit.
struct Nearest<'a, T: Scalar> {
    tree: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    slabs: RaySlabs<T>,
    ray: ShearedRay<T>,
    /// Up to where a nearer hit may be.
    end: T,
    /// The nearest so far.
    hit: Option<Hit<T>>,
    /// For the positions of a tile that is not loaded.
    room: &'a mut [[T; LANE_COUNT]; 3],
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Nearest<'_, T> {
    /// Where the ray enters each child's box.
    type Kept = [T; CHILD_COUNT];

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, entries: &mut Self::Kept) -> Children {
        let mut room = None;
        let node = self.tree.node(node as usize, &mut room);
        let (enters, mut left) = self.slabs.entering::<L>(node, self.end);
        enters.store(entries);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        // The nearest tile first, the others as they come.
        let mut next = smallest_of(&mut left, entries);
        while let Some(place) = next {
            if self.search_tile::<L>((node.first + place) as usize) {
                left &= enters.is_at_most(L::splat(self.end));
            }
            next = first_of(&mut left);
        }
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, entries: &Self::Kept, left: &mut Mask) -> Option<u32> {
        smallest_of(left, entries).filter(|&place| entries[place as usize % CHILD_COUNT] <= self.end)
    }
}

impl<T: Scalar> Nearest<'_, T> {
    /// Looks for a nearer hit in a tile; gives whether there is one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn search_tile<L: Lanes<T>>(&mut self, index: usize) -> bool {
        let tile = &self.tree.tiles[index];
        let positions = self.tree.positions_of::<L>(index, self.mesh, self.room);
        let (may_meet, vertices) = self.ray.may_meet::<L>(positions, &tile.corners);
        let mut met = may_meet & tile.present;
        if met == 0 {
            return false;
        }
        let mut is_nearer = false;
        let triangles = ProjectedTriangles::new::<L>(vertices, &tile.corners);
        while let Some(place) = first_of(&mut met) {
            let place = place as usize % TILE_SIZE;
            let found = triangles.intersect(place, tile.triangles[place]);
            if let Some(hit) = found.filter(|hit| hit.t <= self.end && self.hit.is_none_or(|n| hit.is_before(&n))) {
                (self.end, self.hit, is_nearer) = (hit.t, Some(hit), true);
            }
        }
        is_nearer
    }
}

impl<T: Scalar> Bvh<T> {
    /// What `then` makes of where a ray first meets the mesh.
    pub(crate) fn nearest_of_ray<O>(
        &self,
        mesh: &Mesh<T>,
        ray: impl Into<Ray<T>>,
        then: impl FnOnce(Option<Hit<T>>) -> O,
    ) -> O {
        crate::simd::dispatch::<T, _>(NearestOfRay { tree: self, mesh, ray, then })
    }

    /// Where a ray first meets the mesh, on some lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn nearest_of_ray_on<L: Lanes<T>>(&self, mesh: &Mesh<T>, ray: Ray<T>) -> Option<Hit<T>> {
        L::outlined(NearestOfRay { tree: self, mesh, ray, then: |hit| hit })
    }
}
