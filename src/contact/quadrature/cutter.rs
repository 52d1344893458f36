use crate::contact::point_pair::SurfacePoint;
use crate::contact::quadrature::corners::{Corners, DEEPEST, longest_edge};
use crate::contact::quadrature::sample::{Sample, Sampling, WHOLE};
use crate::contact::statistics::Statistics;
use crate::math::{Aabb, Scalar, Vector3, direction, length};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::query::Tracer;

/// Cuts triangles into pieces of the size asked for.
pub(crate) struct Cutter<'a, T: Scalar> {
    region: &'a Aabb<T>,
    /// The square of the longest edge that a piece may have.
    longest_allowed: T,
    /// Pieces left larger than asked.
    uncut: u64,
    /// Triangles in the region that have no normal.
    without_normal: u64,
    halvings_left: u32,
}

/// The largest number of cuts of one surface, so that cutting ends for needles and for whatever spacing a caller asks. It is
/// ten times what an overlap with equal sides takes, and gives about a million pieces.
const MOST_HALVINGS_OF_REGION: u32 = 1 << 13;
const MOST_HALVINGS: u32 = 1 << 20;

/// How many rays stand on the largest face of the overlap box where samples do not follow the load. docs/accuracy.md has the
/// errors with half as many, under *rays on its largest face*.
const RAYS_ON_LARGEST_FACE: f64 = 128.0;

/// If both bodies of a pair meet more than this many others, they share out their rays among these, so that the number of rays
/// grows with the bodies and not with the pairs.
const MOST_WITH_ALL_RAYS: u32 = 12;
/// At least this many rays stand on the largest face even then; with fewer, large triangles would miss the overlap.
const FEWEST_ON_LARGEST_FACE: f64 = 8.0;

/// The part of the rays on the overlap box's largest face that a pair casts if both bodies meet at least `neighbours` others.
pub(crate) fn part_of_rays<T: Scalar>(neighbours: u32) -> T {
    let part = f64::from(MOST_WITH_ALL_RAYS) / f64::from(neighbours.max(1));
    T::of(part.clamp(FEWEST_ON_LARGEST_FACE / RAYS_ON_LARGEST_FACE, 1.0))
}

/// The triangle that pieces are cut from.
struct Face<T: Scalar> {
    triangle: u32,
    vertices: [u32; 3],
    normal: Vector3<T>,
}

/// A part of a triangle.
struct Piece<T: Scalar> {
    corners: Corners<T>,
    area: T,
    depth: u8,
    number: u32,
}

impl<'a, T: Scalar> Cutter<'a, T> {
    /// The one for this sampling; `None` where rays start at vertices.
    pub(crate) fn new(sampling: Sampling<T>, overlap: &Aabb<T>, region: &'a Aabb<T>) -> Option<Self> {
        let (squared_spacing, halvings_left) = match sampling {
            Sampling::Vertices => return None,
            Sampling::Accuracy(_) => (overlap.largest_face() / T::of(RAYS_ON_LARGEST_FACE), MOST_HALVINGS_OF_REGION),
            Sampling::Spacing(spacing) => (spacing * spacing, MOST_HALVINGS),
        };
        // A region that is no more than a line or a point gives no measure: one ray for each triangle then.
        let longest_allowed = if squared_spacing > T::zero() { squared_spacing * T::of(2.0) } else { T::INFINITY };
        Some(Self { region, longest_allowed, uncut: 0, without_normal: 0, halvings_left })
    }

    /// The same with so many times as few rays.
    pub(crate) fn with_part_of_rays(mut self, part: T) -> Self {
        self.longest_allowed /= part;
        self
    }

    /// Counts pieces left larger than asked, and triangles without a normal.
    pub(crate) fn count(&self, statistics: &mut Statistics) {
        statistics.uncut_pieces += self.uncut;
        statistics.without_normal += self.without_normal;
    }

    /// Adds the pieces of all triangles of some groups.
    pub(crate) fn cut_groups(&mut self, own: &Tracer<'_, T>, groups: &[u32], samples: &mut Vec<Sample<T>>) {
        groups.iter().for_each(|&group| own.triangles_of(group, |triangle| self.cut(own.mesh(), triangle, samples)));
    }

    /// Adds the triangle's pieces whose middles lie in the region.
    fn cut(&mut self, mesh: &Mesh<T>, triangle: u32, samples: &mut Vec<Sample<T>>) {
        let [a, b, c] = mesh.corners(triangle);
        if !Aabb::of_triangle(&[a, b, c]).overlaps(self.region) {
            return;
        }
        let (ab, ac) = (b - a, c - a);
        let scaled = ab.cross(&ac);
        let Some(normal) = direction(&scaled) else {
            self.without_normal += 1;
            return;
        };
        let vertices = mesh.topology().triangles()[triangle as usize];
        let (area, corners) = (length(&scaled) * T::of(0.5), Corners::of_triangle([a, b, c]));
        let longest = ab.norm_squared().max(ac.norm_squared()).max((c - b).norm_squared());
        let (face, whole) = (Face { triangle, vertices, normal }, Piece { corners, area, depth: 0, number: WHOLE });
        // Most triangles of fine meshes are short enough.
        if longest <= self.longest_allowed {
            self.add(&face, &whole, samples);
        } else {
            self.halve(&face, &whole, samples);
        }
    }

    /// Halves the piece at the middle of its longest edge until that edge is short enough, and adds the middle of each part that
    /// lies in the region. Parts beside the region are dropped whole, so that a floor costs what lies under the body.
    fn halve(&mut self, face: &Face<T>, piece: &Piece<T>, samples: &mut Vec<Sample<T>>) {
        if !Aabb::of_triangle(&piece.corners.positions).overlaps(self.region) {
            return;
        }
        // Written so that NaN stops too.
        let is_long = longest_edge(&piece.corners.positions).1 > self.longest_allowed && piece.depth < DEEPEST;
        let halves = if is_long { piece.corners.halves() } else { None };
        match halves {
            Some(halves) if self.halvings_left > 0 => {
                self.halvings_left -= 1;
                let (area, depth) = (piece.area * T::of(0.5), piece.depth + 1);
                for (half, corners) in (0..).zip(halves) {
                    let number = piece.number.wrapping_mul(2).wrapping_add(half);
                    self.halve(face, &Piece { corners, area, depth, number }, samples);
                }
                return;
            }
            _ => self.uncut += u64::from(halves.is_some()),
        }
        self.add(face, piece, samples);
    }

    /// Adds the middle of a piece, if it lies in the region.
    fn add(&self, face: &Face<T>, piece: &Piece<T>, samples: &mut Vec<Sample<T>>) {
        let (position, weights) = piece.corners.middle();
        if self.region.contains(&position) {
            let point =
                SurfacePoint { triangle: face.triangle, vertices: face.vertices, weights: weights.into(), position };
            samples.room_for(1).push(Sample { point, normal: face.normal, area: piece.area, piece: piece.number });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    const EVERYWHERE: Aabb<f64> = Aabb { lower: Vector3::new(-1e9, -1e9, -1e9), upper: Vector3::new(1e17, 1e17, 1e17) };

    /// The areas of the pieces of a triangle in the region.
    fn areas(cutter: &mut Cutter<'_, f64>, corners: [[f64; 3]; 3]) -> Vec<f64> {
        let mesh = Mesh::open(&corners, &[[0, 1, 2]]).expect("it has an area");
        let mut samples = Vec::new();
        cutter.cut(&mesh, 0, &mut samples);
        samples.iter().map(|sample| sample.area).collect()
    }

    fn with_spacing(spacing: f64, region: &Aabb<f64>) -> Cutter<'_, f64> {
        Cutter::new(Sampling::Spacing(spacing), &EVERYWHERE, region).expect("rays start on faces")
    }

    /// Half a square with sides of 8: its halves are halves of squares again, so that k halvings of all leave 2ᵏ pieces
    /// with longest sides of √(128 / 2ᵏ).
    const HALF_A_SQUARE: [[f64; 3]; 3] = [[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]];

    #[test]
    fn triangles_are_halved_until_no_side_is_longer_than_the_diagonal_of_a_square_of_the_spacing() {
        for (spacing, pieces) in [(1.0, 64), (1.01, 64), (0.99, 128), (2.0, 16), (7.99, 2), (8.0, 1)] {
            let mut cutter = with_spacing(spacing, &EVERYWHERE);
            assert_eq!(areas(&mut cutter, HALF_A_SQUARE), vec![32.0 / pieces as f64; pieces], "{spacing}");
            assert_eq!((MOST_HALVINGS - cutter.halvings_left, cutter.uncut), (pieces as u32 - 1, 0));
        }
    }

    /// Of eight pieces three halvings, the first half first, leave two; their quarter and the other half are too large.
    #[test]
    fn pieces_left_uncut_are_counted() {
        let mut cutter = with_spacing(2.9, &EVERYWHERE);
        cutter.halvings_left = 3;
        assert_eq!(areas(&mut cutter, HALF_A_SQUARE), [4.0, 4.0, 8.0, 16.0]);
        assert_eq!(cutter.uncut, 2);
        assert_eq!(areas(&mut cutter, HALF_A_SQUARE), [32.0]);
        assert_eq!(cutter.uncut, 3);
    }

    /// Of the halves of what has a corner at the origin one has it too, and no other part comes near.
    #[test]
    fn halves_of_halves_come_to_an_end() {
        let tiny = Aabb { lower: Vector3::repeat(-1e-60), upper: Vector3::repeat(1e-60) };
        let mut cutter = with_spacing(1e-40, &tiny);
        assert_eq!(areas(&mut cutter, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]), [0.0; 0]);
        assert_eq!((MOST_HALVINGS - cutter.halvings_left, cutter.uncut), (u32::from(DEEPEST), 0));
    }

    /// Far from the origin, where the middles of the shorter sides are rounded to one of their ends.
    #[test]
    fn pieces_that_rounding_does_not_let_be_halved_are_whole() {
        let far = 2f64.powi(53);
        let mut cutter = with_spacing(1e-3, &EVERYWHERE);
        let corners = [[far, far, 0.0], [far + 2.0, far, 0.0], [far, far + 2.0, 0.0]];
        assert_eq!(areas(&mut cutter, corners), [1.0, 1.0]);
        assert_eq!((MOST_HALVINGS - cutter.halvings_left, cutter.uncut), (1, 0));
    }
}
