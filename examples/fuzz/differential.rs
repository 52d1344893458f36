//! Rays through a mesh from bytes: wide octree, classic octree and every triangle in turn give the same hits, to the bit.

use crate::bytes::Bytes;
use crate::surface;
use raycontact::math::Vector3;
use raycontact::octree::{Layout, Octree};
use raycontact::ray::Ray;

pub fn run(bytes: &mut Bytes) -> u64 {
    let Ok(mut mesh) = surface::mesh(bytes) else { return 0 };
    let mut octrees = [Layout::Wide, Layout::Classic].map(|layout| Octree::with_layout(&mesh, layout));
    // A step, so that octrees are refitted too; where numbers are not finite nothing has changed.
    let moved: Vec<[f64; 3]> = mesh.positions().iter().map(|p| [p.x + bytes.number(), p.y, p.z]).collect();
    if mesh.set_positions(&moved).is_ok() {
        octrees.iter_mut().for_each(|octree| octree.update(&mesh).expect("its own octree"));
    }
    let tracers = octrees.each_ref().map(|octree| octree.tracer(&mesh).expect("the octree is fresh"));
    let mut outcome = 1;
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
        let number = expected.map_or(7, |hit| u64::from(hit.triangle)) + 64 * of_wide.len() as u64;
        outcome = (outcome * 31 + number) % 4093;
    }
    outcome
}
