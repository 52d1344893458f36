//! How often the closed parts of a surface wind around a point: the sum of the triangles' solid angles (van Oosterom and
//! Strackee 1983; Jacobson, Kavan and Sorkine-Hornung 2013). Far groups of triangles count as one dipole (Barill, Dickson,
//! Schmidt, Levin and Jacobson 2018), so that a point among n triangles does not take n steps.

use crate::math::{Vector3, direction, length, margins};
use crate::memory::{self, Room};

/// A group this many of its radii away counts as one dipole. The error of the winding number stays far below one half.
const FAR: f64 = 6.0;

const LEAF_LENGTH: usize = 8;

pub(crate) type Corners = [Vector3<f64>; 3];

/// What part of the full solid angle a triangle covers as seen from `point`; positive where it is seen from behind. Zero
/// for a triangle that the point lies on, so that a surface winds half around its own points.
pub(crate) fn of_triangle(corners: &Corners, point: &Vector3<f64>) -> f64 {
    let [Some(a), Some(b), Some(c)] = corners.map(|corner| direction(&(corner - point))) else { return 0.0 };
    let volume = a.dot(&b.cross(&c));
    if volume.abs() <= margins::margin(margins::FLAT_TETRAHEDRON) {
        return 0.0;
    }
    volume.atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a)) / std::f64::consts::TAU
}

/// Triangles in groups of groups.
pub(crate) struct WindingTree {
    triangles: Vec<Corners>,
    /// A group comes before those within it.
    groups: Vec<Group>,
}

struct Group {
    centre: Vector3<f64>,
    radius: f64,
    /// The sum of the triangles' normals, each as long as twice the area.
    normal: Vector3<f64>,
    first: u32,
    count: u32,
    /// The number of the next group that is not within this one.
    next: u32,
}

impl WindingTree {
    pub(crate) fn new(triangles: Vec<Corners>) -> Self {
        let mut tree = Self { groups: memory::with_room(triangles.len() / 2), triangles };
        tree.group(0, tree.triangles.len());
        tree
    }

    /// Calls itself as often within one another as the logarithm of the number of triangles.
    fn group(&mut self, first: usize, end: usize) {
        let place = self.groups.len();
        let triangles = &mut self.triangles[first..end];
        let count = triangles.len();
        // Weighted by areas, so that a plane group is a dipole up to the second order.
        let area = triangles.iter().map(|corners| length(&normal(corners))).sum::<f64>();
        let weighted = |corners: &Corners| middle(corners) * length(&normal(corners));
        let centre = match triangles.iter().map(weighted).sum::<Vector3<f64>>() / area {
            centre if centre.iter().all(|x| x.is_finite()) => centre,
            // The areas underflow.
            _ => triangles.first().map_or(Vector3::zeros(), middle),
        };
        let radius = triangles.iter().flatten().map(|corner| length(&(corner - centre))).fold(0.0, f64::max);
        let normal = triangles.iter().map(normal).sum();
        let group = Group { centre, radius, normal, first: first as u32, count: count as u32, next: 0 };
        self.groups.room_for(1).push(group);
        if count > LEAF_LENGTH {
            let (lower, upper) =
                triangles.iter().map(middle).fold((centre, centre), |(l, u), m| (l.inf(&m), u.sup(&m)));
            let axis = (upper - lower).imax();
            let half = count / 2;
            triangles.select_nth_unstable_by(half, |s, t| middle(s)[axis].total_cmp(&middle(t)[axis]));
            self.group(first, first + half);
            self.group(first + half, end);
        }
        self.groups[place].next = self.groups.len() as u32;
    }

    /// How often the triangles wind around `point`.
    pub(crate) fn winding_number(&self, point: &Vector3<f64>) -> f64 {
        let (mut sum, mut place) = (0.0, 0);
        while let Some(group) = self.groups.get(place) {
            let way = group.centre - point;
            let distance = length(&way);
            if distance > FAR * group.radius {
                // Two factors, since a cube might underflow.
                let (towards, nearness) = (way / distance, 1.0 / distance);
                sum += (group.normal * nearness * nearness).dot(&towards) / (8.0 * std::f64::consts::PI);
                place = group.next as usize;
            } else if group.count as usize <= LEAF_LENGTH {
                let own = &self.triangles[group.first as usize..][..group.count as usize];
                sum += own.iter().map(|corners| of_triangle(corners, point)).sum::<f64>();
                place = group.next as usize;
            } else {
                place += 1;
            }
        }
        sum
    }
}

fn normal([a, b, c]: &Corners) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

fn middle([a, b, c]: &Corners) -> Vector3<f64> {
    (a + b + c) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    /// So many triangles has each.
    const SPHERE: usize = 20 << 6;

    /// Spheres of many triangles, one inside the other, facing either way.
    fn nested_spheres() -> Vec<Corners> {
        let mut triangles = Vec::new();
        for (radius, is_outward) in [(1.0, true), (0.8, false), (0.79, true), (0.5, true), (0.3, false)] {
            let sphere = shapes::sphere(3).scaled(radius).mesh::<f64>();
            let corners = (0..SPHERE as u32).map(|triangle| sphere.corners(triangle));
            triangles.extend(corners.map(|[a, b, c]| if is_outward { [a, b, c] } else { [a, c, b] }));
        }
        triangles
    }

    #[test]
    fn groups_give_what_all_triangles_give() {
        let triangles = nested_spheres();
        let tree = WindingTree::new(triangles.clone());
        for i in 0..400 {
            let part = |step: f64| (f64::from(i) * step).fract() * 2.4 - 1.2;
            let point = Vector3::new(part(0.618_034), part(0.414_214), part(0.302_776));
            let expected: f64 = triangles.iter().map(|corners| of_triangle(corners, &point)).sum();
            assert!((expected - expected.round()).abs() < 1e-9, "{point}: {expected}");
            let found = tree.winding_number(&point);
            assert!((found - expected).abs() < 0.05, "{point}: {found}, not {expected}");
        }
    }

    #[test]
    fn a_surface_winds_half_around_its_own_points() {
        let triangles = &nested_spheres()[..SPHERE];
        let tree = WindingTree::new(triangles.to_vec());
        for corners in triangles {
            let found = tree.winding_number(&middle(corners));
            assert!((0.4..0.6).contains(&found), "{corners:?}: {found}");
        }
    }
}
