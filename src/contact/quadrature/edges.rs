use crate::contact::point_pair::SurfacePoint;
use crate::contact::quadrature::sample::Sample;
use crate::math::{Aabb, Scalar, Vector3, direction, length};
use crate::mesh::{Edge, Mesh, Side};
use crate::query::Tracer;
use crate::self_contact::rounding;
use crate::triangle::{Hit, Ray};

/// Offers a sample in the middle of each stretch of an edge that lies inside the other mesh, with the length of the stretch.
/// Two surfaces cross if and only if an edge of one pierces a triangle of the other; edges between triangles of one plane can
/// be left out. The sample's normal is the mean of the two faces', its area a third of theirs times the fraction of the edge
/// inside. The lists are scratch memory.
pub(crate) fn for_each_inside_stretch<T: Scalar>(
    tracers: [&Tracer<'_, T>; 2],
    region: &Aabb<T>,
    lists: (&mut Vec<u32>, &mut Vec<u64>),
    (sides, crossings): (&mut Vec<Side>, &mut Vec<Hit<T>>),
    mut offer: impl FnMut(Sample<T>, T),
) {
    let mesh = tracers[0].mesh();
    let mut look = |edge: Edge| {
        let [from, to] = edge.vertices.map(|vertex| mesh.position(vertex));
        let segment_box = Aabb { lower: from.inf(&to), upper: from.sup(&to) };
        if !segment_box.overlaps(region) {
            return;
        }
        tracers[1].crossings(&Ray::new(from, to - from).until(T::one()), crossings);
        let mut number = 0;
        for_each_inside_interval(crossings, |start, end| {
            if let Some(sample) = middle_of_stretch(mesh, &edge, [start, end], number) {
                offer(sample, length(&(to - from)) * (end - start));
            }
            number += 1;
        });
    };
    let topology = mesh.topology();
    tracers[0].vertices_near(region, lists, |vertex| topology.edges_from(vertex, sides).for_each(&mut look));
}

/// Offers the intervals of [0, 1] that lie inside, for the crossings of a segment in their order.
fn for_each_inside_interval<T: Scalar>(crossings: &[Hit<T>], mut offer: impl FnMut(T, T)) {
    let change = |crossing: &Hit<T>| if crossing.is_exit { -1 } else { 1 };
    // A segment that has left more often than it has entered started inside.
    let (_, lowest) = crossings.iter().fold((0, 0), |(depth, lowest): (i32, i32), crossing| {
        let depth = depth + change(crossing);
        (depth, lowest.min(depth))
    });
    let mut depth = -lowest;
    let mut start = T::zero();
    for crossing in crossings {
        let before = depth;
        depth += change(crossing);
        if before == 0 {
            start = crossing.t;
        } else if depth == 0 {
            offer(start, crossing.t);
        }
    }
    if depth > 0 && !crossings.is_empty() {
        offer(start, T::one());
    }
}

/// `None` where a triangle has no normal, and where both lie in one plane: where the far corner of one is within rounding of
/// the other's plane.
fn middle_of_stretch<T: Scalar>(mesh: &Mesh<T>, edge: &Edge, [start, end]: [T; 2], number: u32) -> Option<Sample<T>> {
    let half = T::of(0.5);
    let along = (start + end) * half;
    let [from, to] = edge.vertices.map(|vertex| mesh.position(vertex));
    let scaled_normals = edge.triangles.map(|triangle| mesh.scaled_normal(triangle));
    let doubled_area = length(&scaled_normals[0]) + length(&scaled_normals[1]);
    let normals = [direction(&scaled_normals[0])?, direction(&scaled_normals[1])?];
    let normal = direction(&(normals[0] + normals[1]))?;
    let reach = |corner: Vector3<T>| normals[0].dot(&(corner - from)).abs();
    let height = mesh.corners(edge.triangles[1]).map(reach).into_iter().fold(T::zero(), |most, reach| most.max(reach));
    if height <= rounding(mesh) && normals[0].dot(&normals[1]) > T::zero() {
        return None;
    }
    let triangle = edge.triangles[0];
    let corners = mesh.topology().triangles()[triangle as usize];
    let side = corners.iter().position(|corner| !edge.vertices.contains(corner))?;
    let weights = corners.map(|corner| match corner {
        corner if corner == edge.vertices[0] => T::one() - along,
        corner if corner == edge.vertices[1] => along,
        _ => T::zero(),
    });
    let point = SurfacePoint { triangle, vertices: corners, weights, position: from + (to - from) * along };
    let piece = 3 * number + side as u32;
    Some(Sample { point, normal, area: doubled_area * (end - start) / T::of(6.0), piece, distance: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts of [0, 1] inside, for crossings at these t: +1 enters, −1 leaves.
    fn inside(crossings: &[(f64, i32)]) -> Vec<[f64; 2]> {
        let hit = |&(t, change): &(f64, i32)| Hit { triangle: 0, t, weights: [0.0; 3], is_exit: change < 0 };
        let (hits, mut found): (Vec<_>, _) = (crossings.iter().map(hit).collect(), Vec::new());
        for_each_inside_interval(&hits, |start, end| found.push([start, end]));
        found
    }

    /// The judge: how deep a point lies, told by the crossings before it, and at least 0 all along.
    fn depth_at(crossings: &[(f64, i32)], t: f64) -> i32 {
        let sums = crossings.iter().scan(0, |sum, (_, change)| {
            *sum += change;
            Some(*sum)
        });
        let started_at = -sums.min().unwrap_or(0).min(0);
        started_at + crossings.iter().filter(|crossing| crossing.0 < t).map(|crossing| crossing.1).sum::<i32>()
    }

    /// Every row of up to six entries and exits.
    #[test]
    fn intervals_are_where_the_depth_is_not_zero() {
        for (count, signs) in (1..=6).flat_map(|count| (0..1 << count).map(move |signs| (count, signs))) {
            let change = |place: i32| if signs >> place & 1 == 1 { 1 } else { -1 };
            let crossings: Vec<_> = (0..count).map(|k| (f64::from(k + 1) / f64::from(count + 1), change(k))).collect();
            let found = inside(&crossings);
            assert!(found.iter().all(|[start, end]| start < end) && found.is_sorted_by(|a, b| a[1] < b[0]));
            for piece in 0..=count {
                let middle = (f64::from(piece) + 0.5) / f64::from(count + 1);
                let is_inside = found.iter().any(|[start, end]| *start < middle && middle < *end);
                assert_eq!(is_inside, depth_at(&crossings, middle) > 0, "{crossings:?} at {middle}");
            }
        }
        assert!(inside(&[]).is_empty());
    }

    #[test]
    fn a_stretch_stands_for_its_part_of_a_third_of_both_faces() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 6.0]];
        let mesh = Mesh::<f64>::new(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).expect("it is closed");
        let mut edges = mesh.topology().edges();
        let edge =
            edges.find(|edge| edge.vertices.contains(&0) && edge.vertices.contains(&1)).expect("it has that edge");
        let sample = middle_of_stretch(&mesh, &edge, [0.25, 0.75], 0).expect("its faces have normals");
        // Faces of areas 4 and 6 meet at a right angle.
        assert!((sample.area - 0.5 * 10.0 / 3.0).abs() < 1e-14);
        assert!((sample.normal + Vector3::new(0.0, 0.5f64.sqrt(), 0.5f64.sqrt())).norm() < 1e-14);
        let sample = middle_of_stretch(&mesh, &edge, [0.0, 0.5], 0).expect("its faces have normals");
        let from_first = if edge.vertices[0] == 0 { 0.5 } else { 1.5 };
        assert_eq!(
            (sample.point.position, sample.point.weights),
            (Vector3::new(from_first, 0.0, 0.0), [0.75, 0.25, 0.0])
        );
        let (mut named, mut corners) =
            (sample.point.vertices, mesh.topology().triangles()[sample.point.triangle as usize]);
        named.sort();
        corners.sort();
        assert_eq!(named, corners);
        let weighted = (0..3).map(|i| mesh.position(sample.point.vertices[i]) * sample.point.weights[i]);
        assert_eq!(weighted.sum::<Vector3<f64>>(), sample.point.position);
    }
}
