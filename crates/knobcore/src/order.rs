//! Numbers as keys to sort by.
//!
//! With `sort_by_cached_key` whatever is sorted shares one compiled sort, of keys and places; each `sort_by` with a
//! comparison of its own compiles another, some 5 KB of machine code and a quarter of a second of the compiler's time.

use std::cmp::Ordering;

/// A number that sorts from the least to the largest, NaN last.
#[derive(Clone, Copy)]
pub(crate) struct Ascending(pub(crate) f64);

/// Sorts from the largest to the least, NaN first.
pub(crate) fn descending(value: f64) -> Ascending {
    Ascending(-value)
}

/// Of things in their order the first of those that are the same.
pub(crate) fn firsts<T>(all: Vec<T>, same: impl Fn(&T, &T) -> bool) -> Vec<T> {
    let mut apart: Vec<T> = Vec::new();
    for one in all {
        if !apart.iter().any(|other| same(other, &one)) {
            apart.push(one);
        }
    }
    apart
}

/// The number that a sort would put at a place, if there is one; NaN last.
pub(crate) fn nth(values: &mut [f64], at: usize) -> Option<f64> {
    (at < values.len()).then(|| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// The least of some numbers, the largest, and those between them that part them in so many; nothing of none.
pub(crate) fn quantiles(mut values: Vec<f64>, parts: usize) -> Vec<f64> {
    let Some(last) = values.len().checked_sub(1) else { return Vec::new() };
    let places: Vec<usize> = (0..=parts).map(|i| last * i / parts).collect();
    place(&mut values, &places);
    places.iter().map(|at| values[*at]).collect()
}

/// Puts at `places` (ascending) the numbers that a sort would put there, in less than half its time.
fn place(values: &mut [f64], places: &[usize]) {
    let Some(middle) = places.get(places.len() / 2).copied() else { return };
    let (below, _, above) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let (before, after) = places.split_at(places.len() / 2);
    let left = before.partition_point(|at| *at < middle);
    place(below, &before[..left]);
    let after: Vec<usize> = after.iter().filter(|at| **at > middle).map(|at| at - middle - 1).collect();
    place(above, &after);
}

impl Ord for Ascending {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Ascending {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ascending {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ascending {}

#[cfg(test)]
mod tests {
    use super::{Ascending, descending, firsts, nth, quantiles};

    #[test]
    fn equals_keep_their_order_both_ways_and_nan_is_the_largest() {
        let mut rows = [(2.0, 0), (f64::NAN, 1), (-1.0, 2), (2.0, 3), (f64::INFINITY, 4)];
        rows.sort_by_cached_key(|(key, _)| Ascending(*key));
        assert_eq!(rows.map(|(_, at)| at), [2, 0, 3, 4, 1]);
        rows.sort_by_cached_key(|(_, at)| *at);
        rows.sort_by_cached_key(|(key, _)| descending(*key));
        assert_eq!(rows.map(|(_, at)| at), [1, 4, 0, 3, 2]);
    }

    #[test]
    fn of_the_same_the_first_stays_wherever_the_others_are() {
        assert_eq!(firsts(vec![13, 25, 23, 14, 35, 46], |a, b| a % 10 == b % 10), [13, 25, 14, 46]);
    }

    #[test]
    fn quantiles_stand_where_a_sort_puts_them() {
        let mut values: Vec<f64> = (0..997_u32).map(|k| f64::from(k * 389 % 101)).collect();
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        for parts in [1, 7, 60, 2000] {
            let expected: Vec<f64> = (0..=parts).map(|i| sorted[996 * i / parts]).collect();
            assert_eq!(quantiles(values.clone(), parts), expected, "{parts}");
        }
        assert_eq!(nth(&mut values, 500), Some(sorted[500]));
        assert_eq!((nth(&mut [], 0), quantiles(Vec::new(), 3)), (None, Vec::new()));
    }
}
