use crate::bvh::Candidates;
use crate::math::{Scalar, Vector3};
use crate::memory;
use crate::query::crossings::winding_number;
use crate::query::octree::Tree;
use crate::query::point_order::{BLOCK, PointOrder};
use crate::query::tracer::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes, dispatch, lanes_of};
use crate::triangle::{Hit, Ray, RayPacket};

impl<T: Scalar> Tracer<'_, T> {
    /// How often the surface winds around a point: 0 outside, 1 inside, more where it folds over itself, negative where it is
    /// inside out. `None` where the surface is open, so that it has no inside, and where the point is not finite. On the
    /// surface, or so near that rounding decides, it is the number of one of the sides. `crossings` is scratch memory.
    pub fn winding_number(&self, point: &Vector3<T>, crossings: &mut Vec<Hit<T>>) -> Option<i32> {
        if self.mesh().is_open() || !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        if !self.mesh().aabb().contains(point) {
            return Some(0);
        }
        // Any direction will do: edges and vertices on the way are counted as if the ray passed beside them.
        self.crossings(&Ray::new(*point, Vector3::z()), crossings);
        Some(crossings.iter().map(Hit::sign).sum())
    }

    /// [`winding_number`](Self::winding_number) of each of many points, into `numbers`, which is cleared first.
    pub fn winding_numbers(&self, points: &[Vector3<T>], numbers: &mut Vec<Option<i32>>) {
        memory::refill_with(numbers, None, points.len());
        if !self.mesh().is_open() {
            dispatch::<T, _>(WindingNumbers { tracer: self, points, numbers });
        }
    }

    /// How often the surface winds around the start of each ray of a packet; the rays end outside. Triangles that have all of a
    /// ray's `touched` vertices do not count. `crossings` is scratch memory.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn windings_of_packet<L: Lanes<T>>(
        &self,
        packet: &RayPacket<T>,
        touched: &[[u32; LANE_COUNT]; 3],
        list: &mut Candidates<T>,
        crossings: &mut Vec<Hit<T>>,
        numbers: &mut [i32; LANE_COUNT],
    ) {
        match self.tree {
            Tree::Bvh(tree) => tree.windings::<L>(self.mesh(), packet, touched, list, numbers),
            Tree::PaperOctree(_) => self.windings_one_by_one(packet, touched, crossings, numbers),
        }
    }

    fn windings_one_by_one(
        &self,
        packet: &RayPacket<T>,
        touched: &[[u32; LANE_COUNT]; 3],
        crossings: &mut Vec<Hit<T>>,
        numbers: &mut [i32; LANE_COUNT],
    ) {
        for lane in lanes_of(packet.present) {
            let touched = [0, 1, 2].map(|corner| touched[corner][lane]);
            numbers[lane] = winding_number(self, &packet.ray(lane), touched, crossings);
        }
    }
}

/// [`Tracer::winding_numbers`] of a closed surface.
struct WindingNumbers<'a, 'b, T: Scalar> {
    tracer: &'a Tracer<'b, T>,
    points: &'a [Vector3<T>],
    numbers: &'a mut [Option<i32>],
}

impl<T: Scalar> Kernel<T> for WindingNumbers<'_, '_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tracer, points, numbers } = self;
        let (mut packet, mut list, mut crossings) = (RayPacket::empty(), Candidates::new(), Vec::new());
        for (points, numbers) in points.chunks(BLOCK).zip(numbers.chunks_mut(BLOCK)) {
            let order = PointOrder::new(points);
            let is_in_box = |&&place: &&u32| tracer.mesh().aabb().contains(&points[place as usize]);
            let mut inside = order.places().iter().filter(is_in_box);
            loop {
                let (mut places, mut rays, mut count) =
                    ([0; LANE_COUNT], [Ray::new(Vector3::zeros(), Vector3::z()); LANE_COUNT], 0);
                for (&place, lane) in inside.by_ref().take(LANE_COUNT).zip(0..) {
                    // Any direction will do: edges and vertices on the way are counted as if the ray passed beside them.
                    (places[lane], rays[lane].origin, count) = (place as usize, points[place as usize], lane + 1);
                }
                if count == 0 {
                    break;
                }
                packet.set_rays::<L>(&rays[..count]);
                let mut found = [0; LANE_COUNT];
                tracer.windings_of_packet::<L>(
                    &packet,
                    &[[u32::MAX; LANE_COUNT]; 3],
                    &mut list,
                    &mut crossings,
                    &mut found,
                );
                for (place, found) in places.into_iter().zip(found).take(count) {
                    numbers[place] = Some(found);
                }
            }
            for (point, number) in points.iter().zip(numbers) {
                if number.is_none() && point.iter().all(|x| x.is_finite()) {
                    *number = Some(0);
                }
            }
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::cuboid::CUBOID_FACES;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::{torus_positions, torus_triangles};
    use crate::query::octree::{Layout, Octree};
    use crate::simd::on_every_path;

    /// Packets of rays from these vertices, against and along each axis and the other way.
    #[derive(Clone, Copy)]
    struct Asked<'a, T: Scalar> {
        tracer: &'a Tracer<'a, T>,
        vertices: &'a [u32],
        directions: &'a [Vector3<T>],
    }

    impl<T: Scalar> Kernel<T> for Asked<'_, T> {
        type Output = Vec<i32>;

        fn run<L: Lanes<T>>(self) -> Vec<i32> {
            let mut packet = RayPacket::empty();
            let (mut list, mut crossings, mut all) = (Candidates::new(), Vec::new(), Vec::new());
            for direction in self.directions {
                for vertices in self.vertices.chunks(LANE_COUNT) {
                    let (mut touched, mut numbers) = ([0; LANE_COUNT], [9; LANE_COUNT]);
                    let mesh = self.tracer.mesh();
                    let rays: Vec<_> = vertices.iter().map(|&v| Ray::new(mesh.position(v), *direction)).collect();
                    touched[..vertices.len()].copy_from_slice(vertices);
                    packet.set_rays::<L>(&rays);
                    self.tracer.windings_of_packet::<L>(
                        &packet,
                        &[touched; 3],
                        &mut list,
                        &mut crossings,
                        &mut numbers,
                    );
                    all.extend(&numbers[..vertices.len()]);
                }
            }
            all
        }
    }

    /// The sum of the signs of all crossings, triangle by triangle.
    fn expected<T: Scalar>(mesh: &Mesh<T>, vertex: u32, direction: &Vector3<T>) -> i32 {
        let ray = crate::triangle::ShearedRay::new(&Ray::new(mesh.position(vertex), *direction));
        let others = (0..).zip(mesh.topology().triangles()).filter(|(_, corners)| !corners.contains(&vertex));
        let crossed = others.filter_map(|(triangle, _)| ray.crossing(&mesh.corners(triangle), triangle));
        crossed.map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum()
    }

    fn assert_same_on_all_paths<T: Scalar>(positions: &[[f64; 3]], triangles: &[[u32; 3]]) {
        let positions: Vec<_> = positions.iter().map(|point| point.map(T::of)).collect();
        let mesh = Mesh::new(&positions, triangles).expect("it is closed");
        let vertices: Vec<_> = mesh.topology().surface_vertices().iter().copied().take(100).collect();
        let ways = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [1.0, -1.0, 1.0], [0.3, 0.5, -0.7]];
        let directions = ways.map(|way| Vector3::from(way.map(T::of)));
        let all = directions.iter().flat_map(|way| vertices.iter().map(|&vertex| expected(&mesh, vertex, way)));
        let all: Vec<_> = all.collect();
        assert!(all.contains(&0) && all.contains(&1));
        for layout in [Layout::Bvh, Layout::PaperOctree] {
            let octree = Octree::with_layout(&mesh, layout);
            let tracer = octree.tracer(&mesh).expect("it is new");
            let asked = Asked { tracer: &tracer, vertices: &vertices, directions: &directions };
            for (path, found) in on_every_path::<T, _>(asked).into_iter().enumerate() {
                assert_eq!(found, all, "{layout:?}, path {path}");
            }
        }
    }

    /// Of cubes on one grid, rays go along faces and through edges and vertices.
    #[test]
    fn packets_count_every_crossing_on_all_paths() {
        let at = |i: usize| [0, 1, 2].map(|axis| (((i % 8) >> axis) & 1) as f64 + (i / 8) as f64 * 0.5);
        let cubes: Vec<_> = (0..32).map(at).collect();
        let faces: Vec<_> = (0..4).flat_map(|cube| CUBOID_FACES.map(|face| face.map(|v| v + 8 * cube))).collect();
        assert_same_on_all_paths::<f64>(&cubes, &faces);
        assert_same_on_all_paths::<f32>(&cubes, &faces);
        let sides = [48, 12];
        assert_same_on_all_paths::<f64>(&torus_positions(sides, 3), &torus_triangles(sides));
        assert_same_on_all_paths::<f32>(&torus_positions(sides, 3), &torus_triangles(sides));
    }
}
