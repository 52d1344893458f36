//! Which triangles of a surface touch others of it. If none does, the surface neither passes through itself nor folds over, and
//! no ray has to be traced to know that.

#[cfg(test)]
pub(crate) mod tests;

use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::query::Octree;
use crate::self_contact::certificate::NearTiles;
use crate::self_contact::certificate::reach::Reach;
use crate::self_contact::fans::{Facet, altitude_of_fan, least_altitude, strain_of_fan};
use crate::self_contact::nearness::{projected_gap, rounding, separation, touch_distance};
use crate::self_contact::tangled::{Limits, MOST_PAIRS_OF_TILES, is_tangled};

/// What the search found, and the memory it needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touching<T: Scalar> {
    /// By triangle whether it comes nearer to another than rounding tells apart, or its neighbourhood folds over.
    pub(crate) touched: Vec<bool>,
    /// Whether any triangle does.
    pub(crate) any: bool,
    /// Triangles without a common vertex that touch.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// The body is tangled, and nothing else is told.
    pub(crate) is_tangled: bool,
    limits: Limits,
    /// Vertices around which the surface folds over.
    folds: usize,
    facets: Vec<Facet<T>>,
    /// By vertex: how far the triangles around it may be strained, as a part of their size, before they may touch.
    pub(crate) strains: Vec<T>,
    near: NearTiles<T>,
    /// Pairs of triangles held against each other.
    #[cfg(test)]
    pub(crate) tried: u64,
}

/// What holds for the triangles around all vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fans<T: Scalar> {
    /// Triangles around a vertex do not touch each other while the ends of no edge move against each other by more than this.
    pub(crate) stretch: T,
    /// The mean altitude of the triangles.
    pub(crate) fineness: T,
}

impl<T: Scalar> Touching<T> {
    /// Starts anew with a surface that touches itself nowhere; everywhere, where squares of lengths would underflow or overflow.
    pub(crate) fn reset(&mut self, mesh: &Mesh<T>) {
        let rounding = rounding(mesh);
        self.pairs.clear();
        (self.is_tangled, self.folds) = (false, 0);
        let square = rounding * rounding;
        self.any = !(T::SAFE_SQUARES.0 <= square && square <= T::SAFE_SQUARES.1);
        memory::refill_with(&mut self.touched, self.any, mesh.topology().triangles().len());
        self.limits = if self.any { Limits::NONE } else { Limits::of(mesh) };
    }

    /// Looks at the whole surface, but for a tangled one.
    pub(crate) fn search(&mut self, octree: &Octree<T>, mesh: &Mesh<T>) {
        self.reset(mesh);
        self.is_tangled = is_tangled(mesh);
        self.search_within(&Self::reach(mesh), octree, mesh);
    }

    /// Looks at the whole surface, however long it takes.
    pub(crate) fn search_all(&mut self, octree: &Octree<T>, mesh: &Mesh<T>) {
        self.reset(mesh);
        self.limits = Limits::NONE;
        self.search_within(&Reach { most_pairs: usize::MAX, ..Self::reach(mesh) }, octree, mesh);
    }

    fn search_within(&mut self, reach: &Reach<T>, octree: &Octree<T>, mesh: &Mesh<T>) {
        if !self.is_tangled {
            self.search_fans(mesh);
        }
        if !self.is_tangled {
            let mut near = std::mem::take(&mut self.near);
            self.search_pairs(octree, mesh, reach, &mut near);
            self.near = near;
        }
    }

    /// The reach of a search for what touches.
    pub(crate) fn reach(mesh: &Mesh<T>) -> Reach<T> {
        let pairs = MOST_PAIRS_OF_TILES * mesh.topology().triangles().len();
        Reach { touch: touch_distance(mesh), margin: T::zero(), tile_margin: T::zero(), most_pairs: pairs }
    }

    fn touch(&mut self, triangle: u32) {
        self.touched[triangle as usize] = true;
        self.any = true;
    }

    /// Looks at the triangles around each vertex: those with a common vertex. With too many folds the body is tangled.
    pub(crate) fn search_fans(&mut self, mesh: &Mesh<T>) -> Fans<T> {
        let count = mesh.topology().triangles().len();
        memory::refill(&mut self.facets, (0..count as u32).map(|triangle| Facet::new(&mesh.corners(triangle))));
        let altitudes = self.facets.iter().map(|facet| facet.area / facet.longest_edge);
        let fineness = altitudes.fold(T::zero(), |sum, altitude| sum + altitude) / T::of(count as f64);
        let least_allowed = least_altitude(mesh);
        let mut least = T::INFINITY;
        memory::refill_with(&mut self.strains, T::zero(), mesh.topology().vertex_count());
        for &vertex in mesh.topology().surface_vertices() {
            let (altitude, cosine) = altitude_of_fan(mesh, vertex, |triangle| self.facets[triangle as usize]);
            self.strains[vertex as usize] = strain_of_fan(cosine, least_allowed / altitude);
            self.folds += usize::from(altitude == T::zero());
            if altitude < least_allowed {
                mesh.topology().triangles_around(vertex).iter().for_each(|&triangle| self.touch(triangle));
            } else {
                least = least.min(altitude);
            }
        }
        self.is_tangled |= self.limits.are_exceeded(mesh, self.folds);
        // Where the ends of edges of length L or less move by ε, twice the area of a triangle changes by at most 2 ε L + ε².
        Fans { stretch: (least - least_allowed) / T::of(3.0), fineness }
    }

    /// Looks at the triangles without a common vertex, until more touch or are close than the limits allow. A margin of 0 is
    /// quickest. What touches and what is close depends neither on the order of the pairs nor on the margins.
    pub(crate) fn search_pairs(
        &mut self,
        octree: &Octree<T>,
        mesh: &Mesh<T>,
        reach: &Reach<T>,
        near: &mut NearTiles<T>,
    ) {
        let Reach { touch, margin, .. } = *reach;
        let (most_touching, most_close) = (self.limits.touching, self.limits.close(self.folds));
        if most_close != usize::MAX {
            // Beside many folds, overlapping boxes are counted before any distance is computed.
            let mut close = 0;
            let boxes = Reach { margin: T::zero(), tile_margin: T::zero(), ..*reach };
            self.is_tangled = !octree.search_near(mesh, &boxes, near, |a, b, _| {
                let [a, b] = [Aabb::of_triangle(&mesh.corners(a)), Aabb::of_triangle(&mesh.corners(b))];
                close += usize::from(a.grown(touch).overlaps(&b));
                (close <= most_close).then_some(T::zero())
            });
            if self.is_tangled {
                return;
            }
        }
        let sheltered = reach.of_sheltered();
        let is_done = octree.search_near(mesh, reach, near, |a, b, is_steep| {
            #[cfg(test)]
            (self.tried += 1);
            // The smaller number first, so that the layout does not matter to the last bit.
            let pair = [a.min(b), a.max(b)];
            let corners = [mesh.corners(pair[0]), mesh.corners(pair[1])];
            if !(is_steep && margin > T::zero()) && are_apart(&corners, sheltered) {
                return Some(sheltered - touch);
            }
            let distance = separation(&corners, if is_steep { touch + margin } else { sheltered });
            if distance < touch {
                pair.into_iter().for_each(|triangle| self.touch(triangle));
                self.pairs.room_for(1).push(pair);
            }
            (self.pairs.len() <= most_touching).then_some(distance - touch)
        });
        self.is_tangled = !is_done;
    }

    /// Whether any triangles touch in pairs of tiles that have lapsed, or around a vertex of a strained triangle.
    pub(crate) fn any_lapsed_touch(octree: &Octree<T>, mesh: &Mesh<T>, near: &mut NearTiles<T>) -> bool {
        let (touch, least_allowed) = (touch_distance(mesh), least_altitude(mesh));
        let folds = |vertex: u32| {
            altitude_of_fan(mesh, vertex, |triangle| Facet::new(&mesh.corners(triangle))).0 < least_allowed
        };
        let mut any =
            octree.strained(near).any(|triangle| mesh.topology().triangles()[triangle as usize].into_iter().any(folds));
        if any {
            return true;
        }
        octree.search_lapsed(mesh, touch, near, |a, b| {
            any = separation(&[mesh.corners(a), mesh.corners(b)], touch) < touch;
            !any
        });
        any
    }
}

/// Whether the line of centres alone parts two triangles by more than `distance`; quicker than [`separation`], without a root.
#[inline]
fn are_apart<T: Scalar>(corners: &[[Vector3<T>; 3]; 2], distance: T) -> bool {
    let [a, b] = corners;
    let axis = (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2]);
    let (gap, square) = (projected_gap(corners, &axis), axis.norm_squared());
    // Where squares underflow or overflow it is not known.
    let is_safe = T::SAFE_SQUARES.0 <= square && square <= T::SAFE_SQUARES.1;
    is_safe && gap > T::zero() && gap * gap / square > distance * distance * T::of(margins::CLEAR_GAP)
}
