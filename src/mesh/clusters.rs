//! Clusters of neighbouring triangles: what the leaves of the fast octree hold. They are found once for a mesh and are the same
//! for its clones, so an octree is made faster for a mesh that had one before, or that was unpacked.

use super::{Mesh, OrderInSpace, Topology};
use crate::math::{Aabb, LANE_COUNT, Scalar, Vector3};
use crate::memory::{self, Room};
use std::mem;

/// A cluster has at most so many triangles, and as many vertices.
pub(crate) const CLUSTER_SIZE: usize = LANE_COUNT;

/// A node of the tree above clusters has at most so many children.
const CHILD_COUNT: usize = LANE_COUNT;

/// All triangles of a mesh, cluster by cluster, in the order in which the tree above leads to them.
#[derive(Debug)]
pub(crate) struct Clusters {
    triangles: Vec<u32>,
    /// How many triangles each cluster has.
    sizes: Vec<u8>,
}

impl Clusters {
    /// Of a mesh, by its reference positions.
    pub(super) fn new<T: Scalar>(mesh: &Mesh<T>) -> Self {
        let mut clusters = grow(mesh);
        let mut places =
            memory::listed(clusters.iter().zip(0..).map(|(cluster, number)| (centre(mesh, cluster), number)));
        sort(&mut places);
        let sorted = memory::listed(places.iter().map(|&(_, number)| mem::take(&mut clusters[number as usize])));
        Self {
            triangles: memory::listed(sorted.iter().flatten().copied()),
            sizes: memory::listed(sorted.iter().map(|cluster| cluster.len() as u8)),
        }
    }

    /// As they were found before, for a mesh with this topology; `None` where they cannot be its clusters.
    pub(super) fn known(topology: &Topology, triangles: Vec<u32>, sizes: Vec<u8>) -> Option<Self> {
        let count = topology.triangles().len();
        let mut is_free = memory::filled(true, count);
        let is_whole = triangles.len() == count
            && triangles.iter().all(|&triangle| is_free.get_mut(triangle as usize).is_some_and(mem::take));
        let clusters = Self { triangles, sizes };
        let are_small = clusters.sizes.iter().all(|&size| (1..=CLUSTER_SIZE).contains(&usize::from(size)));
        let sum: usize = clusters.sizes.iter().map(|&size| usize::from(size)).sum();
        (is_whole && are_small && sum == count && clusters.iter().all(|cluster| has_few_vertices(topology, cluster)))
            .then_some(clusters)
    }

    pub(crate) fn len(&self) -> usize {
        self.sizes.len()
    }

    /// The triangles of each.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = &self.triangles[..];
        self.sizes.iter().map(move |&size| {
            let (cluster, others) = rest.split_at(usize::from(size));
            rest = others;
            cluster
        })
    }

    pub(super) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    pub(super) fn sizes(&self) -> &[u8] {
        &self.sizes
    }
}

fn has_few_vertices(topology: &Topology, cluster: &[u32]) -> bool {
    let (mut vertices, mut count) = ([0; 3 * CLUSTER_SIZE], 0);
    for vertex in cluster.iter().flat_map(|&triangle| topology.triangles()[triangle as usize]) {
        if !vertices[..count].contains(&vertex) {
            vertices[count] = vertex;
            count += 1;
        }
    }
    count <= CLUSTER_SIZE
}

/// The centre of a cluster's box, and the cluster.
type Place<T> = (Vector3<T>, u32);

fn centre<T: Scalar>(mesh: &Mesh<T>, cluster: &[u32]) -> Vector3<T> {
    let mut aabb = Aabb::empty();
    let corners = cluster.iter().flat_map(|&triangle| mesh.topology().triangles()[triangle as usize]);
    corners.for_each(|vertex| aabb.include(&mesh.reference_positions()[vertex as usize]));
    aabb.centre()
}

/// Where a set of clusters is halved, and its halves again, until each part is one child's; `None` where it is.
pub(crate) fn middle(count: usize, capacity: usize) -> Option<usize> {
    // About the middle, and so that one half is all full parts.
    (count > capacity).then(|| (count / 2).next_multiple_of(capacity))
}

/// How many clusters a child can hold, if all below it are full, of a node above so many; `None` where those are its children.
pub(crate) fn capacity_below(count: usize) -> Option<usize> {
    let mut capacity = CHILD_COUNT;
    while capacity * CHILD_COUNT < count {
        capacity *= CHILD_COUNT;
    }
    (count > CHILD_COUNT).then_some(capacity)
}

/// Sorts clusters so that those under one node of the tree follow one another: a set is halved along the longest side of
/// its centres' box again and again, at places that leave as few nodes as can be.
fn sort<T: Scalar>(places: &mut [Place<T>]) {
    if let Some(capacity) = capacity_below(places.len()) {
        halve(places, capacity);
    }
}

fn halve<T: Scalar>(places: &mut [Place<T>], capacity: usize) {
    let Some(middle) = middle(places.len(), capacity) else { return sort(places) };
    let mut centres = Aabb::empty();
    places.iter().for_each(|(centre, _)| centres.include(centre));
    let axis = (centres.upper - centres.lower).imax();
    places.select_nth_unstable_by(middle, |(a, i), (b, j)| {
        a[axis].partial_cmp(&b[axis]).unwrap_or(std::cmp::Ordering::Equal).then(i.cmp(j))
    });
    let (left, right) = places.split_at_mut(middle);
    halve(left, capacity);
    halve(right, capacity);
}

/// Cuts the surface, at its reference positions, into clusters: each grows from a seed over shared edges until it has 16
/// triangles or would have more than 16 vertices. Which neighbour is next: the one that adds the fewest vertices, then the
/// one nearest to the cluster's centre, then the first in space. A new cluster starts where the last one could not go on, so
/// that few remnants are left between clusters.
fn grow<T: Scalar>(mesh: &Mesh<T>) -> Vec<Vec<u32>> {
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
    let mut clusters = memory::with_room(count / 12 + 1);
    for &first in &in_space.order {
        growth.seeds.room_for(1).push(first);
        while let Some(seed) = growth.seeds.pop() {
            if !growth.taken[seed as usize] {
                let cluster = growth.grow(seed);
                clusters.room_for(1).push(cluster);
            }
        }
    }
    clusters
}

struct Growth<'a, T: Scalar> {
    topology: &'a Topology,
    centres: Vec<Vector3<T>>,
    /// In space.
    places: Vec<u32>,
    taken: Vec<bool>,
    seeds: Vec<u32>,
    /// Of the cluster that grows.
    vertices: Vec<u32>,
    /// What it may grow by.
    border: Vec<u32>,
}

impl<T: Scalar> Growth<'_, T> {
    fn grow(&mut self, seed: u32) -> Vec<u32> {
        let mut cluster = memory::with_room(CLUSTER_SIZE);
        let (mut vertices, mut border) = (mem::take(&mut self.vertices), mem::take(&mut self.border));
        vertices.clear();
        border.clear();
        border.room_for(1).push(seed);
        let mut sum = Vector3::zeros();
        while cluster.len() < CLUSTER_SIZE {
            let centre = sum / T::of((cluster.len() as f64).max(1.0));
            let Some(place) = self.best(&border, &vertices, &centre) else { break };
            let triangle = border.swap_remove(place);
            self.taken[triangle as usize] = true;
            cluster.room_for(1).push(triangle);
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
        cluster
    }

    /// The place in `border` of the triangle to take next; `None` where all have too many new vertices.
    fn best(&self, border: &[u32], vertices: &[u32], centre: &Vector3<T>) -> Option<usize> {
        let ranked = border.iter().enumerate().filter_map(|(place, &triangle)| {
            let corners = self.topology.triangles()[triangle as usize];
            let new = corners.iter().filter(|corner| !vertices.contains(corner)).count();
            let distance = (self.centres[triangle as usize] - centre).norm_squared();
            (vertices.len() + new <= CLUSTER_SIZE).then_some((new, distance, self.places[triangle as usize], place))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn only_what_can_be_clusters_is_taken() {
        let mesh = shapes::fan(400).mesh::<f64>();
        let (topology, found) = (mesh.topology(), mesh.clusters());
        let accepted = |change: &dyn Fn(&mut Vec<u32>, &mut Vec<u8>)| {
            let (mut triangles, mut sizes) = (found.triangles.clone(), found.sizes.clone());
            change(&mut triangles, &mut sizes);
            Clusters::known(topology, triangles, sizes)
        };
        let same = accepted(&|_, _| {}).expect("they were found");
        assert!(same.iter().eq(found.iter()) && same.len() > 17);
        assert!(accepted(&|triangles, _| triangles[1] = triangles[0]).is_none(), "one triangle twice");
        assert!(accepted(&|triangles, _| triangles[1] = 800).is_none(), "an unknown triangle");
        assert!(accepted(&|triangles, _| triangles.truncate(799)).is_none(), "one triangle is missing");
        assert!(accepted(&|_, sizes| sizes.truncate(sizes.len() - 1)).is_none(), "one cluster is missing");
        assert!(accepted(&|_, sizes| sizes.push(0)).is_none(), "an empty cluster");
        assert!(
            accepted(&|_, sizes| *sizes = [17].into_iter().chain([16; 48]).chain([15]).collect()).is_none(),
            "too large"
        );
        let scattered = |triangles: &mut Vec<u32>, sizes: &mut Vec<u8>| {
            *triangles = (0..800).map(|i| i % 16 * 50 + i / 16).collect();
            *sizes = vec![16; 50];
        };
        assert!(accepted(&scattered).is_none(), "more vertices than sixteen");
        let ones = |_: &mut Vec<u32>, sizes: &mut Vec<u8>| *sizes = vec![1; 800];
        assert_eq!(accepted(&ones).expect("small ones are allowed").len(), 800);
    }

    /// What the tree assumes of their order: the clusters under each node follow one another, and those of one half lie to one
    /// side of those of the other, wherever a set is halved.
    #[test]
    fn halves_lie_apart() {
        fn assert_apart(centres: &[Vector3<f64>], capacity: usize) -> usize {
            let Some(middle) = middle(centres.len(), capacity) else {
                return capacity_below(centres.len()).map_or(0, |capacity| assert_apart(centres, capacity));
            };
            let (left, right) = centres.split_at(middle);
            let apart = |axis: usize| {
                let most = left.iter().map(|centre| centre[axis]).fold(f64::NEG_INFINITY, f64::max);
                right.iter().all(|centre| centre[axis] >= most)
            };
            assert!((0..3).any(apart), "{} and {} clusters", left.len(), right.len());
            1 + assert_apart(left, capacity) + assert_apart(right, capacity)
        }
        // Three levels of nodes.
        let mesh = shapes::fan(3000).mesh::<f64>();
        let centres: Vec<_> = mesh.clusters().iter().map(|cluster| centre(&mesh, cluster)).collect();
        let halvings = assert_apart(&centres, capacity_below(centres.len()).expect("more than one node"));
        assert!(centres.len() > 256 && halvings > 20, "{} clusters, {halvings} halvings", centres.len());
    }
}
