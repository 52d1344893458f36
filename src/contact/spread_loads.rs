//! Over which vertices a contact's load is spread. Where one ray stands for many triangles, its load lies on the vertices of
//! all of them, as that of an even pressure does, and its opposite on about as much of the other surface around the ray's end.

use crate::contact::list::ContactList;
use crate::contact::pair::Pair;
use crate::contact::point_pair::{Contact, ContactKind, SurfacePoint};
use crate::contact::spread::{EndWorkspace, Marks, SpreadWorkspace};
use crate::math::{Scalar, Vector3, length, normalising_factor};
use crate::memory::{self, Room};
use crate::mesh::Mesh;

impl<T: Scalar> Pair<'_, T> {
    /// Spreads the loads of its contacts, from `start` on, where they are those of elements.
    pub(crate) fn spread_loads(&self, start: usize, list: &mut ContactList<T>) {
        // Cages spread loads by themselves, and rigid bodies need not.
        let are_nodes = self.tracers.iter().any(|tracer| tracer.mesh().are_vertices_nodes());
        let Some(shares) = self.fixed_shares.filter(|_| are_nodes && list.len() > start) else { return };
        let ContactList { contacts, spreads, workspace, .. } = list;
        let SpreadWorkspace { ends, marks } = &mut workspace.spread;
        let meshes = self.tracers.map(|tracer| tracer.mesh());
        marks.start(meshes.map(Mesh::topology));
        for contact in contacts[start..].iter_mut().filter(|contact| contact.kind == ContactKind::Ray) {
            let side = usize::from(contact.colliding != self.bodies[0]);
            let area = contact.area / shares[side];
            if area > T::zero() {
                let [first, second] = &mut *ends;
                let mut first = End::new(meshes[side], contact, area, first);
                let mut second = End::new(meshes[1 - side], contact, area, second);
                if bear(contact, [&mut first, &mut second], area, marks) {
                    let gap = (second.mean() - first.mean()).dot(&contact.direction) / first.factor;
                    contact.spread = spreads.add([first.vertices, second.vertices], gap);
                }
            }
        }
        marks.is_unfinished = false;
    }
}

/// Finds the vertices that bear the two ends of a contact of this area; false where those of one triangle each will do.
fn bear<T: Scalar>(contact: &Contact<T>, [first, second]: [&mut End<'_, T>; 2], area: T, marks: &mut Marks) -> bool {
    let patches = first.mesh.patches();
    let patch = patches.named(!contact.piece, contact.p1.triangle);
    if patch.is_none() && area + area <= length(&second.mesh.scaled_normal(contact.p2.triangle)) {
        return false;
    }
    match patch {
        Some(patch) => first.bear_on_patch(patches.triangles_of(patch), marks),
        None => first.bear_on_corners(&contact.p1),
    }
    // The pair feels no torque if the means of both ends lie on one line along the force.
    let from = first.local(&contact.p1.position);
    let aside = first.mean() - from;
    if second.bear_around(contact.p2.triangle, &aside, area, marks) {
        return true;
    }
    second.bear_on_corners(&contact.p2);
    if patch.is_none() || second.move_mean(&aside) {
        return patch.is_some();
    }
    second.bear_on_corners(&contact.p2);
    first.move_mean(&from)
}

/// The vertices that bear one end of a contact. Coordinates are about its second point, scaled so that its area is from 1 to 4.
struct End<'a, T: Scalar> {
    mesh: &'a Mesh<T>,
    origin: Vector3<T>,
    factor: T,
    /// Of the push.
    direction: Vector3<T>,
    vertices: &'a mut Vec<(u32, T)>,
    positions: &'a mut Vec<Vector3<T>>,
}

impl<'a, T: Scalar> End<'a, T> {
    fn new(mesh: &'a Mesh<T>, contact: &Contact<T>, area: T, scratch: &'a mut EndWorkspace<T>) -> Self {
        let (factor, _) = normalising_factor(area.sqrt());
        let EndWorkspace { vertices, positions } = scratch;
        let mut end =
            Self { mesh, origin: contact.p2.position, factor, direction: contact.direction, vertices, positions };
        end.clear();
        end
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.positions.clear();
    }

    fn local(&self, point: &Vector3<T>) -> Vector3<T> {
        (point - self.origin) * self.factor
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn corners(&self, [a, b, c]: [u32; 3]) -> [Vector3<T>; 3] {
        [self.mesh.position(a), self.mesh.position(b), self.mesh.position(c)].map(|corner| self.local(&corner))
    }

    fn mean(&self) -> Vector3<T> {
        self.weights().fold(Vector3::zeros(), |sum, (position, weight)| sum + position * weight)
    }

    fn weights(&self) -> impl Iterator<Item = (Vector3<T>, T)> {
        self.positions.iter().zip(&*self.vertices).map(|(&position, &(_, weight))| (position, weight))
    }

    /// The corners of a point's triangle.
    fn bear_on_corners(&mut self, point: &SurfacePoint<T>) {
        let corners = (0..3).map(|corner| (point.vertices[corner], point.weights[corner]));
        memory::refill(self.vertices, corners);
        memory::refill(self.positions, self.corners(point.vertices));
    }

    /// The vertices of a patch, as an even pressure loads them.
    fn bear_on_patch(&mut self, triangles: &[u32], marks: &mut Marks) {
        let all = self.mesh.topology().triangles();
        for &triangle in triangles {
            let vertices = all[triangle as usize];
            let [a, b, c] = self.corners(vertices);
            self.load(vertices, [a, b, c], (b - a).cross(&(c - a)).norm(), marks);
        }
        self.normalise(marks);
    }

    /// Spreads over the triangles around the origin that face the push, of about this area, starting with `triangle`. The
    /// nearest bear most. Seen along the push, the mean of the vertices is `aside`. False where only one triangle would bear.
    fn bear_around(&mut self, triangle: u32, aside: &Vector3<T>, area: T, marks: &mut Marks) -> bool {
        // With weights that fall to 0 there, the area counts a little more than once.
        let mut square = area * self.factor * self.factor * T::of(0.7);
        loop {
            let count = self.load_around(triangle, square, marks);
            self.normalise(marks);
            if count > 1 && self.move_mean(aside) {
                return true;
            }
            // Beside an edge only a smaller area lies evenly around the origin.
            self.clear();
            square *= T::of(0.25);
            if count < 2 {
                return false;
            }
        }
    }

    /// Loads the triangles within a distance of the origin that face the push; gives how many there are.
    fn load_around(&mut self, triangle: u32, square: T, marks: &mut Marks) -> usize {
        let topology = self.mesh.topology();
        marks.met.clear();
        let mut count = usize::from(self.load_within(triangle, square, marks));
        let mut next = 0;
        // Triangles around a vertex that bears some of the load may bear some too.
        while let Some(&(vertex, _)) = self.vertices.get(next) {
            next += 1;
            for &neighbour in topology.triangles_around(vertex) {
                count += usize::from(!marks.is_met[neighbour as usize] && self.load_within(neighbour, square, marks));
            }
        }
        marks.met.iter().for_each(|&triangle| marks.is_met[triangle as usize] = false);
        count
    }

    /// Loads a triangle where its middle lies within a distance of the origin and it faces the push.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load_within(&mut self, triangle: u32, square: T, marks: &mut Marks) -> bool {
        marks.is_met[triangle as usize] = true;
        marks.met.room_for(1).push(triangle);
        let vertices = self.mesh.topology().triangles()[triangle as usize];
        let [a, b, c] = self.corners(vertices);
        let facing = (b - a).cross(&(c - a)).dot(&self.direction);
        let away = ((a + b + c) / T::of(3.0)).norm_squared();
        // Written so that NaN is left out.
        let bears = away < square && facing > T::zero();
        if bears {
            self.load(vertices, [a, b, c], facing * (square - away), marks);
        }
        bears
    }

    /// Adds the same weight to three vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load(&mut self, vertices: [u32; 3], corners: [Vector3<T>; 3], weight: T, marks: &mut Marks) {
        for (vertex, corner) in vertices.into_iter().zip(corners) {
            let number = &mut marks.numbers[vertex as usize];
            if *number == 0 {
                self.vertices.room_for(1).push((vertex, T::zero()));
                self.positions.room_for(1).push(corner);
                *number = self.vertices.len() as u32;
            }
            self.vertices[*number as usize - 1].1 += weight;
        }
    }

    /// Makes the weights sum to 1, and takes back the marks of the vertices.
    fn normalise(&mut self, marks: &mut Marks) {
        let sum = self.vertices.iter().fold(T::zero(), |sum, &(_, weight)| sum + weight);
        for (vertex, weight) in &mut *self.vertices {
            marks.numbers[*vertex as usize] = 0;
            *weight /= sum;
        }
    }

    /// Multiplies the weights by a function that is linear across the push, so that their mean moves to `to`, seen along the
    /// push. False, with useless weights, where one would be negative.
    fn move_mean(&mut self, to: &Vector3<T>) -> bool {
        let direction = self.direction;
        let other = if direction.x.abs() < direction.y.abs() { Vector3::x() } else { Vector3::y() };
        let u = direction.cross(&other).normalize();
        let axes = [u, direction.cross(&u)];
        let along = |vector: Vector3<T>| axes.each_ref().map(|axis| vector.dot(axis));
        let mean = self.mean();
        let (mut uu, mut uv, mut vv) = (T::zero(), T::zero(), T::zero());
        for (position, weight) in self.weights() {
            let [u, v] = along(position - mean);
            (uu, uv, vv) = (uu + weight * u * u, uv + weight * u * v, vv + weight * v * v);
        }
        let [u, v] = along(to - mean);
        let determinant = uu * vv - uv * uv;
        let change = [(vv * u - uv * v) / determinant, (uu * v - uv * u) / determinant];
        self.positions.iter().zip(&mut *self.vertices).all(|(position, (_, weight))| {
            let [u, v] = along(position - mean);
            *weight *= T::one() + change[0] * u + change[1] * v;
            *weight >= T::zero()
        })
    }
}
