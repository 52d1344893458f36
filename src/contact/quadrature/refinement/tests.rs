use super::*;
use crate::contact::options::DetectionOptions;
use crate::contact::test_contact::with_pair;
use crate::mesh::test_mesh::boxes;

/// The areas of the samples on a triangle in a region, and how many of these are left too large. The overlap box is a cube
/// with sides of 1/8 in its middle.
fn areas(sampling: Sampling<f64>, corners: [[f64; 3]; 3], region: [[f64; 3]; 2]) -> (Vec<f64>, u64) {
    let (mesh, other) = (Mesh::open(&corners, &[[0, 1, 2]]).expect("it has an area"), boxes(&[region]));
    let [middle, half] = [other.aabb().centre(), Vector3::repeat(0.0625)];
    let overlap = &Aabb { lower: middle - half, upper: middle + half };
    let options = DetectionOptions { sampling, ..Default::default() };
    with_pair([&mesh, &other], &options, |pair| {
        let pair = Pair { overlap, region: other.aabb(), ..*pair };
        let mut quadrature = Quadrature::default();
        quadrature.fill(&pair, &[vec![0], vec![]], Purpose::Rays);
        (quadrature.samples[0].iter().map(|sample| sample.area).collect(), quadrature.counts.uncut_pieces)
    })
}

/// Half a square with sides of 8: its halves are halves of squares again, so that k halvings of all leave 2ᵏ pieces
/// with longest sides of √(128 / 2ᵏ).
const HALF_A_SQUARE: [[f64; 3]; 3] = [[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]];

#[test]
fn triangles_are_halved_until_no_side_is_longer_than_the_diagonal_of_a_square_of_the_spacing() {
    let around = [[-1.0; 3], [9.0; 3]];
    for (spacing, pieces) in [(1.0, 64), (1.01, 64), (0.99, 128), (2.0, 16), (7.99, 2), (8.0, 1)] {
        let found = areas(Sampling::Spacing(spacing), HALF_A_SQUARE, around);
        assert_eq!(found, (vec![32.0 / f64::from(pieces); pieces as usize], 0), "{spacing}");
    }
}

/// 2¹⁹ would be asked for. With 8 or 64 times the area there are still too many, with 4096 times there are not.
#[test]
fn pieces_left_uncut_are_counted() {
    let found = areas(Sampling::Accuracy(0.01), HALF_A_SQUARE, [[-1.0; 3], [9.0; 3]]);
    assert_eq!(found, (vec![32.0 / 128.0; 128], 128));
}

/// Of the halves of what has a corner at the origin one has it too, and few other parts come near.
#[test]
fn halves_of_halves_come_to_an_end() {
    let (found, _) =
        areas(Sampling::Spacing(1e-40), [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[-1e-60; 3], [1e-60; 3]]);
    assert!(found.is_empty());
}

/// Far from the origin, where the middle of the longest side is rounded to the corner across.
#[test]
fn what_rounding_does_not_let_be_halved_is_whole() {
    let far = 2f64.powi(53);
    let corners = [[far, far, 0.0], [far + 2.0, far, 0.0], [far, far + 2.0, 0.0]];
    let (found, uncut) =
        areas(Sampling::Spacing(1e-3), corners, [[far - 8.0, far - 8.0, -1.0], [far + 8.0, far + 8.0, 1.0]]);
    assert_eq!((found, uncut), (vec![2.0], 1));
}
