use crate::math::{Scalar, Vector3};

/// Halving more often than this changes nothing in either precision.
pub(crate) const DEEPEST: u8 = 96;

/// The corners of a piece of a triangle: their positions, and their barycentric weights in the triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners<T: Scalar> {
    pub(crate) positions: [Vector3<T>; 3],
    pub(crate) weights: [Vector3<T>; 3],
}

impl<T: Scalar> Corners<T> {
    /// The corners of a whole triangle.
    pub(crate) fn of_triangle(positions: [Vector3<T>; 3]) -> Self {
        Self { positions, weights: [Vector3::x(), Vector3::y(), Vector3::z()] }
    }

    /// The corners of a triangle's piece of this number.
    pub(crate) fn of_piece(positions: [Vector3<T>; 3], number: u32) -> Self {
        let mut corners = Self::of_triangle(positions);
        for bit in (0..31 - number.leading_zeros().min(31)).rev() {
            let Some((replaced, position, weights)) = corners.cut() else { break };
            let corner = replaced[(number >> bit & 1) as usize];
            (corners.positions[corner], corners.weights[corner]) = (position, weights);
        }
        corners
    }

    /// The middle: where it is, and its barycentric weights.
    pub(crate) fn middle(&self) -> (Vector3<T>, Vector3<T>) {
        let third = T::one() / T::of(3.0);
        let mean = |[a, b, c]: [Vector3<T>; 3]| (a + b + c) * third;
        (mean(self.positions), mean(self.weights))
    }

    /// Where it is cut into halves, at the middle of the longest edge: the corner that the middle replaces in either half, its
    /// position and its weights. `None` where rounding leaves none.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn cut(&self) -> Option<([usize; 2], Vector3<T>, Vector3<T>)> {
        let (from, _) = longest_edge(&self.positions);
        let (to, half) = ((from + 1) % 3, T::of(0.5));
        let [position, weights] = [self.positions, self.weights].map(|corners| (corners[from] + corners[to]) * half);
        self.positions.iter().all(|&corner| corner != position).then_some(([to, from], position, weights))
    }
}

/// The corner at which the longest edge of a triangle begins, and its squared length. Of equal edges it is the one that comes
/// first in space, so that it does not matter with which corner the triangle begins.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn longest_edge<T: Scalar>(corners: &[Vector3<T>; 3]) -> (usize, T) {
    let squares: [T; 3] = std::array::from_fn(|i| (corners[i] - corners[(i + 1) % 3]).norm_squared());
    let ends = |i: usize| {
        let sum = corners[i] + corners[(i + 1) % 3];
        [sum.x, sum.y, sum.z]
    };
    let is_longer =
        |i: usize, best: usize| squares[i] > squares[best] || (squares[i] == squares[best] && ends(i) < ends(best));
    let longest = (1..3).fold(0, |best, i| if is_longer(i, best) { i } else { best });
    (longest, squares[longest])
}
