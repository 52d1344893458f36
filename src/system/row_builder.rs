//! From contacts on surfaces to rows over the unknowns that carry those surfaces.

use super::Material;
use super::anchors::{Anchors, Corners, Hold, sorted};
use super::body::{Body, Course, Mover, at, weights_of};
use super::loads::{Key, PairLoads, Surface, in_order};
use super::row::{Entry, Held, RigidEnd, Row, Slip};
use super::rows::{Rows, Velocities};
use super::twist::{V3, angular, linear};
use crate::contact::{Bearings, Contact, ContactKind, ContactList, EscapePush};
use crate::force::Weighting;
use crate::math::{Scalar, direction};
use crate::memory::Room;
use nalgebra::Matrix3;

/// Materials of pairs that have one of their own, in order.
pub(super) type PairMaterials = Vec<(Key, Material)>;

/// Makes rows from the contacts of one detection.
pub(super) struct RowBuilder<'a, T: Scalar> {
    pub(super) weighting: Weighting,
    pub(super) bodies: &'a [Body<T>],
    pub(super) pair_materials: &'a PairMaterials,
    pub(super) node_masses: &'a [f64],
    pub(super) rows: &'a mut Rows,
    pub(super) anchors: &'a mut Anchors,
    pub(super) loads: &'a mut PairLoads,
    /// The prediction that detection used.
    pub(super) course: Course<'a>,
    /// The velocities at the start of the step.
    pub(super) before: Velocities<'a>,
}

/// What a row is made of, apart from its entries.
pub(super) struct Spring {
    pub(super) key: Key,
    pub(super) direction: V3,
    pub(super) depth: f64,
    pub(super) cos_alpha: f64,
    /// The coefficient for a stiffness of 1.
    pub(super) area: f64,
    /// The direction of the pair's net push on its first body, of unit length, or zero.
    pub(super) pushes: V3,
    /// The outward normals of both surfaces, added up: zero where they are flush.
    pub(super) lean: V3,
}

/// A contact's area seen along its direction; multiplied by a stiffness in N/m³, it is the spring's coefficient. Weighted by
/// vertex, the area is 1. Zero for contacts of an escape, which pushes whole bodies, so that soft ones are moved and not
/// stretched.
pub(super) fn pressed_area<T: Scalar>(contact: &Contact<T>, weighting: Weighting) -> T {
    match (contact.kind, weighting) {
        (ContactKind::Escape, _) => T::zero(),
        (_, Weighting::Area) => contact.area * contact.cos_alpha,
        (_, Weighting::Vertex) => contact.cos_alpha,
    }
}

/// The direction of a pair's net push on the body with the smaller number: its contacts' directions, weighted by pressure.
fn net_direction<T: Scalar>(contacts: &[Contact<T>], weighting: Weighting) -> V3 {
    let mut sum = V3::zeros();
    for contact in contacts {
        let push = contact.direction * (pressed_area(contact, weighting) * contact.depth);
        let push: V3 = push.map(T::to_f64);
        sum += if contact.colliding <= contact.collided { push } else { -push };
    }
    direction(&sum).unwrap_or_default()
}

/// For friction: the triangle, or vertex, from which a contact starts, its point there, and the corners of the triangle that it
/// holds on to.
type Holds = (u32, Corners, Option<[u32; 3]>);

#[derive(Default)]
pub(super) struct Ends {
    pub(super) rigid: [Option<RigidEnd>; 2],
    given: V3,
    given_before: V3,
    /// The velocity, at the start of the step, of the point whose normal is not the row's direction.
    pub(super) leaning: V3,
}

/// Where a contact acts on one body.
pub(super) struct End<'a, T: Scalar> {
    pub(super) at: &'a Corners,
    /// The vertices over which it is spread, with their weights.
    pub(super) on: Option<&'a [(u32, T)]>,
}

impl<T: Scalar> End<'_, T> {
    fn for_each(&self, mut each: impl FnMut(u32, f64)) {
        match self.on {
            None => (0..3).for_each(|corner| each(self.at.vertices[corner], self.at.weights[corner])),
            Some(spread) => spread.iter().for_each(|&(vertex, weight)| each(vertex, weight.to_f64())),
        }
    }

    /// Its middle, at the last detection.
    pub(super) fn point_ahead(&self, body: &Body<T>) -> V3 {
        if self.on.is_none() {
            return body.point_ahead(self.at);
        }
        let mut sum = V3::zeros();
        self.for_each(|vertex, weight| sum += body.vertex_ahead(vertex) * weight);
        sum
    }
}

/// If the vertex on the far side would need a larger weight than this, the body is too flat there.
const MOST_FAR_WEIGHT: f64 = 2.0;

impl<T: Scalar> RowBuilder<'_, T> {
    /// `wanted` tells by two bodies' numbers whether to take their contacts.
    pub(super) fn add_contacts(&mut self, list: &ContactList<T>, wanted: impl Fn(u32, u32) -> bool) {
        let pair = |contact: &Contact<T>| {
            let Contact { colliding, collided, .. } = *contact;
            (colliding.min(collided), colliding.max(collided))
        };
        for contacts in list.contacts.chunk_by(|one, next| pair(one) == pair(next)) {
            let net = net_direction(contacts, self.weighting);
            for contact in contacts {
                let pushes = if contact.colliding <= contact.collided { net } else { -net };
                self.add_contact(contact, list.spreads.bearings(contact), pushes, &wanted);
            }
        }
    }

    fn add_contact(
        &mut self,
        contact: &Contact<T>,
        bearings: [Bearings<'_, T>; 2],
        pushes: V3,
        wanted: impl Fn(u32, u32) -> bool,
    ) {
        let area = pressed_area(contact, self.weighting).to_f64();
        let bodies = self.bodies;
        let [first, second] = [contact.colliding, contact.collided].map(|number| &bodies[place_of(bodies, number)]);
        let any_moves = first.is_movable() || second.is_movable();
        if !any_moves || area <= 0.0 || !wanted(contact.colliding, contact.collided) {
            return;
        }
        let (p1, p2) = (&contact.p1, &contact.p2);
        let direction: V3 = contact.direction.map(T::to_f64);
        let from = sorted(p1.vertices, weights_of(p1));
        let own = Corners { vertices: p2.vertices, weights: weights_of(p2), height: 0.0 };
        let spreads = bearings.map(|bearings| match bearings {
            Bearings::Spread(spread) => Some(spread),
            Bearings::Point(_) => None,
        });
        let [on_first, on_second] = [(&from, spreads[0]), (&own, spreads[1])].map(|(at, on)| End { at, on });
        let point = on_first.point_ahead(first);
        let key = (contact.colliding, Surface::Body(contact.collided));
        let pair = self.pair(key, None);
        let rubs = self.loads.now[pair].material.friction > 0.0;
        let spring = Spring {
            key,
            direction,
            depth: contact.depth.to_f64(),
            cos_alpha: contact.cos_alpha.to_f64(),
            area,
            pushes,
            lean: second.normal_ahead(p2.vertices) - direction,
        };
        let mut ends = Ends::default();
        self.add_end(&mut ends, 0, first, &on_first, None, &point);
        let (middle, given) = (self.rows.entries.len(), ends.given_before);
        let held = if rubs { held_inside(second, &own, &point) } else { None };
        self.add_end(&mut ends, 1, second, &on_second, held, &point);
        ends.leaning = ends.given_before - given + self.velocity_before(middle, &ends.rigid[1]);
        self.finish(spring, pair, ends, rubs.then_some((p1.triangle, from, Some(p2.vertices))));
    }

    /// Escaping pairs: one spring between the two centres of mass, so that every node gets the same acceleration.
    pub(super) fn add_escapes(&mut self, pushes: &[EscapePush<T>]) {
        for push in pushes {
            let [first, second] = push.bodies;
            if !self.body(first).is_movable() && !self.body(second).is_movable() {
                continue;
            }
            let mut ends = Ends::default();
            self.add_whole_body(&mut ends, 0, first);
            self.add_whole_body(&mut ends, 1, second);
            let area = match self.weighting {
                Weighting::Area => push.area.to_f64(),
                Weighting::Vertex => f64::from(push.contact_count),
            };
            let spring = Spring {
                key: (first, Surface::Body(second)),
                direction: push.direction.map(T::to_f64),
                depth: push.depth.to_f64(),
                cos_alpha: 1.0,
                area,
                pushes: V3::zeros(),
                lean: V3::zeros(),
            };
            let pair = self.pair(spring.key, None);
            self.finish(spring, pair, ends, None);
        }
    }

    fn body(&self, number: u32) -> &Body<T> {
        &self.bodies[self.place(number)]
    }

    /// The row's pair, and where it is its first row its material.
    pub(super) fn pair(&mut self, key: Key, floor: Option<&Material>) -> usize {
        let Self { bodies, pair_materials, loads, .. } = self;
        loads.place(key, || material_of(bodies, pair_materials, key, floor))
    }

    /// Adds one body's entries to the row under way: at its end for the normal force, and where `held` says for friction.
    pub(super) fn add_end(
        &mut self,
        ends: &mut Ends,
        side: usize,
        body: &Body<T>,
        end: &End<'_, T>,
        held: Option<[(u32, f64); 4]>,
        point: &V3,
    ) {
        let sign = [-1.0, 1.0][side];
        match &body.mover {
            Mover::Nodes { table, .. } => {
                let begin = self.rows.rows.last().map_or(0, |row| row.end);
                let mut add = |vertex: u32, along: f64, across: f64| {
                    if along != 0.0 || across != 0.0 {
                        let (along, across) = (sign * along, sign * across);
                        table.for_each(vertex, |node, weight| {
                            self.rows.add(begin, Entry { node, along: along * weight, across: across * weight });
                        });
                    }
                };
                end.for_each(|vertex, weight| add(vertex, weight, if held.is_some() { 0.0 } else { weight }));
                // The fourth vertex is there for friction alone.
                held.iter().flatten().for_each(|&(vertex, weight)| add(vertex, 0.0, weight));
            }
            Mover::Rigid { place, .. } => {
                let arm = point - body.ahead_pose.0;
                ends.rigid[side] = Some(RigidEnd { place: *place, sign, arm });
            }
            Mover::Host(frame) => {
                let arm = point - body.ahead_pose.0;
                let at = |twist: &[f64]| (linear(twist) + angular(twist).cross(&arm)) * sign;
                ends.given += at(&frame.free_velocity);
                ends.given_before += at(&frame.velocity);
            }
        }
    }

    fn add_whole_body(&mut self, ends: &mut Ends, side: usize, number: u32) {
        let bodies = self.bodies;
        let (body, sign) = (&bodies[place_of(bodies, number)], [-1.0, 1.0][side]);
        match &body.mover {
            Mover::Nodes { nodes, .. } => {
                let mass = |node: u32| Some(self.node_masses[node as usize]).filter(|mass| mass.is_finite());
                let sum: f64 = nodes.clone().filter_map(mass).sum();
                for node in nodes.clone() {
                    if let Some(mass) = mass(node) {
                        self.rows.add_distinct(node, sign * mass / sum, sign * mass / sum);
                    }
                }
            }
            Mover::Rigid { place, .. } => {
                ends.rigid[side] = Some(RigidEnd { place: *place, sign, arm: V3::zeros() });
            }
            Mover::Host(frame) => {
                ends.given += linear(&frame.free_velocity) * sign;
                ends.given_before += linear(&frame.velocity) * sign;
            }
        }
    }

    /// How one of a row's ends moves at the start of the step, with the sign of its side: entries from `begin` on, or a rigid
    /// body.
    pub(super) fn velocity_before(&self, begin: usize, rigid: &Option<RigidEnd>) -> V3 {
        let of_nodes = self.rows.entries[begin..].iter().map(|entry| at(self.before.nodes, entry.node) * entry.along);
        rigid.map(|end| end.velocity(self.before.twists)).unwrap_or_default() + of_nodes.sum::<V3>()
    }

    /// Makes a row of the entries added since the last one.
    pub(super) fn finish(&mut self, spring: Spring, pair: usize, ends: Ends, holds: Option<Holds>) {
        let Spring { key, direction, depth, cos_alpha, area, pushes, lean } = spring;
        let material = self.loads.now[pair].material;
        let holds = holds.filter(|_| material.friction > 0.0);
        let row = Row {
            direction,
            coefficient: material.stiffness * area,
            asked: 0.0,
            damping_time: material.damping_time,
            // Only what pushes along the surface that it presses on grips: the sides of what has sunk into a floor do not.
            friction: material.friction * cos_alpha,
            pair,
            order: if matches!(key.1, Surface::Body(second) if second < key.0) { -1.0 } else { 1.0 },
            ahead: Slip::default(),
            sliding: V3::zeros(),
            stretch: V3::zeros(),
            anchor: None,
            given: ends.given,
            rigid: ends.rigid,
            end: self.rows.entries.len(),
            held: Held::default(),
        };
        self.rows.rows.room_for(1).push(row);
        let place = self.rows.rows.len() - 1;
        let ahead = Velocities { nodes: self.course.velocities, twists: self.course.twists };
        let given = self.rows.rows[place].given;
        let (mut slip, Slip { along: closing, across: sliding }) =
            self.rows.slips_of_last((ahead, &given), (self.before, &ends.given_before));
        // How fast a body passes by: it moves as its centre does, and turns about the pair's push.
        let passing = |number: u32, side: usize| {
            let turning = |end: RigidEnd| {
                let spin = angular(&self.before.twists[6 * end.place..6 * end.place + 6]);
                (pushes * pushes.dot(&spin)).cross(&end.arm)
            };
            self.body(number).drift + ends.rigid[side].map(turning).unwrap_or_default()
        };
        let other = if let Surface::Body(second) = key.1 { passing(second, 1) } else { V3::zeros() };
        let seen = [passing(key.0, 0), other].map(|passing| closing - lean.dot(&(passing - ends.leaning)));
        let row = &self.rows.rows[place];
        let seen = if row.order > 0.0 { seen } else { [seen[1], seen[0]] };
        self.loads.now[pair].wander.add(row.order, row.coefficient, closing, seen);
        // Without look-ahead, detection has not moved the bodies.
        if self.course.time <= 0.0 {
            slip = Slip::default();
        }
        if let Some((triangle, from, on)) = holds {
            let (anchor, old) = self.anchors.find(key, triangle, from, on);
            // A new spring is slack at the start of the step.
            let mut stretch = slip.across * self.course.time;
            if let Some(old) = old.map(|place| self.anchors.before(place)) {
                let first = self.body(key.0);
                let from = first.point_ahead(&old.from);
                let to = self.held_at(key, &old.hold);
                stretch = self.rows.rows[place].across(&(to - from));
                if old.from == Corners::NOWHERE {
                    stretch += slip.across * self.course.time;
                }
            }
            let row = &mut self.rows.rows[place];
            (row.anchor, row.stretch) = (Some(anchor), stretch);
        }
        let row = &mut self.rows.rows[place];
        (row.ahead, row.sliding) = (slip, sliding);
        // The row is relieved only by motion along it: what deepens it otherwise, as a floor's top does the sides of what
        // falls onto it, is over when the step is.
        let unseen = (self.course.time * slip.across.dot(&pushes)).max(0.0) / cos_alpha;
        let depth = if depth > unseen { depth - unseen } else { 0.0 };
        row.asked = Row::asked(depth, cos_alpha, self.course.time * slip.along, material.depth_cap);
    }

    /// Where the point that a friction spring holds on to was at the last detection.
    fn held_at(&self, key: Key, hold: &Hold) -> V3 {
        match (hold, key.1) {
            (Hold::Material(corners), Surface::Body(number)) => self.bodies[self.place(number)].point_ahead(corners),
            (Hold::Space(point), _) => *point,
            (Hold::Material(_), Surface::HalfSpace(_)) => V3::zeros(),
        }
    }

    fn place(&self, number: u32) -> usize {
        place_of(self.bodies, number)
    }
}

/// A pair's material, and the sum of both bodies' 1/mass.
pub(super) fn material_of<T: Scalar>(
    bodies: &[Body<T>],
    pair_materials: &PairMaterials,
    key: Key,
    floor: Option<&Material>,
) -> (Material, f64) {
    let find = |number: u32| &bodies[place_of(bodies, number)];
    let first = find(key.0);
    let (other, inverse_mass) = match (key.1, floor) {
        (Surface::Body(number), _) => (find(number).material, 1.0 / find(number).mass),
        (_, floor) => (*floor.unwrap_or(&first.material), 0.0),
    };
    let own = pair_materials.binary_search_by_key(&in_order(key).0, |(pair, _)| *pair).ok();
    let material = own.map_or_else(|| first.material.combined(&other), |place| pair_materials[place].1);
    (material, 1.0 / first.mass + inverse_mass)
}

fn place_of<T: Scalar>(bodies: &[Body<T>], number: u32) -> usize {
    bodies.binary_search_by_key(&number, |body| body.number).expect("the scene's bodies are the system's")
}

/// A point inside a deformable body as a weighted sum of three corners of its surface and a fourth vertex on its far side;
/// `None` where the body is too flat for that.
fn held_inside<T: Scalar>(body: &Body<T>, corners: &Corners, point: &V3) -> Option<[(u32, f64); 4]> {
    if !matches!(body.mover, Mover::Nodes { .. }) {
        return None;
    }
    let at = |vertex: u32| body.ahead[vertex as usize];
    let [a, b, c] = corners.vertices.map(at);
    let normal = (b - a).cross(&(c - a));
    let far = body.outermost.iter().fold((0.0, None), |(most, best), &vertex| {
        let height = normal.dot(&(at(vertex) - a)).abs();
        if height > most { (height, Some(vertex)) } else { (most, best) }
    });
    let far = far.1?;
    let columns = [b - a, c - a, at(far) - a];
    let w = Matrix3::from_columns(&columns).try_inverse()? * (point - a);
    let weights = [1.0 - w.x - w.y - w.z, w.x, w.y, w.z];
    let [first, second, third] = corners.vertices;
    let is_fine = w.z.abs() <= MOST_FAR_WEIGHT;
    is_fine.then(|| [(first, weights[0]), (second, weights[1]), (third, weights[2]), (far, weights[3])])
}
