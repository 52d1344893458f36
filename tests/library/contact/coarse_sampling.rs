//! Fewer rays than triangles: patches.

use crate::common::shapes::{self, Shape};
use crate::common::sorted_along_surface;
use raycontact::contact::{Contact, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};

const LAYOUTS: [Layout; 2] = [Layout::Bvh, Layout::PaperOctree];

pub fn detect<T: Scalar>(meshes: &[Mesh<T>; 2], layout: Layout, sampling: Sampling<T>) -> ContactList<T> {
    let [a, b] = meshes;
    let octrees = [a, b].map(|mesh| Octree::with_layout(mesh, layout));
    let mut list = ContactList::default();
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    query_pair(a, &octrees[0], b, &octrees[1], &options, &mut list).expect("the octrees are fresh");
    crate::common::assert_every_ray_is_counted(&list);
    list
}

/// Net force on the first body and its torque about `about`, for unit stiffness.
pub fn load<T: Scalar>(contacts: &[Contact<T>], about: &Vector3<T>) -> [Vector3<T>; 2] {
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for contact in contacts {
        let pressure = contact.area * contact.depth * contact.cos_alpha;
        let push = contact.direction * if contact.colliding == 0 { pressure } else { -pressure };
        force += push;
        torque += (contact.p1.position - about).cross(&push);
    }
    [force, torque]
}

/// Fine bodies that overlap each in its own way.
pub fn scenes() -> Vec<(&'static str, [Shape; 2])> {
    let torus = || shapes::torus(160, 80, 0.4);
    let block = shapes::block([40, 40, 20]).scaled(0.05);
    let spike = shapes::block([8, 8, 60]).map(|[x, y, z]| [x * 0.01, y * 0.01, z * 0.05 + 0.7]);
    vec![
        ("tori across", [torus(), torus().turned(0.4, 0.9).moved([0.25, 0.1, 0.3])]),
        ("tori, shallow", [torus(), torus().moved([0.1, 0.05, 0.77])]),
        ("spheres", [shapes::sphere(5), shapes::sphere(5).moved([0.9, 0.8, 0.5])]),
        ("sphere in a block", [shapes::sphere(5).scaled(0.5), block.moved([-0.9, -1.1, -1.3])]),
        ("fine in coarse", [shapes::sphere(6).scaled(0.3), shapes::cube(1).moved([0.2, 0.1, 1.15])]),
        ("spike in a sphere", [spike, shapes::sphere(5)]),
    ]
}

/// Contacts of samples of which so many cover the overlap box's largest face, for `errors`.
pub fn dense<T: Scalar>(meshes: &[Mesh<T>; 2], samples: f64) -> ContactList<T> {
    let overlap = meshes[0].aabb().intersection(meshes[1].aabb());
    let [x, y, z]: [T; 3] = (overlap.upper - overlap.lower).into();
    let spacing = Sampling::Spacing(((x * y).max(y * z).max(z * x) / T::of(samples)).sqrt());
    let finest = detect(meshes, Layout::Bvh, spacing);
    assert_eq!(finest.statistics.uncut_pieces, 0, "{} samples are not as dense as they should be", finest.len());
    finest
}

/// How far force and torque are from those of dense samples, as parts of the force and the force times the overlap box's half
/// diagonal; where forces cancel, of a tenth of them all.
pub fn errors<T: Scalar>(meshes: &[Mesh<T>; 2], found: &ContactList<T>, finest: &ContactList<T>) -> [f64; 2] {
    let overlap = meshes[0].aabb().intersection(meshes[1].aabb());
    let [exact, has] = [finest, found].map(|list| load(&list.contacts, &overlap.centre()));
    let all =
        finest.contacts.iter().fold(T::zero(), |sum, contact| sum + contact.area * contact.depth * contact.cos_alpha);
    let force = exact[0].norm().max(all * T::of(0.1));
    let reach = (overlap.upper - overlap.lower).norm() * T::of(0.5);
    [(has[0] - exact[0]).norm() / force, (has[1] - exact[1]).norm() / (force * reach)].map(T::to_f64)
}

/// Where the spacing is larger than the triangles, about one ray for each of its squares of what lies inside, few elsewhere in
/// the overlap box, and a force near that of all.
#[test]
fn a_spacing_larger_than_the_triangles_casts_fewer_rays() {
    let meshes = scenes().swap_remove(0).1.map(|shape| shape.mesh::<f64>());
    let octrees = meshes.each_ref().map(Octree::new);
    let mut crossings = Vec::new();
    let mut is_inside = |side: usize, point: &Vector3<f64>| {
        let other = octrees[side].tracer(&meshes[side]).expect("the octrees are fresh");
        other.winding_number(point, &mut crossings) == Some(1)
    };
    let overlap = meshes[0].aabb().intersection(meshes[1].aabb());
    let in_box: f64 = meshes.iter().map(|mesh| surface_where(mesh, |middle| overlap.contains(middle))).sum();
    let inside = surface_where(&meshes[0], |middle| is_inside(1, middle));
    let inside = inside + surface_where(&meshes[1], |middle| is_inside(0, middle));
    assert!(inside < 0.8 * in_box, "{inside} of {in_box}");
    let finest = dense(&meshes, 20_000.0);
    for (spacing, tolerance) in [(0.05, 0.005), (0.1, 0.01), (0.2, 0.05)] {
        let found = detect(&meshes, Layout::Bvh, Sampling::Spacing(spacing));
        let squares = found.statistics.rays as f64 * spacing * spacing;
        assert!(
            (1.0..2.0).contains(&(squares / inside.midpoint(in_box))),
            "rays for {squares} of {inside} to {in_box}"
        );
        let contacts = found.len() as f64 * spacing * spacing / inside;
        assert!((1.0..2.0).contains(&contacts), "{contacts} contacts a square of {spacing}");
        assert_eq!(found.statistics.patches, found.statistics.rays);
        let errors = errors(&meshes, &found, &finest);
        assert!(errors.iter().all(|error| *error < tolerance), "{spacing}: {errors:?}");
    }
}

/// The area of the triangles whose middles lie somewhere.
fn surface_where(mesh: &Mesh<f64>, mut is_there: impl FnMut(&Vector3<f64>) -> bool) -> f64 {
    let triangles = 0..mesh.topology().triangles().len() as u32;
    let middle = |triangle: &u32| mesh.corners(*triangle).iter().sum::<Vector3<f64>>() / 3.0;
    let there = triangles.filter(|triangle| is_there(&middle(triangle)));
    there.map(|triangle| mesh.scaled_normal(triangle).norm() / 2.0).sum()
}

#[test]
fn layouts_and_scales_do_not_matter_to_the_last_bit() {
    let shapes = scenes().swap_remove(0).1;
    let meshes = shapes.clone().map(|shape| shape.mesh::<f64>());
    // With larger elements the layouts differ in what they leave out beside the overlap, and so in where halving ends.
    for (sampling, scaled) in [
        (Sampling::Spacing(0.1), Sampling::Spacing(0.1 * 1024.0)),
        (Sampling::Accuracy(0.01), Sampling::Accuracy(0.01)),
    ] {
        let [wide, classic] = LAYOUTS.map(|layout| sorted_along_surface(detect(&meshes, layout, sampling).contacts));
        assert!(wide.len() > 200, "{} contacts", wide.len());
        let without_area = |contacts: &[Contact<f64>]| -> Vec<Contact<f64>> {
            // The shares of the load are sums in the octree's order.
            contacts.iter().map(|contact| Contact { area: 0.0, ..*contact }).collect()
        };
        assert_eq!(without_area(&wide), without_area(&classic));
        let large = shapes.clone().map(|shape| shape.scaled(1024.0).mesh::<f64>());
        let large = sorted_along_surface(detect(&large, Layout::Bvh, scaled).contacts);
        assert_eq!(large.len(), wide.len());
        for (large, small) in large.iter().zip(&wide) {
            assert_eq!(large.p1.triangle, small.p1.triangle);
            assert_eq!([large.depth, large.area], [small.depth * 1024.0, small.area * 1024.0 * 1024.0]);
        }
    }
}

/// Bodies that bend keep their patches: the same triangles cast, with the areas that their patches have now.
#[test]
fn patches_stay_when_the_body_moves() {
    let [a, b] = scenes().swap_remove(0).1.map(|shape| shape.mesh::<f64>());
    let triangles = |meshes: &[Mesh<f64>; 2]| {
        let list = detect(meshes, Layout::Bvh, Sampling::Spacing(0.1));
        let of_second = list.contacts.into_iter().filter(|contact| contact.colliding == 1);
        of_second.map(|contact| contact.p1.triangle).collect::<std::collections::BTreeSet<_>>()
    };
    let mut meshes = [a, b];
    let before = triangles(&meshes);
    let positions = meshes[1].positions().to_vec();
    let moved = |vertex: usize| positions[vertex] + Vector3::new(0.0, 0.0, 0.01 * (3.0 * positions[vertex].x).sin());
    meshes[1].set_positions_with(positions.len(), moved).expect("finite");
    let after = triangles(&meshes);
    let common = before.intersection(&after).count();
    // At the overlap's border some come and others go.
    assert!(common * 10 > before.len() * 9, "{common} of {} and {}", before.len(), after.len());
}
