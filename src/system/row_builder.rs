//! From contacts on surfaces to rows over the unknowns that carry those surfaces.

use super::Material;
use super::anchors::{AnchorPoint, Anchors, Hold, sorted};
use super::body::{Body, Mover, weights_of};
use super::buffers::Course;
use super::loads::{Key, PairLoads, Surface, in_order};
use super::row::{Entry, RigidEnd, Row, Slip};
use super::rows::{Rows, Velocities};
use super::twist::{V3, angular, at, linear};
use crate::contact::{Contact, ContactKind, ContactList, EscapePush, WeightedVertices};
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
pub(super) struct Draft {
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

/// A contact's area seen along its direction; times a stiffness in N/m³ it is the spring's coefficient. Weighted by vertex, the
/// area is 1. It is zero for contacts of an escape: the escape has a row that pushes whole bodies, so that soft ones are moved
/// and not stretched.
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

/// For friction: the triangle, or vertex, from which a contact starts, its point there, and the corners of the triangle that is
/// to give its anchor.
type Grip = (u32, AnchorPoint, Option<[u32; 3]>);

/// What moves a row beside nodes.
#[derive(Default)]
pub(super) struct Ends {
    pub(super) rigid: [Option<RigidEnd>; 2],
    /// The slip by bodies that the host moves: without contact, and at the start of the step.
    given: V3,
    given_before: V3,
    /// The velocity, at the start of the step, of the point whose normal is not the row's direction.
    pub(super) leaning: V3,
}

/// Where a contact acts on one body.
pub(super) struct End<'a, T: Scalar> {
    pub(super) at: &'a AnchorPoint,
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

    /// Where it was at the last detection.
    pub(super) fn point_ahead(&self, body: &Body<T>) -> V3 {
        if self.on.is_none() {
            return body.point_ahead(self.at);
        }
        let mut sum = V3::zeros();
        self.for_each(|vertex, weight| sum += body.vertex_ahead(vertex) * weight);
        sum
    }
}

/// A body is too flat where the vertex on its far side would need a larger weight than this.
const MOST_FAR_WEIGHT: f64 = 2.0;

impl<'a, T: Scalar> RowBuilder<'a, T> {
    /// `wanted` tells by two bodies' numbers whether to take their contacts.
    pub(super) fn add_contacts(&mut self, list: &ContactList<T>, wanted: impl Fn(u32, u32) -> bool) {
        for contacts in list.contacts.chunk_by(|one, next| one.bodies() == next.bodies()) {
            let net = net_direction(contacts, self.weighting);
            for contact in contacts {
                let pushes = if contact.colliding <= contact.collided { net } else { -net };
                self.add_contact(contact, list.spreads.vertices_of(contact), pushes, &wanted);
            }
        }
    }

    fn add_contact(
        &mut self,
        contact: &Contact<T>,
        vertices: [WeightedVertices<'_, T>; 2],
        pushes: V3,
        wanted: impl Fn(u32, u32) -> bool,
    ) {
        let area = pressed_area(contact, self.weighting).to_f64();
        let [first, second] = [contact.colliding, contact.collided].map(|number| self.body(number));
        let any_moves = first.is_movable() || second.is_movable();
        if !any_moves || area <= 0.0 || !wanted(contact.colliding, contact.collided) {
            return;
        }
        let (p1, p2) = (&contact.p1, &contact.p2);
        let direction: V3 = contact.direction.map(T::to_f64);
        let from = sorted(p1.vertices, weights_of(p1));
        let own = AnchorPoint { vertices: p2.vertices, weights: weights_of(p2), height: 0.0 };
        let spreads = vertices.map(|vertices| match vertices {
            WeightedVertices::Spread(spread) => Some(spread),
            WeightedVertices::Point(_) => None,
        });
        let [on_first, on_second] = [(&from, spreads[0]), (&own, spreads[1])].map(|(at, on)| End { at, on });
        let point = on_first.point_ahead(first);
        let key = (contact.colliding, Surface::Body(contact.collided));
        let pair = self.pair(key, None);
        let rubs = self.loads.now[pair].material.friction > 0.0;
        let draft = Draft {
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
        let inside = if rubs { point_inside(second, &own, &point) } else { None };
        self.add_end(&mut ends, 1, second, &on_second, inside, &point);
        ends.leaning = ends.given_before - given + self.velocity_before(middle, &ends.rigid[1]);
        self.finish(draft, pair, ends, rubs.then_some((p1.triangle, from, Some(p2.vertices))));
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
            let draft = Draft {
                key: (first, Surface::Body(second)),
                direction: push.direction.map(T::to_f64),
                depth: push.depth.to_f64(),
                cos_alpha: 1.0,
                area,
                pushes: V3::zeros(),
                lean: V3::zeros(),
            };
            let pair = self.pair(draft.key, None);
            self.finish(draft, pair, ends, None);
        }
    }

    fn body(&self, number: u32) -> &'a Body<T> {
        body_of(self.bodies, number)
    }

    /// The index of a row's pair; its first row finds its material.
    pub(super) fn pair(&mut self, key: Key, floor: Option<&Material>) -> usize {
        let Self { bodies, pair_materials, loads, .. } = self;
        loads.index_of(key, || material_of(bodies, pair_materials, key, floor))
    }

    /// Adds one body's entries to the row under way: for the normal force those of its end, for friction those of `inside` if
    /// given.
    pub(super) fn add_end(
        &mut self,
        ends: &mut Ends,
        side: usize,
        body: &Body<T>,
        end: &End<'_, T>,
        inside: Option<[(u32, f64); 4]>,
        point: &V3,
    ) {
        let sign = [-1.0, 1.0][side];
        match &body.mover {
            Mover::Nodes { table, .. } => {
                let begin = self.rows.begin(self.rows.rows.len());
                let mut add = |vertex: u32, along: f64, across: f64| {
                    if along != 0.0 || across != 0.0 {
                        let (along, across) = (sign * along, sign * across);
                        table.for_each(vertex, |node, weight| {
                            self.rows.add(begin, Entry { node, along: along * weight, across: across * weight });
                        });
                    }
                };
                end.for_each(|vertex, weight| add(vertex, weight, if inside.is_some() { 0.0 } else { weight }));
                // The fourth vertex is there for friction alone.
                inside.iter().flatten().for_each(|&(vertex, weight)| add(vertex, 0.0, weight));
            }
            Mover::Rigid { index, .. } => {
                let arm = point - body.ahead_pose.0;
                ends.rigid[side] = Some(RigidEnd { index: *index, sign, arm });
            }
            Mover::Host(surface) => {
                let arm = point - body.ahead_pose.0;
                let at = |twist: &[f64]| (linear(twist) + angular(twist).cross(&arm)) * sign;
                ends.given += at(&surface.free_velocity);
                ends.given_before += at(&surface.velocity);
            }
        }
    }

    fn add_whole_body(&mut self, ends: &mut Ends, side: usize, number: u32) {
        let sign = [-1.0, 1.0][side];
        match &self.body(number).mover {
            Mover::Nodes { nodes, .. } => {
                let mass = |node: u32| Some(self.node_masses[node as usize]).filter(|mass| mass.is_finite());
                let sum: f64 = nodes.clone().filter_map(mass).sum();
                for node in nodes.clone() {
                    if let Some(mass) = mass(node) {
                        self.rows.add_distinct(node, sign * mass / sum, sign * mass / sum);
                    }
                }
            }
            Mover::Rigid { index, .. } => {
                ends.rigid[side] = Some(RigidEnd { index: *index, sign, arm: V3::zeros() });
            }
            Mover::Host(surface) => {
                ends.given += linear(&surface.free_velocity) * sign;
                ends.given_before += linear(&surface.velocity) * sign;
            }
        }
    }

    /// How one of a row's ends moves at the start of the step, with the sign of its side: by the entries from `begin` on, or by
    /// a rigid body.
    pub(super) fn velocity_before(&self, begin: usize, rigid: &Option<RigidEnd>) -> V3 {
        let of_nodes = self.rows.entries[begin..].iter().map(|entry| at(self.before.nodes, entry.node) * entry.along);
        rigid.map(|end| end.velocity(self.before.twists)).unwrap_or_default() + of_nodes.sum::<V3>()
    }

    /// Makes a row of the entries added since the last one.
    pub(super) fn finish(&mut self, draft: Draft, pair: usize, ends: Ends, grip: Option<Grip>) {
        let Draft { key, direction, depth, cos_alpha, area, pushes, lean } = draft;
        let material = self.loads.now[pair].material;
        let mut row = Row {
            direction,
            coefficient: material.stiffness * area,
            damping_time: material.damping_time,
            // What presses on a surface at an angle grips less: the sides of what has sunk into a floor do not grip.
            friction: material.friction * cos_alpha,
            pair,
            order: if matches!(key.1, Surface::Body(second) if second < key.0) { -1.0 } else { 1.0 },
            given: ends.given,
            rigid: ends.rigid,
            end: self.rows.entries.len(),
            ..Row::default()
        };
        let time = self.course.time;
        // Without look-ahead, detection has not moved the bodies.
        if time > 0.0 {
            let ahead = Velocities { nodes: self.course.velocities, twists: self.course.twists };
            row.ahead = self.rows.slip_under_way(&row, ahead, ends.given);
        }
        let Slip { along: closing, across } = self.rows.slip_under_way(&row, self.before, ends.given_before);
        row.sliding = across;
        // How fast a body passes by: it moves as its centre does, and turns about the pair's push.
        let passing = |number: u32, side: usize| {
            let turning = |end: RigidEnd| {
                let spin = angular(&self.before.twists[6 * end.index..6 * end.index + 6]);
                (pushes * pushes.dot(&spin)).cross(&end.arm)
            };
            self.body(number).drift + ends.rigid[side].map(turning).unwrap_or_default()
        };
        let other = if let Surface::Body(second) = key.1 { passing(second, 1) } else { V3::zeros() };
        let seen = [passing(key.0, 0), other].map(|passing| closing - lean.dot(&(passing - ends.leaning)));
        let seen = if row.order > 0.0 { seen } else { [seen[1], seen[0]] };
        self.loads.now[pair].wander.add(row.order, row.coefficient, closing, seen);
        if let Some((triangle, from, on)) = grip.filter(|_| material.friction > 0.0) {
            let (anchor, old) = self.anchors.find(key, triangle, from, on);
            row.anchor = Some(anchor);
            // A new spring is slack at the start of the step.
            row.stretch = row.ahead.across * time;
            if let Some(old) = old {
                let from = self.body(key.0).point_ahead(&old.from);
                let stretch = row.across(&(self.hold_point(key, &old.hold) - from));
                row.stretch = if old.from == AnchorPoint::NOWHERE { stretch + row.stretch } else { stretch };
            }
        }
        // A row can undo only depth that motion along it made. What motion across it made, as at the sides of what falls onto a
        // floor, goes with that motion.
        let unseen = (time * row.ahead.across.dot(&pushes)).max(0.0) / cos_alpha;
        let depth = if depth > unseen { depth - unseen } else { 0.0 };
        let closed = (time * row.ahead.along).max(0.0);
        row.depth = Row::capped(depth, cos_alpha, closed, material.depth_cap);
        // However long a row is, it parts no faster than by the cap over the damping time. An explicit step would have to be the
        // shorter for it.
        if time > 0.0 {
            row.damping_time *= ((row.depth - closed) / material.depth_cap).max(1.0);
        }
        self.rows.rows.room_for(1).push(row);
    }

    /// Where the point that a friction spring holds on to was at the last detection.
    fn hold_point(&self, key: Key, hold: &Hold) -> V3 {
        match (hold, key.1) {
            (Hold::Material(corners), Surface::Body(number)) => self.body(number).point_ahead(corners),
            (Hold::Space(point), _) => *point,
            (Hold::Material(_), Surface::HalfSpace(_)) => V3::zeros(),
        }
    }
}

/// A pair's material, and the sum of both bodies' 1/mass.
pub(super) fn material_of<T: Scalar>(
    bodies: &[Body<T>],
    pair_materials: &PairMaterials,
    key: Key,
    floor: Option<&Material>,
) -> (Material, f64) {
    let first = body_of(bodies, key.0);
    let (other, inverse_mass) = match (key.1, floor) {
        (Surface::Body(number), _) => {
            let second = body_of(bodies, number);
            (second.material, 1.0 / second.mass)
        }
        (_, floor) => (*floor.unwrap_or(&first.material), 0.0),
    };
    let own = pair_materials.binary_search_by_key(&in_order(key).0, |(pair, _)| *pair).ok();
    let material = own.map_or_else(|| first.material.combined(&other), |index| pair_materials[index].1);
    (material, 1.0 / first.mass + inverse_mass)
}

pub(super) fn body_of<T: Scalar>(bodies: &[Body<T>], number: u32) -> &Body<T> {
    let index = bodies.binary_search_by_key(&number, |body| body.number);
    &bodies[index.expect("the scene's bodies are the system's")]
}

/// A point inside a deformable body as a weighted sum of three corners of its surface and a fourth vertex on its far side;
/// `None` where the body is too flat for that.
fn point_inside<T: Scalar>(body: &Body<T>, corners: &AnchorPoint, point: &V3) -> Option<[(u32, f64); 4]> {
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
    let w = Matrix3::from_columns(&[b - a, c - a, at(far) - a]).try_inverse()? * (point - a);
    let [first, second, third] = corners.vertices;
    (w.z.abs() <= MOST_FAR_WEIGHT).then(|| [(first, 1.0 - w.x - w.y - w.z), (second, w.x), (third, w.y), (far, w.z)])
}
