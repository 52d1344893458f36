//! Many meshes at once: which boxes overlap (broad phase), then their contacts, pairs in parallel (narrow phase).

mod broad_phase;

use crate::contact::{ContactList, DetectionOptions, PairMemory, detect_pair, overlap_region};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::octree::Octree;
use broad_phase::BroadPhase;
use rayon::prelude::*;
use std::fmt;

/// Bodies, and what is needed to find all contacts among them.
///
/// The contacts and their order do not depend on the number of threads.
#[derive(Debug)]
pub struct Scene<T: Scalar> {
    bodies: Vec<Option<Body<T>>>,
    broad_phase: BroadPhase<T>,
    /// The contacts of each overlapping pair; kept so that a steady step allocates nothing.
    pair_contacts: Vec<ContactList<T>>,
    /// What each overlapping pair remembers, in the order of the pairs.
    memories: Vec<([u32; 2], PairMemory<T>)>,
    options: DetectionOptions<T>,
    /// `None`: the caller's own thread.
    pool: Option<rayon::ThreadPool>,
}

#[derive(Debug)]
struct Body<T: Scalar> {
    mesh: Mesh<T>,
    octree: Octree<T>,
    /// Room for a list of the octree's tiles.
    tiles: Vec<u32>,
}

/// Why a scene refused something. Nothing was changed.
#[derive(Debug)]
pub enum SceneError {
    /// There is no body of this number.
    UnknownBody {
        /// The number.
        body: u32,
    },
    /// The system gave no threads.
    ThreadsNotStarted {
        /// How many were wanted.
        threads: usize,
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownBody { body } => write!(f, "the scene has no body {body}; it was never added, or was removed"),
            Self::ThreadsNotStarted { threads, source } => {
                write!(f, "could not start {threads} threads: {source}; ask for fewer, or for 1 to use your own")
            }
        }
    }
}

impl std::error::Error for SceneError {}

impl<T: Scalar> Scene<T> {
    /// An empty scene with default options. `threads`: 1 works on the caller's own thread, n on a pool of n threads that the scene owns, 0
    /// on one thread per core.
    ///
    /// # Errors
    /// [`SceneError::ThreadsNotStarted`].
    pub fn new(threads: usize) -> Result<Self, SceneError> {
        let pool = match threads {
            1 => None,
            _ => {
                let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let named = builder.thread_name(|index| format!("raycontact-{index}"));
                Some(named.build().map_err(|source| SceneError::ThreadsNotStarted { threads, source })?)
            }
        };
        let options = DetectionOptions::default();
        Ok(Self {
            bodies: Vec::new(),
            broad_phase: BroadPhase::default(),
            pair_contacts: Vec::new(),
            memories: Vec::new(),
            options,
            pool,
        })
    }

    /// Sets how contacts are found from the next query on.
    pub fn set_options(&mut self, options: DetectionOptions<T>) {
        self.options = options;
    }

    /// Adds a body; gives its number: the smallest that is free.
    pub fn add(&mut self, mesh: Mesh<T>) -> u32 {
        let octree = Octree::new(&mesh);
        let body = Some(Body { mesh, octree, tiles: Vec::new() });
        match self.bodies.iter().position(Option::is_none) {
            Some(free) => {
                self.bodies[free] = body;
                free as u32
            }
            None => {
                self.bodies.push(body);
                (self.bodies.len() - 1) as u32
            }
        }
    }

    /// Removes a body; its number may be given to a later one.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn remove(&mut self, body: u32) -> Result<Mesh<T>, SceneError> {
        self.memories.retain(|(pair, _)| !pair.contains(&body));
        let removed = self.bodies.get_mut(body as usize).and_then(Option::take);
        removed.map(|body| body.mesh).ok_or(SceneError::UnknownBody { body })
    }

    /// A body's mesh.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn mesh(&self, body: u32) -> Result<&Mesh<T>, SceneError> {
        let found = self.bodies.get(body as usize).and_then(Option::as_ref);
        found.map(|body| &body.mesh).ok_or(SceneError::UnknownBody { body })
    }

    /// A body's mesh, to renew its positions.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn mesh_mut(&mut self, body: u32) -> Result<&mut Mesh<T>, SceneError> {
        let found = self.bodies.get_mut(body as usize).and_then(Option::as_mut);
        found.map(|body| &mut body.mesh).ok_or(SceneError::UnknownBody { body })
    }

    /// Finds all contacts between different bodies at their present positions. Replaces what `contacts` held; their
    /// order is by pair (smaller body number first, then the other), then the colliding body, then along its surface.
    pub fn query(&mut self, contacts: &mut ContactList<T>) {
        match self.pool.take() {
            None => self.detect(false),
            Some(pool) => {
                pool.install(|| self.detect(true));
                self.pool = Some(pool);
            }
        }
        contacts.clear();
        for pair in &self.pair_contacts[..self.broad_phase.pairs().len()] {
            contacts.append(pair);
        }
    }

    fn detect(&mut self, parallel: bool) {
        let boxes = self.bodies.iter().map(|body| body.as_ref().map(|body| *body.mesh.aabb()));
        self.broad_phase.update(boxes);
        let broad_phase = &self.broad_phase;
        let pairs = broad_phase.pairs();
        if self.pair_contacts.len() < pairs.len() {
            let new = || if parallel { ContactList::for_pool() } else { ContactList::default() };
            self.pair_contacts.resize_with(pairs.len(), new);
        }

        remember(&mut self.memories, pairs);

        // Only bodies that meet another one need their octree.
        let update = |(index, body): (usize, &mut Option<Body<T>>)| {
            let mut others = broad_phase.met_by(index).peekable();
            if let Some(Body { mesh, octree, tiles }) = body.as_mut().filter(|_| others.peek().is_some()) {
                let regions = others.map(|other| overlap_region(mesh.aabb(), other).1);
                octree.update_in(mesh, regions, tiles).expect("a body keeps its own octree");
            }
        };
        if parallel {
            self.bodies.par_iter_mut().enumerate().for_each(update);
        } else {
            self.bodies.iter_mut().enumerate().for_each(update);
        }

        let (bodies, options) = (&self.bodies, &self.options);
        let tracer = |index: u32| {
            let body = bodies[index as usize].as_ref().expect("pairs name present bodies");
            body.octree.tracer(&body.mesh).expect("octrees are up to date")
        };
        let detect = |(([a, b], memory), contacts): (&mut ([u32; 2], PairMemory<T>), &mut ContactList<T>)| {
            contacts.clear();
            detect_pair([*a, *b], [&tracer(*a), &tracer(*b)], options, Some(memory), contacts);
        };
        if parallel {
            self.memories.par_iter_mut().zip(&mut self.pair_contacts).for_each(detect);
        } else {
            self.memories.iter_mut().zip(&mut self.pair_contacts).for_each(detect);
        }
    }
}

/// Makes `memories` those of `pairs`, both in ascending order: keeps what is known, and forgets pairs that have parted.
fn remember<T: Scalar>(memories: &mut Vec<([u32; 2], PairMemory<T>)>, pairs: &[[u32; 2]]) {
    memories.retain(|(pair, _)| pairs.binary_search(pair).is_ok());
    let known = memories.len();
    for pair in pairs {
        if memories[..known].binary_search_by_key(pair, |(pair, _)| *pair).is_err() {
            memories.push((*pair, PairMemory::default()));
        }
    }
    memories.sort_unstable_by_key(|(pair, _)| *pair);
}
