//! Exact distances from a point to triangles, as fractions of whole numbers.

use super::exact::Dyadic;

type Exact = [Dyadic; 3];

/// A squared distance: numerator / denominator, the latter above zero.
#[derive(Clone, Debug)]
pub struct Square {
    numerator: Dyadic,
    denominator: Dyadic,
}

impl Square {
    fn whole(numerator: Dyadic) -> Self {
        Self { numerator, denominator: Dyadic::from(1.0) }
    }

    fn is_above(&self, other: &Self) -> bool {
        (&self.numerator * &other.denominator).is_above(&(&other.numerator * &self.denominator))
    }

    /// Whether the root differs from a distance ≥ 0 by no more than an error.
    pub fn is_root_within(&self, distance: f64, error: &Error) -> bool {
        let (distance, zero) = (Dyadic::from(distance), Dyadic::from(0.0));
        let square = |length: &Dyadic| Self::whole(length.squared());
        let least = &distance - &error.0;
        let is_far_enough = !least.is_above(&zero) || !square(&least).is_above(self);
        is_far_enough && !self.is_above(&square(&(&distance + &error.0)))
    }
}

/// So many rounding units of a reach: the product may have more digits than a number has.
pub struct Error(Dyadic);

impl Error {
    pub fn new(units: f64, unit: f64, reach: f64) -> Self {
        Self(&Dyadic::from(units * unit) * &Dyadic::from(reach))
    }

    pub fn is_below(&self, distance: &Dyadic) -> bool {
        distance.is_above(&self.0)
    }
}

fn dot(a: &Exact, b: &Exact) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

fn sub(a: &Exact, b: &Exact) -> Exact {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    let part = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [part(1, 2), part(2, 0), part(0, 1)]
}

fn exact(point: &[f64; 3]) -> Exact {
    point.map(Dyadic::from)
}

/// The squared distance from a point to a triangle.
pub fn to_triangle(point: &[f64; 3], corners: [&[f64; 3]; 3]) -> Square {
    let zero = Dyadic::from(0.0);
    let point = exact(point);
    let [a, b, c] = corners.map(|corner| sub(&exact(corner), &point));
    let mut least = Square::whole(dot(&a, &a));
    let mut keep = |square: Square| {
        if least.is_above(&square) {
            least = square;
        }
    };
    for (from, to) in [(&a, &b), (&b, &c), (&c, &a)] {
        keep(Square::whole(dot(from, from)));
        let edge = sub(to, from);
        let (length, along) = (dot(&edge, &edge), &zero - &dot(from, &edge));
        if along.is_above(&zero) && length.is_above(&along) {
            let across = cross(from, &edge);
            keep(Square { numerator: dot(&across, &across), denominator: length });
        }
    }
    let normal = cross(&sub(&b, &a), &sub(&c, &a));
    // The foot of the perpendicular lies on the inner side of all three edges.
    let is_inside = [(&b, &c), (&c, &a), (&a, &b)].iter().all(|(p, q)| dot(&cross(p, q), &normal).is_above(&zero));
    if is_inside {
        let height = dot(&normal, &a);
        keep(Square { numerator: height.squared(), denominator: dot(&normal, &normal) });
    }
    least
}

/// The nearer of two.
pub fn least(a: Square, b: Square) -> Square {
    if a.is_above(&b) { b } else { a }
}

/// The squared distance from a point to the weighted mean of corners.
pub fn to_weighted(point: &[f64; 3], corners: [&[f64; 3]; 3], weights: [f64; 3]) -> Square {
    let offset = offset(point, corners, weights);
    Square::whole(dot(&offset, &offset))
}

/// Whether `position` is the weighted mean of corners to within an error, axis by axis.
pub fn is_weighted(position: &[f64; 3], corners: [&[f64; 3]; 3], weights: [f64; 3], error: &Error) -> bool {
    let zero = Dyadic::from(0.0);
    offset(position, corners, weights).iter().all(|x| !error.is_below(x) && !error.is_below(&(&zero - x)))
}

/// From a point to the weighted mean of corners; weights sum to 1 but for rounding.
fn offset(point: &[f64; 3], corners: [&[f64; 3]; 3], weights: [f64; 3]) -> Exact {
    let point = exact(point);
    let mut offset = [0.0; 3].map(Dyadic::from);
    for (corner, weight) in corners.iter().zip(weights) {
        let (reach, weight) = (sub(&exact(corner), &point), Dyadic::from(weight));
        offset = std::array::from_fn(|axis| &offset[axis] + &(&reach[axis] * &weight));
    }
    offset
}
