#[cfg(test)]
pub(crate) mod tests;

use crate::math::{Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;
use crate::query::Octree;
use crate::self_contact::certificate::NearTiles;
use crate::self_contact::certificate::reach::{Lapse, Reach};
use crate::self_contact::nearness::rounding;
use crate::self_contact::tangled::is_tangled;
use crate::self_contact::touching::Touching;

/// What a body remembers between steps of its search for contacts with itself: where its vertices were when the search found
/// nothing, and how far they may move against each other before it has to search again. The contacts do not depend on it.
#[derive(Clone, Debug)]
pub(crate) struct SelfWarmStart<T: Scalar> {
    /// Triangles around one vertex do not touch each other while this holds.
    fans: Certificate<T>,
    /// By vertex how far the triangles around it may be strained, as a part of their size.
    strains: Vec<T>,
    /// Which tiles are near each other, and how far these may move. Triangles do not touch while nothing of it has lapsed.
    near: NearTiles<T>,
    /// By how much any two vertices may move against each other until tiles may touch that are not near. Negative where that is
    /// not known.
    allowed: T,
    /// The largest rounding error of coordinates for which all this holds.
    rounding: T,
    /// Whether the body passed through itself nowhere when `near` was found.
    is_valid: bool,
    /// The positions for which what follows was found.
    stamp: u64,
    is_clear: bool,
    /// How much of `near` has lapsed.
    lapse: Lapse<T>,
    /// Whether triangles touch in the pairs that have lapsed, or all is to be searched.
    touches: bool,
    /// The sum of the parts of `near` that were searched in each step since nothing had lapsed.
    searched: f64,
    /// The mean altitude of the triangles.
    fineness: T,
    /// Steps since triangles without a common vertex were looked at.
    steps: u32,
    /// Steps until a clearance is looked for again.
    pause: u32,
    /// How many clearances in a row did not last long enough.
    failures: u32,
}

impl<T: Scalar> Default for SelfWarmStart<T> {
    fn default() -> Self {
        Self {
            fans: Certificate::default(),
            strains: Vec::new(),
            near: NearTiles::default(),
            allowed: -T::one(),
            rounding: T::zero(),
            is_valid: false,
            stamp: 0,
            is_clear: false,
            lapse: Lapse::unknown(),
            touches: true,
            searched: 0.0,
            fineness: T::zero(),
            steps: 0,
            pause: 0,
            failures: 0,
        }
    }
}

/// A finding that holds near the positions for which it was made.
#[derive(Clone, Debug, Default)]
struct Certificate<T: Scalar> {
    is_valid: bool,
    positions: Vec<Vector3<T>>,
    allowed: T,
    rounding: T,
}

// What chose these numbers: docs/architecture.md, *Tuned constants*.

// A clearance is what a search finds beyond what touches: by how much the body may move until it may touch itself.

/// The clearance that a search looks for should last this many steps at the present pace.
const STEPS_WANTED: f64 = 16.0;
/// A clearance that lasts fewer steps than this costs more than it saves.
const FEWEST_STEPS: u32 = 5;
/// After such a clearance none is looked for during this many steps, and after the next twice as many.
const PAUSE: u32 = 30;
/// The pause is doubled at most this often.
const MOST_DOUBLINGS: u32 = 3;
/// If more than this part of the near pairs have come too close, the whole surface is searched.
const MOST_LAPSED: f64 = 0.25;
/// Where pairs have lapsed for good, positions are kept anew once looking at them has cost as much as a search of all.
const MOST_SEARCHED: f64 = 1.0;
/// Steep triangles may come nearer by at most this, in mean altitudes: about as far as neighbouring tiles move against each
/// other while strain allows it.
const STEEP_MARGIN: f64 = 1.0;
/// Coordinates may grow by this factor before what was kept for rounding is used up.
const MOST_GROWTH: f64 = 1.5;

impl<T: Scalar> SelfWarmStart<T> {
    /// Whether the body cannot touch itself at its present positions, by what is remembered. Each call gets the same mesh and
    /// octree, which need not be up to date.
    pub(crate) fn is_clear(&mut self, mesh: &Mesh<T>, octree: &Octree<T>) -> bool {
        if self.stamp != mesh.stamp() {
            self.stamp = mesh.stamp();
            self.steps = self.steps.saturating_add(1);
            self.lapse = Lapse::unknown();
            if self.is_valid && self.allowed >= T::zero() && rounding(mesh) <= self.rounding {
                self.lapse = octree.find_lapsed(mesh, self.allowed, &mut self.near);
            }
            let part = self.lapse.part;
            self.searched = if part > 0.0 { self.searched + part } else { 0.0 };
            let is_whole = part > MOST_LAPSED || self.searched > MOST_SEARCHED;
            self.touches = is_whole || part > 0.0 && Touching::any_lapsed_touch(octree, mesh, &mut self.near);
            // One of several components may have come inside another meanwhile.
            self.is_clear = part == 0.0 || !self.touches && mesh.topology().components().len() == 1;
        }
        self.is_clear
    }

    /// Forgets everything: parts of the body lie inside others.
    pub(crate) fn forget(&mut self) {
        self.is_valid = false;
    }

    /// Looks at the whole surface but for what is known of it. [`is_clear`](Self::is_clear) must have been called before.
    pub(crate) fn search(&mut self, octree: &Octree<T>, mesh: &Mesh<T>, touching: &mut Touching<T>) {
        touching.reset(mesh);
        if !self.touches && !touching.any {
            return;
        }
        touching.is_tangled = is_tangled(mesh);
        if touching.is_tangled {
            return;
        }
        let mut tile_margin = self.tile_margin();
        let margin = tile_margin.min(self.fineness * T::of(STEEP_MARGIN));
        if tile_margin > T::zero() || !self.fans.is_known(mesh) || !self.fans.is_strained_at_most(mesh) {
            let found = touching.search_fans(mesh);
            self.fineness = found.fineness;
            std::mem::swap(&mut self.strains, &mut touching.strains);
            self.fans.set(mesh, found.stretch, !touching.any);
        }
        (self.is_valid, self.searched) = (false, 0.0);
        if touching.is_tangled {
            return;
        }
        let reach = Reach { margin, tile_margin, ..Touching::reach(mesh) };
        touching.search_pairs(octree, mesh, &reach, &mut self.near);
        if touching.is_tangled && tile_margin > T::zero() {
            // More tiles may soon be near each other than can be listed; those that are near now decide.
            tile_margin = T::zero();
            self.fail();
            touching.search_pairs(octree, mesh, &Touching::reach(mesh), &mut self.near);
        }
        if touching.is_tangled {
            return;
        }
        self.is_valid = !touching.any;
        self.rounding = rounding(mesh) * T::of(MOST_GROWTH);
        // Where no clearance has been looked for, positions are kept only to know the pace.
        self.allowed = -T::one();
        if self.is_valid && (tile_margin > T::zero() || self.pause <= 1) {
            octree.keep(mesh, &self.strains, &mut self.near);
            self.allowed = tile_margin;
        }
        self.steps = 0;
    }

    /// A clearance was of no use: the next one is looked for later each time.
    fn fail(&mut self) {
        self.pause = PAUSE << self.failures;
        self.failures = (self.failures + 1).min(MOST_DOUBLINGS);
    }

    /// How far tiles that are not near may move against each other: some steps at the present pace; 0 where that does not pay.
    fn tile_margin(&mut self) -> T {
        if !self.is_valid {
            return T::zero();
        }
        if self.pause > 0 {
            self.pause -= 1;
            return T::zero();
        }
        if self.allowed > T::zero() && self.steps < FEWEST_STEPS {
            self.fail();
            return T::zero();
        }
        let lasted = f64::from(self.steps.max(1));
        let mut wanted = STEPS_WANTED;
        if self.allowed > T::zero() {
            self.failures = 0;
            // If something else ended the last clearance early, the next one need not last much longer.
            wanted = wanted.min(2.0 * lasted);
        }
        self.lapse.spread * T::of(wanted / lasted)
    }
}

impl<T: Scalar> Certificate<T> {
    fn set(&mut self, mesh: &Mesh<T>, allowed: T, is_valid: bool) {
        // Coordinates may double before what was kept for rounding is used up.
        (self.is_valid, self.allowed, self.rounding) = (is_valid, allowed, rounding(mesh) * T::of(2.0));
        memory::refill(&mut self.positions, mesh.positions().iter().copied());
    }

    fn is_known(&self, mesh: &Mesh<T>) -> bool {
        self.is_valid && self.positions.len() == mesh.positions().len() && rounding(mesh) <= self.rounding
    }

    /// Whether the two ends of no edge have moved against each other by more than allowed.
    fn is_strained_at_most(&self, mesh: &Mesh<T>) -> bool {
        let allowed = self.allowed * self.allowed;
        let moved = |vertex: u32| mesh.positions()[vertex as usize] - self.positions[vertex as usize];
        mesh.topology().edge_list().iter().all(|edge| {
            let [from, to] = edge.vertices;
            (moved(from) - moved(to)).norm_squared() <= allowed
        })
    }
}
