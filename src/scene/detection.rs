use super::Scene;
use super::autotuner::Way;
use super::bodies::{Bodies, Body};
use super::broad_phase::BroadPhase;
use super::list::{List, PairCost};
use super::own_contacts::OwnContacts;
use super::pairs::{Remembered, by_number};
use crate::contact::{ContactLaw, ContactList, DetectionOptions, Statistics, detect_self, reach_region};
use crate::escape::detect_pair;
use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};
use crate::threads::Helpers;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::Instant;

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// Below this many rays one thread is faster than two, which would have to fetch each other's results.
const FEWEST_RAYS_TO_SHARE: f64 = 1000.0;
/// Reading this many triangles anew takes as long as one ray.
const TRIANGLES_READ_PER_RAY: f64 = 50.0;
/// The same where a body is searched for contacts with itself.
const TRIANGLES_SEARCHED_PER_RAY: f64 = 8.0;

impl<T: Scalar> Scene<T> {
    /// Finds all contacts between different bodies at their present positions, and of those bodies with themselves for
    /// which that is switched on. Replaces what `contacts` held; their order is by pair (the first body in their order, then
    /// the other; a body with itself first of all), then the colliding body, then along its surface.
    ///
    /// A query changes nothing that a later one in the same step could see: with the same positions it finds the same
    /// contacts, however often. What pairs remember goes on with [`advance`](Self::advance).
    ///
    /// Where there is little to do, a thousand rays or so, the calling thread does it alone; a scene with threads of its own
    /// also where that has proved faster, which is tried now and then.
    pub fn query(&mut self, contacts: &mut ContactList<T>) {
        let found = catch_unwind(AssertUnwindSafe(|| self.detect(contacts)));
        if let Err(panic) = found {
            // As if the query had not been. What bodies know of themselves only saves time.
            let owns = self.bodies.iter_mut().filter_map(|body| body.own.as_mut());
            owns.for_each(|own| *own = OwnContacts::default());
            contacts.clear();
            resume_unwind(panic);
        }
    }

    fn detect(&mut self, contacts: &mut ContactList<T>) {
        let stamp = self.newest_stamp();
        let Self { bodies, broad_phase, pairs, .. } = self;
        let (list, ignored) = (bodies.list(), &pairs.ignored);
        broad_phase.update(bodies.iter().map(|body| *body.surface.mesh().aabb()), |pair| {
            let [[first], [second]] = pair.map(|place| &*list[place as usize]);
            let is_ignored = !ignored.is_empty() && ignored.contains(&by_number([first.number, second.number]));
            !is_ignored && first.is_found_with(second)
        });
        let numbers = |pair: &[u32; 2]| pair.map(|place| list[place as usize][0].number);
        pairs.history.start_query(broad_phase.pairs().iter().map(numbers), stamp, |pair| bodies.order(pair));
        bodies.iter_mut().for_each(Body::start_cost);
        self.pair_costs.clear();
        self.order_lists();
        let rays = if self.threads.helpers().are_there() { self.rays_expected() } else { 0.0 };
        if self.threads.helpers().are_there() && rays >= FEWEST_RAYS_TO_SHARE {
            self.detect_as_fast(rays, contacts);
        } else {
            self.detect_alone(contacts);
        }
        self.pairs.history.is_queried = true;
    }

    /// Detects in the way that has proved faster, where the pool is the scene's own; a host that lends its threads has decided.
    fn detect_as_fast(&mut self, rays: f64, contacts: &mut ContactList<T>) {
        let is_free = matches!(self.threads.helpers(), Helpers::Pool);
        let way = if is_free { self.autotuner.way(rays) } else { Way::SideBySide };
        let start = Instant::now();
        match way {
            Way::SideBySide => self.detect_side_by_side(contacts),
            Way::Alone => self.detect_alone(contacts),
        }
        self.autotuner.took(way, rays, start.elapsed());
    }

    /// Decides which lists of contacts there will be, and in which order.
    fn order_lists(&mut self) {
        let lists = &mut self.lists;
        lists.clear();
        let mut next_pair = self.broad_phase.pairs().iter().enumerate().peekable();
        for (first, body) in self.bodies.iter().enumerate() {
            memory::append(lists, body.own.is_some().then_some((List::Body(first), 0)));
            while let Some((place, _)) = next_pair.next_if(|(_, pair)| pair[0] as usize == first) {
                lists.room_for(1).push((List::Pair(place), 0));
            }
        }
    }

    /// The expected cost of the query, in rays.
    fn rays_expected(&self) -> f64 {
        let of_pairs = self.broad_phase.pairs().iter().map(|pair| {
            let [[a], [b]] = pair.map(|place| &*self.bodies.list()[place as usize]);
            a.rays_expected_into(b) + b.rays_expected_into(a)
        });
        let of_bodies = self.bodies.iter().filter(|body| body.own.is_some()).map(Body::triangle_count);
        of_pairs.sum::<f64>() + of_bodies.sum::<f64>() / TRIANGLES_SEARCHED_PER_RAY
    }

    /// Adds each list of contacts to `contacts` as it is found. Bodies are updated only when the first list needs them, so that
    /// in large scenes they are still in the cache then.
    fn detect_alone(&mut self, contacts: &mut ContactList<T>) {
        contacts.clear();
        contacts.workspace.helpers = Helpers::Nobody;
        let Self { bodies, broad_phase, lists, pairs, pair_costs, options, .. } = self;
        let mut next = 0;
        for (list, _) in lists {
            let last = match *list {
                List::Body(place) => place,
                List::Pair(place) => broad_phase.pairs()[place][1] as usize,
            };
            let end = next.max(last + 1);
            Helpers::Nobody.for_each(&mut bodies.list_mut()[next..end], |place, body| {
                let [body] = &mut **body;
                body.update(broad_phase.met_by((next + place) as u32), options);
            });
            next = end;
            let before = all_rays(&contacts.statistics);
            let narrow_phase = NarrowPhase { bodies, broad_phase, options, forbidden: &pairs.without_escape };
            match *list {
                List::Body(place) => contacts.append(narrow_phase.own(place)),
                List::Pair(place) => narrow_phase.detect(&mut pairs.history.after[place], contacts),
            }
            let rays = all_rays(&contacts.statistics) - before;
            bodies.add_cost(list, broad_phase.pairs(), rays, pair_costs);
        }
    }

    /// Lets threads fill a list for each pair, and joins the lists.
    fn detect_side_by_side(&mut self, contacts: &mut ContactList<T>) {
        self.threads.follow_fork();
        let Self { bodies, broad_phase, pair_contacts, pair_costs, lists, pairs, options, threads, .. } = self;
        let count = broad_phase.pairs().len();
        if pair_contacts.len() < count {
            pair_contacts.room_for(count - pair_contacts.len()).resize_with(count, ContactList::default);
        }
        let found = &mut pair_contacts[..count];
        let helpers = threads.helpers();
        threads.run(|| {
            helpers.for_each(bodies.list_mut(), |place, body| {
                let [body] = &mut **body;
                body.update(broad_phase.met_by(place as u32), options);
            });
            let narrow_phase = NarrowPhase { bodies, broad_phase, options, forbidden: &pairs.without_escape };
            let [with_pairs, within_pairs] = helpers.outside_and_within(count);
            with_pairs.for_each_two(&mut pairs.history.after, found, |remembered, found| {
                found.clear();
                found.workspace.helpers = within_pairs.clone();
                narrow_phase.detect(remembered, found);
            });

            if let [(List::Pair(only), _)] = lists[..] {
                contacts.take_from(&mut found[only]);
                return;
            }
            let found = |list: &List| match *list {
                List::Body(place) => narrow_phase.own(place),
                List::Pair(place) => &found[place],
            };
            let mut sum = 0;
            for (list, before) in &mut *lists {
                *before = sum;
                sum += found(list).len();
            }
            contacts.join(helpers, lists.len(), |number| {
                let (list, before) = &lists[number];
                (*before, found(list))
            });
        });
        for (list, _) in lists {
            let statistics = match *list {
                List::Body(place) => bodies.list()[place][0].own.as_ref().map(|own| own.contacts.statistics),
                List::Pair(place) => Some(pair_contacts[place].statistics),
            };
            let rays = statistics.map_or(0, |statistics| all_rays(&statistics));
            bodies.add_cost(list, broad_phase.pairs(), rays, pair_costs);
        }
    }
}

fn all_rays(statistics: &Statistics) -> u64 {
    statistics.rays + statistics.estimate_rays
}

/// Detection between two bodies of a scene.
struct NarrowPhase<'a, T: Scalar> {
    bodies: &'a Bodies<T>,
    broad_phase: &'a BroadPhase<T>,
    options: &'a DetectionOptions<T>,
    /// The pairs that may not escape.
    forbidden: &'a [[u32; 2]],
}

impl<T: Scalar> NarrowPhase<'_, T> {
    /// The contacts of a body with itself.
    fn own(&self, place: usize) -> &ContactList<T> {
        let [body] = &*self.bodies.list()[place];
        &body.own.as_ref().expect("lists name bodies that may collide with themselves").contacts
    }

    /// Adds a pair's contacts.
    fn detect(&self, (pair, memory): &mut Remembered<T>, contacts: &mut ContactList<T>) {
        let bodies = pair.map(|number| self.bodies.get(number).expect("pairs name present bodies"));
        let tracers = bodies.map(|body| body.surface.tracer());
        let may_escape = self.forbidden.binary_search(&by_number(*pair)).is_err();
        let past_folds = self.options.past_folds || bodies.into_iter().any(Body::may_overlap_itself);
        let options = DetectionOptions { past_folds, ..*self.options };
        let places = self.bodies.order(pair);
        let [first, second] =
            [0, 1].map(|side| bodies[side].neighbours.unwrap_or_else(|| self.broad_phase.neighbours(places[side])));
        let (neighbours, tracers) = (first.min(second), tracers.each_ref());
        detect_pair(*pair, tracers, &options, neighbours, Some(memory), may_escape, contacts);
    }
}

impl<T: Scalar> Body<T> {
    fn triangle_count(&self) -> f64 {
        self.surface.mesh().topology().triangles().len() as f64
    }

    /// How many triangles the next query reads anew: none for a body that is where it was, or is moved by a pose.
    fn triangles_read(&self) -> f64 {
        let is_read = self.surface.mesh().pose().is_none() && !self.surface.is_settled();
        if is_read { self.triangle_count() } else { 0.0 }
    }

    /// The expected cost, in rays, of reading the mesh and of casting from it into another: one ray from each vertex in the
    /// overlap of their boxes, if vertices were spread evenly.
    fn rays_expected_into(&self, other: &Self) -> f64 {
        let own = self.surface.mesh().aabb();
        let overlap = own.intersection(other.surface.mesh().aabb());
        let part = |axis: usize| {
            let [whole, part] = [own, &overlap].map(|aabb| (aabb.upper[axis] - aabb.lower[axis]).to_f64());
            if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 1.0 }
        };
        let inside = part(0) * part(1) * part(2);
        inside * self.surface.mesh().topology().surface_vertices().len() as f64
            + self.triangles_read() / TRIANGLES_READ_PER_RAY
    }

    pub(super) fn may_overlap_itself(&self) -> bool {
        self.overlaps_elsewhere || self.own.as_ref().is_some_and(|own| own.may_overlap)
    }

    /// Sets the cost of the query to that of reading the body.
    fn start_cost(&mut self) {
        let is_read = self.surface.mesh().pose().is_none();
        self.cost = if is_read { self.triangle_count() / TRIANGLES_READ_PER_RAY } else { 0.0 };
    }

    /// Finds the body's contacts with itself, where they are asked for and not known yet; gives whether the octree was updated
    /// for that.
    pub(super) fn find_own_contacts(&mut self, options: &DetectionOptions<T>) -> bool {
        let Self { number, surface, own, .. } = self;
        let Some(own) = own else { return false };
        let stamp = surface.mesh().stamp();
        if own.found_at == stamp {
            return false;
        }
        own.contacts.clear();
        own.may_overlap = false;
        if own.memory.is_clear(surface.mesh(), surface.octree()) {
            own.found_at = stamp;
            return false;
        }
        surface.refit();
        let (tracer, octree) = (surface.tracer(), surface.octree());
        own.may_overlap = detect_self(*number, tracer, octree, options, Some(&mut own.memory), &mut own.contacts);
        own.found_at = stamp;
        true
    }

    /// Finds the body's contacts with itself, where they are asked for, and updates the octree where bodies in `others` need it.
    fn update<'a>(&mut self, others: impl Iterator<Item = &'a Aabb<T>>, options: &DetectionOptions<T>) {
        if self.find_own_contacts(options) {
            return;
        }
        let Self { surface, regions, .. } = self;
        // Only bodies that meet another one need their octree.
        memory::refill(regions, others.map(|other| reach_region(surface.mesh().aabb(), other, options.law)));
        if !regions.is_empty() {
            let for_distances = options.law == ContactLaw::Pressure;
            let ray_count = options.expected_rays(regions);
            surface.refit_in(regions, ray_count, for_distances);
        }
    }
}

impl<T: Scalar> Bodies<T> {
    /// Adds the cost of a list of contacts to its bodies, and to the costs of pairs.
    fn add_cost(&mut self, list: &List, pairs: &[[u32; 2]], rays: u64, costs: &mut Vec<PairCost>) {
        let rays = rays as f64;
        match *list {
            List::Body(place) => self.list_mut()[place][0].cost += rays,
            List::Pair(place) => {
                let both = self.two_mut(pairs[place].map(|place| place as usize));
                // A foreign body's own scene does not learn of it.
                let share = if both.iter().any(|body| body.is_foreign) { rays } else { rays * 0.5 };
                costs.room_for(1).push(PairCost { bodies: both.each_ref().map(|body| body.number), cost: rays });
                both.into_iter().for_each(|body| body.cost += share);
            }
        }
    }
}
