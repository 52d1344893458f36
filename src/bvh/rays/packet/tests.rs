use super::*;
use crate::math::Vector3;
use crate::mesh::test_mesh::torus_at;
use crate::query::{Octree, Tracer};
use crate::simd::{Kernel, on_every_path};
use crate::triangle::{Hit, PreparedRay, Ray, TriangleTest};

const SIDES: [u32; 2] = [64, 24];

/// All packets of these rays, listing at most so many tiles.
#[derive(Clone, Copy)]
struct Asked<'a, T: Scalar> {
    tree: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    rays: &'a [Ray<T>],
    touched: &'a [[u32; 3]],
    most_listed: usize,
}

/// The hits of rays in packets, of rays one by one, and what is hidden.
type Answers<T> = (Vec<Option<Hit<T>>>, Vec<Option<Hit<T>>>, Vec<bool>);

impl<T: Scalar> Kernel<T> for Asked<'_, T> {
    type Output = Answers<T>;

    fn run<L: Lanes<T>>(self) -> Self::Output {
        let (mut packet, mut list) = (RayPacket::empty(), Candidates::listing(self.most_listed));
        let (mut found, mut hits, mut all_hidden) = (PacketHits::empty(), Vec::new(), Vec::new());
        for (rays, touched) in self.rays.chunks(LANE_COUNT).zip(self.touched.chunks(LANE_COUNT)) {
            packet.set_rays::<L>(rays);
            self.tree.nearest::<L>(self.mesh, &packet, &mut list, &mut found);
            hits.extend((0..rays.len()).map(|lane| found.get(lane)));
            let mut all_touched = [[0; LANE_COUNT]; 3];
            touched.iter().enumerate().for_each(|(lane, of_ray)| (0..3).for_each(|k| all_touched[k][lane] = of_ray[k]));
            let end = packet.t_max;
            let asked = packet.present;
            let hidden = self.tree.hidden::<L>(self.mesh, &packet, asked, &end, &all_touched, &mut list);
            all_hidden.extend((0..rays.len()).map(|lane| hidden >> lane & 1 == 1));
        }
        let alone = self.rays.iter().map(|&ray| self.tree.nearest_of_ray_on::<L>(self.mesh, ray));
        (hits, alone.collect(), all_hidden)
    }
}

/// Whether the ray leaves the mesh before its end through a triangle that does not have all the touched vertices.
fn is_hidden<T: Scalar>(tracer: &Tracer<T>, ray: &Ray<T>, touched: &[u32; 3]) -> bool {
    let prepared = PreparedRay::new(ray, TriangleTest::Watertight);
    let triangles = tracer.mesh().topology().triangles();
    triangles.iter().zip(0..).filter(|(corners, _)| !touched.iter().all(|vertex| corners.contains(vertex))).any(
        |(_, triangle)| {
            let hit = prepared.intersect(&tracer.mesh().corners(triangle), triangle);
            hit.is_some_and(|hit| hit.is_exit && hit.t < ray.t_max)
        },
    )
}

/// Rays of neighbours through the torus, along its faces and past it; and of vertices that lie anywhere, whose packets the
/// whole torus is in the box of; and of an image of it, seen from far away. With ends everywhere, and without.
fn rays<T: Scalar>(mesh: &Mesh<T>) -> (Vec<Ray<T>>, Vec<[u32; 3]>) {
    let count = mesh.positions().len() - 1;
    let (mut rays, mut touched) = (Vec::new(), Vec::new());
    for number in 0..3 * count {
        let vertex = if number < count { number } else { number * 1009 % count };
        let position = mesh.positions()[vertex];
        let towards = mesh.positions()[(number * 389 + 17) % count];
        let ring = position.xy().normalize();
        let inward = Vector3::new(ring.x, ring.y, T::zero()) - position;
        let direction = match number / 16 % 4 {
            0 => inward * T::of(4.0),
            1 => towards - position,
            2 => Vector3::new(T::zero(), T::of(if number % 2 == 0 { 1.0 } else { -1.0 }), T::zero()),
            _ => (towards - position).cross(&inward),
        };
        // From the surface, from below it, and past the torus.
        let origin = match number % 3 {
            0 => position,
            1 => position + inward * T::of(0.01),
            _ if number / 16 % 4 == 2 => position + Vector3::z() * T::of(2.0),
            _ => position + (towards - position) * T::of(0.2),
        };
        let (origin, direction) = if number < 2 * count {
            (origin, direction)
        } else {
            let eye = Vector3::new(T::of(7.0), T::of(-9.0), T::of(4.0));
            (eye, (position + inward * T::of(0.001) - eye) * T::of(0.25))
        };
        let t_max = T::of([f64::INFINITY, 1.0, 0.3, 5.0, 0.0][number / 7 % 5]);
        rays.push(Ray { origin, direction, t_max });
        touched.push([vertex as u32; 3]);
    }
    (rays, touched)
}

fn assert_same_either_way<T: Scalar>() {
    let mesh: Mesh<T> = torus_at(SIDES, 3);
    let octree = Octree::new(&mesh);
    let tracer = octree.tracer(&mesh).expect("it is new");
    let tree = Bvh::new(&mesh);
    let (rays, touched) = rays(&mesh);
    let expected: Vec<_> = rays.iter().map(|ray| tracer.nearest_hit_of_all(ray)).collect();
    let hidden: Vec<_> = rays.iter().zip(&touched).map(|(ray, touched)| is_hidden(&tracer, ray, touched)).collect();
    assert!(expected.iter().flatten().count() > 500 && expected.contains(&None));
    assert!(hidden.iter().filter(|&&is_hidden| is_hidden).count() > 200 && hidden.contains(&false));
    for most_listed in [0, 1, 30, usize::MAX] {
        let asked = Asked { tree: &tree, mesh: &mesh, rays: &rays, touched: &touched, most_listed };
        for (path, (hits, single, all_hidden)) in on_every_path::<T, _>(asked).into_iter().enumerate() {
            for (place, ray) in rays.iter().enumerate() {
                let found = (hits[place], single[place], all_hidden[place]);
                let right = (expected[place], expected[place], hidden[place]);
                assert_eq!(found, right, "path {path}, listing {most_listed}: {ray:?}");
            }
        }
    }
}

#[test]
fn lists_and_walks_find_the_same_to_the_bit() {
    assert_same_either_way::<f64>();
    assert_same_either_way::<f32>();
}
