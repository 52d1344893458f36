//! Counts of several queries, added up.

use raycontact::contact::Statistics;

/// Every count has a number of its own, and `step` more than the one before.
fn counts(first: u64, step: u64) -> Statistics {
    let mut next = first;
    let mut count = || {
        next += step;
        next
    };
    // In full, so that a count added later is not forgotten here.
    Statistics {
        pairs: count(),
        open_pairs: count(),
        rays: count(),
        patches: count(),
        estimate_rays: count(),
        misses: count(),
        entry_hits: count(),
        own_surface_hits: count(),
        without_normal: count(),
        uncut_pieces: count(),
        edge_contacts: count(),
        self_contacts: count(),
        open_bodies: count(),
        past_folds: count(),
        escapes_started: count(),
        escaping_pairs: count(),
        escape_contacts: count(),
        escapes_turned: count(),
        escapes_forbidden: count(),
    }
}

#[test]
fn each_count_is_added_to_its_own() {
    let mut sum = counts(100, 7);
    sum += counts(3, 2);
    assert_eq!(sum, counts(103, 9));
}
