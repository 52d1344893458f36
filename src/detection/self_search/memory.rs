use super::nearness::rounding;
use super::tangled::is_tangled;
use super::touching::Touching;
use crate::math::{Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;
use crate::octree::{Lapse, NearParts, Octree, Reach};

/// What a body remembers between steps of its search for contacts with itself: where its vertices were when the search found
/// nothing, and how far they may move against each other before it has to search again. The contacts do not depend on it.
#[derive(Clone, Debug)]
pub(crate) struct SelfMemory<T: Scalar> {
    /// Triangles around one vertex do not touch each other until an edge is strained by more than this.
    fans: Certificate<T>,
    /// By vertex: how far the triangles around it may be strained, as a part of their size.
    strains: Vec<T>,
    /// Triangles do not touch until one is strained by more than this holds, parts that are near each other have moved
    /// against each other by more,
    near: NearParts<T>,
    /// or any two vertices by more than this. Negative where nothing is known of that.
    allowed: T,
    /// With coordinates that round by more nothing is known.
    rounding: T,
    /// Whether the body passed through itself nowhere when `near` was found.
    is_valid: bool,
    /// The positions that the rest is about.
    stamp: u64,
    is_clear: bool,
    /// What has happened to `near` since.
    lapse: Lapse<T>,
    /// Whether triangles touch where it has lapsed.
    touches: bool,
    /// The mean altitude of the triangles.
    fineness: T,
    /// Steps since triangles without a common vertex were looked at.
    steps: u32,
    /// Steps until a clearance is looked for again.
    pause: u32,
}

impl<T: Scalar> Default for SelfMemory<T> {
    fn default() -> Self {
        let (fans, strains, near) = (Certificate::default(), Vec::new(), NearParts::default());
        let (allowed, rounding, fineness) = (-T::one(), T::zero(), T::zero());
        let (is_valid, is_clear, touches) = (false, false, true);
        let (stamp, steps, pause) = (0, 0, 0);
        let lapse = Lapse::unknown();
        Self { fans, strains, near, allowed, rounding, is_valid, stamp, is_clear, lapse, touches, fineness, steps, pause }
    }
}

/// Something that was found at some positions, and holds near them.
#[derive(Clone, Debug, Default)]
struct Certificate<T: Scalar> {
    is_valid: bool,
    positions: Vec<Vector3<T>>,
    allowed: T,
    rounding: T,
}

/// The clearance that a search looks for should last this many steps at the present pace.
const STEPS_WANTED: f64 = 16.0;
/// A clearance that lasts fewer steps than this costs more than it saves;
const FEWEST_STEPS: u32 = 3;
/// after one, none is looked for during this many steps.
const PAUSE: u32 = 30;
/// If more than this part of the near pairs have come too close, the whole surface is searched.
const MOST_LAPSED: f64 = 0.25;
/// Steep triangles may come nearer by at most this, in mean altitudes: about as far as parts of one tile and the next move
/// against each other while strain allows it.
const STEEP_MARGIN: f64 = 1.0;
/// Coordinates may grow by this before what was kept for rounding is used up.
const MOST_GROWTH: f64 = 1.5;

impl<T: Scalar> SelfMemory<T> {
    /// Whether the body cannot touch itself at its present positions, by what is remembered. The octree is always the same
    /// of the same mesh, but need not be up to date.
    pub(crate) fn is_clear(&mut self, mesh: &Mesh<T>, octree: &Octree<T>) -> bool {
        if self.stamp != mesh.stamp() {
            self.stamp = mesh.stamp();
            self.steps = self.steps.saturating_add(1);
            self.lapse = Lapse::unknown();
            if self.is_valid && self.allowed >= T::zero() && rounding(mesh) <= self.rounding {
                self.lapse = octree.find_lapsed(mesh, self.allowed, &mut self.near);
            }
            let part = self.lapse.part;
            self.touches = part > MOST_LAPSED || part > 0.0 && Touching::any_lapsed_touch(octree, mesh, &mut self.near);
            // Of several components one may have come inside another meanwhile.
            self.is_clear = part == 0.0 || !self.touches && mesh.topology().components().len() == 1;
        }
        self.is_clear
    }

    /// Nothing is known any more: parts lie inside others.
    pub(in crate::detection) fn forget(&mut self) {
        self.is_valid = false;
    }

    /// Looks at the whole surface but for what is known of it. [`is_clear`](Self::is_clear) has been asked before.
    pub(in crate::detection) fn search(&mut self, octree: &Octree<T>, mesh: &Mesh<T>, touching: &mut Touching<T>) {
        touching.reset(mesh);
        if !self.touches && !touching.any {
            return;
        }
        touching.is_tangled = is_tangled(mesh);
        if touching.is_tangled {
            return;
        }
        let mut part_margin = self.part_margin();
        let margin = part_margin.min(self.fineness * T::of(STEEP_MARGIN));
        if part_margin > T::zero() || !self.fans.is_known(mesh) || !self.fans.is_strained_at_most(mesh) {
            let found = touching.search_fans(mesh);
            self.fineness = found.fineness;
            std::mem::swap(&mut self.strains, &mut touching.strains);
            self.fans.set(mesh, found.strain, !touching.any);
        }
        self.is_valid = false;
        if touching.is_tangled {
            return;
        }
        let reach = Reach { margin, part_margin, ..Touching::reach(mesh) };
        touching.search_pairs(octree, mesh, &reach, &mut self.near);
        if touching.is_tangled && part_margin > T::zero() {
            // More parts may soon be near each other than are listed; those that are near now decide.
            (part_margin, self.pause) = (T::zero(), PAUSE);
            touching.search_pairs(octree, mesh, &Touching::reach(mesh), &mut self.near);
        }
        if touching.is_tangled {
            return;
        }
        self.is_valid = !touching.any;
        self.rounding = rounding(mesh) * T::of(MOST_GROWTH);
        // Where no clearance has been looked for, the positions are only needed to know the pace.
        self.allowed = -T::one();
        if self.is_valid && (part_margin > T::zero() || self.pause <= 1) {
            octree.keep(mesh, &self.strains, &mut self.near);
            self.allowed = part_margin;
        }
        self.steps = 0;
    }

    /// How far parts that are not near may move against each other: some steps at the present pace; nothing where that
    /// does not pay.
    fn part_margin(&mut self) -> T {
        if !self.is_valid {
            return T::zero();
        }
        if self.pause > 0 {
            self.pause -= 1;
            return T::zero();
        }
        if self.allowed > T::zero() && self.steps < FEWEST_STEPS {
            self.pause = PAUSE;
            return T::zero();
        }
        self.lapse.spread / T::of(f64::from(self.steps.max(1))) * T::of(STEPS_WANTED)
    }
}

impl<T: Scalar> Certificate<T> {
    fn set(&mut self, mesh: &Mesh<T>, allowed: T, is_valid: bool) {
        // Coordinates may double before what was kept for rounding is used up.
        (self.is_valid, self.allowed, self.rounding) = (is_valid, allowed, rounding(mesh) * T::of(2.0));
        self.positions.clear();
        memory::append(&mut self.positions, mesh.positions().iter().copied());
    }

    fn is_known(&self, mesh: &Mesh<T>) -> bool {
        self.is_valid && self.positions.len() == mesh.positions().len() && rounding(mesh) <= self.rounding
    }

    /// Whether the two ends of no edge have moved against each other by more than allowed.
    fn is_strained_at_most(&self, mesh: &Mesh<T>) -> bool {
        let allowed = self.allowed * self.allowed;
        let moved = |vertex: u32| mesh.positions()[vertex as usize] - self.positions[vertex as usize];
        mesh.topology().edges().iter().all(|edge| {
            let [from, to] = edge.vertices;
            (moved(from) - moved(to)).norm_squared() <= allowed
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::test_mesh::{torus, torus_positions};
    use std::collections::BTreeSet;

    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn tetrahedron(map: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Mesh<f64> {
        let positions: Vec<_> = CORNERS.iter().enumerate().map(|(vertex, &corner)| map(vertex, corner)).collect();
        Mesh::new(&positions, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).expect("it is closed")
    }

    /// What is found at one position of a body, with so much allowed.
    fn certificate(allowed: f64, is_valid: bool) -> Certificate<f64> {
        let mut certificate = Certificate::default();
        certificate.set(&tetrahedron(|_, corner| corner), allowed, is_valid);
        certificate
    }

    #[test]
    fn what_moves_as_a_whole_is_not_strained() {
        let moved = tetrahedron(|_, [x, y, z]| [x - 0.5, y + 0.25, z - 0.75]);
        let certificate = certificate(0.0, true);
        assert!(certificate.is_known(&moved) && certificate.is_strained_at_most(&moved));
        assert_eq!(certificate.spread(&moved), 0.0);
    }

    #[test]
    fn strain_counts_along_edges_and_spread_between_any_two() {
        // One vertex goes 0.3 to one side, another 0.4 across it: 0.5 against each other.
        let offsets = [[0.0; 3], [0.0, 0.3, 0.0], [0.0; 3], [0.4, 0.0, 0.0]];
        let moved = tetrahedron(|vertex, corner| std::array::from_fn(|axis| corner[axis] + offsets[vertex][axis]));
        assert!(certificate(0.51, true).is_strained_at_most(&moved));
        assert!(!certificate(0.49, true).is_strained_at_most(&moved));
        assert!((certificate(0.0, true).spread(&moved) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn certificates_hold_where_they_are_valid_and_coordinates_have_not_grown() {
        assert!(certificate(1.0, true).is_known(&tetrahedron(|_, corner| corner.map(|x| 1.9 * x))));
        assert!(!certificate(1.0, true).is_known(&tetrahedron(|_, corner| corner.map(|x| 2.1 * x))));
        assert!(!certificate(1.0, false).is_known(&tetrahedron(|_, corner| corner)));
        assert!(!Certificate::default().is_known(&tetrahedron(|_, corner| corner)));
    }

    const SIDES: [u32; 2] = [32, 8];

    /// A torus pinched in the middle, so that its inner sides are so far apart; where they are, they pass through each
    /// other. Folded: one vertex lies beyond the triangles of its neighbour.
    fn pose(mesh: &mut Mesh<f64>, gap: f64, is_folded: bool) {
        let inner = 0.7_f64;
        let depth = inner.hypot(0.3) * (1.0 - gap / (2.0 * inner));
        let pinched = |[x, y, z]: [f64; 3]| [x, y * (1.0 - depth * (-4.0 * x * x).exp() / y.hypot(0.3)), z];
        let mut positions: Vec<_> = torus_positions(SIDES, 0).into_iter().map(pinched).collect();
        if is_folded {
            positions[0] = std::array::from_fn(|axis| 3.0 * positions[1][axis] - 2.0 * positions[0][axis]);
        }
        mesh.set_positions(&positions).expect("finite");
    }

    /// How a step was settled.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    enum Settled {
        Remembered,
        PartSearched,
        Searched { any: bool, lapsed_alone: bool },
    }

    /// One step, held to a search that remembers nothing.
    fn step(memory: &mut SelfMemory<f64>, octree: &mut Octree<f64>, mesh: &Mesh<f64>) -> Settled {
        octree.update(mesh).expect("its own");
        let [mut found, mut expected] = [(); 2].map(|()| Touching::default());
        expected.search(octree, mesh);
        if memory.is_clear(mesh, octree) {
            assert!(!expected.any);
            return Settled::Remembered;
        }
        memory.search(octree, mesh, &mut found);
        assert_eq!((&found.touched, found.any), (&expected.touched, expected.any));
        let lapsed_alone = memory.lapsed <= MOST_LAPSED;
        if memory.steps > 0 {
            return Settled::PartSearched;
        }
        // What may spare the next search is of these positions, at which nothing touches.
        let Certificate { is_valid, allowed, positions, .. } = &memory.pairs;
        assert!(!is_valid || *allowed < 0.0 || (!expected.any && positions == mesh.positions()), "{:?}", memory.pause);
        Settled::Searched { any: expected.any, lapsed_alone }
    }

    #[test]
    fn what_is_remembered_never_tells_other_than_a_search() {
        let mut mesh = torus(SIDES);
        let mut octree = Octree::new(&mesh);
        let mut memory = SelfMemory::default();
        let mut settled = BTreeSet::new();
        let mut pass = |gap: f64, is_folded: bool| {
            pose(&mut mesh, gap, is_folded);
            settled.insert(step(&mut memory, &mut octree, &mesh));
        };
        // Slowly nearer, from far apart to touching and back.
        let nearer = (0..80).map(|i| 0.3 - 0.004 * f64::from(i));
        nearer.clone().chain(nearer.rev()).for_each(|gap| pass(gap, false));
        // A fold that comes, stays and goes, while nothing else moves and while it does.
        for (step, gap) in [0.2, 0.2, 0.2, 0.2, 0.21, 0.2, 0.21, 0.2].into_iter().enumerate() {
            (0..4).for_each(|_| pass(gap, step % 2 == 1));
        }
        // Too fast for anything to be worth remembering, then slowly again.
        let fast = (0..80).map(|i| [0.5, 0.2, -0.01][i % 3]);
        fast.chain([-0.004, -0.003, -0.002, -0.001, 0.001]).for_each(|gap| pass(gap, false));
        (0..80).for_each(|i| pass(0.1 - 0.0015 * f64::from(i), false));
        // At rest after all that.
        (0..41).for_each(|_| pass(0.2, false));
        assert_eq!(step(&mut memory, &mut octree, &mesh), Settled::Remembered);
        let searched = |any, lapsed_alone| Settled::Searched { any, lapsed_alone };
        let searches = [searched(false, false), searched(true, false), searched(true, true)];
        assert!(
            settled.iter().eq([&Settled::Remembered, &Settled::PartSearched].into_iter().chain(&searches)),
            "{settled:?}"
        );
    }
}
