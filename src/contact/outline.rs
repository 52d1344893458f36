//! What a surface has below an area that is seen along a line: by triangle, the loads of an even pressure on that area.

use crate::math::Scalar;
use crate::math::margins::{COVERED, margin};
use crate::memory::Room;
use crate::simd::{Kernel, LANE_COUNT, Lanes, dispatch};

/// A point in a plane.
pub(crate) type Flat<T> = [T; 2];

/// The edges around an area, which lies to their left.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline<T: Scalar> {
    edges: Vec<[Flat<T>; 2]>,
    /// How far the edges are from the origin at most, squared.
    square: T,
}

impl<T: Scalar> Outline<T> {
    pub(crate) fn clear(&mut self) {
        self.edges.clear();
        self.square = T::zero();
    }

    pub(crate) fn add(&mut self, edge: [Flat<T>; 2]) {
        self.edges.room_for(1).push(edge);
        self.square = edge.iter().fold(self.square, |most, [x, y]| most.max(*x * *x + *y * *y));
    }

    /// Of a triangle whose corners go around to the left, the edges that a circle around the outline may cross; `None` where it
    /// is out of the circle's reach, or has its corners to the right.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn crosses(&self, [a, b, c]: &[Flat<T>; 3]) -> Option<[bool; 3]> {
        let left = |a: &Flat<T>, b: &Flat<T>| {
            let along = [b[0] - a[0], b[1] - a[1]];
            let left = a[0] * along[1] - a[1] * along[0];
            (left, left * left <= self.square * (along[0] * along[0] + along[1] * along[1]))
        };
        let [(first, near_first), (second, near_second), (third, near_third)] = [left(a, b), left(b, c), left(c, a)];
        let is_reached = (near_first | (first > T::zero()))
            & (near_second | (second > T::zero()))
            & (near_third | (third > T::zero()));
        (is_reached && first + second + third > T::zero()).then_some([near_first, near_second, near_third])
    }

    /// The weights of the corners of sixteen triangles, by lane.
    pub(crate) fn weights_below(&self, below: &Below<T>) -> [[T; LANE_COUNT]; 3] {
        dispatch::<T, _>(Weigh { edges: &self.edges, below })
    }
}

/// Up to sixteen triangles whose corners go around to the left: their first corners, and from these to the others.
pub(crate) struct Below<T> {
    corners: [[[T; LANE_COUNT]; 2]; 3],
}

impl<T: Scalar> Below<T> {
    pub(crate) fn new() -> Self {
        Self { corners: [[[T::zero(); LANE_COUNT]; 2]; 3] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set(&mut self, lane: usize, [a, b, c]: [Flat<T>; 3]) {
        for axis in 0..2 {
            self.corners[0][axis][lane] = a[axis];
            self.corners[1][axis][lane] = b[axis] - a[axis];
            self.corners[2][axis][lane] = c[axis] - a[axis];
        }
    }
}

/// [`Outline::weights_below`]. With barycentric coordinates x and y, a triangle is where 0 ≤ x and 0 ≤ y ≤ 1 − x. The integral of
/// a function over its part to the left of the edges is the sum over these of -∫ F dx, where F is the function's integral from
/// y = 0 to the edge, or to the triangle's end before it. No edge decides alone, so it does not matter how those that coincide
/// with the triangle's are rounded.
#[derive(Clone, Copy)]
struct Weigh<'a, T: Scalar> {
    edges: &'a [[Flat<T>; 2]],
    below: &'a Below<T>,
}

impl<T: Scalar> Kernel<T> for Weigh<'_, T> {
    type Output = [[T; LANE_COUNT]; 3];

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Self::Output {
        let [zero, one] = [L::splat(T::zero()), L::splat(T::one())];
        let [a, b, c] = &self.below.corners;
        let triangles = Triangles::<L>::new::<T>(
            [L::load(&a[0]), L::load(&a[1])],
            [L::load(&b[0]), L::load(&b[1])],
            [L::load(&c[0]), L::load(&c[1])],
        );
        let [mut areas, mut x_sum, mut y_sum] = [zero; 3];
        for &[from, to] in self.edges {
            let [px, py] = triangles.local(from);
            let [qx, qy] = triangles.local(to);
            // The part of the edge over the triangle.
            let inverse = one.div(qx.sub(px));
            let [first, last] = [bounded(px), bounded(qx)];
            let along = qy.sub(py);
            let start = bounded(first.sub(px).mul(inverse)).mul(along).add(py);
            let end = bounded(last.sub(px).mul(inverse)).mul(along).add(py);
            let across = last.sub(first);
            // Where it passes through y = 0, and through y = 1 - x.
            let [above, beyond] = [start.sub(end), start.add(first).sub(one)];
            let [zeroth, other] = [bounded(start.div(above)), bounded(beyond.div(above.sub(across)))];
            let [early, late] = [zeroth.smaller(other), zeroth.larger(other)];
            let [early_x, late_x] = [across.mul(early).add(first), across.mul(late).add(first)];
            let [early_y, late_y] = [start.sub(above.mul(early)), start.sub(above.mul(late))];
            let points = [
                [first, height(first, start)],
                [early_x, height(early_x, early_y)],
                [late_x, height(late_x, late_y)],
                [last, height(last, end)],
            ];
            for k in 0..3 {
                let ([x0, y0], [x1, y1]) = (points[k], points[k + 1]);
                let (across, both) = (x0.sub(x1), y0.add(y1));
                areas = across.mul(both).add(areas);
                let moment = x0.add(x1).mul(both).add(x0.mul(y0)).add(x1.mul(y1));
                x_sum = across.mul(moment).add(x_sum);
                y_sum = across.mul(both.mul(both).sub(y0.mul(y1))).add(y_sum);
            }
        }
        // Six times the integrals: areas has been added up twice, the others six times.
        let area = areas.mul(L::splat(T::of(3.0)));
        // Less is rounding.
        let least = L::splat(margin(COVERED));
        let size = least.where_less(area, triangles.doubled_area, zero);
        let mut weights = [[T::zero(); LANE_COUNT]; 3];
        area.sub(x_sum).sub(y_sum).larger(zero).mul(size).store(&mut weights[0]);
        x_sum.larger(zero).mul(size).store(&mut weights[1]);
        y_sum.larger(zero).mul(size).store(&mut weights[2]);
        weights
    }
}

/// From 0 to 1; 1 for NaN.
#[cfg_attr(not(debug_assertions), inline(always))]
fn bounded<T: Scalar, L: Lanes<T>>(number: L) -> L {
    number.smaller(L::splat(T::one())).larger(L::splat(T::zero()))
}

/// How high a triangle is there, or an edge below that.
#[cfg_attr(not(debug_assertions), inline(always))]
fn height<T: Scalar, L: Lanes<T>>(x: L, y: L) -> L {
    y.larger(L::splat(T::zero())).smaller(L::splat(T::one()).sub(x))
}

/// Sixteen triangles.
struct Triangles<L> {
    first: [L; 2],
    second: [L; 2],
    third: [L; 2],
    doubled_area: L,
    inverse: L,
}

impl<L> Triangles<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new<T: Scalar>(first: [L; 2], second: [L; 2], third: [L; 2]) -> Self
    where
        L: Lanes<T>,
    {
        let doubled_area = second[0].mul(third[1]).sub(second[1].mul(third[0]));
        let inverse = L::splat(T::one()).div(doubled_area);
        Self { first, second, third, doubled_area, inverse }
    }

    /// The barycentric coordinates of a point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn local<T: Scalar>(&self, [x, y]: Flat<T>) -> [L; 2]
    where
        L: Lanes<T>,
    {
        let (x, y) = (L::splat(x).sub(self.first[0]), L::splat(y).sub(self.first[1]));
        let (second, third) = (&self.second, &self.third);
        [
            x.mul(third[1]).sub(y.mul(third[0])).mul(self.inverse),
            second[0].mul(y).sub(second[1].mul(x)).mul(self.inverse),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(target_arch = "x86_64")]
    use crate::simd::on_every_path;

    /// A star with so many corners, about the origin.
    fn star(corners: usize) -> Outline<f64> {
        let corner = |number: usize| {
            let number = (number % corners) as f64;
            let (angle, radius) = (std::f64::consts::TAU * number / corners as f64, 0.6 + 0.3 * (number * 7.3).sin());
            [radius * angle.cos(), radius * angle.sin()]
        };
        let mut outline = Outline::default();
        (0..corners).for_each(|number| outline.add([corner(number), corner(number + 1)]));
        outline
    }

    /// A square around it, cut into triangles with these edges, one of which may lie along the outline's.
    fn triangles(count: usize) -> Vec<[Flat<f64>; 3]> {
        let at = |i: usize, j: usize| [i, j].map(|k| 2.0 * k as f64 / count as f64 - 1.0);
        let cell = |i: usize, j: usize| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..count * count).flat_map(|number| cell(number % count, number / count)).collect()
    }

    /// The area around the origin, six times, and its moments.
    fn moments(outline: &Outline<f64>) -> [f64; 3] {
        outline.edges.iter().fold([0.0; 3], |[area, x, y], [from, to]| {
            let cross = from[0] * to[1] - from[1] * to[0];
            [area + 3.0 * cross, x + (from[0] + to[0]) * cross, y + (from[1] + to[1]) * cross]
        })
    }

    /// Weights by barycentric coordinates keep the area and its centroid, so together the triangles have those of the outline.
    #[test]
    fn triangles_share_an_area_and_its_centroid_on_every_path() {
        let square = {
            let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
            let mut outline = Outline::default();
            (0..4).for_each(|k| outline.add([corners[k], corners[(k + 1) % 4]]));
            outline
        };
        for outline in [star(3), star(5), star(17), square] {
            for count in [1, 2, 3, 8, 20] {
                let mut sums = [0.0; 3];
                let triangles = triangles(count);
                for some in triangles.chunks(LANE_COUNT) {
                    let mut below = Below::new();
                    some.iter().enumerate().for_each(|(lane, corners)| below.set(lane, *corners));
                    let weights = outline.weights_below(&below);
                    #[cfg(target_arch = "x86_64")]
                    for other in on_every_path(Weigh { edges: &outline.edges, below: &below }) {
                        assert_eq!(
                            other.map(|lanes| lanes[..some.len()].to_vec()),
                            weights.map(|lanes| lanes[..some.len()].to_vec())
                        );
                    }
                    for (lane, corners) in some.iter().enumerate() {
                        let crossed = outline.crosses(corners);
                        for (corner, of_corner) in corners.iter().zip(weights) {
                            let weight = of_corner[lane];
                            assert!(weight == 0.0 || (weight > 0.0 && crossed.is_some()));
                            sums = [sums[0] + weight, sums[1] + weight * corner[0], sums[2] + weight * corner[1]];
                        }
                    }
                }
                let off = std::array::from_fn::<f64, 3, _>(|k| (sums[k] - moments(&outline)[k]).abs());
                assert!(off.into_iter().all(|off| off < (2.0_f64).powi(-36)), "{count}: {off:?}");
            }
        }
    }

    #[test]
    fn a_triangle_beside_the_outline_has_nothing_and_one_within_it_all() {
        let mut below = Below::new();
        let within = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]];
        below.set(0, within.map(|[x, y]| [x + 2.0, y]));
        below.set(1, within);
        let weights = star(5).weights_below(&below);
        assert!(
            weights.iter().all(|of_corner| of_corner[0] == 0.0 && (of_corner[1] - 0.01).abs() < (2.0_f64).powi(-50))
        );
        assert!(star(5).crosses(&within.map(|[x, y]| [x + 2.0, y])).is_none());
        // Corners to the right: seen from behind.
        assert!(star(5).crosses(&[within[0], within[2], within[1]]).is_none());
    }
}
