use super::Helpers;
use crate::memory::Room;
use rayon::prelude::*;

/// One thread copies fewer values than this faster than several.
const FEWEST_FOR_ONE: usize = 256;

impl Helpers {
    /// Adds the values of `count` lists, each as `change` makes it of the list's number and the value. `list` gives how many
    /// values are in all lists before, and the list.
    pub(crate) fn append<'a, V: Send + Sync + 'a>(
        &self,
        values: &mut Vec<V>,
        count: usize,
        list: impl Fn(usize) -> (usize, &'a [V]) + Sync,
        change: impl Fn(usize, &V) -> V + Sync,
    ) {
        let total = count.checked_sub(1).map(&list).map_or(0, |(before, last)| before + last.len());
        values.room_for(total);
        if !matches!(self, Self::Pool) || total < 2 * FEWEST_FOR_ONE {
            (0..count).for_each(|number| values.extend(list(number).1.iter().map(|value| change(number, value))));
            return;
        }
        let nth = |number: &mut usize, place: usize| {
            let (mut before, mut values) = list(*number);
            if place < before || place - before >= values.len() {
                *number = number_of_list(count, place, |number| list(number).0);
                (before, values) = list(*number);
            }
            change(*number, &values[place - before])
        };
        values.par_extend((0..total).into_par_iter().with_min_len(FEWEST_FOR_ONE).map_with(0, nth));
    }
}

/// The last list that has no more than `place` values before it.
fn number_of_list(count: usize, place: usize, before: impl Fn(usize) -> usize) -> usize {
    let (mut first, mut last) = (0, count - 1);
    while first < last {
        let middle = last - (last - first) / 2;
        if before(middle) <= place { first = middle } else { last = middle - 1 }
    }
    first
}
