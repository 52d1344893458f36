//! Getting out of an overlap that contacts cannot resolve: all points inside are pushed along one direction, chosen
//! once and kept until the bodies are apart. Contacts of swallowed bodies or of non-convex overlaps push against each other or
//! back to the middle; one direction that is kept frees them.

use crate::contact::{
    Contact, ContactKind, ContactList, EscapePush, Pair, Purpose, Sample, Statistics, Workspace,
    for_each_inside_stretch, make_contact,
};
use crate::math::{Scalar, Vector3, direction};
use crate::memory::{self, Room};
use crate::query::way_out_past_folds;
use crate::triangle::Ray;

/// A direction is dropped once one of its rays is too long. That is checked whenever this many rays have been traced.
const RAYS_AT_ONCE: usize = 64;
/// A way out is clearly shorter than another if it is less than this part of it. A smaller difference may be rounding.
const CLEARLY_SHORTER: f64 = 0.99;

/// Adds the contacts that push the pair's first body along `away`, and the second against it, and gives how deep the pair is.
/// Adds none, and gives `None`, where the bodies are apart.
pub(crate) fn push_apart<T: Scalar>(pair: &Pair<'_, T>, away: &Vector3<T>, contacts: &mut ContactList<T>) -> Option<T> {
    let start = contacts.len();
    let ContactList { contacts, statistics, pushes, workspace, .. } = contacts;
    for side in [0, 1] {
        inside_samples(pair, side, away, workspace, statistics);
        add_contacts(pair, side, workspace, contacts);
    }
    if contacts.len() == start {
        for side in [0, 1] {
            inside_stretches(pair, side, away, workspace, statistics);
            add_contacts(pair, side, workspace, contacts);
        }
    }
    let added = &mut contacts[start..];
    statistics.escape_contacts += added.len() as u64;
    // All points get the depth of the deepest one. So they come out together, and none holds the body back or turns it.
    let depth = added.iter().fold(T::zero(), |depth, contact| depth.max(contact.depth));
    added.iter_mut().for_each(|contact| contact.depth = depth);
    if added.is_empty() {
        return None;
    }
    pushes.room_for(1).push(EscapePush::new(pair.bodies, *away, depth, added));
    Some(depth)
}

/// The direction in which the first body has the shortest way out of the second, if one is shorter than `most`. The candidates
/// are a fixed set and the line of the boxes' centres; each is judged by the point with the longest way out along it. Of ways
/// that are nearly equally long the first wins, in one order for all pairs. Otherwise rounding would choose between the two sides
/// of a body that lies in the same place as another, and the bodies of a pile would push one another in a circle.
pub(crate) fn choose_direction<T: Scalar>(
    pair: &Pair<'_, T>,
    most: T,
    contacts: &mut ContactList<T>,
) -> Option<Vector3<T>> {
    let ContactList { workspace, statistics, .. } = contacts;
    find_judges(pair, workspace, statistics);
    let mut best: Option<(T, Vector3<T>)> = None;
    for candidate in candidates(pair) {
        let limit = best.map_or(most, |(shortest, _)| shortest * T::of(CLEARLY_SHORTER));
        let found = longest_way_out(pair, &candidate, limit, workspace, statistics);
        best = found.map(|longest| (longest, candidate)).or(best);
    }
    best.map(|(_, candidate)| candidate)
}

/// Whether the pair overlaps, and every point inside has a way out shorter than `limit` when the first body goes `away`.
pub(crate) fn is_short_way_out<T: Scalar>(
    pair: &Pair<'_, T>,
    away: &Vector3<T>,
    limit: T,
    contacts: &mut ContactList<T>,
) -> bool {
    let ContactList { workspace, statistics, .. } = contacts;
    find_judges(pair, workspace, statistics);
    longest_way_out(pair, away, limit, workspace, statistics).is_some()
}

/// Leaves in the workspace the points of either body inside the other, by which directions are judged.
fn find_judges<T: Scalar>(pair: &Pair<'_, T>, workspace: &mut Workspace<T>, statistics: &mut Statistics) {
    workspace.judges.iter_mut().for_each(Vec::clear);
    for find in [inside_samples, inside_stretches] {
        for side in [0, 1] {
            let mut counts = Statistics::default();
            // Along one axis in space, whichever body comes first, since rounding decides for points on the surface.
            find(pair, side, &pair.of_first(Vector3::z()), workspace, &mut counts);
            statistics.estimate_rays += counts.rays;
            let inside = workspace.samples.iter().map(|sample| sample.point.position);
            memory::append(&mut workspace.judges[side], inside);
        }
        if workspace.judges.iter().any(|points| !points.is_empty()) {
            break;
        }
    }
}

/// The longest way out of any judge when the first body goes `away`; `None` where there is none, or one of `limit` or more.
fn longest_way_out<T: Scalar>(
    pair: &Pair<'_, T>,
    away: &Vector3<T>,
    limit: T,
    workspace: &mut Workspace<T>,
    statistics: &mut Statistics,
) -> Option<T> {
    let mut longest = T::zero();
    for side in [0, 1] {
        let count = workspace.judges[side].len();
        for start in (0..count).step_by(RAYS_AT_ONCE) {
            let judges = &workspace.judges[side][start..count.min(start + RAYS_AT_ONCE)];
            memory::refill(&mut workspace.rays, judges.iter().map(|&point| pair.ray_out(side, point, away)));
            statistics.estimate_rays += workspace.rays.len() as u64;
            trace_out(pair, side, workspace);
            for (place, hit) in workspace.hits.iter().enumerate() {
                let way_out = hit.filter(|hit| hit.is_exit).map_or(T::zero(), |hit| hit.t);
                if way_out >= limit {
                    // This point will probably rule out the next direction too, so test it first.
                    workspace.judges[side].swap(0, start + place);
                    return None;
                }
                longest = longest.max(way_out);
            }
        }
    }
    (longest > T::zero()).then_some(longest)
}

/// The directions in which the first body may leave: the 26 to a cube's faces, edges and corners, then the line of centres, which
/// differs from pair to pair.
fn candidates<T: Scalar>(pair: &Pair<'_, T>) -> impl Iterator<Item = Vector3<T>> {
    let cube = (0..27).filter(|&i| i != 13).map(|i| {
        let component = |divisor: i32| T::of(f64::from(i / divisor % 3 - 1));
        Vector3::new(component(1), component(3), component(9))
    });
    let cube = cube.filter_map(|candidate| direction(&candidate)).map(|candidate| pair.of_first(candidate));
    cube.chain([pair.line_of_centres()])
}

/// Leaves in the workspace the samples of one body inside the other, their rays out and where these end.
fn inside_samples<T: Scalar>(
    pair: &Pair<'_, T>,
    side: usize,
    away: &Vector3<T>,
    workspace: &mut Workspace<T>,
    statistics: &mut Statistics,
) {
    let Workspace { groups, sides, .. } = &mut *workspace;
    pair.tracers[side].groups_not_outside(pair.tracers[1 - side], pair.region, &mut groups[side], &mut sides[side]);
    pair.collect(side, Purpose::Escape, workspace);
    let Workspace { samples, rays, .. } = &mut *workspace;
    memory::refill(rays, samples.iter().map(|sample| pair.ray_out(side, sample.point.position, away)));
    keep_inside(pair, side, workspace, statistics);
}

/// The same for the middles of the stretches of edges that lie inside the other body.
fn inside_stretches<T: Scalar>(
    pair: &Pair<'_, T>,
    side: usize,
    away: &Vector3<T>,
    workspace: &mut Workspace<T>,
    statistics: &mut Statistics,
) {
    let Workspace { samples, rays, edge_sides, crossings, groups, marks, .. } = workspace;
    samples.clear();
    rays.clear();
    let tracers = [pair.tracers[side], pair.tracers[1 - side]];
    let scratch = (edge_sides, crossings);
    for_each_inside_stretch(tracers, pair.region, (&mut groups[side], marks), scratch, |sample: Sample<T>, _| {
        rays.room_for(1).push(pair.ray_out(side, sample.point.position, away));
        samples.room_for(1).push(sample);
    });
    keep_inside(pair, side, workspace, statistics);
}

/// Keeps the samples whose ray out meets the surface from inside: these lie inside.
fn keep_inside<T: Scalar>(pair: &Pair<'_, T>, side: usize, workspace: &mut Workspace<T>, statistics: &mut Statistics) {
    statistics.rays += workspace.rays.len() as u64;
    trace_out(pair, side, workspace);
    workspace.keep_exits(statistics);
}

/// Finds where the rays of one body leave the other. Parts of a body may overlap, so a ray from inside may enter another part
/// first; whether a point is inside must not depend on the direction.
fn trace_out<T: Scalar>(pair: &Pair<'_, T>, side: usize, workspace: &mut Workspace<T>) {
    let Workspace { rays, hits, crossings, .. } = workspace;
    let other = pair.tracers[1 - side];
    other.nearest_hits(rays, hits);
    for (ray, hit) in rays.iter().zip(hits).filter(|(_, hit)| hit.is_some_and(|hit| !hit.is_exit)) {
        *hit = way_out_past_folds(other, ray, crossings).or(*hit);
    }
}

fn add_contacts<T: Scalar>(pair: &Pair<'_, T>, side: usize, workspace: &Workspace<T>, contacts: &mut Vec<Contact<T>>) {
    let collided = pair.tracers[1 - side].mesh();
    for (place, sample) in workspace.samples.iter().enumerate() {
        let (Some(hit), ray): (_, &Ray<T>) = (&workspace.hits[place], &workspace.rays[place]) else { continue };
        // Both bodies cast.
        let sample = Sample { area: sample.area * T::of(0.5), ..*sample };
        let (kind, bodies) = (ContactKind::Escape, [pair.bodies[side], pair.bodies[1 - side]]);
        contacts.room_for(1).push(make_contact(kind, bodies, &sample, ray.direction, collided, hit, T::one()));
    }
}
