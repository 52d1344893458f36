use super::tile::TILE_SIZE;
use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::{Mesh, OrderInSpace, Topology};
use std::mem;

/// Cuts the surface, at its reference positions, into tiles: each grows from a seed over shared edges until it has 16
/// triangles or would have more than 16 vertices. Which neighbour is next: the one that adds the fewest vertices, then the
/// one nearest to the tile's centre, then the first in space. A new tile starts where the last one could not go on, so that
/// few remnants are left between tiles.
pub(super) fn cluster<T: Scalar>(mesh: &Mesh<T>) -> Vec<Vec<u32>> {
    let count = mesh.topology().triangles().len();
    let in_space = OrderInSpace::new(mesh);
    // Thrice the centres: all are compared alike.
    let centre = |triangle: u32| {
        let [a, b, c] = in_space.corners(triangle);
        a + b + c
    };
    let centres = memory::listed((0..count as u32).map(centre));
    let (topology, places) = (mesh.topology(), in_space.places());
    let taken = memory::filled(false, count);
    let mut growth =
        Growth { topology, centres, places, taken, seeds: Vec::new(), vertices: Vec::new(), border: Vec::new() };
    let mut tiles = memory::with_room(count / 12 + 1);
    for &first in &in_space.order {
        growth.seeds.room_for(1).push(first);
        while let Some(seed) = growth.seeds.pop() {
            if !growth.taken[seed as usize] {
                let tile = growth.grow(seed);
                tiles.room_for(1).push(tile);
            }
        }
    }
    tiles
}

struct Growth<'a, T: Scalar> {
    topology: &'a Topology,
    centres: Vec<Vector3<T>>,
    /// In space.
    places: Vec<u32>,
    taken: Vec<bool>,
    seeds: Vec<u32>,
    /// Of the tile that grows.
    vertices: Vec<u32>,
    /// What it may grow by.
    border: Vec<u32>,
}

impl<T: Scalar> Growth<'_, T> {
    fn grow(&mut self, seed: u32) -> Vec<u32> {
        let mut tile = memory::with_room(TILE_SIZE);
        let (mut vertices, mut border) = (mem::take(&mut self.vertices), mem::take(&mut self.border));
        vertices.clear();
        border.clear();
        border.room_for(1).push(seed);
        let mut sum = Vector3::zeros();
        while tile.len() < TILE_SIZE {
            let centre = sum / T::of((tile.len() as f64).max(1.0));
            let Some(place) = self.best(&border, &vertices, &centre) else { break };
            let triangle = border.swap_remove(place);
            self.taken[triangle as usize] = true;
            tile.room_for(1).push(triangle);
            sum += self.centres[triangle as usize];
            for vertex in self.topology.triangles()[triangle as usize] {
                if !vertices.contains(&vertex) {
                    vertices.room_for(1).push(vertex);
                }
            }
            for neighbour in neighbours(self.topology, triangle) {
                if !self.taken[neighbour as usize] && !border.contains(&neighbour) {
                    border.room_for(1).push(neighbour);
                }
            }
        }
        border.sort_unstable_by_key(|&triangle| self.places[triangle as usize]);
        memory::append(&mut self.seeds, border.iter().copied());
        (self.vertices, self.border) = (vertices, border);
        tile
    }

    /// The place in `border` of the triangle to take next; `None` where all have too many new vertices.
    fn best(&self, border: &[u32], vertices: &[u32], centre: &Vector3<T>) -> Option<usize> {
        let ranked = border.iter().enumerate().filter_map(|(place, &triangle)| {
            let corners = self.topology.triangles()[triangle as usize];
            let new = corners.iter().filter(|corner| !vertices.contains(corner)).count();
            let distance = (self.centres[triangle as usize] - centre).norm_squared();
            (vertices.len() + new <= TILE_SIZE).then_some((new, distance, self.places[triangle as usize], place))
        });
        let best = ranked.min_by(|a, b| {
            let by_distance = a.1.partial_cmp(&b.1).unwrap_or(std::cmp::Ordering::Equal);
            a.0.cmp(&b.0).then(by_distance).then(a.2.cmp(&b.2))
        });
        best.map(|(.., place)| place)
    }
}

/// The triangles across the three edges.
fn neighbours(topology: &Topology, triangle: u32) -> impl Iterator<Item = u32> {
    let corners = topology.triangles()[triangle as usize];
    (0..3).filter_map(move |i| {
        let ends = [corners[i], corners[(i + 1) % 3]].map(|vertex| (topology.triangles_around(vertex), vertex));
        // Around the other end there may be very many: the apex of a fan.
        let [(around, _), (_, other)] = if ends[0].0.len() <= ends[1].0.len() { ends } else { [ends[1], ends[0]] };
        around.iter().copied().filter(|&t| t != triangle).find(|&t| topology.triangles()[t as usize].contains(&other))
    })
}
