//! Lengths far below one, whose products with areas leave the range of `f32`.

use raycontact::math::Vector3;
use raycontact::ray::{Ray, ShearedRay};

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
