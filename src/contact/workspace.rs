use crate::bvh::SidesScratch;
use crate::contact::point_pair::Contact;
use crate::contact::potential::PotentialRoom;
use crate::contact::quadrature::Sample;
use crate::contact::quadrature::refinement::Quadrature;
use crate::contact::spread::SpreadWorkspace;
use crate::contact::statistics::Statistics;
use crate::contact::weigh::shares::CastLoad;
use crate::math::Scalar;
use crate::memory::Room;
use crate::mesh::Side;
use crate::self_contact::SelfWorkspace;
use crate::threads::Helpers;
use crate::triangle::{Hit, Ray};

/// The rays of one direction of a pair on their way through the filters, each at one place of all arrays. Kept with
/// the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace<T: Scalar> {
    /// Who helps to cast the rays of one pair.
    pub(crate) helpers: Helpers,
    pub(crate) chunks: Vec<Chunk<T>>,
    /// The groups of vertices or triangles in the overlap box, of either body.
    pub(crate) groups: [Vec<u32>; 2],
    /// For which of them lie outside the other body.
    pub(crate) sides: [SidesScratch<T>; 2],
    /// Where the load needs samples, and over what they spread it.
    pub(crate) quadrature: Quadrature<T>,
    pub(crate) spread: SpreadWorkspace<T>,
    /// Of one chunk's groups the vertices in the overlap box.
    pub(crate) vertices: Vec<u32>,
    /// A bit for each vertex.
    pub(crate) marks: Vec<u64>,
    pub(crate) samples: Vec<Sample<T>>,
    pub(crate) rays: Vec<Ray<T>>,
    pub(crate) hits: Vec<Option<Hit<T>>>,
    /// Of each ray the vertices shared by the triangles it starts from.
    pub(crate) touched: Vec<[u32; 3]>,
    /// Whether the ray leaves its own mesh first.
    pub(crate) hidden: Vec<bool>,
    /// The sides from one vertex.
    pub(crate) edge_sides: Vec<Side>,
    /// The crossings of one edge.
    pub(crate) crossings: Vec<Hit<T>>,
    /// For the energy of what was found.
    pub(crate) potential: PotentialRoom<T>,
    /// For contacts of a body with itself.
    pub(crate) own: SelfWorkspace<T>,
}

impl<T: Scalar> Workspace<T> {
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.rays.clear();
    }

    /// Makes room for so many rays from contacts.
    pub(crate) fn reserve(&mut self, count: usize) {
        self.rays.clear();
        self.rays.room_for(count);
        self.touched.clear();
        self.touched.room_for(count);
        self.hidden.clear();
        self.hidden.room_for(count);
    }

    /// Keeps the rays that meet the other mesh from inside first, and counts the others.
    pub(crate) fn keep_exits(&mut self, statistics: &mut Statistics) {
        let mut kept = 0;
        for place in 0..self.rays.len() {
            let hit = &self.hits[place];
            statistics.misses += u64::from(hit.is_none());
            statistics.entry_hits += u64::from(hit.is_some_and(|hit| !hit.is_exit));
            if hit.is_some_and(|hit| hit.is_exit) {
                self.samples[kept] = self.samples[place];
                self.rays[kept] = self.rays[place];
                self.hits[kept] = self.hits[place];
                kept += 1;
            }
        }
        self.samples.truncate(kept);
        self.rays.truncate(kept);
        self.hits.truncate(kept);
    }
}

/// What the rays of some groups found, where chunks are cast side by side.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chunk<T: Scalar> {
    pub(crate) load: CastLoad<T>,
    pub(crate) statistics: Statistics,
    pub(crate) contacts: Vec<Contact<T>>,
    /// The number of contacts in the chunks before.
    pub(crate) before: usize,
    pub(crate) vertices: Vec<u32>,
    pub(crate) crossings: Vec<Hit<T>>,
}
