//! Where along the ray a triangle lies that is seen around it.

type Corners = [[f64; 3]; 3];

fn smallest_and_largest(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// The third coordinate of the triangle's plane over the square with |x| and |y| up to `half_width`, no further than
/// its corners. `None` where the triangle is too thin for that to be accurate.
pub fn range_on_plane(corners: &Corners, half_width: f64) -> Option<(f64, f64)> {
    let [a, b, c] = corners;
    let [u, v] = [b, c].map(|end| [end[0] - a[0], end[1] - a[1], end[2] - a[2]]);
    let doubled_area = u[0] * v[1] - u[1] * v[0];
    let longest = [u[0], u[1], v[0], v[1]].into_iter().map(f64::abs).fold(0.0, f64::max);
    let thinness = longest * longest / doubled_area.abs();
    if thinness.is_nan() || thinness > 1e3 {
        return None;
    }
    let slope_x = (u[2] * v[1] - v[2] * u[1]) / doubled_area;
    let slope_y = (u[0] * v[2] - v[0] * u[2]) / doubled_area;
    let middle = a[2] - slope_x * a[0] - slope_y * a[1];
    let (least, most) = smallest_and_largest(corners.iter().map(|corner| corner[2]))?;
    // The slopes are off by a few rounding units, as many times as the triangle is thin.
    let error = 16.0 * f64::EPSILON * thinness * (most - least) * (1.0 + (a[0].abs() + a[1].abs()) / longest);
    let spread = (slope_x.abs() + slope_y.abs()) * half_width + error;
    Some(((middle - spread).max(least), (middle + spread).min(most)))
}

/// The third coordinate of the part of the triangle with |x| and |y| up to `half_width` (Sutherland and Hodgman 1974);
/// `None` where there is no such part. Never worse than moving the square by a rounding unit.
pub fn range_by_clipping(corners: &Corners, half_width: f64) -> Option<(f64, f64)> {
    let mut points = corners.to_vec();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        points = cut(&points, axis, sign, half_width);
    }
    smallest_and_largest(points.iter().map(|point| point[2]))
}

/// The part of a polygon with sign · coordinate ≤ `limit`.
fn cut(points: &[[f64; 3]], axis: usize, sign: f64, limit: f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::with_capacity(points.len() + 1);
    for (place, &to) in points.iter().enumerate() {
        let from = points[(place + points.len() - 1) % points.len()];
        let (at_from, at_to) = (sign * from[axis], sign * to[axis]);
        if (at_from <= limit) != (at_to <= limit) {
            let part = (limit - at_from) / (at_to - at_from);
            let mut point: [f64; 3] = std::array::from_fn(|i| from[i] + part * (to[i] - from[i]));
            point[axis] = sign * limit;
            kept.push(point);
        }
        if at_to <= limit {
            kept.push(to);
        }
    }
    kept
}
