//! Two or three bodies in any pose, asked for contacts with any options, over some steps: every query ends, counts each of its
//! rays, gives numbers in their range, and gives them again when it is asked again.

use crate::Bytes;
use crate::surface;
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling, query_self};
use raycontact::escape::query_pair;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::scene::Scene;

/// A ball of few triangles, or a surface from bytes.
fn body(bytes: &mut Bytes) -> Option<Mesh<f64>> {
    if bytes.flag() {
        return surface::mesh(bytes).ok();
    }
    let (size, at) = ([0; 3].map(|_| bytes.number().abs()), bytes.point());
    let (rings, around) = (2 + bytes.below(6), 3 + bytes.below(8));
    let mut points = vec![[0.0, 0.0, 1.0]];
    for (ring, k) in (1..rings).flat_map(|ring| (0..around).map(move |k| (ring, k))) {
        let down = std::f64::consts::PI * ring as f64 / rings as f64;
        let turn = std::f64::consts::TAU * k as f64 / around as f64;
        points.push([down.sin() * turn.cos(), down.sin() * turn.sin(), down.cos()]);
    }
    points.push([0.0, 0.0, -1.0]);
    let index = |ring: usize, k: usize| (1 + (ring - 1) * around + k % around) as u32;
    let last = points.len() as u32 - 1;
    let mut triangles = Vec::new();
    for k in 0..around {
        triangles.extend([[0, index(1, k), index(1, k + 1)], [last, index(rings - 1, k + 1), index(rings - 1, k)]]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [index(ring, k), index(ring + 1, k), index(ring + 1, k + 1), index(ring, k + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let place = |point: [f64; 3]| std::array::from_fn(|axis| point[axis] * size[axis] + at[axis]);
    Mesh::new(&points.into_iter().map(place).collect::<Vec<_>>(), &triangles).ok()
}

/// Any there are, spacings not so far below the bodies' size that a million rays are asked for.
fn options(bytes: &mut Bytes, meshes: &[Mesh<f64>]) -> DetectionOptions<f64> {
    let sizes = meshes.iter().map(|mesh| (mesh.aabb().upper - mesh.aabb().lower).amax());
    let fraction = (1.0 + f64::from(bytes.byte())) / 256.0;
    let spacing = sizes.fold(0.0, f64::max) * fraction.max(1.0 / 32.0);
    DetectionOptions {
        sampling: match bytes.below(6) {
            0 => Sampling::Vertices,
            1 if spacing > 0.0 && spacing.is_finite() => Sampling::Spacing(spacing),
            2 => Sampling::Accuracy(fraction),
            3 => Sampling::Accuracy(fraction * fraction * fraction),
            _ => Sampling::default(),
        },
        edges: bytes.flag(),
        escape: bytes.flag(),
        past_folds: bytes.flag(),
        law: if bytes.flag() { ContactLaw::Pressure } else { ContactLaw::RayLength },
    }
}

fn check(list: &ContactList<f64>) {
    let counts = &list.statistics;
    let none = counts.misses + counts.entry_hits + counts.own_surface_hits + counts.replaced;
    assert_eq!(counts.rays, list.len() as u64 + none, "{counts:?}");
    let is_sound = |contact: &raycontact::contact::Contact<f64>| {
        contact.depth >= 0.0 && contact.area >= 0.0 && (0.0..=1.0).contains(&contact.cos_alpha)
    };
    assert!(list.contacts.iter().all(is_sound));
}

pub fn run(bytes: &mut Bytes) {
    let meshes: Vec<_> = (0..2 + bytes.below(2)).filter_map(|_| body(bytes)).collect();
    let Ok(mut scene) = Scene::new(1) else { return };
    for mesh in &meshes {
        let body = scene.add(mesh.clone());
        let _ = scene.set_self_collision(body, bytes.below(4) == 0);
        let spacing = [0.0, 1e-9, 0.3, 1e9, f64::INFINITY, f64::NAN][bytes.below(6)];
        let _ = scene.mesh_mut(body).map(|mesh| mesh.set_carrier_spacing(spacing));
    }
    let (mut first, mut again) = (ContactList::default(), ContactList::default());
    for _ in 0..1 + bytes.below(4) {
        let options = options(bytes, &meshes);
        scene.set_options(options);
        scene.query(&mut first);
        check(&first);
        scene.query(&mut again);
        assert_eq!(again, first);
        if bytes.flag() {
            scene.advance(bytes.number().abs().min(1.0)).expect("a length");
        }
        let [number, axis, by] = [bytes.below(3), bytes.below(3), bytes.byte() as usize];
        if let Ok(mesh) = scene.mesh_mut(number as u32) {
            let moved = |mut position: [f64; 3]| {
                position[axis] += by as f64 / 64.0 - 2.0;
                position
            };
            let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| moved([p.x, p.y, p.z])).collect();
            let _ = mesh.set_positions(&positions);
        }
        if let [a, b, ..] = meshes.as_slice() {
            let octrees = [a, b].map(Octree::new);
            query_pair(a, &octrees[0], b, &octrees[1], &options, &mut first).expect("the octrees are new");
            check(&first);
            query_self(a, &octrees[0], &options, &mut first).expect("the octree is new");
            check(&first);
        }
    }
}
