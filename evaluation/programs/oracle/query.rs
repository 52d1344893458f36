//! One mesh and its rays: asks the library in every way it can be asked.

use super::cases::{Case, Target};
use super::judge::{Judge, Line};
use super::nearest::run_points;
use super::report::{Origin, describe, mesh_text};
use super::tally::{Failure, Tally};
use super::verdict::Verdict;
use crate::random::Random;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree, Tracer};
use raycontact::triangle::{Hit, PreparedRay, Ray, TriangleTest};

/// Rays to one mesh.
pub const BATCH_SIZE: u64 = 256;

/// What the library says about one ray.
#[derive(Default)]
pub struct Answers<T: Scalar> {
    /// The hits on all triangles, whether or not the ray's end comes before.
    pub all: Vec<Hit<T>>,
    /// The first of them before the ray's end.
    pub expected: Option<Hit<T>>,
    /// The nearest hit, by way of asking.
    pub nearest: [(&'static str, Option<Hit<T>>); 4],
    /// All crossings up to the ray's end: classic, wide.
    pub crossings: [Vec<Hit<T>>; 2],
    /// Whether anything is hit before the end: classic, wide, and by testing every triangle.
    pub leaves: [bool; 3],
}

/// The answers that are given for many rays at once.
struct Packets<T: Scalar> {
    nearest: [Vec<Option<Hit<T>>>; 2],
    /// Which triangles each ray starts from, for the question whether it leaves the mesh first.
    touched: Vec<[u32; 3]>,
    leaves: [Vec<bool>; 2],
}

/// Traces the first `count` rays of a batch.
pub fn run_batch<T: Scalar>(case: Case, seed: u64, batch: u64, count: u64, test: TriangleTest) -> Tally {
    let mut random = Random::new(seed, batch);
    let target = Target::<T>::new(case, &mut random);
    let rays = target.rays(BATCH_SIZE as usize, &mut random);
    let rays = &rays[..count as usize];
    let mesh = &target.mesh;
    let octrees = [Layout::PaperOctree, Layout::Bvh].map(|layout| Octree::with_layout(mesh, layout));
    let tracers = octrees.each_ref().map(|octree| octree.tracer(mesh).expect("the octree is fresh").with_test(test));
    let packets = ask_packets(&tracers, rays, &mut random);

    let positions = mesh.positions().iter().map(|position| std::array::from_fn(|axis| position[axis].to_f64()));
    let mut judge = Judge::new(positions.collect(), mesh.topology().triangles(), T::ROUNDING_UNIT.to_f64());
    let mut tally = Tally::default();
    let mut answers = Answers::default();
    for (place, ray) in rays.iter().enumerate() {
        ask(&tracers, ray, test, place, &packets, &mut answers);
        let mut verdict = Verdict::default();
        verdict.compare(&answers);
        let direction = std::array::from_fn(|axis| ray.direction[axis].to_f64());
        if direction != [0.0; 3] {
            judge.look(Line::new(std::array::from_fn(|axis| ray.origin[axis].to_f64()), direction));
            verdict.judge_hits(&judge, &answers, &mut tally);
            verdict.judge_answers(&judge, ray, &answers);
        }
        verdict.count(&mut tally, |what| {
            let text = describe(&target, &Origin { case, seed, batch, place }, ray, &what, &answers.nearest);
            Failure { batch, place, text }
        });
    }
    run_points(&target, &tracers, count, &mut random, &mut tally, |place, what| {
        let text =
            format!("{what}\ncase {}, seed {seed}, batch {batch}, point {place}\n{}", case.name(), mesh_text(mesh));
        Failure { batch, place, text }
    });
    tally.queries += count;
    tally.exact_decisions += judge.exact_decisions;
    tally
}

fn ask_packets<T: Scalar>(tracers: &[Tracer<'_, T>; 2], rays: &[Ray<T>], random: &mut Random) -> Packets<T> {
    let touched = touched(tracers[0].mesh(), rays, random);
    let nearest = tracers.map(|tracer| {
        let mut hits = Vec::new();
        tracer.nearest_hits(rays, &mut hits);
        hits
    });
    let leaves = tracers.map(|tracer| {
        let mut found = Vec::new();
        tracer.leave_before_end(rays, &touched, &mut found);
        found
    });
    Packets { nearest, touched, leaves }
}

/// Which triangles each ray starts from: those around the vertex where its origin is, else those around any vertex,
/// edge or face.
fn touched<T: Scalar>(mesh: &Mesh<T>, rays: &[Ray<T>], random: &mut Random) -> Vec<[u32; 3]> {
    let of_ray = |ray: &Ray<T>| {
        let [a, b, c] = *random.pick(mesh.topology().triangles());
        match mesh.positions().iter().position(|position| *position == ray.origin) {
            Some(vertex) => [vertex as u32; 3],
            None => *random.pick(&[[a; 3], [a, b, b], [a, b, c]]),
        }
    };
    rays.iter().map(of_ray).collect()
}

fn ask<T: Scalar>(
    tracers: &[Tracer<'_, T>; 2],
    ray: &Ray<T>,
    test: TriangleTest,
    place: usize,
    packets: &Packets<T>,
    answers: &mut Answers<T>,
) {
    let [classic, wide] = tracers;
    let mesh = wide.mesh();
    let triangles = mesh.topology().triangles();
    let prepared = PreparedRay::new(ray, test);
    answers.all.clear();
    let hits = (0..triangles.len() as u32).map(|triangle| prepared.intersect(&mesh.corners(triangle), triangle));
    answers.all.extend(hits.flatten());
    let within = answers.all.iter().filter(|hit| hit.t <= ray.t_max);
    // In ascending order of triangles, so that of equal ones the first is kept.
    answers.expected = within.copied().reduce(|nearest, hit| if hit.t < nearest.t { hit } else { nearest });
    // What costs most and differs least from other answers is asked for some rays only.
    let is_asked_all = place.is_multiple_of(4);
    answers.nearest = [
        ("testing every triangle", if is_asked_all { wide.nearest_hit_of_all(ray) } else { answers.expected }),
        // Alone or among many, its rays go the same way.
        ("classic", packets.nearest[0][place]),
        ("wide", wide.nearest_hit(ray)),
        ("wide, many rays", packets.nearest[1][place]),
    ];
    wide.crossings(ray, &mut answers.crossings[1]);
    if is_asked_all {
        classic.crossings(ray, &mut answers.crossings[0]);
    } else {
        let [classic_crossings, wide_crossings] = &mut answers.crossings;
        classic_crossings.clone_from(wide_crossings);
    }
    let is_own =
        |triangle: u32| packets.touched[place].iter().all(|vertex| triangles[triangle as usize].contains(vertex));
    let is_left = answers.all.iter().any(|hit| hit.is_exit && hit.t < ray.t_max && !is_own(hit.triangle));
    answers.leaves = [packets.leaves[0][place], packets.leaves[1][place], is_left];
}
