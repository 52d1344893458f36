use super::SurfacePoint;
use super::samples::Sample;
use crate::math::{Aabb, Scalar, direction, length};
use crate::mesh::{Edge, Mesh};
use crate::octree::Tracer;
use crate::ray::{Hit, Ray};

/// Offers a sample in the middle of each stretch of an edge that lies inside the other mesh, where the edge pierces
/// its surface: two surfaces cross if and only if an edge of one pierces a triangle of the other. Its normal is the
/// mean of the two faces', its area their third, as far as the edge is inside.
pub(super) fn for_each_inside_stretch<T: Scalar>(
    tracers: [&Tracer<'_, T>; 2],
    region: &Aabb<T>,
    crossings: &mut Vec<Hit<T>>,
    mut offer: impl FnMut(Sample<T>),
) {
    let mesh = tracers[0].mesh();
    for edge in mesh.topology().edges() {
        let [from, to] = edge.vertices.map(|vertex| mesh.positions()[vertex as usize]);
        let segment_box = Aabb { lower: from.inf(&to), upper: from.sup(&to) };
        if !segment_box.overlaps(region) {
            continue;
        }
        tracers[1].crossings(&Ray::new(from, to - from).until(T::one()), crossings);
        for_each_inside_interval(crossings, |start, end| {
            if let Some(sample) = middle_of_stretch(mesh, edge, start, end) {
                offer(sample);
            }
        });
    }
}

/// Offers the parts of [0, 1] that lie inside, for the crossings of a segment in their order.
fn for_each_inside_interval<T: Scalar>(crossings: &[Hit<T>], mut offer: impl FnMut(T, T)) {
    let change = |crossing: &Hit<T>| if crossing.is_exit { -1 } else { 1 };
    // A segment that leaves more often than it has entered started inside.
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

fn middle_of_stretch<T: Scalar>(mesh: &Mesh<T>, edge: &Edge, start: T, end: T) -> Option<Sample<T>> {
    let half = T::of(0.5);
    let along = (start + end) * half;
    let [from, to] = edge.vertices.map(|vertex| mesh.positions()[vertex as usize]);
    let scaled_normals = edge.triangles.map(|triangle| mesh.scaled_normal(triangle));
    let doubled_area = length(&scaled_normals[0]) + length(&scaled_normals[1]);
    let normal = direction(&(direction(&scaled_normals[0])? + direction(&scaled_normals[1])?))?;
    let triangle = edge.triangles[0];
    let corners = mesh.topology().triangles()[triangle as usize];
    let third = *corners.iter().find(|corner| !edge.vertices.contains(corner))?;
    let point = SurfacePoint {
        triangle,
        vertices: [edge.vertices[0], edge.vertices[1], third],
        weights: [T::one() - along, along, T::zero()],
        position: from + (to - from) * along,
    };
    Some(Sample { point, normal, area: doubled_area * (end - start) / T::of(6.0) })
}
