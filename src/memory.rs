//! Failed allocations. The standard collections abort the process when they cannot grow. This crate reserves memory first, and
//! where there is none the call unwinds with [`OutOfMemory`]: the C interface turns that into a status, and a program in Rust
//! may catch it.

use std::cell::Cell;
use std::collections::HashSet;
use std::fmt;
use std::hash::Hash;
use std::hint::black_box;
use std::panic::resume_unwind;
use std::sync::Arc;

/// The payload with which a call unwinds when memory runs out: [`std::panic::catch_unwind`] gives it, boxed. No message is
/// printed. Whatever the call was to change is as before; a [`ContactList`](crate::contact::ContactList) that it was to fill
/// is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory;

/// In bytes. Unwinding itself takes some hundred.
const RESERVE: usize = 1 << 10;

thread_local! {
    static RESERVED: Cell<Vec<u8>> = const { Cell::new(Vec::new()) };
}

/// Reserves the memory that this thread needs to report that memory has run out.
pub(crate) fn keep_reserve() -> Result<(), OutOfMemory> {
    // A thread that is ending has no place for it.
    let kept = RESERVED.try_with(|reserved| {
        let mut reserve = reserved.take();
        let outcome = reserve.try_reserve_exact(RESERVE);
        reserved.set(reserve);
        outcome
    });
    if matches!(kept, Ok(Err(_))) { Err(OutOfMemory) } else { Ok(()) }
}

#[cold]
#[inline(never)]
fn unwind() -> ! {
    let _ = RESERVED.try_with(Cell::take);
    // Boxed, it takes no memory.
    resume_unwind(Box::new(OutOfMemory))
}

/// Collections that report when they cannot grow. Call this before whatever may grow one, or use the functions below.
pub(crate) trait Room {
    /// Makes room for so many more, or unwinds.
    fn room_for(&mut self, more: usize) -> &mut Self;
}

impl<V> Room for Vec<V> {
    #[inline(always)]
    fn room_for(&mut self, more: usize) -> &mut Self {
        if self.capacity() - self.len() < more {
            make_room(self, more);
        }
        self
    }
}

#[cold]
#[inline(never)]
fn make_room<V>(list: &mut Vec<V>, more: usize) {
    if list.try_reserve(more).is_err() {
        unwind();
    }
}

impl<V: Eq + Hash> Room for HashSet<V> {
    fn room_for(&mut self, more: usize) -> &mut Self {
        if self.try_reserve(more).is_err() {
            unwind();
        }
        self
    }
}

/// An empty list with room for just so many.
pub(crate) fn with_room<V>(count: usize) -> Vec<V> {
    let mut list = Vec::new();
    if list.try_reserve_exact(count).is_err() {
        unwind();
    }
    list
}

/// A list of so many equal values.
pub(crate) fn filled<V: Clone>(value: V, count: usize) -> Vec<V> {
    let mut list = with_room(count);
    list.resize(count, value);
    list
}

/// A list of all items.
pub(crate) fn listed<V>(items: impl IntoIterator<Item = V>) -> Vec<V> {
    let mut list = Vec::new();
    append(&mut list, items);
    list
}

/// A list of all items, or the first error among them.
pub(crate) fn tried<V, E>(items: impl IntoIterator<Item = Result<V, E>>) -> Result<Vec<V>, E> {
    let mut list = Vec::new();
    for item in items {
        list.room_for(1).push(item?);
    }
    Ok(list)
}

/// Allocates so many bytes and frees them again, before code that would abort without them. Another thread may take them in
/// between.
pub(crate) fn ask(bytes: usize) {
    let room = with_room::<u8>(bytes);
    // So that the compiler cannot remove the allocation.
    black_box(room.as_ptr());
}

/// A value with several owners.
pub(crate) fn shared<V>(value: V) -> Arc<V> {
    // Two counts go with it.
    ask(size_of::<[usize; 2]>() + size_of::<V>());
    Arc::new(value)
}

/// Adds all items to a list.
pub(crate) fn append<V>(list: &mut Vec<V>, items: impl IntoIterator<Item = V>) {
    let items = items.into_iter();
    let (least, most) = items.size_hint();
    list.room_for(least);
    if most == Some(least) {
        list.extend(items);
    } else {
        items.for_each(|item| list.room_for(1).push(item));
    }
}

/// Replaces what a list holds by all items.
pub(crate) fn refill<V>(list: &mut Vec<V>, items: impl IntoIterator<Item = V>) {
    list.clear();
    append(list, items);
}

/// Replaces what a list holds by so many equal values.
pub(crate) fn refill_with<V: Clone>(list: &mut Vec<V>, value: V, count: usize) {
    list.clear();
    list.room_for(count).resize(count, value);
}

/// A value in a place of its own.
pub(crate) fn boxed<V>(value: V) -> Box<[V; 1]> {
    let mut place = with_room(1);
    place.push(value);
    let Ok(boxed) = place.into_boxed_slice().try_into() else { unreachable!("it holds one value") };
    boxed
}

/// [`format!`], which unwinds where there is no memory.
macro_rules! text {
    ($($what:tt)*) => {
        $crate::memory::written(format_args!($($what)*))
    };
}
pub(crate) use text;

/// The formatted text.
pub(crate) fn written(what: fmt::Arguments<'_>) -> String {
    struct Text(String);
    impl fmt::Write for Text {
        fn write_str(&mut self, part: &str) -> fmt::Result {
            if self.0.try_reserve(part.len()).is_err() {
                unwind();
            }
            self.0.push_str(part);
            Ok(())
        }
    }
    let mut text = Text(String::new());
    // What fails to write itself is left out from there on.
    let _ = fmt::write(&mut text, what);
    text.0
}
