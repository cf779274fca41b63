//! Two laws at once, where the best single one leaves something: all pairs of what a scan saw, by their products with
//! each other and with the residual. Each of a pair may have explained little alone.

use super::END;
use super::Search;
use super::follow::Followed;
use super::grammar::Term;
use super::rows::Rows;
use super::scan::Seen;
use super::sum::Sum;
use crate::algebra::{dot, orthonormal, products};
use crate::order::descending;
use nalgebra::{Matrix2, Vector2};

/// Laws of each scan of which pairs are made: one that is half of a sum may stand behind hundreds that imitate all of it.
const MOST: usize = 400;
/// Of laws that were followed so many are besides: they have more functions, at their best parameters.
const BEST: usize = 60;
/// Pairs that are followed.
const FOLLOWED: usize = 24;
/// In so many of them a law is at most.
const EACH: usize = 4;
/// Pairs that are followed to their end behind the measurement filter.
const ENDED: usize = 6;
/// Laws that are held against all others at a time.
const TOGETHER: usize = 32;
/// What the second of a pair has of its own beside the first, at least, as a share.
const OWN: f64 = 1e-3;

/// A law of a scan.
struct Part<'a> {
    term: &'a Term,
    price: f64,
    /// Its one or two columns as they count, orthonormal.
    columns: Vec<Vec<f64>>,
    /// Their products with the residual, nought of a second that it has not.
    along: Vector2<f64>,
}

impl<'a> Part<'a> {
    fn of(rows: &Rows<'_>, term: &'a Term, price: f64) -> Self {
        let columns = orthonormal(&rows.seen(term), rows.len());
        let along = |at| columns.get(at).map_or(0.0, |column: &Vec<f64>| dot(column, &rows.residual));
        let along = Vector2::from_fn(|at, _| along(at));
        Self { term, price, columns, along }
    }

    /// What both take off at once, where `both` are the products of their columns. None where one is the other.
    fn gain_with(&self, other: &Self, both: &Matrix2<f64>) -> Option<f64> {
        let own = Matrix2::identity() - both.tr_mul(both);
        let more = other.along - both.tr_mul(&self.along);
        let factor = own.cholesky().filter(|factor| factor.l_dirty().diagonal().min().powi(2) > OWN)?;
        Some(self.along.norm_squared() + more.dot(&factor.solve(&more)))
    }
}

impl Search<'_> {
    /// The best pairs of laws that were followed or seen in several scans, themselves followed to their ends behind the
    /// measurement filter of `fine`; in any order.
    pub(super) fn pairs(&self, known: &[Followed], seen: &[&Vec<Seen>], fine: &Rows<'_>) -> Vec<Followed> {
        let known = known.iter().filter_map(|one| one.law.alone()).take(BEST);
        let seen = seen.iter().flat_map(|one| one.iter().take(MOST)).map(|one| &one.term);
        // A formula is friction under a load as a whole, or not at all.
        let terms: Vec<&Term> = known.chain(seen).filter(|term| !term.powers.pressed).collect();
        let parts: Vec<Part<'_>> =
            self.watch.each(&terms, |term| Part::of(&self.rows[1], term, self.price(term)));
        let columns: Vec<&[f64]> = parts.iter().flat_map(|part| &part.columns).map(Vec::as_slice).collect();
        // Where the columns of each begin, and those of the last end.
        let begins: Vec<usize> = std::iter::once(0)
            .chain(parts.iter().scan(0, |end, part| {
                *end += part.columns.len();
                Some(*end)
            }))
            .collect();
        let firsts: Vec<usize> = (0..parts.len()).step_by(TOGETHER).collect();
        let of = |from: &usize| -> Vec<(f64, [usize; 2])> {
            let to = (from + TOGETHER).min(parts.len());
            let start = begins[*from];
            let all = products(&columns[start..begins[to]], &columns[start..]);
            let weighed = |first: usize, second: usize| {
                let (one, other) = (&parts[first], &parts[second]);
                let both = Matrix2::from_fn(|i, j| {
                    let own = i < one.columns.len() && j < other.columns.len();
                    if own { all[(begins[first] + i - start, begins[second] + j - start)] } else { 0.0 }
                });
                let gain = one.gain_with(other, &both)?;
                Some((gain / self.white - one.price - other.price, [first, second]))
            };
            let weighed = &weighed;
            let beyond =
                |first: usize| (first + 1..parts.len()).filter_map(move |second| weighed(first, second));
            (*from..to).flat_map(beyond).collect()
        };
        let mut pairs = self.watch.each(&firsts, of).concat();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut times = vec![0; parts.len()];
        let mut chosen: Vec<Sum> = Vec::new();
        for (_, pair) in pairs {
            if chosen.len() < FOLLOWED && pair.iter().all(|at| times[*at] < EACH) {
                pair.iter().for_each(|at| times[*at] += 1);
                chosen.push(Sum(pair.iter().map(|at| parts[*at].term.clone()).collect()));
            }
        }
        let follow = |law: &Sum| self.glanced(law.clone());
        let mut followed: Vec<Followed> = self.watch.each(&chosen, follow).into_iter().flatten().collect();
        followed.sort_by_cached_key(|one| descending(self.score(one)));
        followed.truncate(ENDED);
        let end = |one: &Followed| Some(Followed::at(fine, one.law.clone())?.best(fine, END, self.reach));
        self.watch.each(&followed, end).into_iter().flatten().collect()
    }
}
