//! Takes the times of rays: round by round, in each every method in turn.

use super::Arguments;
use super::embree::{self, RayHit, Way};
use super::kinds::{self, Kind};
use super::row::Row;
use crate::c_library::Surface;
use crate::clock;
use crate::host::Host;
use crate::libraries::Libraries;
use crate::measure::{ROUNDS, median};
use crate::peer::BodyView;
use crate::workload::{Body, Workload};
use raycontact::capi::{rayc_hit, rayc_ray, rayc_scalar};
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::triangle::{Hit, Ray};

/// So many rays of a kind are held against every triangle.
const CHECKED: usize = 200;

/// How far Embree's distances may be off, in the surface's size: it works in single precision, with another test.
const EMBREE_MAY_BE_OFF: f64 = 1e-4;

/// Before tracing.
const NO_HIT: rayc_hit = rayc_hit { triangle: 0, is_exit: 0, t: 0.0, weights: [0.0; 3] };

/// Who traces, and how.
enum Method<'a> {
    Embree { surface: &'a embree::Surface<'a>, is_stream: bool },
    Raycontact { surface: &'a Surface, is_batch: bool, is_double: bool },
}

struct Running<'a> {
    name: &'static str,
    method: Method<'a>,
    /// Nanoseconds for a ray, round by round.
    times: Vec<f64>,
    /// Of the last round.
    hits: Vec<rayc_hit>,
}

pub fn run(workload: &Workload, arguments: &Arguments, libraries: &Libraries) -> Result<Vec<Row>, String> {
    let host = Host::new(workload);
    let [body, other] = [0, 1].map(|number| (&workload.bodies[number], host.bodies[number].single()));
    let view = BodyView::new(body.0, &host.bodies[0]);
    let of_embree = arguments.simd.of_embree();
    let [built, refitted, built_4, refitted_4] = [(false, false), (false, true), (true, false), (true, true)]
        .map(|(is_4, refits)| embree::Surface::new(&libraries.peers, is_4, of_embree, refits, &view));
    let single = Surface::new(&libraries.raycontact, body.1, body.0, rayc_scalar::RAYC_SCALAR_F32)?;
    let double = Surface::new(&libraries.raycontact, body.1, body.0, rayc_scalar::RAYC_SCALAR_F64)?;
    let judge = Judge { single: Judged::new(mesh(body)?), double: Judged::new(mesh(body)?) };

    let mut rows = Vec::new();
    for kind in kinds::all(&judge.single.mesh, &mesh(other)?, arguments.count) {
        let of_embree = |surface, is_stream| Method::Embree { surface, is_stream };
        let own = |surface, is_batch, is_double| Method::Raycontact { surface, is_batch, is_double };
        let mut methods = [
            ("embree-single", of_embree(&built, false)),
            ("embree-stream", of_embree(&built, true)),
            ("embree-refit-single", of_embree(&refitted, false)),
            ("embree4-single", of_embree(&built_4, false)),
            ("embree4-refit-single", of_embree(&refitted_4, false)),
            ("raycontact-single", own(&single, false, false)),
            ("raycontact-batch", own(&single, true, false)),
            ("raycontact-single-f64", own(&double, false, true)),
            ("raycontact-batch-f64", own(&double, true, true)),
        ]
        .map(|(name, method)| Running { name, method, times: Vec::new(), hits: vec![NO_HIT; kind.rays.len()] });
        for round in 0..=ROUNDS {
            for running in &mut methods {
                let time = running.trace(&kind);
                // The first round warms up.
                if round > 0 {
                    running.times.push(time);
                }
            }
        }
        let reference = methods[0].times.clone();
        for running in methods {
            let ratios = reference.iter().zip(&running.times).map(|(first, own)| first / own).collect();
            let (checked, wrong) = judge.check(&kind, &running);
            rows.push(Row {
                workload: workload.name.clone(),
                triangles: body.0.triangles.len(),
                kind: kind.name.to_owned(),
                rays: kind.rays.len(),
                hits: running.hits.iter().filter(|hit| hit.triangle != embree::NO_TRIANGLE).count(),
                simd: arguments.simd.name().to_owned(),
                method: running.name.to_owned(),
                ns: median(running.times),
                embree_single_over_this: median(ratios),
                checked,
                wrong,
            });
        }
    }
    Ok(rows)
}

fn mesh<T: Scalar>((body, positions): (&Body, &[[f32; 3]])) -> Result<Mesh<T>, String> {
    let positions: Vec<[T; 3]> = positions.iter().map(|point| point.map(|x| T::of(x.into()))).collect();
    Mesh::new(&positions, &body.triangles).map_err(|error| error.to_string())
}

impl Running<'_> {
    /// Traces all rays; gives the nanoseconds for one.
    fn trace(&mut self, kind: &Kind) -> f64 {
        let (us, ()) = match &self.method {
            Method::Embree { surface, is_stream } => {
                let mut rays: Vec<RayHit> = kind.rays.iter().map(RayHit::from).collect();
                let way = match (is_stream, kind.is_coherent) {
                    (false, _) => Way::Single,
                    (true, true) => Way::CoherentStream,
                    (true, false) => Way::IncoherentStream,
                };
                let time = clock::time(1, || surface.trace(&mut rays, way));
                for (hit, ray) in self.hits.iter_mut().zip(&rays) {
                    *hit = rayc_hit { triangle: ray.triangle, t: ray.t_max.into(), ..NO_HIT };
                }
                time
            }
            Method::Raycontact { surface, is_batch, .. } => {
                let rays: Vec<rayc_ray> = kind.rays.iter().map(rayc_ray::from).collect();
                let hits = &mut self.hits;
                clock::time(1, || {
                    if *is_batch { surface.trace_together(&rays, hits) } else { surface.trace_one_by_one(&rays, hits) }
                })
            }
        };
        us * 1000.0 / kind.rays.len() as f64
    }
}

/// Every triangle against some of the rays.
struct Judge {
    single: Judged<f32>,
    double: Judged<f64>,
}

struct Judged<T: Scalar> {
    mesh: Mesh<T>,
    octree: Octree<T>,
}

impl Judge {
    /// How many rays were checked, and how many have another hit: to the bit raycontact's, roughly Embree's.
    fn check(&self, kind: &Kind, running: &Running) -> (usize, usize) {
        let is_close = |t: f64, other: f64| {
            (t - other).abs() <= EMBREE_MAY_BE_OFF * f64::from(self.single.mesh.aabb().longest_side())
        };
        let step = kind.rays.len().div_ceil(CHECKED);
        let places = (0..kind.rays.len()).step_by(step);
        let is_right = |place: usize| {
            let (ray, hit) = (&kind.rays[place], &running.hits[place]);
            match running.method {
                Method::Embree { .. } => match (self.double.nearest(ray), hit.triangle) {
                    (None, triangle) => triangle == embree::NO_TRIANGLE,
                    (Some(exact), triangle) => triangle != embree::NO_TRIANGLE && is_close(exact.t, hit.t),
                },
                Method::Raycontact { is_double: true, .. } => same(self.double.nearest(ray), hit),
                Method::Raycontact { .. } => same(self.single.nearest(ray), hit),
            }
        };
        (places.clone().count(), places.filter(|&place| !is_right(place)).count())
    }
}

impl<T: Scalar> Judged<T> {
    fn new(mesh: Mesh<T>) -> Self {
        let octree = Octree::new(&mesh);
        Self { mesh, octree }
    }

    fn nearest(&self, ray: &kinds::Ray) -> Option<Hit<T>> {
        let vector = |v: [f32; 3]| v.map(|x| T::of(x.into())).into();
        let ray = Ray { origin: vector(ray.origin), direction: vector(ray.direction), t_max: T::INFINITY };
        self.octree.tracer(&self.mesh).expect("it is of this mesh").nearest_hit_of_all(&ray)
    }
}

fn same<T: Scalar>(exact: Option<Hit<T>>, hit: &rayc_hit) -> bool {
    exact.map_or(hit.triangle == embree::NO_TRIANGLE, |exact| {
        let numbers = (exact.t.to_f64(), exact.weights.map(T::to_f64), u32::from(exact.is_exit));
        exact.triangle == hit.triangle && numbers == (hit.t, hit.weights, hit.is_exit)
    })
}
