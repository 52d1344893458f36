//! Whenever two closed surfaces cross, at least one contact is reported. The judge is exact: an edge of one pierces a
//! triangle of the other, by predicates of exact sign on the very coordinates the library is given.

use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use robust::{Coord3D, orient3d};

/// Pairs drawn; debug builds are much slower.
const COUNT: u32 = if cfg!(debug_assertions) { 200 } else { 6000 };

/// A repeatable sequence (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Of any order of magnitude between the two.
    fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low.log10(), high.log10()))
    }
}

/// Coarse boxes, bars and plates, tetrahedra, spikes, stars and tori, turned anyhow.
fn shape(random: &mut Random) -> Shape {
    let kind = random.between(0.0, 5.0) as usize;
    let sides: Point = [0; 3].map(|_| if kind < 4 { random.magnitude(0.02, 1.0) } else { 1.0 });
    let shape = match kind {
        0 => shapes::cube(1),
        1 => shapes::cube(2),
        2 => shapes::tetrahedron(),
        3 => shapes::star(),
        _ => shapes::torus(8, 5, random.between(0.05, 0.6)),
    };
    let stretched = shape.map(|p| std::array::from_fn(|axis| p[axis] * sides[axis]));
    stretched.turned(random.between(0.0, 6.3), random.between(0.0, 6.3)).turned(random.between(0.0, 6.3), 0.0)
}

/// A vertex or the middle of an edge.
fn feature(shape: &Shape, random: &mut Random) -> Point {
    let triangle = shape.triangles[random.between(0.0, shape.triangles.len() as f64) as usize];
    let [a, b, c] = triangle.map(|vertex| shape.positions[vertex as usize]);
    let weights = match random.between(0.0, 3.0) as usize {
        0 => [1.0, 0.0, 0.0],
        1 => [0.3, 0.7, 0.0],
        _ => [0.2, 0.5, 0.3],
    };
    std::array::from_fn(|axis| a[axis] * weights[0] + b[axis] * weights[1] + c[axis] * weights[2])
}

/// The second with some point of it near some point of the first: from touching, almost, to far inside.
fn crossing(random: &mut Random) -> [Shape; 2] {
    let [a, b] = [shape(random), shape(random)];
    let (at, from, reach) = (feature(&a, random), feature(&b, random), random.magnitude(1e-6, 0.3));
    let by = std::array::from_fn(|axis| at[axis] - from[axis] + random.between(-reach, reach));
    [a, b.moved(by)]
}

/// Whether an edge of `a` goes through a triangle of `b`, from strictly one side to strictly the other, and strictly
/// within the triangle.
fn pierces<T: Scalar>(a: &Mesh<T>, b: &Mesh<T>) -> bool {
    let coord = |mesh: &Mesh<T>, vertex: u32| {
        let [x, y, z] = mesh.positions()[vertex as usize].map(T::to_f64).into();
        Coord3D { x, y, z }
    };
    let triangles: Vec<_> = b.topology().triangles().iter().map(|corners| corners.map(|v| coord(b, v))).collect();
    a.topology().edges().any(|edge| {
        let [from, to] = edge.vertices.map(|vertex| coord(a, vertex));
        triangles.iter().any(|&[p, q, r]| {
            let sides = [orient3d(p, q, r, from), orient3d(p, q, r, to)];
            let turns = [(p, q), (q, r), (r, p)].map(|(s, t)| orient3d(from, to, s, t));
            sides[0] * sides[1] < 0.0 && (turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0))
        })
    })
}

fn check<T: Scalar>(seed: u64) {
    let mut random = Random(seed);
    let (mut crossings, mut list) = (0, ContactList::default());
    for number in 0..COUNT {
        let meshes = crossing(&mut random).map(|shape| shape.try_mesh::<T>());
        // Rounded to single precision, a thin one may have no volume.
        let [Ok(a), Ok(b)] = meshes else { continue };
        if !pierces(&a, &b) && !pierces(&b, &a) {
            continue;
        }
        crossings += 1;
        let octrees = [Octree::new(&a), Octree::new(&b)];
        for sampling in [Sampling::default(), Sampling::Vertices, Sampling::Spacing(T::of(0.3))] {
            let options = DetectionOptions { sampling, ..DetectionOptions::default() };
            query_pair(&a, &octrees[0], &b, &octrees[1], &options, &mut list).expect("the octrees are fresh");
            crate::common::assert_every_ray_is_counted(&list);
            assert!(!list.is_empty(), "seed {seed}, pair {number}, {sampling:?}: {:?}", list.statistics);
        }
    }
    assert!(crossings > COUNT * 2 / 5, "{crossings} cross");
}

#[test]
fn surfaces_that_cross_are_reported_in_double_precision() {
    check::<f64>(1);
}

#[test]
fn surfaces_that_cross_are_reported_in_single_precision() {
    check::<f32>(2);
}
