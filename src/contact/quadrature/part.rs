//! A convex part of a triangle, in the triangle's barycentric weights, cut by planes.

use crate::math::{Scalar, Vector3, length};

/// A triangle cut by five planes has eight corners. Where rounding decides on which side each corner lies, a cut may leave up
/// to half as many again: 3, 4, 6, 9, 13, 19.
const MOST_CORNERS: usize = 19;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<T: Scalar> {
    /// The weights of each corner, in order around the part.
    pub(crate) weights: [Vector3<T>; MOST_CORNERS],
    pub(crate) count: usize,
}

/// A plane, with the unit vector into what it leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<T: Scalar> {
    pub(crate) point: Vector3<T>,
    pub(crate) inward: Vector3<T>,
}

impl<T: Scalar> Plane<T> {
    pub(crate) fn depth(&self, at: &Vector3<T>) -> T {
        (at - self.point).dot(&self.inward)
    }
}

/// What a plane leaves of a part.
pub(crate) enum Cut<T: Scalar> {
    All,
    Some(Part<T>),
    Nothing,
}

fn position<T: Scalar>([a, b, c]: &[Vector3<T>; 3], weights: &Vector3<T>) -> Vector3<T> {
    a * weights.x + b * weights.y + c * weights.z
}

impl<T: Scalar> Part<T> {
    /// Without a corner.
    pub(crate) fn none() -> Self {
        Self { weights: [Vector3::zeros(); MOST_CORNERS], count: 0 }
    }

    /// The triangle with these weights.
    pub(crate) fn whole(weights: &[Vector3<T>; 3]) -> Self {
        let mut all = [Vector3::zeros(); MOST_CORNERS];
        all[..3].copy_from_slice(weights);
        Self { weights: all, count: 3 }
    }

    /// The triangles from the first corner to each edge: the sum of their weights, and their doubled area as a part of the
    /// triangle's.
    fn fan(&self) -> impl Iterator<Item = (Vector3<T>, T)> {
        let first = self.weights[0];
        self.weights[1..self.count].windows(2).map(move |pair| {
            let [b, c] = [pair[0], pair[1]].map(|corner| corner - first);
            (first + pair[0] + pair[1], b.x * c.y - b.y * c.x)
        })
    }

    /// As a part of the doubled area of the triangle.
    pub(crate) fn doubled_area(&self) -> T {
        self.fan().fold(T::zero(), |sum, (_, doubled_area)| sum + doubled_area)
    }

    /// The centre of area: where it is, and its weights.
    pub(crate) fn middle(&self, corners: &[Vector3<T>; 3]) -> (Vector3<T>, Vector3<T>) {
        let sum = self.fan().fold(Vector3::zeros(), |sum, (corners, doubled_area)| sum + corners * doubled_area);
        let weights = sum / (self.doubled_area() * T::of(3.0));
        (position(corners, &weights), weights)
    }

    /// How far it reaches from a point.
    pub(crate) fn reach(&self, corners: &[Vector3<T>; 3], from: &Vector3<T>) -> T {
        let distance = |weights| length(&(position(corners, weights) - from));
        self.weights[..self.count].iter().map(distance).fold(T::zero(), |most, distance| most.max(distance))
    }

    /// What lies where a depth that grows evenly is more than zero: all, or nothing, as far as rounding tells.
    pub(crate) fn beyond(&self, corners: &[Vector3<T>; 3], rounding: T, depth: impl Fn(&Vector3<T>) -> T) -> Cut<T> {
        let depth = |weights: &Vector3<T>| depth(&position(corners, weights));
        let mut part = Self { count: 0, ..*self };
        let mut keep = |weights| {
            part.weights[part.count] = weights;
            part.count += 1;
        };
        let mut from = self.weights[self.count - 1];
        let mut from_depth = depth(&from);
        let (mut least, mut most) = (from_depth, from_depth);
        for to in &self.weights[..self.count] {
            let to_depth = depth(to);
            if (from_depth > T::zero()) != (to_depth > T::zero()) {
                keep(from + (to - from) * (from_depth / (from_depth - to_depth)));
            }
            if to_depth > T::zero() {
                keep(*to);
            }
            (least, most) = (least.min(to_depth), most.max(to_depth));
            (from, from_depth) = (*to, to_depth);
        }
        if least >= -rounding {
            Cut::All
        } else if most <= rounding {
            Cut::Nothing
        } else {
            Cut::Some(part)
        }
    }

    /// What is nearer to one of the planes than to the others, the first of equally near ones; `None` where that is nothing.
    pub(crate) fn nearest_to(
        &self,
        planes: &[Plane<T>],
        place: usize,
        rounding: T,
        corners: &[Vector3<T>; 3],
    ) -> Option<Self> {
        let mut others = planes.iter().enumerate().filter(|&(other, _)| other != place);
        others.try_fold(*self, |part, (number, other)| {
            let handicap = if place < number { rounding } else { -rounding };
            match part.beyond(corners, T::zero(), |at| other.depth(at) - planes[place].depth(at) + handicap) {
                Cut::All => Some(part),
                Cut::Some(part) => Some(part),
                Cut::Nothing => None,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vector3<f64>; 3] =
        [Vector3::new(1.0, 0.0, 2.0), Vector3::new(4.0, 0.5, 2.0), Vector3::new(1.5, 3.0, 1.0)];
    const WHOLE: [Vector3<f64>; 3] =
        [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];

    /// Against the share of many points spread evenly over the triangle, and the mean of their weights.
    #[test]
    fn parts_are_as_large_as_the_points_they_hold_and_in_their_middle() {
        let planes = [
            (Vector3::new(2.0, 0.7, 1.8), Vector3::new(1.0, 0.2, 0.0)),
            (Vector3::new(2.0, 1.0, 1.5), Vector3::new(-0.3, -1.0, 0.4)),
            (Vector3::new(2.6, 0.5, 2.0), Vector3::new(-0.8, 1.5, 0.1)),
        ];
        let count = 700;
        let mut part = Part::whole(&WHOLE);
        for number in 0..planes.len() {
            let (point, inward) = planes[number];
            let Cut::Some(left) = part.beyond(&CORNERS, 0.0, |at| Plane { point, inward }.depth(at)) else {
                panic!("plane {number} cuts")
            };
            part = left;
            let mut held = 0.0;
            let mut sum = Vector3::zeros();
            for i in 0..count {
                for j in 0..count - i {
                    let [x, y] = [i, j].map(|k| (f64::from(k) + 1.0 / 3.0) / f64::from(count));
                    let weights = Vector3::new(x, y, 1.0 - x - y);
                    let at = position(&CORNERS, &weights);
                    if planes[..=number].iter().all(|(point, inward)| (at - point).dot(inward) > 0.0) {
                        held += 1.0;
                        sum += weights;
                    }
                }
            }
            let all = f64::from(count * (count + 1) / 2);
            assert!(
                (part.doubled_area() - held / all).abs() < 0.003,
                "{number}: {} {}",
                part.doubled_area(),
                held / all
            );
            let (at, weights) = part.middle(&CORNERS);
            assert!((weights - sum / held).amax() < 0.003, "{number}: {weights} {}", sum / held);
            assert_eq!(at, position(&CORNERS, &weights));
        }
        assert_eq!(part.count, 3);
    }

    #[test]
    fn planes_beside_a_part_leave_all_or_nothing() {
        let part = Part::whole(&WHOLE);
        assert!(matches!(part.beyond(&CORNERS, 0.0, |at| at.x), Cut::All));
        assert!(matches!(part.beyond(&CORNERS, 0.0, |at| -at.x), Cut::Nothing));
    }
}
