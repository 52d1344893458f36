use crate::math::{Scalar, Vector3};
use crate::triangle::main_axis::AXES;
use crate::triangle::ray::{Hit, Ray};

/// A ray in the coordinates of Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection": the axis along
/// which it runs most becomes z, and a shear turns it into the z axis itself. Every vertex then has one projection,
/// whichever triangle asks, so the triangles of a closed mesh project without gaps.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay<T: Scalar> {
    /// Along the ray's own axes.
    pub(crate) origin: Vector3<T>,
    /// Which of [`AXES`] these are.
    pub(crate) axes: u8,
    pub(crate) shear: Vector3<T>,
}

impl<T: Scalar> ShearedRay<T> {
    /// Shears `ray`. A direction that is zero or not finite meets nothing.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(ray: &Ray<T>) -> Self {
        let d = &ray.direction;
        let main = d.iamax();
        let axes = if d[main] < T::zero() { main + 3 } else { main };
        let [x, y, z] = AXES[axes].map(usize::from);
        // An infinite component would make the shear, and every t, zero. So it is made NaN, as it is for a direction of zero.
        let is_finite = d.x.is_finite() && d.y.is_finite() && d.z.is_finite();
        let along = if is_finite { d[z] } else { T::of(f64::NAN) };
        let shear = Vector3::new(d[x] / along, d[y] / along, T::one() / along);
        let origin = Vector3::new(ray.origin[x], ray.origin[y], ray.origin[z]);
        Self { origin, axes: axes as u8, shear }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn project(&self, corner: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = AXES[usize::from(self.axes)].map(usize::from);
        let from_origin = Vector3::new(corner[x], corner[y], corner[z]) - self.origin;
        Vector3::new(
            from_origin.x - self.shear.x * from_origin.z,
            from_origin.y - self.shear.y * from_origin.z,
            self.shear.z * from_origin.z,
        )
    }

    /// The hit on the triangle with these corners at `t` ≥ 0, from either side. A ray through an edge or a vertex
    /// shared by several triangles hits at least one of them. Where twice the triangle's area, as the ray sees it, is above the
    /// largest number (coordinates beyond about 10¹⁹ in `f32`, 10¹⁵⁴ in `f64`), there is none.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn intersect(&self, corners: &[Vector3<T>; 3], triangle: u32) -> Option<Hit<T>> {
        let projected = [self.project(&corners[0]), self.project(&corners[1]), self.project(&corners[2])];
        let [a, b, c] = &projected;
        let zero = T::zero();
        // A rounded edge function that is not zero has the exact one's sign: most triangles are refused by these.
        let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| p.x * q.y - p.y * q.x);
        if (u > zero || v > zero || w > zero) && (u < zero || v < zero || w < zero) {
            return None;
        }
        intersect_projected(&projected, triangle)
    }
}

/// [`ShearedRay::intersect`] of a triangle whose corners are projected.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn intersect_projected<T: Scalar>([a, b, c]: &[Vector3<T>; 3], triangle: u32) -> Option<Hit<T>> {
    let zero = T::zero();
    let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| edge_function(p, q));
    let all_right = u >= zero && v >= zero && w >= zero;
    let all_left = u <= zero && v <= zero && w <= zero;
    let determinant = u + v + w;
    // The determinant is zero where the triangle projects to a line; its neighbours answer for its edges.
    if !(all_right || all_left) || determinant == zero || !determinant.is_finite() {
        return None;
    }
    // Weights first: products of lengths with edge functions, which are areas, may underflow.
    let weights = [u / determinant, v / determinant, w / determinant];
    let t = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
    if t >= zero && t.is_finite() { Some(Hit { triangle, t, weights, is_exit: determinant < zero }) } else { None }
}

impl<T: Scalar> ShearedRay<T> {
    /// The crossing of the triangle with these corners at `t` ≥ 0. A ray through an edge or a vertex crosses just those triangles
    /// there that it would cross if it were moved aside by an infinitely small step (ε, ε²) of the projection. So the signs
    /// along a ray, +1 for an exit and −1 for an entry, sum to the winding number of a closed mesh at the origin.
    pub fn crossing(&self, corners: &[Vector3<T>; 3], triangle: u32) -> Option<Hit<T>> {
        let [a, b, c] = [0, 1, 2].map(|corner| self.project(&corners[corner]));
        let sides = [(&c, &b), (&a, &c), (&b, &a)].map(|(p, q)| side_of_moved_ray(p, q));
        if sides[0] == 0 || sides[0] != sides[1] || sides[1] != sides[2] {
            return None;
        }
        // The moved ray crosses, so the ray itself meets the triangle, if only its border.
        self.intersect(corners, triangle)
    }
}

/// The sign of the edge function of a ray moved by (ε, ε²); zero only where p and q coincide.
fn side_of_moved_ray<T: Scalar>(p: &Vector3<T>, q: &Vector3<T>) -> i8 {
    let sign = |x: T| i8::from(x > T::zero()) - i8::from(x < T::zero());
    match (sign(edge_function(p, q)), sign(p.y - q.y)) {
        (0, 0) => sign(q.x - p.x),
        (0, by_y) => by_y,
        (by_area, _) => by_area,
    }
}

/// Twice the signed area of (0, p, q) in the projection: p.x·q.y − p.y·q.x, to within 1.5 rounding units of itself
/// (Kahan; Jeannerod, Louvet and Muller 2013).
///
/// So its sign is exact, zero included, and neighbours never both see a ray outside their shared edge. And the weights
/// are as accurate as the projections, however thin the triangle looks: without the correction, `t` on a triangle seen
/// nearly edge-on could be anywhere between its corners.
#[cfg_attr(not(debug_assertions), inline(always))]
fn edge_function<T: Scalar>(p: &Vector3<T>, q: &Vector3<T>) -> T {
    let right = p.y * q.x;
    let right_error = (-p.y).mul_add(q.x, right);
    p.x.mul_add(q.y, -right) + right_error
}
