//! What garbage and crowds cost: bodies in which everything touches everything, alone and in pairs, and bodies that all overlap
//! many others, beside the ordinary step of as many triangles.

use crate::support::arguments::Arguments;
use crate::support::shapes::{self, Shape};
use crate::support::{Vector, random};
use indicatif::{ProgressBar, ProgressStyle};
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling, Statistics};
use raycontact::escape::query_pair;
use raycontact::query::Octree;
use raycontact::scene::Scene;
use std::f64::consts::TAU;
use std::process::ExitCode;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

pub const HELP: &str = "\
Measures what self-collision costs bodies of garbage, beside a torus of as many triangles that touches nothing of itself; what a
pair costs of which both bodies or one are garbage, beside two such tori that overlap; and what a crowd of tetrahedra costs that all overlap many others, beside as many that overlap four.

  --size N      quads around the torus, half as many across (default 110: 12 100 triangles)
  --bodies N    tetrahedra in the crowd (default 10000)
  --runs N      steps timed of each, in turns, after 2 to warm up; odd (default 9)
  --help        this text

Garbage: the torus with all vertices in one point, on a line, in a plane or anywhere in a box, with some of them anywhere, or
each or those of one half thrown about; all grow a little before every step. Prints for each the median time of a step, also as a
multiple of that of the torus moving by a ripple and of the torus at rest, and what its statistics count. Pairs are without
self-collision, with the default options, the paper's, and the default ones with the law of ray lengths, and also beside the
two tori at rest. Times are those of the thread, so that other work on the machine does not count.
The crowd: tetrahedra of one size anywhere in a cube, so that the boxes of each overlap those of about 110 others. Its ordinary
step: as many in a larger cube, so that each meets about four others. Both with the default options and the paper's.
Target: at most 20 times the ordinary step, for what is marked with a star.
Exit status: 0; 1 where the target is missed; 2 for a wrong command line.";

/// What is timed: moved on by one step, then queried.
struct Timed {
    name: String,
    scene: Scene<f64>,
    step: Box<dyn FnMut(usize) -> Vec<Vec<[f64; 3]>>>,
    contacts: ContactList<f64>,
    times: Vec<Duration>,
}

impl Timed {
    fn run(&mut self, number: usize) {
        let positions = (self.step)(number);
        for (body, positions) in positions.iter().enumerate() {
            self.scene.mesh_mut(body as u32).expect("it was added").set_positions(positions).expect("finite");
        }
        let start = own_time();
        self.scene.query(&mut self.contacts);
        self.times.push(own_time() - start);
    }

    fn median(&self) -> f64 {
        let mut times = self.times.clone();
        times.sort();
        times[times.len() / 2].as_secs_f64()
    }
}

/// How long this thread has had a processor, so that other work on the machine does not count; where the system does not
/// tell, the time that has passed.
fn own_time() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    // The system sums up when the thread is put aside.
    std::thread::yield_now();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

pub fn main(mut arguments: Arguments) -> ExitCode {
    let size: usize = arguments.value("--size", 110);
    let bodies: usize = arguments.value("--bodies", 10_000);
    let runs: usize = arguments.value("--runs", 9);
    if size < 6 || bodies == 0 || runs.is_multiple_of(2) {
        arguments.fail("at least 6 quads around, 1 body, and an odd number of runs");
    }
    arguments.finish();
    let torus = shapes::torus(size, size / 2, 0.4, false);
    println!("{} triangles", torus.triangles.len());
    let edge = TAU / size as f64;
    let mut worst = measure(garbage(one_body, &torus, edge), 2, runs);
    let ray_lengths = DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() };
    for (name, options) in [
        ("default options", DetectionOptions::default()),
        ("the paper's", DetectionOptions::paper()),
        ("ray lengths", ray_lengths),
    ] {
        for whole in [None, Some(&torus)] {
            println!("pairs, {} garbage, {name}", if whole.is_some() { "one of them" } else { "both" });
            worst = worst.max(measure(garbage(pair(options, whole), &torus, edge), 2, runs));
        }
    }
    println!("{bodies} tetrahedra");
    worst = worst.max(measure(crowds(bodies), 1, runs));
    net_forces();
    if worst <= 20.0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Times all in turns, of which the first `ordinary` are what the others are held to; prints them, and gives the largest
/// multiple of the first among those with a star.
fn measure(mut timed: Vec<Timed>, ordinary: usize, runs: usize) -> f64 {
    const WARM_UP: usize = 2;
    let progress = ProgressBar::new(((runs + WARM_UP) * timed.len()) as u64);
    progress.set_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} steps, {eta} left").expect("the template is valid"),
    );
    for number in 0..runs + WARM_UP {
        for one in &mut timed {
            one.run(number);
            progress.inc(1);
        }
        if number + 1 == WARM_UP {
            timed.iter_mut().for_each(|one| one.times.clear());
        }
    }
    progress.finish_and_clear();
    let mut worst = 0.0f64;
    for one in &timed {
        let time = one.median();
        let multiples: Vec<f64> = timed[..ordinary].iter().map(|ordinary| time / ordinary.median()).collect();
        let Statistics { pairs, rays, tangled_bodies, tangled_pairs, crowded_pairs, .. } = one.contacts.statistics;
        let tangled = tangled_bodies + tangled_pairs;
        let shown: Vec<String> = multiples.iter().map(|multiple| format!("{multiple:9.2}")).collect();
        println!(
            "{:28} {:10.3} ms {} {rays:10} rays {:9} contacts, {tangled} tangled, {crowded_pairs} of {pairs} crowded",
            one.name,
            time * 1e3,
            shown.join(""),
            one.contacts.len()
        );
        worst = if one.name.ends_with('*') { worst.max(multiples[0]) } else { worst };
    }
    worst
}

/// Where a vertex of the torus goes, with numbers from -1 to 1.
type Place<'a> = &'a dyn Fn(&Vector, &mut dyn FnMut() -> f64) -> Vector;

/// The torus, moving and at rest, then garbage, as `made` puts it into a scene. `edge` is how long its edges are.
fn garbage(made: impl Fn(&str, &Shape, Step) -> Timed, torus: &Shape, edge: f64) -> Vec<Timed> {
    let in_place = |name: &str, place: Place| {
        let mut next = random(1);
        let points: Vec<Vector> = torus.points.iter().map(|point| place(point, &mut next)).collect();
        let grown =
            move |number: usize| points.iter().map(|p| (p * (1.0 + 1e-3 * (number % 2) as f64)).into()).collect();
        made(name, torus, Box::new(grown))
    };
    let anywhere = |next: &mut dyn FnMut() -> f64| Vector::new(next(), next(), next());
    let rest = torus.points.clone();
    let rippled = move |number: usize| {
        let at = |p: &Vector| {
            let height = 0.02 * (3.0 * p.x + 2.0 * p.y + 0.3 * number as f64).sin();
            (p + Vector::new(p.y, -p.x, 0.5).normalize() * height).into()
        };
        rest.iter().map(at).collect()
    };
    let still = torus.points.clone();
    let mut all = vec![
        made("torus, moving", torus, Box::new(rippled)),
        made("torus, at rest", torus, Box::new(move |_| still.iter().map(|p| (*p).into()).collect())),
        in_place("all in one point *", &|_, _| Vector::new(1.0, 2.0, 3.0)),
        in_place("all nearly in one point *", &|p, _| Vector::new(1.0, 2.0, 3.0) + p * 1e-14),
        in_place("a tenth in one point *", &|p, next| if next() < -0.8 { Vector::new(1.0, 0.0, 0.0) } else { *p }),
        in_place("all on a line *", &|p, _| Vector::new(p.x, 2.0 * p.x, 3.0 * p.x)),
        in_place("all in a plane *", &|p, _| Vector::new(p.x, p.y, 0.0)),
        in_place("all in a slanting plane *", &|p, _| Vector::new(p.x, p.y, 0.3 * p.x + 0.7 * p.y)),
    ];
    for percent in [1, 3, 10, 30, 100] {
        let place: Place = &|p, next| if next() < 0.02 * f64::from(percent) - 1.0 { anywhere(next) } else { *p };
        all.push(in_place(&format!("{percent} % anywhere *"), place));
    }
    for by in [0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0] {
        let thrown: Place = &|p, next| p + anywhere(next) * (by * edge);
        all.push(in_place(&format!("thrown by {by} edges *"), thrown));
        let half: Place = &|p, next| if p.x > 0.0 { p + anywhere(next) * (by * edge) } else { *p };
        all.push(in_place(&format!("half thrown by {by} edges *"), half));
    }
    all
}

/// Where a body's vertices are in a step.
type Step = Box<dyn FnMut(usize) -> Vec<[f64; 3]>>;

fn one_body(name: &str, shape: &Shape, mut step: Step) -> Timed {
    let mut scene = Scene::new(1).expect("no threads are needed");
    let body = scene.add(shape.mesh(|point| *point));
    scene.set_self_collision(body, true).expect("it was added");
    let step = Box::new(move |number| vec![step(number)]);
    Timed { name: name.into(), scene, step, contacts: ContactList::default(), times: Vec::new() }
}

/// Two bodies beside one another, of which the second is whole where a shape is given.
fn pair(options: DetectionOptions<f64>, whole: Option<&Shape>) -> impl Fn(&str, &Shape, Step) -> Timed {
    const BESIDE: Vector = Vector::new(0.9, 0.2, 0.1);
    let moved =
        |points: &[[f64; 3]]| points.iter().map(|&p| (Vector::from(p) + BESIDE).into()).collect::<Vec<[f64; 3]>>();
    let whole: Option<Vec<[f64; 3]>> = whole.map(|whole| whole.points.iter().map(|p| (p + BESIDE).into()).collect());
    move |name, shape, mut step| {
        let mut scene = Scene::new(1).expect("no threads are needed");
        scene.set_options(options);
        for by in [Vector::zeros(), BESIDE] {
            scene.add(shape.mesh(|point| point + by));
        }
        let whole = whole.clone();
        let step = Box::new(move |number| {
            let first = step(number);
            let second = whole.clone().unwrap_or_else(|| moved(&first));
            vec![first, second]
        });
        Timed { name: name.into(), scene, step, contacts: ContactList::default(), times: Vec::new() }
    }
}

/// Tetrahedra that meet four others each, and a crowd of them.
fn crowds(count: usize) -> Vec<Timed> {
    let places = |volume_of_each: f64| -> Vec<Vector> {
        let (mut next, half_width) = (random(7), 0.5 * (volume_of_each * count as f64).cbrt());
        (0..count).map(|_| Vector::new(next(), next(), next()) * half_width).collect()
    };
    vec![
        crowd("four others, default", DetectionOptions::default(), places(2.5)),
        crowd("four others, the paper's", DetectionOptions::paper(), places(2.5)),
        crowd("crowd, default *", DetectionOptions::default(), places(2.5 / 32.0)),
        crowd("crowd, the paper's", DetectionOptions::paper(), places(2.5 / 32.0)),
    ]
}

/// Prints how far the net forces on the bodies of a crowd are off, with as few rays as a scene casts and with all.
fn net_forces() {
    const COUNT: usize = 120;
    let mut next = random(11);
    let places = (0..COUNT).map(|_| Vector::new(next(), next(), next())).collect();
    let ray = |sampling| DetectionOptions { sampling, edges: false, escape: false, ..DetectionOptions::default() };
    let mut timed = crowd("", ray(Sampling::default()), places);
    timed.run(0);
    let meshes: Vec<_> = (0..COUNT as u32).map(|body| timed.scene.mesh(body).expect("it was added").clone()).collect();
    let octrees: Vec<_> = meshes.iter().map(Octree::new).collect();
    let alone = |options: DetectionOptions<f64>| {
        let (mut forces, mut list) = (vec![Vector::zeros(); COUNT], ContactList::default());
        for (a, b) in (0..COUNT).flat_map(|a| (a + 1..COUNT).map(move |b| (a, b))) {
            query_pair(&meshes[a], &octrees[a], &meshes[b], &octrees[b], &options, &mut list).expect("up to date");
            add_net_forces(&list, [a, b], &mut forces);
        }
        forces
    };
    let finest = alone(ray(Sampling::Spacing(0.03)));
    let mut shared = vec![Vector::zeros(); COUNT];
    add_net_forces(&timed.contacts, std::array::from_fn::<_, COUNT, _>(|body| body), &mut shared);
    let Statistics { pairs, crowded_pairs, .. } = timed.contacts.statistics;
    println!("{COUNT} tetrahedra, {pairs} pairs, {crowded_pairs} crowded: net forces of the bodies off by");
    for (name, forces) in [("as a scene casts", shared), ("each pair alone", alone(ray(Sampling::default())))] {
        let mut errors: Vec<f64> =
            forces.iter().zip(&finest).map(|(f, exact)| (f - exact).norm() / exact.norm()).collect();
        errors.sort_by(f64::total_cmp);
        println!("{name:28} median {:.4}, nine of ten below {:.4}", errors[COUNT / 2], errors[COUNT * 9 / 10]);
    }
}

/// Adds each contact's force for unit stiffness to its two bodies, of these numbers.
fn add_net_forces<const N: usize>(list: &ContactList<f64>, bodies: [usize; N], forces: &mut [Vector]) {
    for contact in &list.contacts {
        let force = contact.direction * (contact.area * contact.depth * contact.cos_alpha);
        forces[bodies[contact.colliding as usize]] += force;
        forces[bodies[contact.collided as usize]] -= force;
    }
}

fn crowd(name: &str, options: DetectionOptions<f64>, places: Vec<Vector>) -> Timed {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let shape = Shape {
        points: corners.map(Vector::from).to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    };
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.set_options(options);
    let mut next = random(3);
    let mut points = Vec::new();
    for place in &places {
        let turn = shapes::turn([next(), next(), next()], 3.0 * next());
        let at = |p: &Vector| turn * p + place;
        scene.add(shape.mesh(at));
        points.push(shape.points.iter().map(at).collect::<Vec<Vector>>());
    }
    let step = Box::new(move |number| {
        let by = 1.0 + 1e-4 * (number % 2) as f64;
        points.iter().map(|points| points.iter().map(|p| (p * by).into()).collect()).collect()
    });
    Timed { name: name.into(), scene, step, contacts: ContactList::default(), times: Vec::new() }
}
