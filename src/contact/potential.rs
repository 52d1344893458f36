//! The energy whose gradient the forces of the pressure law are: the integral of the distance to the one surface over what
//! is in both bodies.
//!
//! By Gauss's theorem it is a sum over the samples that cast. Each stands for a column along a line, nearly that of its ray,
//! from the sample to where the line leaves the other body. The lines of a pair are parallel, or meet in one point where bodies
//! press from many sides, as on a ball in a box. The integral does not depend on the lines, so they may change from call to
//! call. Its error is that of the samples, and of the depths between them.

use crate::contact::pair::Pair;
use crate::contact::point_pair::{Contact, ContactKind};
use crate::math::{Scalar, Vector3, length};
use crate::memory::{self, Room};
use crate::query::Tracer;
use crate::self_contact::rounding;
use crate::triangle::{ClosestPoint, Ray};

/// A column is halved until the depth in its middle is the mean of those at its ends, within this fraction of the pair's mean
/// depth.
const TOLERANCE: f64 = 0.01;
/// And at most this often.
const MOST_HALVINGS: usize = 6;

/// A stretch of a line within one body, with the area that it stands for.
#[derive(Clone, Copy, Debug)]
struct Column<T: Scalar> {
    line: Line<T>,
    /// Distances along the line.
    ends: [T; 2],
    /// How deep both ends are below the body's surface.
    depths: [T; 2],
    /// Seen along the line, at its origin.
    area: T,
}

/// A line through a sample. `narrowing` is the inverse of the distance to the point in which the pair's lines meet, 0 where
/// they are parallel.
#[derive(Clone, Copy, Debug)]
struct Line<T: Scalar> {
    origin: Vector3<T>,
    direction: Vector3<T>,
    narrowing: T,
}

/// The columns of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns<T: Scalar> {
    /// By the body in which they are.
    within: [Vec<Column<T>>; 2],
    /// Scratch memory for the integral.
    halves: Vec<Column<T>>,
    middles: Vec<Vector3<T>>,
    bounds: Vec<T>,
    nearest: Vec<Option<ClosestPoint<T>>>,
}

impl<T: Scalar> Line<T> {
    fn turned(self) -> Self {
        Self { direction: -self.direction, narrowing: -self.narrowing, ..self }
    }

    fn at(&self, t: T) -> Vector3<T> {
        self.origin + self.direction * t
    }

    /// How far it runs inside a body, to the surface or to where all lines meet, and how deep it is there.
    fn span(&self, body: &Tracer<'_, T>, cap: T) -> Option<[T; 2]> {
        let meeting = if self.narrowing > T::zero() { T::one() / self.narrowing } else { T::INFINITY };
        match body.nearest_hit(&Ray { origin: self.origin, direction: self.direction, t_max: meeting }) {
            Some(hit) => hit.is_exit.then(|| [hit.t, T::zero()]),
            None => {
                let point = self.at(meeting);
                // A line that starts outside by rounding has no end.
                let nearest = body.mesh().aabb().contains(&point).then(|| body.closest_point(&point, T::INFINITY));
                nearest.flatten().map(|nearest| [meeting, nearest.distance.min(cap)])
            }
        }
    }
}

/// The lines of a pair, in the direction in which the body with the smaller number is pushed: `aim` − `narrowing` · point.
struct Lines<T: Scalar> {
    aim: Vector3<T>,
    narrowing: T,
}

impl<T: Scalar> Lines<T> {
    /// Lines near the contacts' directions: those of the best fit that meet in one point, made more parallel the less the
    /// pushes cancel out.
    fn new(contacts: &[Contact<T>], first: u32) -> Self {
        let weighted = || {
            contacts.iter().map(|contact| {
                let sign = if contact.colliding == first { T::one() } else { -T::one() };
                (contact.area * contact.depth * contact.cos_alpha, contact.direction * sign, contact.p1.position)
            })
        };
        let mut sum = (T::zero(), Vector3::zeros(), Vector3::zeros());
        weighted().for_each(|(load, push, point)| {
            sum = (sum.0 + load, sum.1 + push * load, sum.2 + point * load);
        });
        let [push, middle] = [sum.1, sum.2].map(|vector| vector / sum.0);
        let (mut along, mut squares) = (T::zero(), T::zero());
        weighted().for_each(|(load, push, point)| {
            along -= load * push.dot(&(point - middle));
            squares += load * (point - middle).norm_squared();
        });
        let cancelled = (T::one() - length(&push)).max(T::zero());
        let narrowing = if squares > T::zero() { along / squares * cancelled } else { T::zero() };
        Self { aim: push + middle * narrowing, narrowing }
    }

    fn through(&self, origin: Vector3<T>, is_of_first: bool) -> Line<T> {
        let direction = self.aim - origin * self.narrowing;
        let size = length(&direction);
        let line = Line { origin, direction: direction / size, narrowing: self.narrowing / size };
        if is_of_first { line } else { line.turned() }
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// The energy, over the stiffness, of all this pair's contacts; no pressure is larger than at the depth `cap`.
    pub(crate) fn potential(&self, contacts: &[Contact<T>], cap: T, columns: &mut Columns<T>) -> T {
        let mut energy = T::zero();
        columns.within.iter_mut().for_each(Vec::clear);
        let lines = Lines::new(contacts, self.bodies[0]);
        let (mut load, mut moment) = (T::zero(), T::zero());
        for contact in contacts.iter().filter(|contact| contact.area * contact.depth * contact.cos_alpha > T::zero()) {
            let depth = contact.depth * contact.cos_alpha;
            match (contact.kind, self.fixed_shares) {
                (ContactKind::Ray, Some(shares)) => {
                    (load, moment) = (load + contact.area * depth, moment + contact.area * depth * depth);
                    self.add_columns(contact, depth, cap, shares, &lines, &mut columns.within);
                }
                // What two edges share grows with the cube of the depth in area, and with the fourth power in energy.
                (ContactKind::Edge, Some(_)) => energy += contact.area * depth * contact.depth * T::of(0.25),
                _ => energy += contact.area * depth * contact.depth * T::of(0.5),
            }
        }
        if load > T::zero() {
            let tolerance = (moment / load).min(cap) * T::of(TOLERANCE);
            energy +=
                (0..2).fold(T::zero(), |sum, side| sum + columns.integral(self.tracers[side], side, cap, tolerance));
        }
        energy
    }

    /// Adds the columns that a sample stands for. Where its line leaves its own body before the other, a column that enters
    /// that body runs too far; this sample then takes away what is too much. Seen from the other body, it adds the stretch
    /// between two points of its own.
    fn add_columns(
        &self,
        contact: &Contact<T>,
        depth: T,
        cap: T,
        shares: [T; 2],
        lines: &Lines<T>,
        columns: &mut [Vec<Column<T>>; 2],
    ) {
        let side = usize::from(contact.colliding != self.bodies[0]);
        let [own, other] = [self.tracers[side], self.tracers[1 - side]];
        let start = contact.p1.position;
        let line = lines.through(start, side == 0);
        let along = contact.direction.dot(&line.direction);
        let mut add = |within: usize, line: Line<T>, from: T, span: Option<[T; 2]>, area: T| {
            if let Some([end, last]) = span {
                let (ends, depths) = ([T::zero(), end], [from.min(cap), last]);
                columns[within].room_for(1).push(Column { line, ends, depths, area });
            }
        };
        if along > T::zero() {
            add(1 - side, line, depth, line.span(other, cap), contact.area * along);
            return;
        }
        let (back, area) = (line.turned(), -contact.area * along);
        let way_back = back.span(other, cap);
        // A little inside, so as not to meet the face from which it starts.
        let inside = Line { origin: start + contact.direction * rounding(own.mesh()), ..back };
        match inside.span(own, cap) {
            Some(own_way) if way_back.is_none_or(|way| own_way[0] < way[0]) => {
                add(1 - side, line, depth, line.span(other, cap), -area);
                if shares[side] > T::zero() {
                    add(side, back, T::zero(), Some(own_way), area / shares[side] * shares[1 - side]);
                }
            }
            _ => add(1 - side, back, depth, way_back, area),
        }
    }
}

impl<T: Scalar> Columns<T> {
    /// The integral of the depth below a body's surface over the columns within it, by Simpson's rule.
    fn integral(&mut self, body: &Tracer<'_, T>, side: usize, cap: T, tolerance: T) -> T {
        let (mut sum, half) = (T::zero(), T::of(0.5));
        for halvings in 0..=MOST_HALVINGS {
            let Self { within, halves, middles, bounds, nearest } = self;
            let columns = &mut within[side];
            let middle = |column: &Column<T>| (column.ends[0] + column.ends[1]) * half;
            memory::refill(middles, columns.iter().map(|column| column.line.at(middle(column))));
            memory::refill_with(bounds, T::INFINITY, middles.len());
            body.closest_points(middles, bounds, nearest);
            halves.clear();
            for (column, nearest) in columns.iter().zip(&*nearest) {
                let Column { line, ends: [start, end], depths: [first, last], area } = *column;
                let middle = middle(column);
                let depth = nearest.as_ref().map_or(T::zero(), |nearest| nearest.distance.min(cap));
                if halvings < MOST_HALVINGS && (depth - (first + last) * half).abs() > tolerance {
                    let both = [([start, middle], [first, depth]), ([middle, end], [depth, last])];
                    memory::append(halves, both.map(|(ends, depths)| Column { line, ends, depths, area }));
                } else {
                    let width = |t: T| (T::one() - line.narrowing * t).powi(2);
                    let six = first * width(start) + depth * width(middle) * T::of(4.0) + last * width(end);
                    sum += area * (end - start) * six / T::of(6.0);
                }
            }
            std::mem::swap(columns, halves);
        }
        sum
    }
}
