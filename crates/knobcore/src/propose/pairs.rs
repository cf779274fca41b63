//! Two laws at once, where the best single one leaves something: all pairs of what a scan saw, by their products with
//! each other and with the residual. Each of a pair may have explained little alone.

use super::END;
use super::Search;
use super::follow::Followed;
use super::grammar::Term;
use super::rows::Rows;
use super::scan::Seen;
use super::sum::Sum;
use crate::algebra::{dot, orthonormal};
use crate::order::descending;
use nalgebra::{DMatrix, DVector};

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
/// What the second of a pair has of its own beside the first, at least, as a share.
const OWN: f64 = 1e-3;

/// A law of a scan.
struct Part<'a> {
    term: &'a Term,
    /// Its columns as they count, orthonormal, and their products with the residual.
    columns: Vec<Vec<f64>>,
    along: DVector<f64>,
}

impl<'a> Part<'a> {
    fn of(rows: &Rows<'_>, term: &'a Term) -> Self {
        let columns = orthonormal(&rows.seen(term), rows.len());
        let along = columns.iter().map(|column| dot(column, &rows.residual)).collect::<Vec<_>>().into();
        Self { term, columns, along }
    }

    /// What both take off at once. None where one is the other.
    fn gain_with(&self, other: &Self) -> Option<f64> {
        let (n, m) = (self.columns.len(), other.columns.len());
        let both = DMatrix::from_fn(n, m, |i, j| dot(&self.columns[i], &other.columns[j]));
        let own = DMatrix::identity(m, m) - both.tr_mul(&both);
        let more = &other.along - both.tr_mul(&self.along);
        let factor = own.cholesky().filter(|factor| factor.l_dirty().diagonal().min().powi(2) > OWN)?;
        Some(self.along.norm_squared() + more.dot(&factor.solve(&more)))
    }
}

impl Search<'_> {
    /// The best pairs of laws that were followed or seen in several scans, themselves followed to their ends behind the
    /// measurement filter of `fine`; in any order.
    pub(super) fn pairs(&self, known: &[Followed], seen: &[&Vec<Seen>], fine: &Rows<'_>) -> Vec<Followed> {
        let known = known.iter().filter_map(|one| one.law.alone()).take(BEST);
        let terms: Vec<(usize, &Term)> = known
            .chain(seen.iter().flat_map(|one| one.iter().take(MOST)).map(|one| &one.term))
            .enumerate()
            .collect();
        let mut parts: Vec<(usize, Part<'_>)> =
            self.watch.each(&terms, |one| (one.0, Part::of(&self.rows[1], one.1)));
        parts.sort_by_key(|(at, _)| *at);
        let firsts: Vec<usize> = (0..parts.len()).collect();
        let of = |first: &usize| -> Vec<(f64, [usize; 2])> {
            let (_, one) = &parts[*first];
            let beyond = parts.iter().enumerate().skip(first + 1);
            let paired = beyond.filter_map(|(second, (_, other))| {
                let price = self.price(one.term) + self.price(other.term);
                Some((one.gain_with(other)? / self.white - price, [*first, second]))
            });
            paired.collect()
        };
        let mut pairs = self.watch.each(&firsts, of).concat();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut times = vec![0; parts.len()];
        let mut chosen: Vec<Sum> = Vec::new();
        for (_, pair) in pairs {
            if chosen.len() < FOLLOWED && pair.iter().all(|at| times[*at] < EACH) {
                pair.iter().for_each(|at| times[*at] += 1);
                chosen.push(Sum(pair.iter().map(|at| parts[*at].1.term.clone()).collect()));
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
