use super::Mesh;
use super::normals::RingLanes;
use crate::math::{LANE_COUNT, Lanes, Mask, Scalar, Vectors};

/// Vertices around which all triangles face along an axis, or all against it, and go around once: seen along the axis they
/// cover a neighbourhood of the vertex once, so that the points just before and behind it lie on either side of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// By axis.
    pub(crate) along: [Mask; 3],
    pub(crate) against: [Mask; 3],
}

/// The least part of a normal along the axis, squared: far more than the rounding of normals.
const LEAST_PART: f64 = 1.0 / 64.0;
/// The least sine of a triangle's angle, squared: the normal is rounded by some units of its two edges' product.
const LEAST_SINE: f64 = 1.0 / (1 << 20) as f64;

impl<T: Scalar> Mesh<T> {
    /// Of up to sixteen vertices. Where rounding might decide, or squares underflow or overflow, neither holds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn facing<L: Lanes<T>>(&self, vertices: &[u32]) -> Facing {
        let count = vertices.len().min(LANE_COUNT);
        let mut own = [vertices[0]; LANE_COUNT];
        own[..count].copy_from_slice(&vertices[..count]);
        let rings = RingLanes::new::<T, L>(self.topology(), own);
        let base = self.gather::<L>(&own);
        let zero = L::splat(T::zero());
        let (least, greatest) = (L::splat(T::SAFE_SQUARES.0), L::splat(T::SAFE_SQUARES.1));
        let (least_part, least_sine) = (L::splat(T::of(LEAST_PART)), L::splat(T::of(LEAST_SINE)));
        let (mut along, mut against) = ([Mask::MAX; 3], [Mask::MAX; 3]);
        // How often the edges pass from the lower to the upper half along each axis.
        let (mut once, mut more) = ([0; 3], [0; 3]);
        let (mut before, mut square_before, mut is_below, mut has_length_before) = (Vectors::zeros(), zero, [0; 3], 0);
        for place in 0..rings.longest {
            let edge = self.gather::<L>(&rings.at::<T, L>(place)).sub(base);
            let has_length = zero.is_less(edge.magnitude().largest());
            let is_triangle = has_length & has_length_before;
            let (normal, square_of_edge) = (before.cross(edge), edge.dot(edge));
            let square = normal.dot(normal);
            let is_sure = least.is_at_most(square)
                & square.is_at_most(greatest)
                & square_of_edge.mul(square_before).mul(least_sine).is_at_most(square);
            let part = square.mul(least_part);
            let (edges, normals) = ([edge.x, edge.y, edge.z], [normal.x, normal.y, normal.z]);
            for axis in 0..3 {
                let is_enough = part.is_at_most(normals[axis].mul(normals[axis])) & is_sure;
                along[axis] &= zero.is_less(normals[axis]) & is_enough | !is_triangle;
                against[axis] &= normals[axis].is_less(zero) & is_enough | !is_triangle;
                let is_below_now = edges[axis].is_less(zero);
                let passes = is_below[axis] & !is_below_now & is_triangle;
                more[axis] |= once[axis] & passes;
                once[axis] |= passes;
                is_below[axis] = is_below_now;
            }
            (before, square_before, has_length_before) = (edge, square_of_edge, has_length);
        }
        for axis in 0..3 {
            // Seen along one axis, the edges pass the next.
            let next = (axis + 1) % 3;
            along[axis] &= once[next] & !more[next];
            against[axis] &= once[next] & !more[next];
        }
        Facing { along, against }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::math::{Kernel, on_every_path};
    use crate::octree::test_mesh::{torus_positions, torus_triangles};

    #[derive(Clone, Copy)]
    struct Asked<'a, T: Scalar>(&'a Mesh<T>);

    impl<T: Scalar> Kernel<T> for Asked<'_, T> {
        type Output = Vec<[bool; 6]>;

        fn run<L: Lanes<T>>(self) -> Self::Output {
            let mut all = Vec::new();
            for some in self.0.topology().surface_vertices().chunks(LANE_COUNT) {
                let Facing { along, against } = self.0.facing::<L>(some);
                let [a, b, c] = along;
                let [d, e, f] = against;
                all.extend((0..some.len()).map(|lane| [a, b, c, d, e, f].map(|mask| mask >> lane & 1 == 1)));
            }
            all
        }
    }

    /// Which way all triangles around a vertex face by more than a part of their area: −1, 1 or 0, and whether it is a
    /// near thing.
    fn facing<T: Scalar>(mesh: &Mesh<T>, vertex: u32, axis: usize) -> (i32, bool) {
        let parts = mesh.topology().triangles_around(vertex).iter().map(|&triangle| {
            let normal = mesh.scaled_normal(triangle).map(T::to_f64);
            normal[axis] / normal.norm()
        });
        let (least, most) = parts.fold((1.0f64, -1.0f64), |(least, most), part| (least.min(part), most.max(part)));
        let is_near = |part: f64| (part.abs() - LEAST_PART.sqrt()).abs() < 1e-4;
        let way = if least > LEAST_PART.sqrt() { 1 } else { -i32::from(most < -LEAST_PART.sqrt()) };
        (way, is_near(least) || is_near(most))
    }

    fn assert_same_on_all_paths<T: Scalar>() {
        let sides = [48, 12];
        let positions: Vec<_> = torus_positions(sides, 3).into_iter().map(|point| point.map(T::of)).collect();
        let mesh = Mesh::new(&positions, &torus_triangles(sides)).expect("it is closed");
        let [first, others @ ..] = &on_every_path::<T, _>(Asked(&mesh))[..] else { panic!("there is a path") };
        assert!(others.iter().all(|other| other == first));
        let mut counts = [0; 3];
        for (&vertex, found) in mesh.topology().surface_vertices().iter().zip(first) {
            for axis in 0..3 {
                let (expected, is_near) = facing(&mesh, vertex, axis);
                let way = i32::from(found[axis]) - i32::from(found[axis + 3]);
                assert!(way == expected || is_near, "vertex {vertex}, axis {axis}: {way}, not {expected}");
                counts[(way + 1) as usize] += 1;
            }
        }
        assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
    }

    #[test]
    fn triangles_around_a_vertex_face_one_way_on_all_paths() {
        assert_same_on_all_paths::<f64>();
        assert_same_on_all_paths::<f32>();
    }

    /// A fan that goes around twice, as a screw with its ends joined: it faces upward all over, and covers its middle twice.
    #[test]
    fn a_fan_that_goes_around_twice_faces_no_way() {
        let ring = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 5.0).sin_cos();
            let height = -1.0 - 0.3 * (f64::from(i) * std::f64::consts::PI / 5.0).cos();
            [cos, sin, height]
        };
        let positions: Vec<_> = (0..10).map(ring).chain([[0.0; 3], [0.0, 0.0, -5.0]]).collect();
        let sides = (0..10).flat_map(|i| [[10, i, (i + 1) % 10], [11, (i + 1) % 10, i]]);
        let mesh = Mesh::new(&positions, &sides.collect::<Vec<_>>()).expect("it is closed");
        assert!(mesh.topology().triangles_around(10).iter().all(|&triangle| mesh.scaled_normal(triangle).z > 0.0));
        for found in on_every_path::<f64, _>(Asked(&mesh)) {
            assert_eq!(found[10], [false; 6]);
        }
    }
}
