//! Rays through a mesh from bytes, and its contacts with itself: wide octree, classic octree and every triangle or ray in
//! turn give the same, to the bit.

use crate::Bytes;
use crate::surface;
use raycontact::contact::{ContactList, DetectionOptions, query_self, query_self_with_all_rays};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::triangle::Ray;

pub fn run(bytes: &mut Bytes) {
    let Ok(mut mesh) = surface::mesh(bytes) else { return };
    let mut octrees = [Layout::Bvh, Layout::PaperOctree].map(|layout| Octree::with_layout(&mesh, layout));
    // A step, so that octrees are refitted too; where numbers are not finite nothing has changed.
    let moved: Vec<[f64; 3]> = mesh.positions().iter().map(|p| [p.x + bytes.number(), p.y, p.z]).collect();
    if mesh.set_positions(&moved).is_ok() {
        octrees.iter_mut().for_each(|octree| octree.update(&mesh).expect("its own octree"));
    }
    let tracers = octrees.each_ref().map(|octree| octree.tracer(&mesh).expect("the octree is fresh"));
    while bytes.are_left() {
        let target = mesh.positions()[bytes.below(mesh.positions().len())];
        let origin = if bytes.flag() { Vector3::from(bytes.point()) } else { mesh.positions()[bytes.below(8)] };
        let direction = if bytes.flag() { Vector3::from(bytes.point()) } else { target - origin };
        if !origin.iter().chain(direction.iter()).all(|x| x.is_finite()) {
            continue;
        }
        let ray = Ray::new(origin, direction);
        let expected = tracers[0].nearest_hit_of_all(&ray);
        for tracer in tracers {
            assert_eq!(tracer.nearest_hit(&ray), expected, "{ray:?}");
        }
        let mut crossings = [Vec::new(), Vec::new()];
        tracers.iter().zip(&mut crossings).for_each(|(tracer, found)| tracer.crossings(&ray, found));
        let [of_wide, of_classic] = crossings.each_mut().map(|found| {
            found.sort_by_key(|hit| hit.triangle);
            &*found
        });
        assert_eq!(of_wide, of_classic, "{ray:?}");
    }
    own_contacts(&mesh, &octrees);
}

fn own_contacts(mesh: &Mesh<f64>, octrees: &[Octree<f64>]) {
    let options = DetectionOptions::default();
    let mut all = ContactList::default();
    query_self_with_all_rays(mesh, &octrees[0], &options, &mut all).expect("the octree is fresh");
    for octree in octrees {
        let mut found = ContactList::default();
        query_self(mesh, octree, &options, &mut found).expect("the octree is fresh");
        assert_eq!(found.contacts, all.contacts);
    }
}
