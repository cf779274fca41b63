//! Spans of rows of which the same is true.

use std::ops::Range;

/// The spans of these rows in which something holds, with at most so many rows between two of one span in which it
/// does not.
pub(crate) fn spans(rows: Range<usize>, between: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for at in rows.filter(|&at| holds(at)) {
        match spans.last_mut().filter(|last| at <= last.end + between) {
            Some(last) => last.end = at + 1,
            None => spans.push(at..at + 1),
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_goes_on_over_as_many_rows_as_may_lie_between_and_no_more() {
        let holds = |at: usize| [2, 3, 6, 9, 13].contains(&at);
        assert_eq!(spans(0..20, 0, holds), [2..4, 6..7, 9..10, 13..14]);
        assert_eq!(spans(0..20, 2, holds), [2..10, 13..14]);
        assert_eq!(spans(3..14, 2, holds), [3..10, 13..14]);
        assert!(spans(4..6, 9, holds).is_empty());
    }
}
