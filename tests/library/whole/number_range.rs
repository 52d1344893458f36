//! Lengths whose products leave the range of numbers.

use crate::common::cuboid::CUBOID_FACES;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::triangle::{Hit, Ray, ShearedRay, moller_trumbore};

/// A ray from one vertex of a body of 10⁻⁹ that passes a triangle nearly along its edge: the edge functions are 10⁻³²,
/// and a length times one of them is below the smallest normal number. Its `t` was off by 42 rounding units of the
/// reach. Found by the oracle: seed 2008, batch 74994, ray 207.
#[test]
fn t_and_weights_of_a_tiny_triangle_seen_edge_on_name_one_point() {
    let point = |bits: [u32; 3]| Vector3::from(bits.map(f32::from_bits));
    let ray = Ray::new(point([0x31281844, 0xb12a6db4, 0x30fd12d4]), point([0xbee8e4fa, 0x3f12d575, 0x3f2e66c7]));
    let corners = [
        point([0xaf6f026d, 0xb166a3e8, 0x305c14f4]),
        point([0x30953698, 0xb0522df4, 0x318546c1]),
        point([0xb0d8da3d, 0xb0e18362, 0x31430955]),
    ];
    let hit = ShearedRay::new(&ray).intersect(&corners, 11).expect("the ray meets it at a corner");

    // In f64 the rounding of this check itself does not count.
    let [origin, direction] = [ray.origin, ray.direction].map(|vector| vector.cast::<f64>());
    let reaches = corners.map(|corner| corner.cast::<f64>() - origin);
    let on_triangle: Vector3<f64> = (0..3).map(|corner| reaches[corner] * f64::from(hit.weights[corner])).sum();
    let reach = reaches.iter().map(Vector3::amax).fold(0.0, f64::max);
    let units = (on_triangle - direction * f64::from(hit.t)).amax() / (reach * f64::from(f32::EPSILON) / 2.0);
    assert!(units <= 32.0, "t and weights differ by {units} rounding units of the reach");
}

/// Twice the area is 2.6 · 10³⁰⁸, of which each edge function is a third: it was a hit at the ray's origin, with weights of
/// zero.
#[test]
fn a_triangle_whose_area_overflows_is_not_met() {
    let corners = [0.0, 1.0, 2.0].map(|third| {
        let (sin, cos) = (third * std::f64::consts::TAU / 3.0).sin_cos();
        Vector3::new(1e154 * cos, 1e154 * sin, 1.0)
    });
    let ray = Ray::new(Vector3::zeros(), Vector3::z());
    assert_eq!(ShearedRay::new(&ray).intersect(&corners, 0), None);
    assert_eq!(ShearedRay::new(&ray).crossing(&corners, 0), None);
    assert_eq!(moller_trumbore(&ray, &corners, 0), None);
    let smaller = corners.map(|corner| Vector3::new(corner.x / 2.0, corner.y / 2.0, 1.0));
    let hit = ShearedRay::new(&ray).intersect(&smaller, 0).expect("the ray meets its middle");
    assert!((hit.t - 1.0).abs() < 1e-15 && hit.weights.iter().all(|weight| (weight - 1.0 / 3.0).abs() < 1e-15));
}

/// The same, found by the fuzz target `differential`: among all triangles there was such a hit, in the octrees none.
#[test]
fn octrees_and_all_triangles_agree_where_areas_overflow() {
    let start = [
        [-3.5, 3.5, -2.875],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-0.90625, -0.90625, -0.90625],
        [-0.90625, -0.90625, 1.21875],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    let shifts = [-0.90625, 0.0, -1.0866673596175315e308, 1.1875, -3.65625, -0.03125, -1.468793024018605e173, -0.90625];
    let ray = Ray::new(
        Vector3::new(-0.03125, -1.0866673596175315e308, 1.1875),
        Vector3::new(-0.03125, -1.0737201067890185e308, 1.21875),
    );
    let mut mesh = Mesh::open(&start, &CUBOID_FACES).expect("a cuboid pulled about");
    let moved: Vec<_> = start.iter().zip(shifts).map(|([x, y, z], shift)| [x + shift, *y, *z]).collect();
    mesh.set_positions(&moved).expect("finite");
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let tracer = octree.tracer(&mesh).expect("the octree is fresh");
        let (mut hits, expected) = (Vec::new(), tracer.nearest_hit_of_all(&ray));
        tracer.nearest_hits(&[ray], &mut hits);
        assert_eq!((tracer.nearest_hit(&ray), hits[0]), (expected, expected), "{layout:?}");
    }
}

/// What the octrees and all triangles find of a ray alone, and of it in a packet with others like it.
fn assert_same_in_octrees<T: Scalar>(mesh: &Mesh<T>, ray: Ray<T>) -> Option<Hit<T>> {
    let mut expected = None;
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(mesh, layout);
        let tracer = octree.tracer(mesh).expect("the octree is fresh");
        expected = tracer.nearest_hit_of_all(&ray);
        assert_eq!(tracer.nearest_hit(&ray), expected, "{layout:?}, {ray:?}");
        let mut hits = Vec::new();
        tracer.nearest_hits(&[ray; 16], &mut hits);
        assert_eq!(hits, [expected; 16], "{layout:?}, {ray:?}");
    }
    expected
}

/// A ray that lies in a face and comes from so far away, that where it leaves the face's box, a stand-in for infinity, was
/// before where it meets the box. Found by the fuzz target `differential`.
#[test]
fn rays_in_a_face_are_not_lost_from_far_away() {
    let mut start: Vec<_> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(f64::from)).collect();
    start.extend((0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(f64::from)).map(|[x, y, z]| {
        if [x, y, z] == [0.0, 1.0, 0.0] { [1.3125; 3] } else { [x - 0.09375, y + 1.3125, z + 1.3125] }
    }));
    let shifts = [
        1.3125, -1.0625, -1.0625, -1.0625, -1.0625, 1.3125, 1.3125, 1.3125, 1.3125, -1.0625, -1.0625, 1.3125, 1.3125,
        -0.46875, 1.3125, 1.3125,
    ];
    let triangles = [0, 8].map(|first| CUBOID_FACES.map(|corners| corners.map(|corner| corner + first))).concat();
    let mut mesh = Mesh::new(&start, &triangles).expect("two cubes, one pulled about");
    let moved: Vec<_> = start.iter().zip(shifts).map(|([x, y, z], shift)| [x + shift, *y, *z]).collect();
    mesh.set_positions(&moved).expect("finite");
    let origin = Vector3::new(-1.0378369609580543e294, 1.3125, 1.3125);
    let hit = assert_same_in_octrees(&mesh, Ray::new(origin, Vector3::new(3.9375, 0.0, 0.0)));
    assert_eq!(hit.expect("it meets a vertex").t, 2.63577640878236e293);
}

/// The same by the length of what a ray and a cube have in common: along a face from all distances, of all lengths.
fn assert_rays_in_a_face_are_found<T: Scalar>(exponents: i32) {
    let (mut met, mut asked) = (0, 0);
    for size in (-exponents..=exponents).step_by(exponents as usize / 8) {
        let size = 2.0_f64.powi(size);
        let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|x| T::of(x as f64 * size));
        let Ok(mesh) = Mesh::new(&(0..8).map(corner).collect::<Vec<_>>(), &CUBOID_FACES) else { continue };
        for length in (-exponents..=exponents).step_by(exponents as usize / 16) {
            for distance in [0.5, 3.0, 2.0_f64.powi(exponents - 1) / size] {
                let from = Vector3::new(-distance * size, 0.25 * size, size).map(T::of);
                for height in [T::zero(), from.z] {
                    let origin = Vector3::new(from.x, from.y, height);
                    let direction = Vector3::x() * T::of(2.0_f64.powi(length));
                    asked += 1;
                    met += usize::from(assert_same_in_octrees(&mesh, Ray::new(origin, direction)).is_some());
                }
            }
        }
    }
    assert!(asked > 500 && met > asked / 4, "{met} of {asked} rays met a cube");
}

#[test]
fn rays_in_a_face_are_found_at_all_lengths() {
    assert_rays_in_a_face_are_found::<f64>(1000);
    assert_rays_in_a_face_are_found::<f32>(120);
}
