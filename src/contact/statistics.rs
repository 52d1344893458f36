/// What a query did. Every ray is either a contact or counted under the one reason why it is none: `rays` is the number of
/// contacts + `misses` + `entry_hits` + `own_surface_hits` + `replaced`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Pairs of meshes whose boxes overlap.
    pub pairs: u64,
    /// Of these, pairs with an open mesh: no edges are traced for them and they do not escape; two open meshes do not even
    /// cast rays.
    pub open_pairs: u64,
    /// Rays traced, from surface points inside an overlap box; none from parts of a surface that are known to lie outside the
    /// other body.
    pub rays: u64,
    /// Of these, rays that stand for a patch of several triangles.
    pub patches: u64,
    /// Rays beside those, traced only to find out how fine the sampling has to be ([`Sampling::Accuracy`]), or whether
    /// and which way a pair is to escape.
    ///
    /// [`Sampling::Accuracy`]: crate::contact::Sampling::Accuracy
    pub estimate_rays: u64,
    /// Rays that left the overlap box without meeting the other mesh, or along an escape its box; for a body with itself,
    /// rays from points that lie inside no other part of it.
    pub misses: u64,
    /// Rays whose first hit enters the other mesh: they start outside it.
    pub entry_hits: u64,
    /// Rays that leave their own mesh before the other, though they start inside it; for a body with itself, rays that
    /// leave through the far side of their own fold.
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
    /// How often a ray went past another fold of its own body or of the other ([`DetectionOptions::past_folds`]).
    ///
    /// [`DetectionOptions::past_folds`]: crate::contact::DetectionOptions::past_folds
    pub past_folds: u64,
    /// Pairs that began to escape in this query.
    pub escapes_started: u64,
    /// Pairs that are escaping, those included.
    pub escaping_pairs: u64,
    /// Contacts of escaping pairs.
    pub escape_contacts: u64,
    /// Pairs whose escape turned: to a shorter way out, or, stopped by others, from the next query on to the line of centres.
    pub escapes_turned: u64,
    /// Pairs that contacts cannot part and that would have begun to escape, had it not been forbidden to them.
    pub escapes_forbidden: u64,
    /// Bodies whose contacts with themselves were asked for, but that are tangled and have none: nearly everything touches
    /// everything, and no inside is left to tell. docs/architecture.md says by which signs they are known.
    pub tangled_bodies: u64,
    /// Pairs of a crowd, which get fewer samples ([`Sampling::Accuracy`](crate::contact::Sampling::Accuracy)).
    pub crowded_pairs: u64,
    /// Pairs that have no contacts since one of the two is tangled and meets the other's rays nearly everywhere: no inside is
    /// left to tell. docs/architecture.md says how they are known.
    pub tangled_pairs: u64,
    /// Pairs of which a point lies deeper in the other body than the volume of one of the two over its area: half of a plate's
    /// thickness, a third of a ball's radius. By the mesh as it was made, and by how its area has grown. None are counted
    /// with [`Sampling::Vertices`]. A contact system counts bodies in half-spaces too.
    ///
    /// [`Sampling::Vertices`]: crate::contact::Sampling::Vertices
    pub deep_pairs: u64,
    /// By what fraction of its net force a pair was allowed to be off, the most of all pairs ([`Sampling::Accuracy`], more in
    /// crowds); 0 where no pair was sampled by accuracy.
    ///
    /// [`Sampling::Accuracy`]: crate::contact::Sampling::Accuracy
    pub error_asked: f64,
    /// By what fraction of its net force, or of a tenth of the sizes of all its forces if that is more, a pair is expected to
    /// be off, the most of all pairs: the root of the sum of the squares of what each sample may be off. An estimate, not a
    /// bound. It may exceed what was asked (docs/options.md), most of all where the sampling ended too early (`uncut_pieces`).
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
