use crate::math::{Scalar, Vector3};
use crate::triangle::closest_point::ClosestPoint;
use crate::triangle::query_point::QueryPoint;

/// The places of a triangle's corners in ascending order of their vertices.
pub(crate) fn ascending(vertices: [u32; 3]) -> [usize; 3] {
    let mut places = [0, 1, 2];
    places.sort_unstable_by_key(|&place| vertices[place]);
    places
}

/// The point of one triangle that is nearest to a query point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglePoint<T: Scalar> {
    /// Its squared distance, in the query point's scale.
    pub(crate) square: T,
    /// Its weights at the corners, in ascending order of their vertices.
    weights: [T; 3],
}

/// The nearest point of an edge: where along it, and its squared distance.
struct EdgePoint<T> {
    along: T,
    square: T,
}

impl<T: Scalar> TrianglePoint<T> {
    /// Of the triangle with these corners, in ascending order of their vertices.
    pub(crate) fn new(query: &QueryPoint<T>, corners: &[Vector3<T>; 3]) -> Self {
        let (zero, one) = (T::zero(), T::one());
        let [at_a, at_b, at_c] = corners.map(|corner| corner * query.factor);
        let [a, b, c] = [at_a - query.position, at_b - query.position, at_c - query.position];
        let (ab, ac, bc) = (at_b - at_a, at_c - at_a, at_c - at_b);
        let (inverse_ab, inverse_ac, inverse_bc) = (one / ab.dot(&ab), one / ac.dot(&ac), one / bc.dot(&bc));
        let (on_ab, foot_on_ab) = edge_point(&a, &b, &ab, inverse_ab);
        let (on_ac, _) = edge_point(&a, &c, &ac, inverse_ac);
        let (on_bc, _) = edge_point(&b, &c, &bc, inverse_bc);

        // Inside: least squares by orthogonalising the second edge and the point against the first (modified Gram and
        // Schmidt), which is as good as exact for a triangle and a point moved by a few roundings (Björck 1967); a normal
        // would not be, where the triangle is thin.
        let lean = ac.dot(&ab) * inverse_ab;
        let across = ac - ab * lean;
        let inverse_across = one / across.dot(&across);
        let third = -foot_on_ab.vector.dot(&across) * inverse_across;
        let second = foot_on_ab.along - third * lean;
        let foot = foot_on_ab.vector + across * third;
        // NaN where the triangle has no area: the edges then answer for it.
        let is_inside = zero < second && zero < third && second + third < one;

        let mut nearest = Self { square: on_ab.square, weights: [one - on_ab.along, on_ab.along, zero] };
        let others = [
            (true, on_ac.square, [one - on_ac.along, zero, on_ac.along]),
            (true, on_bc.square, [zero, one - on_bc.along, on_bc.along]),
            (is_inside, foot.dot(&foot), [one - (second + third), second, third]),
        ];
        for (counts, square, weights) in others {
            if counts && square < nearest.square {
                nearest = Self { square, weights };
            }
        }
        nearest
    }

    /// The point in the caller's scale; `places` are those of the corners, in ascending order of their vertices, in the
    /// triangle.
    pub(crate) fn resolved(
        &self,
        query: &QueryPoint<T>,
        triangle: u32,
        corners: &[Vector3<T>; 3],
        places: [usize; 3],
    ) -> ClosestPoint<T> {
        // Halves, since differences of finite numbers may overflow.
        let half = T::of(0.5);
        let [a, b, c] = corners.map(|corner| corner * half);
        let [first, second, third] = self.weights;
        let on_corner = self.weights.iter().position(|&weight| weight == T::one());
        let position = match on_corner {
            Some(corner) => corners[corner],
            // On an edge as the triangle beside it does.
            None if first == T::zero() => (b + (c - b) * third) / half,
            None => (a + ((b - a) * second + (c - a) * third)) / half,
        };
        let mut weights = self.weights;
        for (place, weight) in places.into_iter().zip(self.weights) {
            weights[place] = weight;
        }
        ClosestPoint { triangle, weights, position, distance: self.square.sqrt() * query.inverse }
    }
}

/// The foot of the perpendicular on the line through an edge, from the point, and where it is along the edge.
struct Foot<T: Scalar> {
    along: T,
    vector: Vector3<T>,
}

/// Of the edge from `a` to `b`, both as seen from the point.
fn edge_point<T: Scalar>(
    a: &Vector3<T>,
    b: &Vector3<T>,
    edge: &Vector3<T>,
    inverse_square: T,
) -> (EdgePoint<T>, Foot<T>) {
    let (zero, one) = (T::zero(), T::one());
    let along = -a.dot(edge) * inverse_square;
    let vector = a + edge * along;
    let nearest = if one <= along {
        EdgePoint { along: one, square: b.dot(b) }
    } else if zero < along {
        EdgePoint { along, square: vector.dot(&vector) }
    } else {
        // An edge without a length too.
        EdgePoint { along: zero, square: a.dot(a) }
    };
    (nearest, Foot { along, vector })
}
