use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Vectors};

/// Sums over triangles, about a point.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moments<T: Scalar> {
    pub(crate) area: T,
    /// Σ area · normal.
    pub(crate) vector: Vector3<T>,
    /// Σ area · middle.
    pub(crate) first: Vector3<T>,
    /// The integral of the squared distance.
    pub(crate) second: T,
}

impl<T: Scalar> Moments<T> {
    /// Of both together.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self {
            area: self.area + other.area,
            vector: self.vector + other.vector,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    fn add(&mut self, [a, b, c]: [Vector3<T>; 3]) {
        let vector = (b - a).cross(&(c - a)) * T::of(0.5);
        let (area, whole) = (vector.norm(), a + b + c);
        self.area += area;
        self.vector += vector;
        self.first += whole * (area * (T::one() / T::of(3.0)));
        let squares = a.norm_squared() + b.norm_squared() + c.norm_squared() + whole.norm_squared();
        self.second += squares * (area * (T::one() / T::of(12.0)));
    }
}

/// So few triangles are added one by one: lanes would stay empty.
const FEW: usize = 4;

/// Adds up the moments of some triangles about a point, with all lengths multiplied by a factor.
pub(crate) struct MomentsOf<'a, T: Scalar> {
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) triangles: &'a [u32],
    pub(crate) middle: Vector3<T>,
    pub(crate) factor: T,
}

impl<T: Scalar> Kernel<T> for MomentsOf<'_, T> {
    type Output = Moments<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Moments<T> {
        let Self { mesh, triangles, middle, factor } = self;
        if triangles.len() <= FEW {
            let mut sums = Moments::default();
            for &triangle in triangles {
                sums.add(mesh.corners(triangle).map(|corner| (corner - middle) * factor));
            }
            return sums;
        }
        let all = mesh.topology().triangles();
        let (middle, factor) = (Vectors::<T, L>::splat(&middle), L::splat(factor));
        let (third, twelfth) = (L::splat(T::one() / T::of(3.0)), L::splat(T::one() / T::of(12.0)));
        let mut area_sum = L::splat(T::zero());
        let mut second_sum = L::splat(T::zero());
        let (mut vector_sum, mut first_sum) = (Vectors::<T, L>::zeros(), Vectors::<T, L>::zeros());
        for some in triangles.chunks(LANE_COUNT) {
            // Lanes beyond the last have the same corner three times, and so no area.
            let mut vertices = [[all[some[0] as usize][0]; LANE_COUNT]; 3];
            for (lane, &triangle) in some.iter().enumerate() {
                let [a, b, c] = all[triangle as usize];
                (vertices[0][lane], vertices[1][lane], vertices[2][lane]) = (a, b, c);
            }
            let a = mesh.gather::<L>(&vertices[0]).sub(middle).scaled(factor);
            let b = mesh.gather::<L>(&vertices[1]).sub(middle).scaled(factor);
            let c = mesh.gather::<L>(&vertices[2]).sub(middle).scaled(factor);
            let vector = b.sub(a).cross(c.sub(a)).scaled(L::splat(T::of(0.5)));
            let area = vector.dot(vector).sqrt();
            let whole = a.add(b).add(c);
            area_sum = area_sum.add(area);
            vector_sum = vector_sum.add(vector);
            first_sum = first_sum.add(whole.scaled(area.mul(third)));
            let squares = a.dot(a).add(b.dot(b)).add(c.dot(c)).add(whole.dot(whole));
            second_sum = second_sum.add(squares.mul(area.mul(twelfth)));
        }
        Moments {
            area: sum(area_sum),
            vector: Vector3::new(sum(vector_sum.x), sum(vector_sum.y), sum(vector_sum.z)),
            first: Vector3::new(sum(first_sum.x), sum(first_sum.y), sum(first_sum.z)),
            second: sum(second_sum),
        }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn sum<T: Scalar, L: Lanes<T>>(lanes: L) -> T {
    let mut values = [T::zero(); LANE_COUNT];
    lanes.store(&mut values);
    // By halves, which takes fewer steps one after the other than a running sum.
    let mut half = LANE_COUNT / 2;
    while half > 0 {
        for lane in 0..half {
            values[lane] += values[lane + half];
        }
        half /= 2;
    }
    values[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_mesh::torus;
    use crate::simd::dispatch;

    /// Moments are those of the triangles one by one, whose middles of edges integrate squares exactly.
    #[test]
    fn moments_are_those_of_the_triangles() {
        let mesh = torus([20, 10]);
        let (middle, factor) = (Vector3::new(0.3, -0.2, 0.1), 4.0);
        for triangles in [vec![7], vec![3, 9, 40, 41], (0..16).collect::<Vec<u32>>(), (3..52).collect()] {
            let found = dispatch::<f64, _>(MomentsOf { mesh: &mesh, triangles: &triangles, middle, factor });
            let (mut area, mut vector, mut first, mut second) = (0.0, Vector3::zeros(), Vector3::zeros(), 0.0);
            for &triangle in &triangles {
                let [a, b, c] = mesh.corners(triangle).map(|corner| (corner - middle) * factor);
                let normal = mesh.scaled_normal(triangle) * (0.5 * factor * factor);
                let edges = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
                area += normal.norm();
                vector += normal;
                first += (a + b + c) / 3.0 * normal.norm();
                second += edges.iter().map(Vector3::norm_squared).sum::<f64>() / 3.0 * normal.norm();
            }
            assert!((found.area - area).abs() < 1e-13 * area && (found.second - second).abs() < 1e-13 * second);
            assert!((found.vector - vector).norm() < 1e-13 * area && (found.first - first).norm() < 1e-12 * area);
            let of = |triangles| dispatch::<f64, _>(MomentsOf { mesh: &mesh, triangles, middle, factor });
            let (some, others) = triangles.split_at(triangles.len() / 2);
            let both = of(some).with(&of(others));
            assert!((both.area - area).abs() < 1e-13 * area && (both.second - second).abs() < 1e-13 * second);
            assert!((both.vector - vector).norm() < 1e-13 * area && (both.first - first).norm() < 1e-12 * area);
        }
    }
}
