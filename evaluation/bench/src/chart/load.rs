//! Net force and torque of each pair, how far they are from the limit, and how the methods' pushes are weighted.

use crate::Vector;
use crate::host::Host;
use crate::method::Push;
use crate::workload::Workload;
use std::collections::BTreeMap;

/// What a push stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Weights {
    /// Its area: as the method says, else that around its vertex, half of it since both bodies cast.
    Area,
    /// All pushes of a body stand for as much, as in the paper: the mean of their areas, else half the mean area around
    /// its vertices. So only the spread is judged, not the choice of the stiffness.
    Paper,
}

/// On the first body of a pair.
#[derive(Clone, Copy, Default)]
struct Load {
    force: Vector,
    torque: Vector,
}

/// Of all pairs that touch, by their bodies.
#[derive(Default)]
pub struct Loads(BTreeMap<[u32; 2], Load>);

/// How far loads are from those of the limit.
#[derive(Clone, Copy, Default)]
pub struct Difference {
    /// The larger of the errors of force and torque, each over the limit's forces; torques over half the diagonal of the
    /// pair's overlap box.
    pub force: f64,
    /// Degrees between the net forces, in the mean over the pairs, weighted by force.
    pub direction: f64,
}

/// The bodies of a scene at one step.
pub struct Moment {
    boxes: Vec<[Vector; 2]>,
    /// By body and vertex.
    areas: Vec<Vec<f64>>,
}

impl Moment {
    pub fn new(workload: &Workload, host: &Host) -> Self {
        let mut moment = Self { boxes: Vec::new(), areas: Vec::new() };
        for (body, host) in workload.bodies.iter().zip(&host.bodies) {
            let at = |vertex: u32| Vector::from(host.double()[vertex as usize]);
            let mut areas = vec![0.0; body.rest.len()];
            let mut bounds = [at(0), at(0)];
            for &[a, b, c] in &body.triangles {
                let area = (at(b) - at(a)).cross(&(at(c) - at(a))).norm() / 2.0;
                for vertex in [a, b, c] {
                    areas[vertex as usize] += area / 3.0;
                    bounds = [bounds[0].inf(&at(vertex)), bounds[1].sup(&at(vertex))];
                }
            }
            moment.boxes.push(bounds);
            moment.areas.push(areas);
        }
        moment
    }

    /// Corners of the overlap box of two bodies.
    fn overlap(&self, pair: [u32; 2]) -> [Vector; 2] {
        let [a, b] = pair.map(|body| &self.boxes[body as usize]);
        [a[0].sup(&b[0]), a[1].inf(&b[1])]
    }

    /// Net force and torque of each pair, about the middle of its overlap box.
    pub fn loads(&self, pushes: &[Push], weights: Weights) -> Loads {
        let means: Vec<f64> = (0..self.boxes.len()).map(|body| self.mean_area(pushes, body)).collect();
        let mut loads = BTreeMap::<_, Load>::new();
        for push in pushes {
            let [pushed, other] = push.bodies;
            let weight = match (weights, push.area, push.vertices.first()) {
                (Weights::Area, Some(area), _) => area,
                (Weights::Area, None, Some(&[_, vertex])) => self.areas[pushed as usize][vertex as usize] / 2.0,
                _ => means[pushed as usize],
            };
            let pair = [pushed.min(other), pushed.max(other)];
            let [lower, upper] = self.overlap(pair);
            let force = push.force * weight * if pushed == pair[0] { 1.0 } else { -1.0 };
            let load = loads.entry(pair).or_default();
            load.force += force;
            load.torque += (push.point - (lower + upper) / 2.0).cross(&force);
        }
        Loads(loads)
    }

    fn mean_area(&self, pushes: &[Push], body: usize) -> f64 {
        let own = pushes.iter().filter(|push| push.bodies[0] as usize == body);
        let areas: Vec<f64> = own.filter_map(|push| push.area).collect();
        let (areas, share) = if areas.is_empty() { (&self.areas[body], 0.5) } else { (&areas, 1.0) };
        areas.iter().sum::<f64>() * share / areas.len() as f64
    }

    /// How far `found` is from `limit`.
    pub fn difference(&self, limit: &Loads, found: &Loads) -> Difference {
        let (mut total, mut sum) = (0.0, [0.0; 3]);
        for pair in limit.0.keys().chain(found.0.keys().filter(|pair| !limit.0.contains_key(*pair))) {
            let of = |loads: &Loads| loads.0.get(pair).copied().unwrap_or_default();
            let (exact, has) = (of(limit), of(found));
            let [lower, upper] = self.overlap(*pair);
            let force = exact.force.norm();
            total += force;
            sum[0] += (has.force - exact.force).norm();
            sum[1] += (has.torque - exact.torque).norm() / ((upper - lower).norm() / 2.0);
            // No force at all is no better than one across.
            let is_comparable = force > 0.0 && has.force.norm() > 0.0;
            sum[2] += force * if is_comparable { has.force.angle(&exact.force).to_degrees() } else { 90.0 };
        }
        let [force, torque, direction] = sum.map(|sum| sum / total);
        Difference { force: force.max(torque), direction }
    }
}

impl Loads {
    /// Where this goes when edges are halved again and again, the error falling with their square.
    pub fn extrapolated(&self, coarser: &Self) -> Self {
        let further = |(pair, load): (&[u32; 2], &Load)| {
            let before = coarser.0.get(pair).copied().unwrap_or(*load);
            let force = load.force + (load.force - before.force) / 3.0;
            (*pair, Load { force, torque: load.torque + (load.torque - before.torque) / 3.0 })
        };
        Self(self.0.iter().map(further).collect())
    }
}
