use super::workspace::Workspace;
use crate::math::{Scalar, Vector3};

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

/// A point of one surface inside another body, and the point of that body's surface to which it is pulled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T: Scalar> {
    /// The body the ray starts from.
    pub colliding: u32,
    /// The body the ray ends on.
    pub collided: u32,
    /// The ray's origin, on the colliding body.
    pub p1: SurfacePoint<T>,
    /// The ray's end, on the collided body.
    pub p2: SurfacePoint<T>,
    /// The ray's direction, from p1 to p2: the inward normal at p1, of unit length.
    pub direction: Vector3<T>,
    /// The distance from p1 to p2, ≥ 0.
    pub depth: T,
    /// Cosine of the angle between the ray and the outward normal at p2, in \[0, 1\].
    pub cos_alpha: T,
    /// The surface area the contact stands for: that of the ray's share of the surface, times the share of the load that
    /// the rays of this direction carry; the two directions' shares sum to 1.
    pub area: T,
}

/// What a query did. Every ray is either a contact or counted under the one reason why it is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Pairs of meshes whose boxes overlap.
    pub pairs: u64,
    /// Rays traced, from the surface points inside an overlap box.
    pub rays: u64,
    /// Rays that left the overlap box without meeting the other mesh.
    pub misses: u64,
    /// Rays whose first hit enters the other mesh: they start outside it.
    pub entry_hits: u64,
    /// Rays that leave their own mesh before the other.
    pub own_surface_hits: u64,
    /// Vertices or triangles inside an overlap box that cast no ray: their normal has no length.
    pub without_normal: u64,
}

/// The contacts of one query, in a fixed order: by pair, then the colliding body, then along its surface.
///
/// Two lists are equal where their contacts and statistics are.
#[derive(Clone, Debug, Default)]
pub struct ContactList<T: Scalar> {
    /// The contacts.
    pub contacts: Vec<Contact<T>>,
    /// How they were found.
    pub statistics: Statistics,
    pub(super) workspace: Workspace<T>,
}

impl<T: Scalar> PartialEq for ContactList<T> {
    fn eq(&self, other: &Self) -> bool {
        self.contacts == other.contacts && self.statistics == other.statistics
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

    /// Forgets everything but the memory.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.statistics = Statistics::default();
    }

    /// Adds the contacts and counts of `other` after its own.
    pub fn append(&mut self, other: &Self) {
        self.contacts.extend_from_slice(&other.contacts);
        let (sum, more) = (&mut self.statistics, &other.statistics);
        sum.pairs += more.pairs;
        sum.rays += more.rays;
        sum.misses += more.misses;
        sum.entry_hits += more.entry_hits;
        sum.own_surface_hits += more.own_surface_hits;
        sum.without_normal += more.without_normal;
    }
}
