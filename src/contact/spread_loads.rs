//! Over which vertices a contact's load is spread. Where one ray stands for many triangles, its load lies on the vertices of
//! all of them, as that of an even pressure does, and its opposite on about as much of the other surface around the ray's end.

use crate::contact::list::ContactList;
use crate::contact::outline::{Below, Flat, Outline};
use crate::contact::pair::Pair;
use crate::contact::point_pair::{Contact, ContactKind, SurfacePoint};
use crate::contact::quadrature::corners::Corners;
use crate::contact::spread::{EndWorkspace, Marks, SpreadWorkspace};
use crate::math::{Scalar, Vector3, length, normalising_factor};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::simd::LANE_COUNT;

impl<T: Scalar> Pair<'_, T> {
    /// Spreads the loads of its contacts, from `start` on, where they are those of elements.
    pub(crate) fn spread_loads(&self, start: usize, list: &mut ContactList<T>) {
        // Cages spread loads by themselves, and rigid bodies need not.
        let are_nodes = self.tracers.iter().any(|tracer| tracer.mesh().are_vertices_nodes());
        let Some(shares) = self.fixed_shares.filter(|_| are_nodes && list.len() > start) else { return };
        let ContactList { contacts, spreads, workspace, .. } = list;
        let SpreadWorkspace { ends, marks, outline } = &mut workspace.spread;
        let meshes = self.tracers.map(|tracer| tracer.mesh());
        marks.start(meshes.map(Mesh::topology));
        for contact in contacts[start..].iter_mut().filter(|contact| contact.kind == ContactKind::Ray) {
            let side = usize::from(contact.colliding != self.bodies[0]);
            let area = contact.area / shares[side];
            let patches = meshes[side].patches();
            let patch = patches.named(!contact.piece, contact.p1.triangle);
            let target = meshes[1 - side];
            let is_small = || area + area <= length(&target.scaled_normal(contact.p2.triangle));
            let is_alone = patch.is_none() && !target.are_vertices_known_nodes() && is_small();
            if area > T::zero() && !is_alone {
                let [first, second] = &mut *ends;
                let mut first = End::new(meshes[side], contact, area, first);
                let mut second = End::new(target, contact, area, second);
                if bear(contact, patch, [&mut first, &mut second], area, outline, marks) {
                    let gap = (second.mean() - first.mean()).dot(&contact.direction) / first.factor;
                    contact.spread = spreads.add([first.vertices, second.vertices], gap);
                }
            }
        }
        marks.is_unfinished = false;
    }
}

/// Finds the vertices that bear the two ends of a contact of this area and of this patch, if that is what casts; false where those
/// of one triangle each will do.
fn bear<T: Scalar>(
    contact: &Contact<T>,
    patch: Option<u32>,
    [first, second]: [&mut End<'_, T>; 2],
    area: T,
    outline: &mut Outline<T>,
    marks: &mut Marks,
) -> bool {
    let mut is_exact = second.mesh.are_vertices_known_nodes();
    let from = first.local(&contact.p1.position);
    outline.clear();
    match patch {
        Some(patch) => {
            let triangles = first.mesh.patches().triangles_of(patch);
            first.bear_on_patch(triangles, marks);
            if is_exact {
                first.outline_patch(triangles, &from, outline, marks);
            }
        }
        None => {
            first.bear_on_corners(&contact.p1);
            if is_exact {
                let piece = Corners::of_piece(first.mesh.corners(contact.p1.triangle), contact.piece);
                // A vertex is no piece, and what was halved more than 30 times is not known by its number.
                is_exact = piece.middle().0 == contact.p1.position;
                let ([a, b, c], axes) = (piece.positions, first.axes());
                [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| first.outline_edge(edge, &from, &axes, outline));
            }
        }
    }
    // The pair feels no torque if the means of both ends lie on one line along the force.
    let aside = first.mean() - from;
    // With weights that fall to 0 there, the area counts a little more than once.
    let square = area * first.factor * first.factor * T::of(0.7);
    let is_borne = second.bear_evenly(&aside, marks, |end, size, marks| {
        if is_exact {
            end.load_below(contact.p2.triangle, outline, size, marks)
        } else {
            end.load_around(contact.p2.triangle, square * size * size, marks)
        }
    });
    if is_borne {
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
    flat: &'a mut Vec<Flat<T>>,
}

impl<'a, T: Scalar> End<'a, T> {
    fn new(mesh: &'a Mesh<T>, contact: &Contact<T>, area: T, scratch: &'a mut EndWorkspace<T>) -> Self {
        let (factor, _) = normalising_factor(area.sqrt());
        let EndWorkspace { vertices, positions, flat } = scratch;
        let (origin, direction) = (contact.p2.position, contact.direction);
        let mut end = Self { mesh, origin, factor, direction, vertices, positions, flat };
        end.clear();
        end
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.positions.clear();
        self.flat.clear();
    }

    fn local(&self, point: &Vector3<T>) -> Vector3<T> {
        (point - self.origin) * self.factor
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn corners(&self, [a, b, c]: [u32; 3]) -> [Vector3<T>; 3] {
        [self.mesh.position(a), self.mesh.position(b), self.mesh.position(c)].map(|corner| self.local(&corner))
    }

    /// Two directions across the push.
    fn axes(&self) -> [Vector3<T>; 2] {
        let direction = self.direction;
        let other = if direction.x.abs() < direction.y.abs() { Vector3::x() } else { Vector3::y() };
        let u = direction.cross(&other).normalize();
        [u, direction.cross(&u)]
    }

    fn mean(&self) -> Vector3<T> {
        self.weights().fold(Vector3::zeros(), |sum, (position, weight)| sum + position * weight)
    }

    fn weights(&self) -> impl Iterator<Item = (Vector3<T>, T)> {
        self.positions.iter().zip(&*self.vertices).map(|(&position, &(_, weight))| (position, weight))
    }

    /// Adds the edges around a patch, about a point of it.
    #[inline(never)]
    fn outline_patch(&self, triangles: &[u32], from: &Vector3<T>, outline: &mut Outline<T>, marks: &mut Marks) {
        let (topology, axes) = (self.mesh.topology(), self.axes());
        triangles.iter().for_each(|&triangle| marks.meet(triangle));
        for &triangle in triangles {
            let [a, b, c] = self.mesh.corners(triangle);
            for (k, edge) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                let mut others = topology.across(triangle, [0, 1, 2].map(|other| other == k));
                if !others.any(|other| marks.is_met[other as usize]) {
                    self.outline_edge(edge, from, &axes, outline);
                }
            }
        }
        marks.forget();
    }

    /// Adds an edge, which goes around what lies to its left as seen from outside.
    fn outline_edge(
        &self,
        [a, b]: [Vector3<T>; 2],
        from: &Vector3<T>,
        axes: &[Vector3<T>; 2],
        outline: &mut Outline<T>,
    ) {
        let flat = |point: &Vector3<T>| flat(&(self.local(point) - from), axes);
        // Seen along the push, that is from inside, it is the other way around.
        outline.add([flat(&b), flat(&a)]);
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

    /// Spreads over the triangles around the origin that face the push, so that the mean of the vertices is `aside`, seen along
    /// the push. `load` adds them, given by how much the area is to be smaller, and says how many there are. False where only one
    /// would bear.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bear_evenly(
        &mut self,
        aside: &Vector3<T>,
        marks: &mut Marks,
        mut load: impl FnMut(&mut Self, T, &mut Marks) -> usize,
    ) -> bool {
        let mut size = T::one();
        loop {
            let count = load(self, size, marks);
            self.normalise(marks);
            if count > 1 && self.move_mean(aside) {
                return true;
            }
            // Beside an edge only a smaller area lies evenly around the origin.
            self.clear();
            size *= T::of(0.5);
            if count < 2 {
                return false;
            }
        }
    }

    /// Loads what lies below an outline of this size and faces the push, from a triangle on; gives how many triangles that are.
    #[inline(never)] // so that the common way, the other one, keeps its registers
    fn load_below(&mut self, triangle: u32, outline: &Outline<T>, size: T, marks: &mut Marks) -> usize {
        let (topology, axes) = (self.mesh.topology(), self.axes());
        let (mut below, mut corners, mut lane) = (Below::new(), [[0; 3]; LANE_COUNT], 0);
        let (mut count, mut next) = (0, 0);
        marks.meet(triangle);
        while let Some(&triangle) = marks.met.get(next) {
            next += 1;
            let [a, b, c] = topology.triangles()[triangle as usize];
            corners[lane] = [self.number(a, &axes, marks), self.number(b, &axes, marks), self.number(c, &axes, marks)];
            let [a, b, c] = corners[lane];
            // The outline stays as it is, so all else is larger.
            let flat = [self.flat[a], self.flat[b], self.flat[c]].map(|[x, y]| [x / size, y / size]);
            if let Some(crossed) = outline.crosses(&flat) {
                below.set(lane, flat);
                lane += 1;
                topology.across(triangle, crossed).for_each(|other| marks.meet(other));
            }
            if lane == LANE_COUNT || (next == marks.met.len() && lane > 0) {
                let weights = outline.weights_below(&below);
                for (k, corners) in corners[..lane].iter().enumerate() {
                    let of_lane = [weights[0][k], weights[1][k], weights[2][k]];
                    count += usize::from(of_lane[0] + of_lane[1] + of_lane[2] > T::zero());
                    corners.iter().zip(of_lane).for_each(|(&corner, weight)| self.vertices[corner].1 += weight);
                }
                lane = 0;
            }
        }
        marks.forget();
        self.forget_unloaded(marks);
        count
    }

    /// The place of a vertex among those that may bear.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn number(&mut self, vertex: u32, axes: &[Vector3<T>; 2], marks: &mut Marks) -> usize {
        let number = &mut marks.numbers[vertex as usize];
        if *number == 0 {
            let position = self.local(&self.mesh.position(vertex));
            self.vertices.room_for(1).push((vertex, T::zero()));
            self.positions.room_for(1).push(position);
            self.flat.room_for(1).push(flat(&position, axes));
            *number = self.vertices.len() as u32;
        }
        *number as usize - 1
    }

    /// Removes the vertices that bear nothing.
    fn forget_unloaded(&mut self, marks: &mut Marks) {
        let mut kept = 0;
        for place in 0..self.vertices.len() {
            let (vertex, weight) = self.vertices[place];
            marks.numbers[vertex as usize] = 0;
            if weight > T::zero() {
                (self.vertices[kept], self.positions[kept]) = ((vertex, weight), self.positions[place]);
                kept += 1;
            }
        }
        self.vertices.truncate(kept);
        self.positions.truncate(kept);
    }

    /// Loads the triangles within a distance of the origin that face the push; gives how many there are.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load_around(&mut self, triangle: u32, square: T, marks: &mut Marks) -> usize {
        let topology = self.mesh.topology();
        let mut count = usize::from(self.load_within(triangle, square, marks));
        let mut next = 0;
        // Triangles around a vertex that bears some of the load may bear some too.
        while let Some(&(vertex, _)) = self.vertices.get(next) {
            next += 1;
            for &neighbour in topology.triangles_around(vertex) {
                count += usize::from(!marks.is_met[neighbour as usize] && self.load_within(neighbour, square, marks));
            }
        }
        marks.forget();
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
        let axes = self.axes();
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

/// As seen along the push.
#[cfg_attr(not(debug_assertions), inline(always))]
fn flat<T: Scalar>(local: &Vector3<T>, axes: &[Vector3<T>; 2]) -> Flat<T> {
    [local.dot(&axes[0]), local.dot(&axes[1])]
}
