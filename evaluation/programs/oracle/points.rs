//! Points to ask for the nearest one of a mesh's surface.

use super::cases::Target;
use crate::random::Random;
use raycontact::math::{Scalar, Vector3};

impl<T: Scalar> Target<T> {
    /// Points of all kinds; in half of all cases each 16 are neighbours.
    pub fn points(&self, count: usize, random: &mut Random) -> Vec<Vector3<T>> {
        let are_neighbours = random.once_in(2);
        let mut points: Vec<Vector3<T>> = Vec::with_capacity(count);
        while points.len() < count {
            let first = self.point(random);
            points.push(first);
            for _ in 1..if are_neighbours { 16.min(count - points.len() + 1) } else { 1 } {
                points.push(first + self.small(0.1, random));
            }
        }
        points
    }

    /// A vector of at most so many sizes.
    fn small(&self, sizes: f64, random: &mut Random) -> Vector3<T> {
        Vector3::from(random.point(sizes * self.size()).map(T::of))
    }

    fn point(&self, random: &mut Random) -> Vector3<T> {
        let least = T::ROUNDING_UNIT.to_f64().log2() - 2.0;
        match random.below(9) {
            0 => self.vertex(random),
            1 => self.on_edge(random),
            2 => self.on_surface(random),
            // Beside those, by anything down to nothing.
            3 => {
                let beside = random.between(least, 0.0).exp2();
                let on_it = [self.vertex(random), self.on_edge(random), self.on_surface(random)];
                *random.pick(&on_it) + self.small(beside, random)
            }
            // As far from two parts of the surface, or nearly.
            4 => (self.vertex(random) + self.vertex(random)) * T::of(0.5),
            5 => (self.on_surface(random) + self.on_surface(random)) * T::of(0.5),
            6 => self.around(0.3, random),
            7 => self.origin(random),
            _ => {
                let far = random.between(0.0, 30.0).exp2();
                self.around(far, random)
            }
        }
    }
}
