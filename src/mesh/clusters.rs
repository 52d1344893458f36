//! Clusters of neighbouring triangles, of which the default tree makes its tiles. They are found once for a mesh and are the same
//! for its clones, so a tree is made faster for a mesh that had one before, or that another process made.

use super::edges::NO_TRIANGLE;
use super::{OrderInSpace, Topology};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::{self, Room};
use crate::simd::LANE_COUNT;
use std::cmp::Ordering;
use std::mem;

/// A cluster has at most this many triangles, and as many vertices.
pub(crate) const CLUSTER_SIZE: usize = LANE_COUNT;

/// A node of the tree above clusters has at most this many children.
const CHILD_COUNT: usize = LANE_COUNT;

/// All triangles of a mesh, cluster by cluster, in the order in which the tree above leads to them.
#[derive(Debug)]
pub(crate) struct Clusters {
    triangles: Vec<u32>,
    /// How many triangles each cluster has.
    sizes: Vec<u8>,
}

impl Clusters {
    /// Of a mesh with these reference positions.
    pub(crate) fn new<T: Scalar>(topology: &Topology, positions: &[Vector3<T>]) -> Self {
        let mut clusters = grow(topology, positions);
        let mut centres = memory::listed(
            clusters.iter().zip(0..).map(|(cluster, number)| (centre(topology, positions, cluster), number)),
        );
        sort(&mut centres);
        let sorted = memory::listed(centres.iter().map(|&(_, number)| mem::take(&mut clusters[number as usize])));
        Self {
            triangles: memory::listed(sorted.iter().flatten().copied()),
            sizes: memory::listed(sorted.iter().map(|cluster| cluster.len() as u8)),
        }
    }

    /// Takes over clusters that were found before; `None` where they cannot be those of a mesh with this topology.
    pub(crate) fn known(topology: &Topology, triangles: Vec<u32>, sizes: Vec<u8>) -> Option<Self> {
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

    pub(crate) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    pub(crate) fn sizes(&self) -> &[u8] {
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

/// The centre of something, and its number.
type Centre<T> = (Vector3<T>, u32);

fn centre<T: Scalar>(topology: &Topology, positions: &[Vector3<T>], cluster: &[u32]) -> Vector3<T> {
    let mut aabb = Aabb::empty();
    let corners = cluster.iter().flat_map(|&triangle| topology.triangles()[triangle as usize]);
    corners.for_each(|vertex| aabb.include(&positions[vertex as usize]));
    aabb.centre()
}

/// Where a set of clusters is halved for children that hold up to `capacity` each; `None` for what one child holds.
pub(crate) fn middle(count: usize, capacity: usize) -> Option<usize> {
    // About the middle, but so that one half fills its children.
    (count > capacity).then(|| (count / 2).next_multiple_of(capacity))
}

/// How many clusters a full child of a node above this many holds; `None` where the clusters are the node's children.
pub(crate) fn capacity_below(count: usize) -> Option<usize> {
    let mut capacity = CHILD_COUNT;
    while capacity * CHILD_COUNT < count {
        capacity *= CHILD_COUNT;
    }
    (count > CHILD_COUNT).then_some(capacity)
}

/// Sorts clusters so that those under one node of the tree follow one another: a set is halved along the longest side of
/// its centres' box again and again, at places that leave as few nodes as can be.
fn sort<T: Scalar>(centres: &mut [Centre<T>]) {
    if let Some(capacity) = capacity_below(centres.len()) {
        halve(centres, capacity);
    }
}

/// Sorts points so that those close together in the list are mostly close together in space.
pub(crate) fn sort_points<T: Scalar>(points: &mut [Centre<T>]) {
    halve(points, 1);
}

fn halve<T: Scalar>(centres: &mut [Centre<T>], capacity: usize) {
    let Some(middle) = middle(centres.len(), capacity) else { return sort(centres) };
    let mut around = Aabb::empty();
    centres.iter().for_each(|(centre, _)| around.include(centre));
    let axis = (around.upper - around.lower).imax();
    centres.select_nth_unstable_by(middle, |(a, i), (b, j)| {
        a[axis].partial_cmp(&b[axis]).unwrap_or(Ordering::Equal).then(i.cmp(j))
    });
    let (left, right) = centres.split_at_mut(middle);
    halve(left, capacity);
    halve(right, capacity);
}

/// Cuts the surface, at its reference positions, into clusters. Each grows from a seed over shared edges until it has 16
/// triangles or would have more than 16 vertices. Next comes the neighbour that adds the fewest vertices; of several the one
/// nearest to the cluster's centre, then the first in space. A new cluster starts where the last one could not go on, so
/// that few remnants are left between clusters.
fn grow<T: Scalar>(topology: &Topology, positions: &[Vector3<T>]) -> Vec<Vec<u32>> {
    let count = topology.triangles().len();
    let in_space = OrderInSpace::new(topology, positions);
    let (neighbours, places) = (topology.neighbours(), in_space.places());
    let cluster_of = memory::filled(NO_CLUSTER, count);
    let (seeds, border) = (Vec::new(), Vec::new());
    let mut growth =
        Growth { in_space: &in_space, triangles: topology.triangles(), neighbours, places, cluster_of, seeds, border };
    let mut clusters = memory::with_room(count / 12 + 1);
    for &first in &in_space.order {
        growth.seeds.room_for(1).push(first);
        while let Some(seed) = growth.seeds.pop() {
            if growth.cluster_of[seed as usize] != TAKEN {
                let cluster = growth.grow(seed, clusters.len() as u32);
                clusters.room_for(1).push(cluster);
            }
        }
    }
    clusters
}

/// In place of a cluster's number: no cluster has come to the triangle; the triangle belongs to a cluster for good.
const NO_CLUSTER: u32 = u32::MAX;
const TAKEN: u32 = u32::MAX - 1;

struct Growth<'a, T: Scalar> {
    in_space: &'a OrderInSpace<'a, T>,
    triangles: &'a [[u32; 3]],
    neighbours: Vec<[u32; 3]>,
    /// By triangle its place in space.
    places: Vec<u32>,
    /// By triangle the last cluster that bordered on it.
    cluster_of: Vec<u32>,
    seeds: Vec<u32>,
    /// The triangles that the present cluster may grow by.
    border: Vec<Candidate<T>>,
}

/// A triangle that a cluster may grow by.
#[derive(Clone, Copy)]
struct Candidate<T: Scalar> {
    triangle: u32,
    corners: [u32; 3],
    /// How many of its corners the cluster does not have.
    new: u32,
    /// Its place in space.
    place: u32,
    /// Three times its centre, as all are compared.
    centre: Vector3<T>,
}

impl<T: Scalar> Growth<'_, T> {
    fn grow(&mut self, seed: u32, number: u32) -> Vec<u32> {
        let mut cluster = memory::with_room(CLUSTER_SIZE);
        let (mut vertices, mut count) = ([0; CLUSTER_SIZE], 0);
        self.border.clear();
        self.cluster_of[seed as usize] = number;
        let first = self.candidate(seed, &[]);
        self.border.room_for(1).push(first);
        let mut sum = Vector3::zeros();
        while cluster.len() < CLUSTER_SIZE {
            let centre = sum / T::of((cluster.len() as f64).max(1.0));
            let Some(place) = best(&self.border, CLUSTER_SIZE - count, &centre) else { break };
            let Candidate { triangle, corners, centre, .. } = self.border.swap_remove(place);
            self.cluster_of[triangle as usize] = TAKEN;
            cluster.room_for(1).push(triangle);
            sum += centre;
            for vertex in corners {
                if !vertices[..count].contains(&vertex) {
                    vertices[count] = vertex;
                    count += 1;
                    for candidate in &mut self.border {
                        candidate.new -= u32::from(candidate.corners.contains(&vertex));
                    }
                }
            }
            for neighbour in self.neighbours[triangle as usize] {
                if neighbour == NO_TRIANGLE || [number, TAKEN].contains(&self.cluster_of[neighbour as usize]) {
                    continue;
                }
                self.cluster_of[neighbour as usize] = number;
                let candidate = self.candidate(neighbour, &vertices[..count]);
                self.border.room_for(1).push(candidate);
            }
        }
        self.border.sort_unstable_by_key(|candidate| candidate.place);
        memory::append(&mut self.seeds, self.border.iter().map(|candidate| candidate.triangle));
        cluster
    }

    fn candidate(&self, triangle: u32, vertices: &[u32]) -> Candidate<T> {
        let corners = self.triangles[triangle as usize];
        let new = corners.iter().filter(|corner| !vertices.contains(corner)).count() as u32;
        let [a, b, c] = self.in_space.corners(triangle);
        Candidate { triangle, corners, new, place: self.places[triangle as usize], centre: a + b + c }
    }
}

/// The place of the candidate to take next; `None` where all have more new vertices than there is room for.
fn best<T: Scalar>(border: &[Candidate<T>], room: usize, centre: &Vector3<T>) -> Option<usize> {
    let mut best: Option<(usize, &Candidate<T>, T)> = None;
    for (place, candidate) in border.iter().enumerate().filter(|(_, candidate)| candidate.new as usize <= room) {
        let distance = (candidate.centre - centre).norm_squared();
        let is_better = best.is_none_or(|(_, best, least)| {
            let by_distance = distance.partial_cmp(&least).unwrap_or(Ordering::Equal);
            candidate.new.cmp(&best.new).then(by_distance).then(candidate.place.cmp(&best.place)).is_lt()
        });
        if is_better {
            best = Some((place, candidate, distance));
        }
    }
    best.map(|(place, ..)| place)
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
        let centres: Vec<_> = mesh
            .clusters()
            .iter()
            .map(|cluster| centre(mesh.topology(), mesh.reference_positions(), cluster))
            .collect();
        let halvings = assert_apart(&centres, capacity_below(centres.len()).expect("more than one node"));
        assert!(centres.len() > 256 && halvings > 20, "{} clusters, {halvings} halvings", centres.len());
    }
}
