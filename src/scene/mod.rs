//! Many meshes at once: which boxes overlap (broad phase), then their contacts, pairs in parallel (narrow phase).

mod autotuner;
mod bodies;
mod broad_phase;
mod detection;
mod differential;
mod error;
pub(crate) mod hooks;
mod list;
mod own_contacts;
mod pairs;
mod posed;
mod potential;
mod saved;

pub use crate::bytes::BytesError;
pub use error::SceneError;
pub use list::PairCost;

use crate::contact::{ContactList, DetectionOptions};
use crate::escape::PairMemory;
use crate::math::Scalar;
use crate::memory::Room;
use crate::mesh::{Carrier, Mesh};
use crate::threads::{ParallelFor, Threads};
use bodies::{Bodies, Body};
use broad_phase::BroadPhase;
use list::List;
use own_contacts::OwnContacts;
use pairs::{Pairs, by_number};
use std::sync::{Arc, Weak};

/// Bodies, and what is needed to find all contacts among them.
///
/// The contacts and their order do not depend on the number of threads. A call for a body that the scene does not have gives
/// [`SceneError::UnknownBody`], and one for a pair of a body and itself [`SceneError::SameBody`].
#[derive(Debug, Default)]
pub struct Scene<T: Scalar> {
    bodies: Bodies<T>,
    broad_phase: BroadPhase<T>,
    /// The contacts of each overlapping pair, where threads find them side by side; kept so that a steady step allocates
    /// nothing.
    pair_contacts: Vec<ContactList<T>>,
    /// The cost of the newest query for each pair.
    pair_costs: Vec<PairCost>,
    /// All lists of the last query in the order of their contacts, and how many contacts are in the lists before each.
    lists: Vec<(List, usize)>,
    /// What is remembered of pairs from step to step.
    pairs: Pairs<T>,
    options: DetectionOptions<T>,
    threads: Threads,
    autotuner: autotuner::Autotuner,
}

impl<T: Scalar> Scene<T> {
    /// An empty scene with default options. `threads`: 1 works on the caller's own thread, n on a pool of n threads that the
    /// scene owns and that have ended when it is dropped, 0 on a pool of one thread for each core. In a process forked
    /// since, where the pool's threads are not, it starts them anew with the first query that needs them.
    ///
    /// # Errors
    /// [`SceneError::ThreadsNotStarted`].
    pub fn new(threads: usize) -> Result<Self, SceneError> {
        let started = Threads::new(threads);
        let threads = started.map_err(|source| SceneError::ThreadsNotStarted { threads, source })?;
        Ok(Self { threads, ..Self::default() })
    }

    /// An empty scene with default options that works on the host's threads.
    pub fn with_host_threads(host: Arc<dyn ParallelFor>) -> Self {
        Self { threads: Threads::of_host(host), ..Self::default() }
    }

    /// The host's threads, if it lends them, for what follows a query.
    pub(crate) fn lent_threads(&self) -> Option<Weak<dyn ParallelFor>> {
        self.threads.helpers().lent()
    }

    /// Works with these threads from here on, and puts its former ones in their place.
    pub(crate) fn exchange_threads(&mut self, threads: &mut Threads) {
        std::mem::swap(&mut self.threads, threads);
    }

    /// Sets how contacts are found from the next query on.
    pub fn set_options(&mut self, options: DetectionOptions<T>) {
        self.options = options;
        self.bodies.iter_mut().filter_map(|body| body.own.as_mut()).for_each(|own| own.found_at = 0);
    }

    /// Adds a body; gives its number, which no body of the scene ever had: the n-th gets n − 1. Only
    /// [`release_body_numbers`](Self::release_body_numbers) lets numbers of removed bodies come back.
    ///
    /// The number is also the body's key, by which all that has an order goes: see
    /// [`add_with_key`](Self::add_with_key).
    ///
    /// # Panics
    /// Where 2³² − 1 numbers were given.
    pub fn add(&mut self, mesh: Mesh<T>) -> u32 {
        self.bodies.add(mesh, None)
    }

    /// The same with a key of the host's. Pairs, contacts and sums come in the order of the bodies' keys, and of equal ones
    /// by number; the first body of a pair is the first in this order. So scenes whose bodies have the same keys find the
    /// same contacts in the same order, whatever the numbers, which depend on who was there before.
    ///
    /// # Errors
    /// [`SceneError::KeyTaken`].
    pub fn add_with_key(&mut self, mesh: Mesh<T>, key: u64) -> Result<u32, SceneError> {
        if self.bodies.has_key(key) {
            return Err(SceneError::KeyTaken { key });
        }
        Ok(self.bodies.add(mesh, Some(key)))
    }

    /// Removes a body. Its number is refused from here on ([`SceneError::UnknownBody`]), and no other body gets it before
    /// [`release_body_numbers`](Self::release_body_numbers).
    pub fn remove(&mut self, body: u32) -> Result<Mesh<T>, SceneError> {
        self.pairs.forget(body);
        let removed = self.bodies.remove(body).ok_or(SceneError::UnknownBody { body })?;
        let mut mesh = removed.surface.into_mesh();
        mesh.settle();
        Ok(mesh)
    }

    /// Lets the numbers of bodies removed so far be given to new bodies, the smallest first. For a host whose bodies come and
    /// go without end: arrays indexed by number stay as short as the most bodies that were there at once. Call it when
    /// nothing uses a removed body's number any more, neither contacts nor saved memories nor a contact system; whatever
    /// still does would reach another body. Takes time in proportion to the numbers given since the last call.
    pub fn release_body_numbers(&mut self) {
        self.bodies.release_numbers();
    }

    /// A body's mesh.
    pub fn mesh(&self, body: u32) -> Result<&Mesh<T>, SceneError> {
        self.bodies.get(body).map(|body| body.surface.mesh()).ok_or(SceneError::UnknownBody { body })
    }

    /// The numbers of its bodies, in the bodies' order: ascending, where none has a key of the host's.
    pub fn body_numbers(&self) -> impl Iterator<Item = u32> {
        self.bodies.iter().map(|body| body.number)
    }

    /// A body's mesh, to renew its positions.
    pub fn mesh_mut(&mut self, body: u32) -> Result<&mut Mesh<T>, SceneError> {
        self.bodies.get_mut(body).map(|body| body.surface.mesh_mut()).ok_or(SceneError::UnknownBody { body })
    }

    /// Tells a body what moves it, unless the host has said so.
    pub(crate) fn carry_by(&mut self, body: u32, carrier: Carrier<T>) {
        self.bodies.get_mut(body).into_iter().for_each(|body| body.surface.mesh_mut().carry_by(carrier));
    }

    /// Lets two bodies escape from one another, as they may by default, or forbids it: a press fit, a body meant to stay
    /// inside another. An escape that is under way ends. It holds until it is set otherwise or one of the bodies is removed;
    /// it is no part of what [`save_pair_memories`](Self::save_pair_memories) saves.
    pub fn allow_escape(&mut self, a: u32, b: u32, allowed: bool) -> Result<(), SceneError> {
        let pair = self.known_pair(a, b)?;
        self.pairs.allow_escape(pair, allowed);
        Ok(())
    }

    /// Whether two bodies may escape from one another.
    pub fn may_escape(&self, a: u32, b: u32) -> Result<bool, SceneError> {
        let pair = self.known_pair(a, b)?;
        Ok(self.pairs.without_escape.binary_search(&pair).is_err())
    }

    /// Ends a step of this many seconds: what the step's last query found goes into what pairs remember, by which they escape
    /// where contacts cannot part them. Once a step, after the last query of it; a host that queries several times a step, to
    /// look ahead or to detect anew, thus escapes no sooner.
    ///
    /// The rules count steps; those shorter than 1/60 s count as the part of it that they are. From the first call on, this
    /// alone ends a step: a host that queries several times in its first step calls it before, with 0. A scene for which it is
    /// never called ends a step, of 1/60 s or more, at each query before which any body was given positions since the last.
    ///
    /// # Errors
    /// [`SceneError::StepLength`] where `seconds` is negative or not finite.
    pub fn advance(&mut self, seconds: f64) -> Result<(), SceneError> {
        if !(seconds.is_finite() && seconds >= 0.0) {
            return Err(SceneError::StepLength { seconds });
        }
        self.pairs.history.advance(seconds, |pair| self.bodies.order(pair));
        Ok(())
    }

    /// Makes the newest query count for nothing: pairs remember what they did when the last step ended.
    pub(crate) fn disregard_query(&mut self) {
        self.pairs.history.is_queried = false;
    }

    /// What each pair whose boxes overlapped in the last query remembers since, in the order of the pairs.
    pub fn pair_memories(&self) -> &[([u32; 2], PairMemory<T>)] {
        self.pairs.history.newest()
    }

    /// Replaces what one pair remembers, as [`pair_memories`](Self::pair_memories) of this scene or another gave it; the
    /// pair's bodies in their order. It counts from the next query on at which their boxes overlap, and is forgotten by one
    /// at which they do not.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::SameBody`], [`SceneError::PairMemory`] where it is nothing that a pair can
    /// remember or the bodies are the other way round; the memories are then as before.
    pub fn set_pair_memory(&mut self, pair: [u32; 2], memory: PairMemory<T>) -> Result<(), SceneError> {
        self.known_pair(pair[0], pair[1])?;
        let [first, second] = self.bodies.order(&pair);
        if first > second || !memory.is_possible() {
            return Err(SceneError::PairMemory { pair });
        }
        self.pairs.history.set(pair, memory, |pair| self.bodies.order(pair));
        Ok(())
    }

    /// How many bytes [`save_pair_memories`](Self::save_pair_memories) appends now.
    pub fn saved_length(&self) -> usize {
        saved::saved_length(&self.pairs.history)
    }

    /// Appends to `bytes` what the pairs remember. A scene with the same bodies, positions and settings that restores it
    /// goes on as this one does, to the bit.
    pub fn save_pair_memories(&self, bytes: &mut Vec<u8>) {
        saved::save(&self.pairs.history, self.newest_stamp(), bytes);
    }

    /// Replaces what the pairs remember by what was saved. No bytes at all are not the same as saved bytes of no pair.
    ///
    /// # Errors
    /// [`SceneError::SavedState`], and [`SceneError::UnknownBody`] where a body of a saved pair is not in the scene; the
    /// memories are then as before.
    pub fn restore_pair_memories(&mut self, bytes: &[u8]) -> Result<(), SceneError> {
        let history = saved::restore(bytes, self.newest_stamp())?;
        let key = |number: u32| self.bodies.get(number).map_or(u64::from(number), |body| body.key);
        if !history.is_in_order(|pair| pair.map(|number| (key(number), number))) {
            return Err(BytesError::Damaged.into());
        }
        let mut memories = history.before.iter().chain(&history.after);
        memories.try_for_each(|([a, b], _)| self.known_pair(*a, *b).map(drop))?;
        self.pairs.history = history;
        Ok(())
    }

    /// Switches contacts between two bodies off or on again from the next query on: collision groups, parts of one machine.
    /// On for new bodies. While it is off, the pair is not looked at, and what it remembered is forgotten.
    pub fn set_pair_collision(&mut self, a: u32, b: u32, is_on: bool) -> Result<(), SceneError> {
        let pair = self.known_pair(a, b)?;
        if is_on {
            self.pairs.ignored.remove(&pair);
        } else {
            self.pairs.ignored.room_for(1).insert(pair);
        }
        Ok(())
    }

    /// The stamp of the newest positions of any body; any new positions change it.
    fn newest_stamp(&self) -> u64 {
        self.bodies.iter().map(|body| body.surface.mesh().stamp().max(body.given)).max().unwrap_or_default()
    }

    /// The pair by number.
    fn known_pair(&self, a: u32, b: u32) -> Result<[u32; 2], SceneError> {
        self.mesh(a).and(self.mesh(b))?;
        if a == b { Err(SceneError::SameBody { body: a }) } else { Ok(by_number([a, b])) }
    }

    /// Switches contacts of a body with itself on or off from the next query on; off for a new body. Where it is on,
    /// contacts with other bodies are also found past the body's own folds ([`DetectionOptions::past_folds`]).
    pub fn set_self_collision(&mut self, body: u32, is_on: bool) -> Result<(), SceneError> {
        let Body { own, surface, .. } = self.bodies.get_mut(body).ok_or(SceneError::UnknownBody { body })?;
        match (is_on, own.is_some()) {
            (true, false) => {
                *own = Some(OwnContacts::default());
                surface.mesh_mut().settle();
            }
            (false, _) => *own = None,
            (true, true) => {}
        }
        Ok(())
    }

    /// Finds the contacts of bodies with themselves where they are asked for. The next query at the same positions does not find
    /// them again.
    pub fn find_self_contacts(&mut self) {
        let Self { bodies, options, .. } = self;
        for body in bodies.iter_mut() {
            body.find_own_contacts(options);
        }
    }

    /// Whether a body may overlap itself, as the newest query or [`find_self_contacts`](Self::find_self_contacts) found;
    /// never one whose self-collision is off.
    pub fn overlaps_itself(&self, body: u32) -> Result<bool, SceneError> {
        self.bodies.get(body).map(Body::may_overlap_itself).ok_or(SceneError::UnknownBody { body })
    }

    /// What the newest query took for a body, in rays: those of its contacts with itself, half of those of its pairs, and all of
    /// those of its pairs with [foreign](Self::is_foreign) bodies. Fifty triangles that are read count as a ray.
    pub fn body_cost(&self, body: u32) -> Result<f64, SceneError> {
        self.bodies.get(body).map(|body| body.cost).ok_or(SceneError::UnknownBody { body })
    }

    /// What the newest query took for each pair whose boxes overlapped, in the order of the pairs; none before the first.
    pub fn pair_costs(&self) -> &[PairCost] {
        &self.pair_costs
    }
}
