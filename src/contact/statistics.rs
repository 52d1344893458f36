/// What a query did. Every ray is either a contact or counted under the one reason why it is none: `rays` is the number of
/// contacts + `misses` + `entry_hits` + `own_surface_hits` + `replaced`. `rayc_statistics` in `raycontact/contacts.h` says more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Pairs of meshes whose boxes overlap.
    pub pairs: u64,
    /// Of these, pairs with an open mesh.
    pub open_pairs: u64,
    /// Rays traced, from surface points inside an overlap box that may lie inside the other body.
    pub rays: u64,
    /// Of these, rays that stand for a patch of several triangles.
    pub patches: u64,
    /// Rays beside those, traced only to find out how fine the sampling has to be, or whether and which way a pair is to escape.
    pub estimate_rays: u64,
    /// Rays that left the overlap box without meeting the other mesh; of a body with itself, rays that found no inside.
    pub misses: u64,
    /// Rays whose first hit enters the other mesh: they start outside it.
    pub entry_hits: u64,
    /// Rays that leave their own mesh before the other; for a body with itself, through the far side of their own fold.
    pub own_surface_hits: u64,
    /// Contacts found and replaced by those of an escape that began in the same query.
    pub replaced: u64,
    /// Vertices or triangles inside an overlap box that cast no ray: their normal has no length.
    pub without_normal: u64,
    /// Pieces of triangles left larger than the sampling asks, because they have been cut as often as they may.
    pub uncut_pieces: u64,
    /// Contacts of edges, where no ray from a surface point found any.
    pub edge_contacts: u64,
    /// Contacts of bodies with themselves.
    pub self_contacts: u64,
    /// Bodies whose contacts with themselves were asked for, but that are open and have none.
    pub open_bodies: u64,
    /// How often a ray went past another fold of its own body or of the other.
    pub past_folds: u64,
    /// Pairs that began to escape in this query.
    pub escapes_started: u64,
    /// Pairs that are escaping, those included.
    pub escaping_pairs: u64,
    /// Contacts of escaping pairs.
    pub escape_contacts: u64,
    /// Pairs whose escape turned: to a shorter way out or, stopped by others, to the line of centres.
    pub escapes_turned: u64,
    /// Pairs that contacts cannot part and that would have begun to escape, had it not been forbidden to them.
    pub escapes_forbidden: u64,
    /// Bodies whose contacts with themselves were asked for, but that are tangled and have none.
    pub tangled_bodies: u64,
    /// Pairs of a crowd, which get fewer samples.
    pub crowded_pairs: u64,
    /// Pairs that have no contacts since one of the two is tangled and meets the other's rays nearly everywhere.
    pub tangled_pairs: u64,
    /// Pairs of which a point lies deeper in the other body than the volume of one of the two over its area; none with
    /// [`Sampling::Vertices`](crate::contact::Sampling::Vertices). A contact system counts bodies in half-spaces too.
    pub deep_pairs: u64,
    /// By what fraction of its net force a pair was allowed to be off, the most of all pairs sampled by accuracy, else 0.
    pub error_asked: f64,
    /// By what fraction of its net force a pair may be off, the most of all: an estimate, at times more than was asked.
    pub error_estimated: f64,
}

/// Calls a macro with the names of all counters.
macro_rules! with_counters {
    ($call:ident) => {
        $call! {
            pairs, open_pairs, rays, patches, estimate_rays, misses, entry_hits, own_surface_hits,
            replaced, without_normal, uncut_pieces, edge_contacts, self_contacts, open_bodies,
            past_folds, escapes_started, escaping_pairs, escape_contacts, escapes_turned,
            escapes_forbidden, tangled_bodies, crowded_pairs, tangled_pairs, deep_pairs
        }
    };
}
pub(crate) use with_counters;

impl std::ops::AddAssign for Statistics {
    fn add_assign(&mut self, more: Self) {
        macro_rules! add {
            ($($counter:ident),*) => {{
                let Self { $($counter),*, error_asked, error_estimated } = more;
                self.error_asked = self.error_asked.max(error_asked);
                self.error_estimated = self.error_estimated.max(error_estimated);
                $(self.$counter += $counter;)*
            }};
        }
        with_counters!(add);
    }
}
