use crate::bvh::SidesScratch;
use crate::contact::point_pair::Contact;
use crate::contact::potential::Columns;
use crate::contact::quadrature::Sample;
use crate::contact::quadrature::refinement::Quadrature;
use crate::contact::spread::SpreadWorkspace;
use crate::contact::statistics::Statistics;
use crate::contact::weigh::shares::CastLoad;
use crate::math::{Scalar, Vector3};
use crate::memory::Room;
use crate::mesh::Side;
use crate::self_contact::SelfWorkspace;
use crate::threads::Helpers;
use crate::triangle::{Hit, Ray};

/// Scratch memory of detection. Kept with the contacts, so that a steady step allocates nothing. `samples`, `rays` and `hits`
/// go together by index.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace<T: Scalar> {
    /// Who helps to cast the rays of one pair.
    pub(crate) helpers: Helpers,
    pub(crate) chunks: Vec<Chunk<T>>,
    /// The groups of vertices or triangles in the overlap box, of either body.
    pub(crate) groups: [Vec<u32>; 2],
    /// For telling which of these lie outside the other body.
    pub(crate) sides: [SidesScratch<T>; 2],
    pub(crate) quadrature: Quadrature<T>,
    pub(crate) spread: SpreadWorkspace<T>,
    /// The vertices of a chunk's groups in the overlap box.
    pub(crate) vertices: Vec<u32>,
    /// A bit for each vertex.
    pub(crate) marks: Vec<u64>,
    pub(crate) samples: Vec<Sample<T>>,
    pub(crate) rays: Vec<Ray<T>>,
    pub(crate) hits: Vec<Option<Hit<T>>>,
    /// By ray the vertices that all triangles have where it starts.
    pub(crate) touched: Vec<[u32; 3]>,
    /// Whether the ray leaves its own mesh first.
    pub(crate) hidden: Vec<bool>,
    /// The sides from one vertex.
    pub(crate) edge_sides: Vec<Side>,
    /// The crossings of one edge or ray.
    pub(crate) crossings: Vec<Hit<T>>,
    /// The points of either body inside the other, by which the directions of an escape are judged.
    pub(crate) judges: [Vec<Vector3<T>>; 2],
    /// For the energy of a list's contacts.
    pub(crate) columns: Columns<T>,
    /// For contacts of a body with itself.
    pub(crate) own: SelfWorkspace<T>,
}

impl<T: Scalar> Workspace<T> {
    /// Reserves memory for so many rays from contacts.
    pub(crate) fn reserve(&mut self, count: usize) {
        self.rays.clear();
        self.rays.room_for(count);
        self.touched.clear();
        self.touched.room_for(count);
        self.hidden.clear();
        self.hidden.room_for(count);
        for judges in &mut self.judges {
            judges.clear();
            judges.room_for(count);
        }
    }

    /// Keeps the rays that meet the other mesh from inside first, and counts the others.
    pub(crate) fn keep_exits(&mut self, statistics: &mut Statistics) {
        let mut kept = 0;
        for index in 0..self.rays.len() {
            let hit = &self.hits[index];
            statistics.misses += u64::from(hit.is_none());
            statistics.entry_hits += u64::from(hit.is_some_and(|hit| !hit.is_exit));
            if hit.is_some_and(|hit| hit.is_exit) {
                self.samples[kept] = self.samples[index];
                self.rays[kept] = self.rays[index];
                self.hits[kept] = self.hits[index];
                kept += 1;
            }
        }
        self.samples.truncate(kept);
        self.rays.truncate(kept);
        self.hits.truncate(kept);
    }
}

/// The contacts of some of a direction's samples, where threads cast side by side.
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
