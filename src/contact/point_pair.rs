use crate::math::{Scalar, Vector3};
use std::num::NonZeroU32;

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
    pub(crate) fn touched(&self) -> [u32; 3] {
        touched_of(self.vertices, self.weights)
    }
}

/// The vertices of a triangle that have a weight; each that has none is replaced by one that has.
pub(crate) fn touched_of<T: Scalar>(vertices: [u32; 3], weights: [T; 3]) -> [u32; 3] {
    let one = (0..3).find(|&k| weights[k] != T::zero()).unwrap_or(0);
    [0, 1, 2].map(|k| vertices[if weights[k] != T::zero() { k } else { one }])
}

/// Which of its list's spreads a contact has, counted from 1; by default it has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpreadNumber(pub(crate) Option<NonZeroU32>);

impl SpreadNumber {
    /// The same behind so many others.
    pub(crate) fn after(self, before: usize) -> Self {
        Self(self.0.and_then(|number| number.checked_add(before as u32)))
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
    /// Which part of its triangle the ray stands for: 1 is the whole triangle, and the halves of piece n are 2 n and 2 n + 1.
    /// 2³¹ or more where the ray stands for a patch of triangles. 0 for a ray from a vertex. For a contact of an edge it is 3 n
    /// + k: the edge lies across from corner k, and the contact is on its n-th stretch inside the other body, counted from 0.
    pub piece: u32,
    /// The ray's origin, on the colliding body.
    pub p1: SurfacePoint<T>,
    /// The ray's end, on the collided body.
    pub p2: SurfacePoint<T>,
    /// The ray's direction, from p1 to p2: the inward normal at p1, of unit length.
    pub direction: Vector3<T>,
    /// The distance from p1 to p2, ≥ 0.
    pub depth: T,
    /// The factor of the depth in the pressure, in \[0, 1\]. Under
    /// [`ContactLaw::Pressure`](crate::contact::options::ContactLaw) the distance from p1 to the nearest point of the collided
    /// body over the depth, which beside a flat face is the cosine of the angle between the ray and the outward normal at p2;
    /// under [`ContactLaw::RayLength`](crate::contact::options::ContactLaw) that cosine.
    pub cos_alpha: T,
    /// The surface area that the ray stands for, times the share of the load that the rays of this direction carry. The two
    /// directions' shares sum to 1.
    pub area: T,
    /// Over which vertices its load is spread, in the list that it belongs to.
    pub spread: SpreadNumber,
}

impl<T: Scalar> Contact<T> {
    /// Its bodies' numbers, the smaller one first.
    pub(crate) fn bodies(&self) -> [u32; 2] {
        [self.colliding.min(self.collided), self.colliding.max(self.collided)]
    }

    /// A number for the surface point that casts and the body that it meets: the same from step to step while the triangle is
    /// cut in the same way, and another for every other contact. It is a hash of 64 bits: two contacts of a query with 100 000
    /// have the same with a probability of 3 · 10⁻¹⁰.
    pub fn id(&self) -> u64 {
        let SurfacePoint { triangle, vertices, .. } = self.p1;
        let words = [[self.kind as u32, self.piece], [self.colliding, self.collided], [triangle, vertices[0]]];
        words.into_iter().fold(0, |id, [high, low]| mixed(id ^ (u64::from(high) << 32 | u64::from(low))))
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014) after a step of its sequence: each bit of the result depends
/// on all of the number's.
fn mixed(number: u64) -> u64 {
    let mut mixed = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ mixed >> 31
}
