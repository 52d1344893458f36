use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};

/// Finds the pairs of bodies whose boxes overlap: sorts the boxes along one axis and compares those whose intervals meet.
#[derive(Debug, Default)]
pub(super) struct BroadPhase<T: Scalar> {
    sorted: Vec<(Aabb<T>, u32)>,
    pairs: Vec<[u32; 2]>,
    /// Every pair in both orders, ascending.
    meetings: Vec<[u32; 2]>,
    /// The boxes in the order of the bodies.
    boxes: Vec<Aabb<T>>,
}

impl<T: Scalar> BroadPhase<T> {
    /// Finds the wanted pairs anew. The boxes are in the order of the bodies, which are named by their places in it.
    pub(super) fn update(&mut self, boxes: impl Iterator<Item = Aabb<T>>, is_wanted: impl Fn(&[u32; 2]) -> bool) {
        self.sorted.clear();
        memory::refill(&mut self.boxes, boxes);
        memory::append(&mut self.sorted, self.boxes.iter().copied().zip(0..));
        let axis = self.longest_axis();
        self.sorted.sort_unstable_by(|(a, i), (b, j)| {
            a.lower[axis].partial_cmp(&b.lower[axis]).expect("positions are finite").then(i.cmp(j))
        });

        self.pairs.clear();
        for (place, (aabb, body)) in self.sorted.iter().enumerate() {
            let later = self.sorted[place + 1..].iter();
            for (other_box, other) in later.take_while(|(other, _)| other.lower[axis] <= aabb.upper[axis]) {
                let pair = [*body.min(other), *body.max(other)];
                if aabb.overlaps(other_box) && is_wanted(&pair) {
                    self.pairs.room_for(1).push(pair);
                }
            }
        }
        self.pairs.sort_unstable();
        memory::refill(&mut self.meetings, self.pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]));
        self.meetings.sort_unstable();
    }

    /// How many others a body meets.
    pub(super) fn neighbours(&self, body: u32) -> u32 {
        let met_before = |body: u32| self.meetings.partition_point(|&[one, _]| one < body);
        (met_before(body + 1) - met_before(body)) as u32
    }

    /// Overlapping pairs, smaller place first, in ascending order.
    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The boxes of the bodies that meet this one.
    pub(super) fn met_by(&self, body: u32) -> impl Iterator<Item = &Aabb<T>> {
        let first = self.meetings.partition_point(|&[one, _]| one < body);
        let own = self.meetings[first..].iter().take_while(move |&&[one, _]| one == body);
        own.map(|&[_, other]| &self.boxes[other as usize])
    }

    /// The axis along which the scene is longest: there the fewest intervals meet.
    fn longest_axis(&self) -> usize {
        let scene = self.boxes.iter().fold(Aabb::empty(), |scene, aabb| scene.union(aabb));
        (scene.upper - scene.lower).imax()
    }
}
