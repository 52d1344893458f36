use super::rayc_contacts;
use crate::capi::base::rayc_status;
use crate::capi::ffi::{growing, guard, reading, with_precision, write_known};
use crate::contact::{Statistics, with_counters};

/// What a query did; later versions may count more, at the end. Every ray is either a contact or counted under the one
/// reason why it is none: rays = contacts + misses + entry_hits + own_surface_hits + replaced.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_statistics {
    /// Pairs of meshes whose boxes overlap.
    pub pairs: u64,
    /// Of these, pairs with an open mesh: no edges are traced for them and they do not escape; two open meshes do not even
    /// cast rays.
    pub open_pairs: u64,
    /// Rays traced, from surface points inside an overlap box; none from parts of a surface that are known to lie outside the
    /// other body.
    pub rays: u64,
    /// Rays that left the overlap box without meeting the other mesh; while a pair escapes, rays that left that mesh's
    /// own box. For a body with itself, rays from points that lie inside no other part of it.
    pub misses: u64,
    /// Rays whose first hit enters the other mesh: they start outside it.
    pub entry_hits: u64,
    /// Rays that leave their own mesh before the other; for a body with itself, rays that leave through the far side of
    /// their own fold.
    pub own_surface_hits: u64,
    /// Vertices or triangles inside an overlap box that cast no ray: their normal has no length.
    pub without_normal: u64,
    /// Pieces of triangles left larger than the sampling asks, because they have been cut as often as they may.
    pub uncut_pieces: u64,
    /// Contacts found.
    pub contacts: u64,
    /// Of these, contacts of edges, where no ray from a surface point found any.
    pub edge_contacts: u64,
    /// Of these, contacts of bodies with themselves.
    pub self_contacts: u64,
    /// Bodies whose contacts with themselves were asked for, but that are open and have none.
    pub open_bodies: u64,
    /// How often a ray went past another fold of its own body or of the other: past_folds in rayc_detection_options.
    pub past_folds: u64,
    /// Pairs that began to escape in this query.
    pub escapes_started: u64,
    /// Pairs that are escaping, those included.
    pub escaping_pairs: u64,
    /// Contacts of escaping pairs.
    pub escape_contacts: u64,
    /// Pairs whose escape turned: to a shorter way out, since their own led deeper; or, where other bodies blocked it,
    /// to the line between their centres from the next query on.
    pub escapes_turned: u64,
    /// Pairs that contacts cannot part, and that would have begun to escape if rayc_scene_allow_escape() did not forbid
    /// it.
    pub escapes_forbidden: u64,
    /// Of the rays, those that stand for a patch of several triangles.
    pub patches: u64,
    /// Rays beside those, traced only to find out how fine the sampling has to be (RAYC_SAMPLING_ACCURACY),
    /// or whether and which way a pair is to escape.
    pub estimate_rays: u64,
    /// Contacts found and replaced by those of an escape that began in the same query.
    pub replaced: u64,
    /// Bodies whose contacts with themselves were asked for, but that are tangled and have none: nearly everything touches
    /// everything, and no inside is left to tell. docs/architecture.md says by which signs they are known.
    pub tangled_bodies: u64,
    /// Pairs of a crowd, which get fewer samples: see RAYC_SAMPLING_ACCURACY.
    pub crowded_pairs: u64,
    /// Pairs that have no contacts since one of the two is tangled and meets the other's rays nearly everywhere: no inside is
    /// left to tell. docs/architecture.md says how they are known.
    pub tangled_pairs: u64,
    /// Pairs of which a point lies deeper in the other body than the volume of one of the two over its area: half of a plate's
    /// thickness, a third of a ball's radius. By the mesh as it was made, and by how its area has grown. A warning: near the
    /// middle of a body the nearest surface may be the wrong one, and where the stiffness is too small for the load, a body
    /// floats in another by its buoyancy (its weight is the stiffness times the volume inside). A body with half of its
    /// volume below a flat face is always counted. None are counted with RAYC_SAMPLING_VERTICES. A contact system counts bodies
    /// in half-spaces too; it looks where bodies would be at the end of the step without contact.
    pub deep_pairs: u64,
    /// By what part of its net force a pair was allowed to be off, the most of all (RAYC_SAMPLING_ACCURACY, more in crowds).
    pub error_asked: f64,
    /// By what part of its net force, or of a tenth of the sizes of all its forces if that is more, a pair is expected to be
    /// off, the most of all pairs: the root of the sum of the squares of what each sample may be off. An estimate, not a bound.
    /// It may exceed what was asked (docs/options.md), most of all where the sampling ended too early (uncut_pieces).
    pub error_estimated: f64,
}

growing!(rayc_statistics, escapes_forbidden: u64);

impl rayc_statistics {
    pub(super) fn of(found: Statistics, contacts: usize) -> Self {
        let Statistics { error_asked, error_estimated, .. } = found;
        macro_rules! copy {
            ($($counter:ident),*) => {
                Self { contacts: contacts as u64, error_asked, error_estimated, $($counter: found.$counter),* }
            };
        }
        with_counters!(copy)
    }
}

/// What the query that filled `contacts` did. struct_size: sizeof(rayc_statistics), so that a later library writes no more
/// than the caller knows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_statistics(
    contacts: *const rayc_contacts,
    struct_size: usize,
    statistics: *mut rayc_statistics,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let found = with_precision!(list, |list| list.statistics);
        let known = rayc_statistics::of(found, list.len());
        write_known(struct_size, statistics, "statistics", known)
    })
}
