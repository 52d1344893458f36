use super::{Scalar, Vector3};

/// An axis-aligned box, closed: its faces belong to it. Empty where a lower bound is above the upper one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<T: Scalar> {
    /// The corner with the smallest coordinates.
    pub lower: Vector3<T>,
    /// The corner with the largest coordinates.
    pub upper: Vector3<T>,
}

impl<T: Scalar> Aabb<T> {
    /// The box that holds nothing.
    pub fn empty() -> Self {
        Self { lower: Vector3::repeat(T::INFINITY), upper: Vector3::repeat(-T::INFINITY) }
    }

    /// The smallest box around three points.
    pub fn of_triangle(corners: &[Vector3<T>; 3]) -> Self {
        let [a, b, c] = corners;
        Self { lower: a.inf(b).inf(c), upper: a.sup(b).sup(c) }
    }

    /// Grows the box until it holds `point`.
    pub fn include(&mut self, point: &Vector3<T>) {
        self.lower = self.lower.inf(point);
        self.upper = self.upper.sup(point);
    }

    /// The box that two boxes have in common; empty where they do not meet.
    pub fn intersection(&self, other: &Self) -> Self {
        Self { lower: self.lower.sup(&other.lower), upper: self.upper.inf(&other.upper) }
    }

    /// The smallest box around two boxes.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self { lower: self.lower.inf(&other.lower), upper: self.upper.sup(&other.upper) }
    }

    /// The middle.
    pub fn centre(&self) -> Vector3<T> {
        self.lower + (self.upper - self.lower) * T::of(0.5)
    }

    /// The area of the largest face.
    pub(crate) fn largest_face(&self) -> T {
        let sides = self.upper - self.lower;
        (sides.x * sides.y).max(sides.y * sides.z).max(sides.z * sides.x)
    }

    /// The box with all faces moved outward by `margin`.
    pub fn grown(&self, margin: T) -> Self {
        Self { lower: self.lower.add_scalar(-margin), upper: self.upper.add_scalar(margin) }
    }

    /// Whether no point lies in the box.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.lower[axis] > self.upper[axis])
    }

    /// Whether `point` lies in the box or on its faces.
    pub fn contains(&self, point: &Vector3<T>) -> bool {
        (0..3).all(|axis| self.lower[axis] <= point[axis] && point[axis] <= self.upper[axis])
    }

    /// Whether two boxes share a point.
    pub fn overlaps(&self, other: &Self) -> bool {
        !self.intersection(other).is_empty()
    }

    /// The longest side.
    pub fn longest_side(&self) -> T {
        (self.upper - self.lower).max()
    }

    /// The largest distance along one axis from `point` to a corner.
    pub fn reach_from(&self, point: &Vector3<T>) -> T {
        (self.lower - point).abs().sup(&(self.upper - point).abs()).max()
    }
}
