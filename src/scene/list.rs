/// One list of contacts.
#[derive(Clone, Copy, Debug)]
pub(super) enum List {
    /// Of the body at this place with itself.
    Body(usize),
    /// Of the pair at this place.
    Pair(usize),
}
