use super::cutter::{CutPiece, Cutter};
use super::found::{set_lane, vector};
use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar, Vectors, direction, length};
use crate::memory::Room;
use crate::mesh::{Mesh, NormalLanes, Standing};
use crate::octree::Tracer;

/// Where rays start.
#[derive(Clone, Copy)]
pub(super) enum Starts<'a> {
    /// From the vertices or triangles of these groups.
    Groups(&'a [u32]),
    /// From the triangles at these places, each for its patch.
    Patches(&'a Standing, &'a [u32]),
}

impl Starts<'_> {
    /// In how many steps they are taken.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Groups(groups) => groups.len(),
            Self::Patches(_, places) => places.len().div_ceil(LANE_COUNT),
        }
    }
}

/// A group of triangles on its way into packets.
pub(super) struct FaceSource<'a, T: Scalar> {
    pub(super) cutter: Cutter<'a, T>,
    pub(super) triangles: [u32; LANE_COUNT],
    pub(super) lanes: NormalLanes<T>,
    /// Which of the triangles have rays that are not yet in a packet.
    pub(super) left: Mask,
    /// Which need not be cut.
    pub(super) short: Mask,
    /// How many stood for others too.
    pub(super) patch_count: u64,
}

impl<'a, T: Scalar> FaceSource<'a, T> {
    pub(super) fn new(cutter: Cutter<'a, T>) -> Self {
        let (triangles, lanes) = ([0; LANE_COUNT], NormalLanes::empty());
        Self { cutter, triangles, lanes, left: 0, short: 0, patch_count: 0 }
    }

    /// Turns to another group, or the next sixteen patches; gives how many of the triangles in the region have no normal.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn next<L: Lanes<T>>(&mut self, own: &Tracer<'_, T>, starts: Starts<'_>, number: usize) -> u64 {
        let mut count = 0;
        let mut add = |triangle| {
            self.triangles[count] = triangle;
            count += 1;
        };
        let mut patches = None;
        match starts {
            Starts::Groups(groups) => own.triangles_of(groups[number], add),
            Starts::Patches(standing, places) => {
                let places = &places[number * LANE_COUNT..places.len().min((number + 1) * LANE_COUNT)];
                places.iter().for_each(|&place| add(standing.triangle(place)));
                patches = Some((standing, places));
            }
        }
        let mut corners = [[[T::zero(); LANE_COUNT]; 3]; 3];
        own.mesh().face_normals::<L>(&self.triangles[..count], &mut corners, &mut self.lanes);
        let Aabb { lower, upper } = self.cutter.region;
        let (lower, upper) = (Vectors::<T, L>::splat(lower), Vectors::splat(upper));
        let (a, b, c) = (Vectors::load(&corners[0]), Vectors::load(&corners[1]), Vectors::load(&corners[2]));
        let touching = a.smaller(b).smaller(c).are_at_most(upper)
            & lower.are_at_most(a.larger(b).larger(c))
            & ((1u32 << count) - 1) as Mask;
        let (ab, bc, ca) = (a.sub(b), b.sub(c), c.sub(a));
        let longest = ab.dot(ab).larger(bc.dot(bc)).larger(ca.dot(ca));
        let middle = Vectors::load(&self.lanes.position);
        let middles_inside = lower.are_at_most(middle) & middle.are_at_most(upper);
        self.short = !L::splat(self.cutter.longest_allowed).is_less(longest);
        if let Some((standing, places)) = patches {
            self.stand_for_patches::<L>(own.mesh(), standing, places, middles_inside & touching);
        }
        self.left = touching & self.lanes.found & (middles_inside | !self.short);
        u64::from((touching & !self.lanes.found).count_ones())
    }

    /// Gives the triangles the normals and areas of the patches that they stand for: of the sum of area · normal, so that
    /// an even pressure pushes a patch just as its triangles.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn stand_for_patches<L: Lanes<T>>(
        &mut self,
        mesh: &Mesh<T>,
        standing: &Standing,
        places: &[u32],
        mut wanted: Mask,
    ) {
        while wanted != 0 {
            let lane = wanted.trailing_zeros() as usize;
            wanted &= wanted - 1;
            let border = standing.border(places[lane]);
            if border.is_empty() {
                continue;
            }
            self.patch_count += 1;
            self.short |= 1 << lane;
            let vector = mesh.doubled_area_within::<L>(border) * T::of(0.5);
            match direction(&vector) {
                Some(normal) => {
                    set_lane(&mut self.lanes.normal, lane, &normal);
                    self.lanes.area[lane] = length(&vector);
                    self.lanes.found |= 1 << lane;
                }
                None => self.lanes.found &= !(1 << lane),
            }
        }
    }

    /// The pieces of one triangle, the last first.
    pub(super) fn cut(&mut self, mesh: &Mesh<T>, lane: usize, pieces: &mut Vec<CutPiece<T>>) {
        let (normal, area) = (vector(&self.lanes.normal, lane), self.lanes.area[lane]);
        self.cutter.cut(mesh, self.triangles[lane], normal, area, &mut |piece| pieces.room_for(1).push(piece));
        pieces.reverse();
    }
}
