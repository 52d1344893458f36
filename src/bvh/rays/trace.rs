use crate::bvh::rays::slabs::RaySlabs;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, lanes_of};
use crate::triangle::{PreparedRay, Ray};

/// Offers every triangle that a ray may meet up to the `t` that `offer` last returned.
pub(crate) struct Trace<'a, T: Scalar, F> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) ray: &'a Ray<T>,
    pub(crate) prepared: &'a PreparedRay<T>,
    pub(crate) offer: &'a mut F,
}

impl<T: Scalar, F: FnMut(u32) -> T> Kernel<T> for Trace<'_, T, F> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let (slabs, end) = (RaySlabs::new(self.ray, self.mesh.aabb()), self.ray.t_max);
        Way::new(()).walk::<T, L>(&mut OnTheWay { trace: self, slabs, end });
    }
}

struct OnTheWay<'a, T: Scalar, F> {
    trace: Trace<'a, T, F>,
    slabs: RaySlabs<T>,
    end: T,
}

impl<T: Scalar, L: Lanes<T>, F: FnMut(u32) -> T> Visitor<T, L> for OnTheWay<'_, T, F> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, (): &mut ()) -> Children {
        let mut room = None;
        let node = self.trace.tree.node(node as usize, &mut room);
        let (_, mut left) = self.slabs.entering::<L>(node, self.end);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        while let Some(place) = first_of(&mut left) {
            self.offer::<L>((node.first + place) as usize);
        }
        Children::NONE
    }
}

impl<T: Scalar, F: FnMut(u32) -> T> OnTheWay<'_, T, F> {
    /// Offers the triangles of a tile that the ray may meet.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn offer<L: Lanes<T>>(&mut self, index: usize) {
        let Trace { tree, mesh, prepared, offer, .. } = &mut self.trace;
        let tile = &tree.tiles[index];
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let met = match prepared {
            PreparedRay::Watertight(ray) => {
                let positions = tree.positions_of::<L>(index, mesh, &mut room);
                ray.may_meet::<L>(positions, &tile.corners).0 & tile.present
            }
            PreparedRay::MollerTrumbore(_) => tile.present,
        };
        for place in lanes_of(met) {
            // A hit may shorten the ray.
            self.end = offer(tile.triangles[place]);
        }
    }
}

impl<T: Scalar> Bvh<T> {
    /// Offers every triangle that the ray may meet up to the `t` that `offer` last returned.
    pub(crate) fn visit(
        &self,
        ray: &Ray<T>,
        prepared: &PreparedRay<T>,
        mesh: &Mesh<T>,
        offer: &mut impl FnMut(u32) -> T,
    ) {
        crate::simd::dispatch::<T, _>(Trace { tree: self, mesh, ray, prepared, offer });
    }
}
