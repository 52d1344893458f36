use super::Mesh;
use super::normals::{Fan, NormalLanes};
use crate::math::Scalar;
use crate::math::margins::{LEAST_PART, LEAST_SINE};
use crate::simd::{Lanes, Mask, Vectors};

/// Around which vertices all triangles face along an axis, or all against it, and go around once. Seen along the axis these cover
/// a neighbourhood of the vertex once, so the points just before and behind it lie on either side of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// By axis.
    pub(crate) along: [Mask; 3],
    pub(crate) against: [Mask; 3],
}

impl<T: Scalar> Mesh<T> {
    /// For up to sixteen vertices, whose normals go into `found`. Where rounding might decide, or squares underflow or overflow,
    /// a vertex faces neither way.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn facing<L: Lanes<T>>(&self, vertices: &[u32], found: &mut NormalLanes<T>) -> Facing {
        let mut fan = FacingFan { along: [Mask::MAX; 3], against: [Mask::MAX; 3], once: [0; 3], more: [0; 3] };
        self.vertex_normals_and::<L>(vertices, found, &mut fan);
        let FacingFan { mut along, mut against, once, more } = fan;
        for axis in 0..3 {
            // Seen along an axis, edges go around by passing the next axis.
            let next = (axis + 1) % 3;
            along[axis] &= once[next] & !more[next];
            against[axis] &= once[next] & !more[next];
        }
        Facing { along, against }
    }
}

/// The state of the fans while their triangles are visited in order.
struct FacingFan {
    along: [Mask; 3],
    against: [Mask; 3],
    /// Whether the edges have passed from the lower to the upper half of each axis, and whether more than once.
    once: [Mask; 3],
    more: [Mask; 3],
}

impl<T: Scalar> Fan<T> for FacingFan {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add<L: Lanes<T>>(
        &mut self,
        [before, edge]: [Vectors<T, L>; 2],
        normal: Vectors<T, L>,
        is_safe: Mask,
        is_triangle: Mask,
    ) {
        let zero = L::splat(T::zero());
        let square = normal.dot(normal);
        let least_square = edge.dot(edge).mul(before.dot(before)).mul(L::splat(T::of(LEAST_SINE)));
        let is_sure = is_safe & least_square.is_at_most(square);
        let part = square.mul(L::splat(T::of(LEAST_PART)));
        let (edges, edges_before) = ([edge.x, edge.y, edge.z], [before.x, before.y, before.z]);
        let normals = [normal.x, normal.y, normal.z];
        for axis in 0..3 {
            let is_enough = part.is_at_most(normals[axis].mul(normals[axis])) & is_sure;
            self.along[axis] &= zero.is_less(normals[axis]) & is_enough | !is_triangle;
            self.against[axis] &= normals[axis].is_less(zero) & is_enough | !is_triangle;
            let passes = edges_before[axis].is_less(zero) & !edges[axis].is_less(zero) & is_triangle;
            self.more[axis] |= self.once[axis] & passes;
            self.once[axis] |= passes;
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::mesh::test_mesh::torus_at;
    use crate::simd::{Kernel, LANE_COUNT, on_every_path};

    #[derive(Clone, Copy)]
    struct Asked<'a, T: Scalar>(&'a Mesh<T>);

    impl<T: Scalar> Kernel<T> for Asked<'_, T> {
        type Output = Vec<[bool; 6]>;

        fn run<L: Lanes<T>>(self) -> Self::Output {
            let mut all = Vec::new();
            let (mut normals, mut alone) = (NormalLanes::empty(), NormalLanes::empty());
            for some in self.0.topology().surface_vertices().chunks(LANE_COUNT) {
                let Facing { along, against } = self.0.facing::<L>(some, &mut normals);
                self.0.vertex_normals::<L>(some, &mut alone);
                assert_eq!((normals.normal, normals.outward), (alone.normal, alone.outward));
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
        let mesh: Mesh<T> = torus_at([48, 12], 3);
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
