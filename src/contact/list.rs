use super::EscapePush;
use super::workspace::Workspace;
use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::ray::{Hit, Ray};
use crate::threads::Helpers;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// A point on a mesh's surface. It moves with its triangle: its position is the weighted sum of the three vertices'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<T: Scalar> {
    /// The triangle it lies on.
    pub triangle: u32,
    /// The triangle's corners. Where the point is a vertex, that vertex comes first.
    pub vertices: [u32; 3],
    /// Barycentric weights at `vertices`; they sum to 1. A vertex has 1, 0, 0.
    pub weights: [T; 3],
    /// Where it was at detection.
    pub position: Vector3<T>,
}

impl<T: Scalar> SurfacePoint<T> {
    /// The vertices that all triangles touching the point have in common: those with a weight.
    pub(super) fn touched(&self) -> [u32; 3] {
        let [first, second, third] = self.vertices;
        let [_, b, c] = self.weights.map(|weight| weight != T::zero());
        [first, if b { second } else { first }, if c { third } else { first }]
    }

    pub(super) fn of_hit(mesh: &Mesh<T>, ray: &Ray<T>, hit: &Hit<T>) -> Self {
        Self {
            triangle: hit.triangle,
            vertices: mesh.topology().triangles()[hit.triangle as usize],
            weights: hit.weights,
            position: ray.origin + ray.direction * hit.t,
        }
    }
}

/// How a contact came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactKind {
    /// A ray along the inward normal leaves the other body before its own: the paper's contact.
    Ray,
    /// The same from the middle of an edge that pierces the other body, where no point of either surface does.
    Edge,
    /// The pair is escaping: `direction` is the pair's, `depth` is that of its deepest point, `cos_alpha` is 1.
    Escape,
}

/// A point of one surface inside another body, and the point of that body's surface to which it is pulled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T: Scalar> {
    /// How it came about.
    pub kind: ContactKind,
    /// The body the ray starts from.
    pub colliding: u32,
    /// The body the ray ends on; the same for a contact of a body with itself.
    pub collided: u32,
    /// The ray's origin, on the colliding body.
    pub p1: SurfacePoint<T>,
    /// The ray's end, on the collided body.
    pub p2: SurfacePoint<T>,
    /// The ray's direction, from p1 to p2: the inward normal at p1, of unit length.
    pub direction: Vector3<T>,
    /// The distance from p1 to p2, ≥ 0.
    pub depth: T,
    /// What the depth is multiplied with in the pressure, in \[0, 1\]. Under [`ContactLaw::Pressure`](super::ContactLaw) the
    /// distance from p1 to the nearest point of the collided body over the depth, which beside a flat face is the cosine of
    /// the angle between the ray and the outward normal at p2; under [`ContactLaw::RayLength`](super::ContactLaw) that cosine.
    pub cos_alpha: T,
    /// The surface area the contact stands for: that of the ray's share of the surface, times the share of the load that
    /// the rays of this direction carry; the two directions' shares sum to 1.
    pub area: T,
}

/// What a query did. Every ray is either a contact or counted under the one reason why it is none: `rays` is the number of
/// contacts + `misses` + `entry_hits` + `own_surface_hits` + `replaced`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Pairs of meshes whose boxes overlap.
    pub pairs: u64,
    /// Of these, pairs with an open mesh: no edges are traced for them and they do not escape; two open meshes do not even
    /// cast rays.
    pub open_pairs: u64,
    /// Rays traced, from the surface points inside an overlap box.
    pub rays: u64,
    /// Of these, rays that stand for a patch of several triangles.
    pub patches: u64,
    /// Rays beside those, traced only to find out how fine the sampling has to be ([`Sampling::Tolerance`]), or whether
    /// and which way a pair is to escape.
    ///
    /// [`Sampling::Tolerance`]: super::Sampling::Tolerance
    pub estimate_rays: u64,
    /// Rays that left the overlap box without meeting the other mesh, or along an escape its box; for a body with itself,
    /// rays from points that lie inside no other part of it.
    pub misses: u64,
    /// Rays whose first hit enters the other mesh: they start outside it.
    pub entry_hits: u64,
    /// Rays that leave their own mesh before the other, though they start inside it; for a body with itself, rays that
    /// leave through the far side of their own fold.
    pub own_surface_hits: u64,
    /// Contacts found and replaced by those of an escape that began in the same query.
    pub replaced: u64,
    /// Vertices or triangles inside an overlap box that cast no ray: their normal has no length.
    pub without_normal: u64,
    /// Pieces of triangles left larger than the spacing asks, because their surface had been cut as often as it may.
    pub uncut_pieces: u64,
    /// Contacts of edges, where no ray from a surface point found any.
    pub edge_contacts: u64,
    /// Contacts of bodies with themselves.
    pub self_contacts: u64,
    /// Bodies whose contacts with themselves were asked for, but that are open and have none.
    pub open_bodies: u64,
    /// How often a ray went past another fold of its own body or of the other ([`DetectionOptions::past_folds`]).
    ///
    /// [`DetectionOptions::past_folds`]: super::DetectionOptions::past_folds
    pub past_folds: u64,
    /// Pairs that began to escape in this query.
    pub escapes_started: u64,
    /// Pairs that are escaping, those included.
    pub escaping_pairs: u64,
    /// Contacts of escaping pairs.
    pub escape_contacts: u64,
    /// Pairs whose escape was held fast by others and has turned to the line of centres, from the next query on.
    pub escapes_turned: u64,
    /// Pairs that contacts cannot part and that would have begun to escape, had it not been forbidden to them.
    pub escapes_forbidden: u64,
    /// Bodies whose contacts with themselves were asked for, but that are tangled and have none: of 512 triangles or more,
    /// which touch about 24 others or more each on average, or about 6 among 96 or more whose boxes overlap theirs, so that no
    /// inside is left to tell; or with more than 64 pairs of near parts, of up to 16 triangles, for each triangle.
    pub tangled_bodies: u64,
    /// Pairs of a crowd, whose triangles are cut into fewer pieces ([`Sampling::Automatic`](super::Sampling::Automatic)).
    pub crowded_pairs: u64,
}

impl std::ops::AddAssign for Statistics {
    fn add_assign(&mut self, more: Self) {
        self.pairs += more.pairs;
        self.open_pairs += more.open_pairs;
        self.rays += more.rays;
        self.patches += more.patches;
        self.estimate_rays += more.estimate_rays;
        self.misses += more.misses;
        self.entry_hits += more.entry_hits;
        self.own_surface_hits += more.own_surface_hits;
        self.replaced += more.replaced;
        self.without_normal += more.without_normal;
        self.uncut_pieces += more.uncut_pieces;
        self.edge_contacts += more.edge_contacts;
        self.self_contacts += more.self_contacts;
        self.open_bodies += more.open_bodies;
        self.past_folds += more.past_folds;
        self.escapes_started += more.escapes_started;
        self.escaping_pairs += more.escaping_pairs;
        self.escape_contacts += more.escape_contacts;
        self.escapes_turned += more.escapes_turned;
        self.escapes_forbidden += more.escapes_forbidden;
        self.tangled_bodies += more.tangled_bodies;
        self.crowded_pairs += more.crowded_pairs;
    }
}

/// The contacts of one query, in a fixed order: by pair, then the colliding body, then along its surface.
///
/// Two lists are equal where their contacts, pushes and statistics are.
#[derive(Clone, Debug, Default)]
pub struct ContactList<T: Scalar> {
    /// The contacts.
    pub contacts: Vec<Contact<T>>,
    /// How they were found.
    pub statistics: Statistics,
    pub(super) pushes: Vec<EscapePush<T>>,
    pub(super) workspace: Workspace<T>,
}

impl<T: Scalar> PartialEq for ContactList<T> {
    fn eq(&self, other: &Self) -> bool {
        self.contacts == other.contacts && self.statistics == other.statistics && self.pushes == other.pushes
    }
}

impl<T: Scalar> ContactList<T> {
    /// How many contacts there are.
    pub fn len(&self) -> usize {
        self.contacts.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Says who helps with the next query for a pair.
    pub(crate) fn set_helpers(&mut self, helpers: Helpers) {
        self.workspace.helpers = helpers;
    }

    /// Forgets everything but the memory.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.pushes.clear();
        self.statistics = Statistics::default();
    }

    /// Fills the list anew; where memory ends on the way it is empty.
    pub(super) fn refill<R>(&mut self, fill: impl FnOnce(&mut Self) -> R) -> R {
        self.clear();
        catch_unwind(AssertUnwindSafe(|| fill(self))).unwrap_or_else(|panic| {
            self.clear();
            resume_unwind(panic)
        })
    }

    /// Replaces what it holds by `count` other lists. `list` gives how many contacts are in all lists before, and the list.
    pub(crate) fn join<'a>(&mut self, helpers: &Helpers, count: usize, list: impl Fn(usize) -> (usize, &'a Self) + Sync)
    where
        T: 'a,
    {
        self.clear();
        let contacts_of = |number| {
            let (before, list) = list(number);
            (before, list.contacts.as_slice())
        };
        helpers.append(&mut self.contacts, count, contacts_of, |_, contact| *contact);
        for number in 0..count {
            let (_, other) = list(number);
            memory::append(&mut self.pushes, other.pushes.iter().copied());
            self.statistics += other.statistics;
        }
    }

    /// Takes over what another list holds, which is then to be cleared.
    pub(crate) fn take_from(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.contacts, &mut other.contacts);
        std::mem::swap(&mut self.pushes, &mut other.pushes);
        self.statistics = other.statistics;
    }

    /// Adds the contacts and counts of `other` after its own.
    pub fn append(&mut self, other: &Self) {
        self.contacts.room_for(other.contacts.len()).extend_from_slice(&other.contacts);
        self.pushes.room_for(other.pushes.len()).extend_from_slice(&other.pushes);
        self.statistics += other.statistics;
    }
}
