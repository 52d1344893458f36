//! How near two triangles of one body are.

use crate::math::{Aabb, Scalar, Vector3, length, margins};
use crate::mesh::Mesh;
use crate::self_contact::near_triangles::is_merged;

/// How far positions may be off as rays see them: projections, hits and the rays' origins are each rounded to a few units of
/// the largest coordinate.
pub(crate) fn rounding<T: Scalar>(mesh: &Mesh<T>) -> T {
    mesh.aabb().lower.amax().max(mesh.aabb().upper.amax()) * margins::margin(margins::SEEN_POSITION)
}

/// Triangles closer than this touch.
pub(crate) fn touch_distance<T: Scalar>(mesh: &Mesh<T>) -> T {
    rounding(mesh) * T::of(margins::TOUCH)
}

/// How near two triangles without a common vertex are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Nearness {
    Apart,
    /// Their boxes overlap.
    Close,
    Touching,
}

/// How near two triangles are. Triangles that cannot touch, as they share a vertex or are merged, count as apart.
pub(crate) fn nearness<T: Scalar>(mesh: &Mesh<T>, pair: [u32; 2]) -> Nearness {
    let touch = touch_distance(mesh);
    // Not by `map`, which the compiler does not inline here and which took half of the time.
    let corners = [mesh.corners(pair[0]), mesh.corners(pair[1])];
    let [a, b] = [Aabb::of_triangle(&corners[0]), Aabb::of_triangle(&corners[1])];
    let [first, second] = [0, 1].map(|side| mesh.topology().triangles()[pair[side] as usize]);
    let may_touch = a.grown(touch).overlaps(&b)
        && !corners.iter().any(is_merged)
        && !first.iter().any(|vertex| second.contains(vertex));
    match may_touch {
        false => Nearness::Apart,
        true if separation(&corners, touch) < touch => Nearness::Touching,
        true => Nearness::Close,
    }
}

/// A lower bound of the distance of two triangles, by planes between them; 0 where no plane parts them. The search
/// ends where `enough` is found.
#[inline]
pub(crate) fn separation<T: Scalar>(corners: &[[Vector3<T>; 3]; 2], enough: T) -> T {
    let [a, b] = corners;
    // The line of centres nearly always parts them.
    let best = gap_along(corners, &((b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2])));
    if best < enough { separation_along_any(corners, best, enough) } else { best }
}

#[cold]
fn separation_along_any<T: Scalar>(corners: &[[Vector3<T>; 3]; 2], mut best: T, enough: T) -> T {
    let [a, b] = corners;
    let edge = |corners: &[Vector3<T>; 3], i: usize| corners[(i + 1) % 3] - corners[i];
    for number in 0..14 {
        if best >= enough {
            break;
        }
        let axis = match number {
            0 | 1 => (corners[number][1] - corners[number][0]).cross(&(corners[number][2] - corners[number][0])),
            2..11 => edge(a, (number - 2) / 3).cross(&edge(b, (number - 2) % 3)),
            // The axes of the boxes come last, since the boxes nearly always overlap. They matter where only the rounded boxes,
            // by which triangles are offered, do.
            _ => Vector3::ith(number - 11, T::one()),
        };
        best = best.max(gap_along_either(corners, &axis));
    }
    best
}

/// How far the second triangle lies beyond the first along an axis; 0 where it does not.
#[inline]
fn gap_along<T: Scalar>(corners: &[[Vector3<T>; 3]; 2], axis: &Vector3<T>) -> T {
    let gap = projected_gap(corners, axis);
    if gap > T::zero() { gap / length(axis) } else { T::zero() }
}

/// How far either triangle lies beyond the other along an axis or its reverse; 0 where none does.
#[inline]
fn gap_along_either<T: Scalar>([a, b]: &[[Vector3<T>; 3]; 2], axis: &Vector3<T>) -> T {
    let along = |corner: &Vector3<T>| (corner - a[0]).dot(axis);
    let (a, b) = ([T::zero(), along(&a[1]), along(&a[2])], b.each_ref().map(along));
    let larger = |x: T, y: T| if x > y { x } else { y };
    let smaller = |x: T, y: T| if x < y { x } else { y };
    let upper = |[x, y, z]: [T; 3]| larger(larger(y, z), x);
    let lower = |[x, y, z]: [T; 3]| smaller(smaller(y, z), x);
    let beyond = [lower(b) - upper(a), lower(a) - upper(b)];
    beyond.into_iter().find(|gap| *gap > T::zero()).map_or(T::zero(), |gap| gap / length(axis))
}

/// How far the second triangle lies beyond the first, times the axis' length; 0 or less where it does not.
#[inline]
pub(crate) fn projected_gap<T: Scalar>([a, b]: &[[Vector3<T>; 3]; 2], axis: &Vector3<T>) -> T {
    let along = |corner: &Vector3<T>| (corner - a[0]).dot(axis);
    let beyond = |x: T, y: T| if x > y { x } else { y };
    let end = beyond(beyond(along(&a[1]), along(&a[2])), T::zero());
    let start = -beyond(beyond(-along(&b[0]), -along(&b[1])), -along(&b[2]));
    start - end
}
