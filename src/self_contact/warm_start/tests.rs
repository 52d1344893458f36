use super::*;
use crate::contact::{ContactList, DetectionOptions, detect_self, query_self_with_all_rays};
use crate::mesh::test_mesh::{torus, torus_positions};
use crate::random::Random;
use crate::self_contact::nearness::{Nearness, nearness};
use crate::shapes;
use std::collections::BTreeSet;

const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn tetrahedron(map: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Mesh<f64> {
    let positions: Vec<_> = CORNERS.iter().enumerate().map(|(vertex, &corner)| map(vertex, corner)).collect();
    Mesh::new(&positions, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).expect("it is closed")
}

/// What is found at one position of a body, with so much allowed.
fn certificate(allowed: f64, is_valid: bool) -> Certificate<f64> {
    let mut certificate = Certificate::default();
    certificate.set(&tetrahedron(|_, corner| corner), allowed, is_valid);
    certificate
}

#[test]
fn what_moves_as_a_whole_is_not_strained() {
    let moved = tetrahedron(|_, [x, y, z]| [x - 0.5, y + 0.25, z - 0.75]);
    let certificate = certificate(0.0, true);
    assert!(certificate.is_known(&moved) && certificate.is_strained_at_most(&moved));
}

#[test]
fn strain_counts_along_edges() {
    // One vertex goes 0.3 to one side, another 0.4 across it: 0.5 against each other.
    let offsets = [[0.0; 3], [0.0, 0.3, 0.0], [0.0; 3], [0.4, 0.0, 0.0]];
    let moved = tetrahedron(|vertex, corner| std::array::from_fn(|axis| corner[axis] + offsets[vertex][axis]));
    assert!(certificate(0.51, true).is_strained_at_most(&moved));
    assert!(!certificate(0.49, true).is_strained_at_most(&moved));
}

#[test]
fn certificates_hold_where_they_are_valid_and_coordinates_have_not_grown() {
    assert!(certificate(1.0, true).is_known(&tetrahedron(|_, corner| corner.map(|x| 1.9 * x))));
    assert!(!certificate(1.0, true).is_known(&tetrahedron(|_, corner| corner.map(|x| 2.1 * x))));
    assert!(!certificate(1.0, false).is_known(&tetrahedron(|_, corner| corner)));
    assert!(!Certificate::default().is_known(&tetrahedron(|_, corner| corner)));
}

const SIDES: [u32; 2] = [32, 8];

/// A torus pinched in the middle, so that its inner sides are so far apart; where they are, they pass through each
/// other. Folded: one vertex lies beyond the triangles of its neighbour.
fn pose(mesh: &mut Mesh<f64>, gap: f64, is_folded: bool) {
    let inner = 0.7_f64;
    let depth = inner.hypot(0.3) * (1.0 - gap / (2.0 * inner));
    let pinched = |[x, y, z]: [f64; 3]| [x, y * (1.0 - depth * (-4.0 * x * x).exp() / y.hypot(0.3)), z];
    let mut positions: Vec<_> = torus_positions(SIDES, 0).into_iter().map(pinched).collect();
    if is_folded {
        positions[0] = std::array::from_fn(|axis| 3.0 * positions[1][axis] - 2.0 * positions[0][axis]);
    }
    mesh.set_positions(&positions).expect("finite");
}

/// How a step was settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Settled {
    Remembered,
    PartSearched,
    Searched { any: bool, lapsed_alone: bool },
}

/// One step, held to a search that remembers nothing. The octree follows only where something has to be searched.
fn step(memory: &mut SelfWarmStart<f64>, octree: &mut Octree<f64>, mesh: &Mesh<f64>) -> Settled {
    let [mut found, mut expected] = [(); 2].map(|()| Touching::default());
    expected.search(&Octree::new(mesh), mesh);
    let is_clear = memory.is_clear(mesh, octree);
    let lapsed_alone = memory.lapse.part <= MOST_LAPSED;
    if is_clear {
        assert!(!expected.any);
        return if memory.lapse.part == 0.0 { Settled::Remembered } else { Settled::PartSearched };
    }
    octree.update(mesh).expect("its own");
    memory.search(octree, mesh, &mut found);
    assert_eq!((&found.touched, found.any), (&expected.touched, expected.any));
    assert!(!memory.is_valid || !expected.any || lapsed_alone);
    Settled::Searched { any: expected.any, lapsed_alone }
}

#[test]
fn what_is_remembered_never_tells_other_than_a_search() {
    let mut mesh = torus(SIDES);
    let mut octree = Octree::new(&mesh);
    let mut memory = SelfWarmStart::default();
    let mut settled = BTreeSet::new();
    let mut pass = |gap: f64, is_folded: bool| {
        pose(&mut mesh, gap, is_folded);
        settled.insert(step(&mut memory, &mut octree, &mesh));
    };
    // Slowly nearer, from far apart to touching and back.
    let nearer = (0..80).map(|i| 0.3 - 0.004 * f64::from(i));
    nearer.clone().chain(nearer.rev()).for_each(|gap| pass(gap, false));
    // A fold that comes, stays and goes, while nothing else moves and while it does.
    for (step, gap) in [0.2, 0.2, 0.2, 0.2, 0.21, 0.2, 0.21, 0.2].into_iter().enumerate() {
        (0..4).for_each(|_| pass(gap, step % 2 == 1));
    }
    // Too fast for anything to be worth remembering, then slowly again.
    let fast = (0..80).map(|i| [0.5, 0.2, -0.01][i % 3]);
    fast.chain([-0.004, -0.003, -0.002, -0.001, 0.001]).for_each(|gap| pass(gap, false));
    (0..80).for_each(|i| pass(0.1 - 0.0015 * f64::from(i), false));
    // At rest after all that.
    (0..300).for_each(|_| pass(0.2, false));
    assert_eq!(step(&mut memory, &mut octree, &mesh), Settled::Remembered);
    let searched = |any, lapsed_alone| Settled::Searched { any, lapsed_alone };
    let searches = [searched(false, false), searched(true, false), searched(true, true)];
    assert!(
        settled.iter().eq([&Settled::Remembered, &Settled::PartSearched].into_iter().chain(&searches)),
        "{settled:?}"
    );
}

/// One vertex is drawn toward a neighbour and past it, and another out through the far side of the tube, while the rest
/// hardly moves: what is strained is looked at alone, until it folds over or passes through.
#[test]
fn a_strained_vertex_is_searched_alone_until_it_touches() {
    let rest = torus_positions([64, 16], 0);
    for aim in [1, 8] {
        let mut mesh = torus([64, 16]);
        let (mut octree, mut memory) = (Octree::new(&mesh), SelfWarmStart::default());
        let mut settled = Vec::new();
        // Out and back, twice: so a strained body is what positions are kept of, too.
        for number in 0..160 {
            let part = [0.0, 1.0, 2.0, 1.0, 0.0][number / 40]
                + [1.0, 1.0, -1.0, -1.0][number / 40] * (number % 40) as f64 / 40.0;
            let mut positions: Vec<_> =
                rest.iter().map(|&[x, y, z]| [x, y, z + 1e-3 * (2.0 * x + 0.3 * number as f64).sin()]).collect();
            positions[0] =
                std::array::from_fn(|axis| positions[0][axis] + part * (positions[aim][axis] - positions[0][axis]));
            mesh.set_positions(&positions).expect("finite");
            let how = step(&mut memory, &mut octree, &mesh);
            settled.push((how, octree.strained(&memory.near).count()));
        }
        let count = |is: &dyn Fn(&(Settled, usize)) -> bool| settled.iter().filter(|&how| is(how)).count();
        assert!(count(&|how| how.0 == Settled::PartSearched && how.1 > 0) > 20, "{aim}: {settled:?}");
        assert!(count(&|how| matches!(how.0, Settled::Searched { any: true, .. })) > 20, "{aim}: {settled:?}");
    }
}

/// A dent that stays is searched alone until that has cost as much as a search of all; then it is part of what is kept.
#[test]
fn what_has_lapsed_for_good_is_kept_anew() {
    let rest = torus_positions([64, 16], 0);
    let mut mesh = torus([64, 16]);
    let (mut octree, mut memory) = (Octree::new(&mesh), SelfWarmStart::default());
    let (mut settled, mut searched) = (Vec::new(), 0.0);
    for number in 0..1000 {
        // It ripples, is dented, and rests.
        let (phase, dent) = (0.3 * f64::from(number.min(24)), 0.08 * f64::from((number - 20).clamp(0, 4)));
        let mut positions: Vec<_> = rest.iter().map(|&[x, y, z]| [x, y, z + 1e-2 * (2.0 * x + phase).sin()]).collect();
        positions[0] =
            std::array::from_fn(|axis| positions[0][axis] + dent * (positions[1][axis] - positions[0][axis]));
        mesh.set_positions(&positions).expect("finite");
        settled.push(step(&mut memory, &mut octree, &mesh));
        if settled.ends_with(&[Settled::PartSearched]) {
            searched += memory.lapse.part;
        }
    }
    let again = settled.iter().rposition(|how| matches!(how, Settled::Searched { .. })).expect("the first");
    assert!(settled[24..again].iter().all(|&how| how == Settled::PartSearched), "{settled:?}");
    assert!((0.9..=1.0).contains(&searched), "{searched}");
    assert!(settled[again + 1..].iter().all(|&how| how == Settled::Remembered), "{settled:?}");
}

/// A torus as it is, one pinched in the middle, one pressed to a sheet, and a sheet rolled up, whose layers face alike.
fn shapes() -> [fn([f64; 3]) -> [f64; 3]; 4] {
    [
        |p| p,
        |[x, y, z]| [x, y * (1.0 - 0.55 * (-4.0 * x * x).exp() / y.hypot(0.3)), z],
        |[x, y, z]| [x, y, 0.1 * z],
        |[x, y, z]| {
            let (radius, angle) = (0.6 + 0.2 * x + 0.25 * z, 2.6 * x);
            [radius * angle.cos(), radius * angle.sin(), 0.5 * y]
        },
    ]
}

/// Bodies that wave, shear, crumple and turn at random, calmly and wildly: whenever they are said to be clear, no two of their
/// triangles touch, each held against each, and no ray of any triangle finds a contact.
#[test]
fn what_is_clear_touches_nothing_however_it_moves() {
    let rest = torus_positions(SIDES, 0);
    let mut touching = 0;
    for (number, shape) in shapes().into_iter().enumerate() {
        let (mut mesh, mut memory) = (torus(SIDES), SelfWarmStart::default());
        let (mut octree, mut list) = (Octree::new(&mesh), ContactList::default());
        let (mut random, mut clear) = (Random::new(7 + number as u64), 0);
        let (mut waves, mut shear, mut crumple, mut turn) = ([[0.0; 4]; 6], [0.0; 3], [0.0; 3], 0.0f64);
        let scale = if number < 2 { 0.5 } else { 0.15 };
        for step in 0..600 {
            let pace = [0.004, 0.02, 0.08][step / 100 % 3];
            for value in waves.as_flattened_mut().iter_mut().chain(&mut shear).chain(&mut crumple) {
                *value = 0.97 * *value + pace * random.signed();
            }
            turn += pace * 4.0;
            let place = |(vertex, &p): (usize, &[f64; 3])| {
                let mut at = shape(p);
                if vertex % 23 == 0 {
                    (0..3).for_each(|axis| at[axis] += 0.3 * crumple[axis]);
                }
                for (k, [height, x, y, z]) in waves.iter().enumerate() {
                    at[k % 3] += scale * height * (3.0 * (p[0] * x + p[1] * y + p[2] * z) * (1.0 + k as f64)).sin();
                }
                let [x, y, z] = [at[0] + shear[0] * at[1], at[1] + shear[1] * at[2], at[2] + shear[2] * at[0]];
                [turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y, z]
            };
            mesh.set_positions(&rest.iter().enumerate().map(place).collect::<Vec<_>>()).expect("finite");
            let is_clear = memory.is_clear(&mesh, &octree);
            if !is_clear {
                octree.update(&mesh).expect("its own");
                memory.search(&octree, &mesh, &mut Touching::default());
            }
            let count = mesh.topology().triangles().len() as u32;
            let mut pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
            let any = pairs.any(|pair| nearness(&mesh, pair) == Nearness::Touching);
            (clear, touching) = (clear + u32::from(is_clear), touching + u32::from(any));
            assert!(!is_clear || !any, "shape {number}, step {step}");
            if is_clear {
                let octree = Octree::new(&mesh);
                query_self_with_all_rays(&mesh, &octree, &DetectionOptions::default(), &mut list).expect("new");
                assert!(list.is_empty(), "shape {number}, step {step}");
            }
        }
        assert!(clear > 60, "shape {number}: {clear} clear");
        println!("{clear} {touching}");
    }
    assert!(touching > 60, "{touching} touching");
}

/// Two tori, one inside the other: they touch nothing, and the body overlaps itself, in each step anew.
#[test]
fn what_lies_inside_another_part_is_not_forgotten() {
    let outer = shapes::torus(32, 8, 0.3);
    let body = outer.joined(&outer.map(|[x, y, z]| {
        let thinner = 0.5 + 0.5 / x.hypot(y);
        [x * thinner, y * thinner, 0.5 * z]
    }));
    let mut mesh: Mesh<f64> = body.mesh();
    let (mut octree, mut memory, mut list) = (Octree::new(&mesh), SelfWarmStart::default(), ContactList::default());
    for step in 0..40 {
        mesh.set_positions(&body.scaled(1.0 + 1e-4 * f64::from(step)).positions).expect("finite");
        octree.update(&mesh).expect("its own");
        let (tracer, options) = (octree.tracer(&mesh).expect("new"), DetectionOptions::default());
        assert!(detect_self(0, tracer, &octree, &options, Some(&mut memory), &mut list), "step {step}");
    }
}
