//! Points in an order in which neighbours follow one another, so that packets of them look at few triangles.

use crate::math::{Aabb, Scalar, Vector3};
use crate::simd::LANE_COUNT;

/// So many points are put in order at a time, in memory of the stack.
pub(crate) const BLOCK: usize = 4096;
/// Points are left as they are where the boxes around each sixteen of them are smaller, on average, than this part of the box
/// around all.
const NEIGHBOURS: f64 = 0.25;
/// Cells of the grid in which they are sorted, along each axis: two to this power.
const BITS: u32 = 10;

/// The places of up to [`BLOCK`] points, neighbours behind one another.
pub(crate) struct PointOrder {
    places: [u32; BLOCK],
    count: usize,
}

impl PointOrder {
    /// Along a Z-order curve (Morton 1966), or as they are where that already puts neighbours behind one another.
    pub(crate) fn new<T: Scalar>(points: &[Vector3<T>]) -> Self {
        let count = points.len();
        let mut places = std::array::from_fn(|place| place as u32);
        let sides = points.chunks(LANE_COUNT).map(|chunk| around(chunk).longest_side());
        let mean = sides.fold(T::zero(), |sum, side| sum + side) / T::of(count.div_ceil(LANE_COUNT) as f64);
        let whole = around(points);
        let factor = T::of(f64::from(1 << BITS)) / whole.longest_side();
        if mean > whole.longest_side() * T::of(NEIGHBOURS) {
            let mut keys = [0; BLOCK];
            for ((key, point), place) in keys.iter_mut().zip(points).zip(0..) {
                let cell = (point - whole.lower).map(|x| (x * factor).to_f64() as u64);
                let curve = spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
                *key = curve << u32::BITS | place;
            }
            keys[..count].sort_unstable();
            places[..count].iter_mut().zip(keys).for_each(|(place, key)| *place = key as u32);
        }
        Self { places, count }
    }

    pub(crate) fn places(&self) -> &[u32] {
        &self.places[..self.count]
    }
}

fn around<T: Scalar>(points: &[Vector3<T>]) -> Aabb<T> {
    let mut bounds = Aabb::empty();
    points.iter().for_each(|point| bounds.include(point));
    bounds
}

/// Puts two empty bits before each of the lowest bits.
fn spread(cell: u64) -> u64 {
    (0..BITS).fold(0, |bits, bit| bits | (cell >> bit & 1) << (3 * bit))
}
