//! Every operation of every path that this processor has, against plain arithmetic lane by lane.

use crate::math::{Scalar, Vector3};
use crate::simd::dispatch::{paths, run_on};
use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::{Kernel, Lanes, Lists};
use crate::simd::portable::Portable;
use proptest::array::{uniform3, uniform16};
use proptest::num::{f32, f64};
use proptest::prelude::*;

/// Operands for every operation.
#[derive(Clone, Debug)]
struct Operands<T: Scalar> {
    lanes: [[T; LANE_COUNT]; 3],
    points: Vec<Vector3<T>>,
    indices: [u32; LANE_COUNT],
    corners: [[u8; LANE_COUNT]; 3],
    sets: [Mask; LANE_COUNT],
    bits: Mask,
}

/// What all operations gave.
#[derive(Debug, Default, PartialEq)]
struct Results {
    /// Numbers to the bit; all NaN are one.
    numbers: Vec<u64>,
    /// Where the sign of zero is not promised.
    values: Vec<f64>,
    masks: Vec<Mask>,
    lists: Vec<Vec<u32>>,
}

impl Results {
    fn note<T: Scalar, L: Lanes<T>, const N: usize>(&mut self, made: [L; N]) {
        made.into_iter().for_each(|lanes| self.note_one(lanes));
    }

    fn note_one<T: Scalar, L: Lanes<T>>(&mut self, lanes: L) {
        let mut numbers = [T::zero(); LANE_COUNT];
        lanes.store(&mut numbers);
        let bits = |number: &T| if number.to_f64().is_nan() { u64::MAX } else { number.to_f64().to_bits() };
        self.numbers.extend(numbers.iter().map(bits));
    }
}

impl<T: Scalar> Kernel<T> for &Operands<T> {
    type Output = Results;

    fn run<L: Lanes<T>>(self) -> Results {
        let mut results = Results::default();
        let [a, b, c] = self.lanes.map(|numbers| L::load(&numbers));
        let Operands { points, indices, corners, sets, bits, .. } = self;
        let rounded_twice = a.mul(b).add(c);
        let mut sums = [[T::zero(); LANE_COUNT]; 3];
        a.times_add(b, c).store(&mut sums[0]);
        rounded_twice.store(&mut sums[1]);
        a.mul_add(b, c).store(&mut sums[2]);
        for lane in 0..LANE_COUNT {
            let [either, twice, once] = [0, 1, 2].map(|kind: usize| sums[kind][lane].to_f64());
            assert!(either == twice || either == once || either.is_nan() && (twice.is_nan() || once.is_nan()));
        }
        let made = [L::splat(self.lanes[0][3]), a.add(b), a.sub(b), a.mul(b), a.div(b), a.sqrt(), a.mul_add(b, c)];
        results.note(made);
        let made =
            [a.negate(), a.smaller(b), a.larger(b), a.magnitude(), a.permute(&corners[0]), L::select(*bits, a, b)];
        results.note(made);
        results.note([
            a.where_less(b, b, c),
            a.where_at_most(b, b, c),
            a.where_less(a, b, c),
            a.where_at_most(a, b, c),
        ]);
        results.masks.extend([a.is_less(b), a.is_at_most(b), a.is_less(a), a.is_at_most(a)]);
        results.masks.extend(L::sides([a, b], corners));
        results.masks.extend([
            L::Lists::equal(indices, indices[7]),
            L::Lists::holding(sets, *bits),
            L::Lists::holding(sets, sets[5] & 0x11),
            L::Lists::with_corner(corners, corners[2][3]),
        ]);
        results.note(L::gather(points, indices));
        let (lower, upper) = L::bounds(points, indices);
        results.values.extend(lower.iter().chain(&upper).map(|value| value.to_f64()));
        let [x, ..] = L::gather(points, indices);
        results.values.extend([x.smallest().to_f64(), x.greatest().to_f64()]);
        results
            .lists
            .push(L::Lists::gather_indices(sets.map(u32::from).as_slice(), &indices.map(|index| index % 16)).to_vec());
        let mut list = vec![7; 3 + LANE_COUNT];
        let count = L::Lists::append(&mut list, 3, 1000, *bits);
        results.lists.push(list[..count].to_vec());
        results
    }
}

/// Any operands; points have no NaN, and the last of them is among those asked for or not.
fn operands<T: Scalar>(number: impl Strategy<Value = T> + Clone) -> impl Strategy<Value = Operands<T>> {
    let is_number = |number: &T| !number.to_f64().is_nan();
    let point = uniform3(number.clone().prop_filter("bounds take no NaN", is_number)).prop_map(Vector3::from);
    let (points, indices) = (proptest::collection::vec(point, 40), uniform16(0..40u32));
    let rest = (uniform3(uniform16(0..16u8)), uniform16(any::<Mask>()), any::<Mask>());
    (uniform3(uniform16(number)), points, indices, rest).prop_map(|(lanes, points, indices, (corners, sets, bits))| {
        Operands { lanes, points, indices, corners, sets, bits }
    })
}

#[allow(unsafe_code)] // calling code for processors that may not be this one
fn assert_same_on_all_paths<T: Scalar>(operands: &Operands<T>) {
    let expected = operands.run::<Portable<T>>();
    for path in paths() {
        // SAFETY: it is one of those that are there.
        assert_eq!(unsafe { run_on(path, operands) }, expected, "{path:?}");
    }
}

proptest! {
    #[test]
    fn all_paths_do_the_same_with_any_singles(operands in operands(f32::ANY)) {
        assert_same_on_all_paths(&operands);
    }

    #[test]
    fn all_paths_do_the_same_with_any_doubles(operands in operands(f64::ANY)) {
        assert_same_on_all_paths(&operands);
    }

    /// Numbers of about the same size, so that signs of edge functions and roundings are not always those of one product.
    #[test]
    fn all_paths_do_the_same_with_ordinary_numbers(singles in operands(-2.0..2.0f32), doubles in operands(-2.0..2.0f64)) {
        assert_same_on_all_paths(&singles);
        assert_same_on_all_paths(&doubles);
    }
}

/// Products next to the middle between two singles, beyond what a double can tell.
struct NearTies<'a>(&'a [[f32; LANE_COUNT]; 3]);

impl Kernel<f32> for NearTies<'_> {
    type Output = [f32; LANE_COUNT];

    fn run<L: Lanes<f32>>(self) -> [f32; LANE_COUNT] {
        let [a, b, c] = self.0.map(|numbers| L::load(&numbers));
        let mut result = [0.0; LANE_COUNT];
        a.mul_add(b, c).store(&mut result);
        result
    }
}

#[test]
#[allow(unsafe_code)] // calling code for processors that may not be this one
fn products_and_sums_are_rounded_once() {
    let (mut near_ties, mut rounded_twice) = (0, 0);
    for start in (0..1 << 23).step_by(16 * 37) {
        // x · y is within 2⁻²⁴ of 1, above or below; times half a unit in the last place of c.
        let x: [f32; LANE_COUNT] = std::array::from_fn(|lane| 1.0 + (start + 37 * lane) as f32 * f32::EPSILON);
        let y = x.map(|x| 1.0 / x * (f32::EPSILON / 2.0));
        let c = std::array::from_fn(|lane| if lane % 2 == 0 { 1.0 } else { -1.0 - f32::EPSILON });
        let once: [f32; LANE_COUNT] = std::array::from_fn(|lane| x[lane].mul_add(y[lane], c[lane]));
        for lane in 0..LANE_COUNT {
            let in_doubles = f64::from(x[lane]) * f64::from(y[lane]) + f64::from(c[lane]);
            near_ties += 1;
            rounded_twice += u32::from(in_doubles as f32 != once[lane]);
        }
        for path in paths() {
            // SAFETY: it is one of those that are there.
            assert_eq!(unsafe { run_on(path, NearTies(&[x, y, c])) }, once, "{path:?}, {start}");
        }
    }
    assert!(rounded_twice > 100, "only {rounded_twice} of {near_ties} would tell");
}
