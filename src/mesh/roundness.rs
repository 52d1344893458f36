use super::Topology;
use crate::math::{Scalar, Vector3, normalising_factor};

/// Up to the first angle between two faces, in degrees, their edge belongs to a smooth surface; from the second on it is an edge
/// of a body with faces. Between the two it is partly either, so that no rounding decides.
const CREASES: [f64; 2] = [50.0, 70.0];

/// How round a surface is, and how large.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roundness {
    /// Its mean curvature, averaged over the area and without the edges between faces, times the radius of the ball with the same
    /// area. 1 for a ball, 0 for a body with flat faces; bulges and dents cancel out. Independent of size and triangulation.
    pub(crate) of_unit: f64,
    /// In m².
    pub(crate) area: f64,
    /// Its volume over its area, in m. Infinite for an open surface.
    pub(crate) half_thickness: f64,
}

pub(crate) fn roundness<T: Scalar>(topology: &Topology, positions: &[Vector3<T>]) -> Roundness {
    // In a scale in which nothing overflows.
    let largest = positions.iter().fold(T::zero(), |largest, position| largest.max(position.amax()));
    let (factor, _) = normalising_factor(largest);
    let at = |vertex: u32| (positions[vertex as usize] * factor).map(Scalar::to_f64);
    let doubled_area = |triangle: u32| {
        let [a, b, c] = topology.triangles()[triangle as usize].map(at);
        (b - a).cross(&(c - a))
    };
    let area: f64 = (0..topology.triangles().len() as u32).map(|triangle| 0.5 * doubled_area(triangle).norm()).sum();
    let base = at(0);
    let six_fold = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| at(vertex) - base);
        a.dot(&b.cross(&c))
    };
    let volume = topology.triangles().iter().map(six_fold).sum::<f64>() / 6.0;
    let [smooth, crease] = CREASES.map(f64::to_radians);
    let mut bent = 0.0;
    for edge in topology.edges() {
        let [first, second] = edge.triangles.map(doubled_area);
        let [from, to] = edge.vertices.map(at);
        let angle = first.cross(&second).norm().atan2(first.dot(&second));
        let part = ((crease - angle) / (crease - smooth)).clamp(0.0, 1.0);
        let corners = topology.triangles()[edge.triangles[1] as usize];
        let bulge = corners.map(|corner| -first.dot(&(at(corner) - from))).into_iter().sum::<f64>();
        bent += angle.copysign(bulge) * part * (to - from).norm();
    }
    // Of a ball the lengths of the edges times their angles sum to 8 π r, and the area is 4 π r².
    let of_unit = bent.abs() / (4.0 * (std::f64::consts::PI * area).sqrt());
    let factor = factor.to_f64();
    Roundness {
        of_unit: if of_unit.is_finite() { of_unit } else { 0.0 },
        area: area / factor / factor,
        half_thickness: if topology.is_open() { f64::INFINITY } else { volume.abs() / area / factor },
    }
}

#[cfg(test)]
mod tests {
    use super::Roundness;
    use crate::cuboid::CUBOID_FACES;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::torus;
    use crate::shapes;

    #[test]
    fn balls_are_round_and_boxes_are_not() {
        for (levels, margin) in [(1, 0.07), (2, 0.02), (4, 0.001)] {
            for radius in [1e-9, 1.0, 1e9] {
                let Roundness { of_unit, area, half_thickness } =
                    shapes::sphere(levels).scaled(radius).moved([5.0 * radius; 3]).mesh::<f64>().roundness();
                assert!((half_thickness / radius * 3.0 - 1.0).abs() < margin, "{levels} levels: {half_thickness}");
                assert!((of_unit - 1.0).abs() < margin, "{levels} levels: {of_unit}");
                let whole = 4.0 * std::f64::consts::PI * radius * radius;
                assert!((area / whole - 1.0).abs() < 2.0 * margin, "{levels} levels: {area} of {whole}");
            }
        }
        let corners: Vec<_> = (0..8).map(|k| [f64::from(k & 1), f64::from(k & 2), f64::from(k & 4) * 0.1]).collect();
        assert_eq!(Mesh::new(&corners, &CUBOID_FACES).expect("it is closed").roundness().of_unit, 0.0);
        // ∫ 2 H dA of a torus with the radii 1 and r is 4 π², its area 4 π² r.
        let (tube, pi) = (0.3f64, std::f64::consts::PI);
        let expected = 4.0 * pi * pi / (4.0 * (pi * 4.0 * pi * pi * tube).sqrt());
        let roundness = torus([96, 48]).roundness().of_unit;
        assert!((roundness / expected - 1.0).abs() < 0.01, "{roundness} {expected}");
    }

    /// The reference positions tell, in whatever pose.
    #[test]
    fn what_is_bent_later_is_as_round_as_before() {
        let mut mesh = torus([24, 12]);
        let before = mesh.clone().roundness().of_unit;
        let flat: Vec<[f64; 3]> = mesh.positions().iter().map(|p| [p.x, p.y, p.z * 0.1]).collect();
        mesh.set_positions(&flat).expect("finite");
        assert_eq!(mesh.roundness().of_unit.to_bits(), before.to_bits());
        let other = Mesh::new(&flat, mesh.topology().triangles()).expect("it is closed");
        let after = other.roundness().of_unit;
        assert!((after - before).abs() > 0.1, "{after}");
    }
}
