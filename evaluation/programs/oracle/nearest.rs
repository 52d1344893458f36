//! Nearest points of a mesh: asked in every way, and held against exact distances.
//!
//! All ways agree to the bit. The distance is the exact one to within [`DISTANCE_ERROR`] rounding units of the reach, here the
//! largest coordinate difference between the point and the mesh; so is that of the point that the weights name; and so, axis
//! by axis, is the position, beside what the coordinates' own rounding takes.

use super::cases::Target;
use super::distance::{Error, is_weighted, least, to_triangle, to_weighted};
use super::tally::{Failure, Tally};
use crate::random::Random;
use raycontact::math::{Scalar, Vector3};
use raycontact::query::Tracer;
use raycontact::triangle::ClosestPoint;

/// What the library promises (`src/triangle/closest_point/`).
pub const DISTANCE_ERROR: f64 = 64.0;

/// One point for so many rays.
const RAYS_PER_POINT: u64 = 8;

/// Asks about the nearest points of one mesh.
pub fn run_points<T: Scalar>(
    target: &Target<T>,
    tracers: &[Tracer<'_, T>; 2],
    rays: u64,
    random: &mut Random,
    tally: &mut Tally,
    failure: impl Fn(usize, String) -> Failure,
) {
    let points = target.points((rays / RAYS_PER_POINT) as usize, random);
    let endless = vec![T::INFINITY; points.len()];
    let many = tracers.map(|tracer| ask(&tracer, &points, &endless));
    let expected: Vec<_> = points.iter().map(|point| tracers[0].closest_point_of_all(point, T::INFINITY)).collect();
    // Bounds from nothing to twice as far as it is.
    let parts = [0.0, 1.0 - 2.0 * T::ROUNDING_UNIT.to_f64(), 1.0, 2.0];
    let bound = |found: &Option<ClosestPoint<T>>| {
        found.map_or(T::one(), |found| found.distance * T::of(parts[random.below(4)]))
    };
    let bounds: Vec<T> = expected.iter().map(bound).collect();
    let bounded = tracers.map(|tracer| ask(&tracer, &points, &bounds));

    let mesh = Positions::new(tracers[0]);
    for (place, point) in points.iter().enumerate() {
        let single = tracers.map(|tracer| tracer.closest_point(point, T::INFINITY));
        let answers = [many[0][place], many[1][place], single[0], single[1]];
        let within = expected[place].filter(|found| found.distance <= bounds[place]);
        let fault = if answers.iter().any(|answer| bits(answer) != bits(&expected[place])) {
            Some(format!("answers differ: {answers:?}"))
        } else if bounded.iter().any(|answers| bits(&answers[place]) != bits(&within)) {
            Some(format!("within {:?}: {:?}", bounds[place], [bounded[0][place], bounded[1][place]]))
        } else if let Some(found) = expected[place] {
            mesh.judge(point, &found, tally)
        } else {
            Some("nothing is near".to_owned())
        };
        tally.points += 1;
        tally.wrong += u64::from(fault.is_some());
        if let Some(what) = fault.filter(|_| tally.first_failure.is_none()) {
            let what = format!("wrong: nearest to {point:?}: {:?}\n{what}", expected[place]);
            tally.first_failure = Some(failure(place, what));
        }
    }
}

fn ask<T: Scalar>(tracer: &Tracer<'_, T>, points: &[Vector3<T>], bounds: &[T]) -> Vec<Option<ClosestPoint<T>>> {
    let mut found = Vec::new();
    tracer.closest_points(points, bounds, &mut found);
    found
}

fn bits<T: Scalar>(found: &Option<ClosestPoint<T>>) -> Option<(u32, Vec<u64>)> {
    let bit = |number: &T| number.to_f64().to_bits();
    found.map(|found| {
        let numbers = found.weights.iter().chain(found.position.iter()).chain([&found.distance]);
        (found.triangle, numbers.map(bit).collect())
    })
}

/// A mesh in doubles.
struct Positions {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Positions {
    fn new<T: Scalar>(tracer: Tracer<'_, T>) -> Self {
        let mesh = tracer.mesh();
        let positions = mesh.positions().iter().map(|position| position.map(|x| x.to_f64()).into()).collect();
        Self { positions, triangles: mesh.topology().triangles().to_vec() }
    }

    fn corners(&self, triangle: u32) -> [&[f64; 3]; 3] {
        self.triangles[triangle as usize].map(|vertex| &self.positions[vertex as usize])
    }

    /// What is wrong with an answer.
    fn judge<T: Scalar>(&self, point: &Vector3<T>, found: &ClosestPoint<T>, tally: &mut Tally) -> Option<String> {
        let unit = T::ROUNDING_UNIT.to_f64();
        let (distance, weights) = (found.distance.to_f64(), found.weights.map(T::to_f64));
        let point: [f64; 3] = point.map(|x| x.to_f64()).into();
        let position: [f64; 3] = found.position.map(|x| x.to_f64()).into();
        let apart = |corner: &[f64; 3]| (0..3).map(|axis| (corner[axis] - point[axis]).abs()).fold(0.0, f64::max);
        let reach = self.positions.iter().map(apart).fold(0.0, f64::max);
        // Boxes farther away than the answer by far more than any rounding hold nothing nearer.
        let limit = distance + 1e-3 * reach;
        let may_be_nearer = |triangle: &u32| {
            let corners = self.corners(*triangle);
            (0..3).all(|axis| {
                let [a, b, c] = corners.map(|corner| corner[axis] - point[axis]);
                a.min(b).min(c) <= limit && a.max(b).max(c) >= -limit
            })
        };
        let near = (0..self.triangles.len() as u32).filter(may_be_nearer);
        let exact = near.map(|triangle| to_triangle(&point, self.corners(triangle))).reduce(least);
        let Some(exact) = exact else { return Some("no triangle is as near".to_owned()) };
        let mut units = 1.0;
        while !exact.is_root_within(distance, &Error::new(units, unit, reach)) {
            if units >= DISTANCE_ERROR {
                return Some(format!("its distance is wrong by more than {units} rounding units of {reach}"));
            }
            units *= 2.0;
        }
        tally.note_distance_error::<T>(units);
        let corners = self.corners(found.triangle);
        let sum: f64 = weights.iter().sum();
        if !weights.iter().all(|weight| (0.0..=1.0).contains(weight)) || (sum - 1.0).abs() > 4.0 * unit {
            return Some("its weights are no mean".to_owned());
        }
        if !to_weighted(&point, corners, weights).is_root_within(distance, &Error::new(DISTANCE_ERROR, unit, reach)) {
            return Some("its weights name a point at another distance".to_owned());
        }
        let largest = corners.iter().flat_map(|corner| corner.iter()).fold(0.0f64, |most, x| most.max(x.abs()));
        let error = Error::new(DISTANCE_ERROR, unit, reach.max(largest));
        (!is_weighted(&position, corners, weights, &error))
            .then(|| "its position is not where its weights say".to_owned())
    }
}
