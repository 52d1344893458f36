use super::contact_point::Contact;
use super::cutter::CutPiece;
use super::load::CastLoad;
use super::samples::Sample;
use super::self_contact::winding::{leaves_body_before_end, way_out_past_folds};
use super::self_contact::workspace::SelfWorkspace;
use super::statistics::Statistics;
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::octree::Tracer;
use crate::ray::{Hit, Ray};
use crate::threads::Helpers;

/// The rays of one direction of a pair on their way through the filters, each at one place of all arrays. Kept with
/// the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<T: Scalar> {
    /// Who helps to cast the rays of one pair.
    pub(super) helpers: Helpers,
    pub(super) chunks: Vec<Chunk<T>>,
    /// The groups of vertices or triangles in the overlap box, of either body.
    pub(super) groups: [Vec<u32>; 2],
    /// Of these the places of the triangles that cast for patches.
    pub(super) places: [Vec<u32>; 2],
    /// Of one chunk's groups the vertices in the overlap box.
    pub(super) vertices: Vec<u32>,
    pub(super) pieces: Pieces<T>,
    pub(super) samples: Vec<Sample<T>>,
    pub(super) rays: Vec<Ray<T>>,
    pub(super) hits: Vec<Option<Hit<T>>>,
    /// Of each ray the vertices shared by the triangles it starts from.
    pub(super) touched: Vec<[u32; 3]>,
    /// Whether the ray leaves its own mesh first.
    pub(super) hidden: Vec<bool>,
    /// The crossings of one edge.
    pub(super) crossings: Vec<Hit<T>>,
    /// For contacts of a body with itself.
    pub(super) own: SelfWorkspace<T>,
}

impl<T: Scalar> Workspace<T> {
    pub(super) fn clear(&mut self) {
        self.samples.clear();
        self.rays.clear();
    }

    /// Makes room for so many rays from contacts.
    pub(super) fn reserve(&mut self, count: usize) {
        self.rays.clear();
        self.rays.room_for(count);
        self.touched.clear();
        self.touched.room_for(count);
        self.hidden.clear();
        self.hidden.room_for(count);
    }

    /// Keeps the rays that meet the other mesh from inside first, and counts the others.
    pub(super) fn keep_exits(&mut self, statistics: &mut Statistics) {
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

    /// Ends each ray at its hit, and notes where it starts, for the test against its own mesh.
    pub(super) fn cut_at_hits(&mut self) {
        self.touched.clear();
        memory::append(&mut self.touched, self.samples.iter().map(|sample| sample.point.touched()));
        for (ray, hit) in self.rays.iter_mut().zip(&self.hits) {
            *ray = ray.until(hit.map_or(ray.t_max, |hit| hit.t));
        }
    }

    /// A ray that starts inside the other body may enter another fold of it before it leaves: its hit is the way out then.
    /// Gives how many there are.
    pub(super) fn follow_past_folds(&mut self, other: &Tracer<'_, T>) -> u64 {
        let mut followed = 0;
        for (ray, hit) in self.rays.iter().zip(&mut self.hits) {
            if hit.is_some_and(|hit| !hit.is_exit) {
                let way_out = way_out_past_folds(other, ray, &mut self.crossings);
                followed += u64::from(way_out.is_some());
                *hit = way_out.or(*hit);
            }
        }
        followed
    }

    /// A ray that meets another fold of its own body has not left the body: such rays are no longer hidden. Gives how
    /// many there are.
    pub(super) fn uncover_past_folds(&mut self, own: &Tracer<'_, T>) -> u64 {
        let mut uncovered = 0;
        for place in 0..self.rays.len() {
            let (ray, touched) = (&self.rays[place], self.touched[place]);
            if self.hidden[place] && !leaves_body_before_end(own, ray, touched, &mut self.crossings) {
                self.hidden[place] = false;
                uncovered += 1;
            }
        }
        uncovered
    }
}

/// Parts of triangles that have yet to cast.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces<T: Scalar> {
    /// Of one triangle, the last first.
    pub(super) cut: Vec<CutPiece<T>>,
    /// The parts inside the other body of pieces that its surface crosses.
    pub(super) inside: Vec<Sample<T>>,
}

impl<T: Scalar> Pieces<T> {
    pub(super) fn clear(&mut self) {
        self.cut.clear();
        self.inside.clear();
    }
}

/// What the rays of some groups found, where chunks are cast side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk<T: Scalar> {
    pub(super) load: CastLoad<T>,
    pub(super) statistics: Statistics,
    pub(super) contacts: Vec<Contact<T>>,
    /// The number of contacts in the chunks before.
    pub(super) before: usize,
    pub(super) pieces: Pieces<T>,
    pub(super) vertices: Vec<u32>,
    pub(super) crossings: Vec<Hit<T>>,
}
