//! The one decision: what is said of each effect that a model lacks.
//!
//! Whoever names an effect asks here: `learn`, which adds the one that is chosen, `diagnose`, the workbench and reports.

use crate::rule::{Rule, rule};

/// A fitted model, before anything is added.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// Root mean square error, N m.
    pub rmse: f64,
    /// What the noise alone would leave of it, N m; NaN where that is not known.
    pub noise_floor: f64,
    /// What the noise leaves of the sum of squares, in variances of the raw noise.
    pub white_squares: f64,
    /// Mean squared error by which laws that were added may be off, (N m)^2: less is no effect more.
    pub law: f64,
    /// Whether chance explains the error already.
    pub complete: bool,
    /// Whether what is left is rounding.
    pub exact: bool,
}

/// What speaks for an effect.
#[derive(Debug, Clone, Copy)]
pub struct Evidence {
    /// What it takes off the sum of squares, in variances of the raw noise.
    pub gain: f64,
    /// Parameters that it adds.
    pub parameters: usize,
    /// How many it is charged for where others do as well: one that may be anything within its range is no choice.
    pub charged: f64,
    /// Chance of such a gain where nothing is missing.
    pub p_value: f64,
    /// Root mean square error with it, N m.
    pub rmse: f64,
    /// Of the squared error of one capture the share that it takes off, where it takes off most: what a capture
    /// shows is no less for others that do not.
    pub felt: f64,
    /// Standard error of what it takes off more or less than the one that explains most, in variances of the raw noise;
    /// infinite where the motion cannot tell the two, whatever they leave.
    pub doubt: f64,
    /// Whether its values cannot be its own.
    pub implausible: bool,
    /// Parameters of the base model that are negative beyond doubt beside it, which no knob has.
    pub bent: usize,
}

/// What is said of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    /// It is missing: the simplest of those that explain most.
    Missing,
    /// The same, but it explains less than the better part of what noise does not: a part of what is missing at most.
    Part,
    /// It could be missing in place of the one that is named: the captures cannot tell them apart.
    Alike,
    /// It could be missing if another did not explain more; once that is added it is weighed again.
    Less,
    /// Its values cannot be its own: it stands in for something else.
    Implausible,
    /// More than chance, but too little of what noise does not explain to be the cause.
    TooLittle,
    /// Not worth its parameters.
    Unpaid,
    /// Chance does as well.
    Chance,
    /// Chance cannot be told from anything: the noise is not known.
    Untold,
}

impl Word {
    /// By which documents call it.
    pub fn id(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Part => "part",
            Self::Alike => "alike",
            Self::Less => "less",
            Self::Implausible => "implausible",
            Self::TooLittle => "too_little",
            Self::Unpaid => "unpaid",
            Self::Chance => "chance",
            Self::Untold => "untold",
        }
    }
}

/// What is said of an effect, and which others the captures cannot tell from it, by their places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Judgement {
    /// What is said.
    pub word: Word,
    /// Others that do as well for their parameters, of those that could be missing.
    pub equivalent: Vec<usize>,
}

/// Judges all effects that were weighed beside a model. One of them at most is [`Word::Missing`] or [`Word::Part`].
pub fn judge(state: &State, all: &[Evidence]) -> Vec<Judgement> {
    judge_by(rule(), state, all)
}

fn judge_by(rule: &Rule, state: &State, all: &[Evidence]) -> Vec<Judgement> {
    let score = |one: &Evidence| one.gain - rule.price * one.parameters as f64;
    let excess = state.rmse.powi(2) - state.noise_floor.powi(2);
    let taken = |one: &Evidence| state.rmse.powi(2) - one.rmse.powi(2);
    let least = (rule.share * excess).max(state.law);
    let chance = if state.complete { rule.rare } else { rule.chance };
    // What is said of each by itself.
    let alone = |one: &Evidence| {
        if state.noise_floor.is_nan() || state.noise_floor <= 0.0 {
            Word::Untold
        } else if state.exact || one.p_value > chance {
            Word::Chance
        } else if score(one) <= 0.0 {
            Word::Unpaid
        } else if one.implausible {
            Word::Implausible
        } else if one.felt < rule.worth || taken(one) < least {
            Word::TooLittle
        } else {
            Word::Less
        }
    };
    let mut words: Vec<Word> = all.iter().map(alone).collect();
    // Where more than noise is left with either, a small share of that says no more than chance does at the floor.
    let margin = |one: &Evidence| {
        let more = ((one.rmse / state.noise_floor).powi(2) - 1.0).max(0.0);
        rule.alike.max(state.white_squares * rule.relative * more)
    };
    let near = |at: usize, other: usize| (score(&all[other]) - score(&all[at])).abs() <= margin(&all[at]);
    // What is left then is no noise, so that it is asked where one leaves less than the other (Vuong 1989).
    let beside = |best: usize, at: usize| {
        let left = all[best].rmse > at_floor(state.white_squares) * state.noise_floor;
        margin(&all[best]).max(if left || all[at].doubt.is_infinite() {
            rule.told_apart * all[at].doubt
        } else {
            0.0
        })
    };
    let of_those = |word| -> Vec<usize> { (0..all.len()).filter(|&at| words[at] == word).collect() };
    let mut could = of_those(Word::Less);
    let best_of =
        |some: &[usize]| some.iter().copied().max_by(|a, b| score(&all[*a]).total_cmp(&score(&all[*b])));
    // A hair decides whether one of two that explain the same is enough: both are, or none.
    let enough = best_of(&could).map_or(f64::INFINITY, |best| score(&all[best]) - margin(&all[best]));
    could.extend(of_those(Word::TooLittle).into_iter().filter(|&at| score(&all[at]) >= enough));
    let best = best_of(&could);
    let alike =
        |at: usize| -> Vec<usize> { could.iter().copied().filter(|&other| near(at, other)).collect() };
    let group = best.map_or_else(Vec::new, &alike);
    // What is hardly known of another's parameters makes it no less likely.
    let told = |one: &Evidence| one.gain - rule.price * one.charged;
    let likely = |at: usize| best.is_some_and(|best| told(&all[at]) >= score(&all[best]) - beside(best, at));
    let simplest = |a: &usize, b: &usize| {
        // What explains as much without friction that gives power back has a better claim than what is simpler.
        let claim = |at: usize| (all[at].bent, all[at].parameters);
        claim(*a).cmp(&claim(*b)).then(score(&all[*b]).total_cmp(&score(&all[*a])))
    };
    let chosen = group.iter().copied().min_by(simplest);
    // What does as well in most stretches takes its place if it is simpler, and bends no more.
    let chosen = chosen.map(|chosen| {
        let close =
            |at: &usize| best.is_some_and(|best| score(&all[best]) - score(&all[*at]) <= beside(best, *at));
        let plainer =
            |at: &usize| all[*at].parameters < all[chosen].parameters && all[*at].bent <= all[chosen].bent;
        could.iter().copied().filter(|at| close(at) && plainer(at)).min_by(simplest).unwrap_or(chosen)
    });
    let mut group = group;
    group.extend(could.iter().copied().filter(|&at| likely(at)));
    group.sort_unstable();
    group.dedup();
    if let Some(chosen) = chosen {
        group.iter().for_each(|&at| words[at] = Word::Alike);
        let mainly = taken(&all[chosen]) >= rule.mainly * excess;
        words[chosen] = if mainly { Word::Missing } else { Word::Part };
    }
    let judgement = |(at, word): (usize, Word)| {
        let same = if group.contains(&at) {
            group.clone()
        } else if word == Word::Less {
            alike(at)
        } else {
            Vec::new()
        };
        Judgement { word, equivalent: same.into_iter().filter(|&other| other != at).collect() }
    };
    words.into_iter().enumerate().map(judgement).collect()
}

/// Whether an error is what noise alone leaves. `beyond` are the parts of the squared error that lie along an axis
/// beyond chance, one an axis that has any.
pub fn complete(state: &State, beyond: &[f64]) -> bool {
    let rule = rule();
    let felt = beyond.iter().any(|part| *part > rule.felt);
    state.exact || state.rmse <= at_floor(state.white_squares) * state.noise_floor && !felt
}

/// Times the noise floor up to which an error is no different from it, where noise leaves such a sum of squares, in
/// variances of the raw noise.
///
/// As many independent samples are about as many as it is: what noise leaves in them and the floor beside it are each
/// known to 1 / sqrt(2 N), so that their ratio is to 1 / sqrt(N). In seconds of a recording that is more than the few
/// percent of a long one.
pub fn at_floor(white_squares: f64) -> f64 {
    (1.0 + rule().steady / white_squares.sqrt()).max(rule().at_floor)
}

/// Whether an error is rounding beside the torque.
pub fn exact(rmse: f64, torque_rms: f64) -> bool {
    rmse <= rule().rounding * torque_rms
}

#[cfg(test)]
mod tests {
    use super::*;

    const BENT: State =
        State { rmse: 2.0, noise_floor: 1.0, white_squares: 1000.0, law: 0.0, complete: false, exact: false };

    /// An effect that takes off a share of what noise does not explain.
    fn takes(share: f64, parameters: usize) -> Evidence {
        let rmse = (4.0 - 3.0 * share).sqrt();
        let felt = 1.0 - rmse.powi(2) / 4.0;
        let gain = 3000.0 * share;
        let (charged, p_value) = (parameters as f64, 0.001);
        Evidence { gain, parameters, charged, p_value, rmse, felt, doubt: 0.0, implausible: false, bent: 0 }
    }

    fn words(state: &State, all: &[Evidence]) -> Vec<Word> {
        judge_by(&Rule::default(), state, all).into_iter().map(|one| one.word).collect()
    }

    #[test]
    fn what_explains_most_is_missing_and_what_explains_less_waits() {
        let all = [takes(0.4, 1), takes(0.99, 2), takes(0.1, 1)];
        assert_eq!(words(&BENT, &all), [Word::Less, Word::Missing, Word::TooLittle]);
    }

    #[test]
    fn slivers_name_nobody_however_sure_they_are() {
        let all: Vec<Evidence> = (1..=14).map(|n| takes(0.01 * f64::from(n), 1)).collect();
        assert!(words(&BENT, &all).iter().all(|word| *word == Word::TooLittle));
    }

    #[test]
    fn less_than_the_better_part_is_a_part() {
        assert_eq!(words(&BENT, &[takes(0.45, 1)]), [Word::Part]);
        assert_eq!(words(&BENT, &[takes(0.55, 1)]), [Word::Missing]);
    }

    #[test]
    fn of_those_alike_the_simplest_is_named_and_each_knows_the_others() {
        let judged = judge_by(&Rule::default(), &BENT, &[takes(0.5, 1), takes(0.992, 3), takes(0.99, 2)]);
        assert_eq!(
            judged.iter().map(|one| one.word).collect::<Vec<_>>(),
            [Word::Less, Word::Alike, Word::Missing]
        );
        assert_eq!((&judged[1].equivalent[..], &judged[2].equivalent[..]), (&[2][..], &[1][..]));
        assert!(judged[0].equivalent.is_empty());
    }

    #[test]
    fn what_explains_the_same_is_enough_with_the_other_or_is_not() {
        let all = [Evidence { felt: 0.0149, ..takes(0.99, 2) }, takes(0.993, 3)];
        assert_eq!(words(&BENT, &all), [Word::Missing, Word::Alike]);
        assert_eq!(words(&BENT, &all[..1]), [Word::TooLittle]);
        // Where the one that is not enough by a hair has the better claim it is named.
        let all = [Evidence { felt: 0.0149, ..takes(0.99, 1) }, takes(0.991, 3)];
        assert_eq!(words(&BENT, &all), [Word::Missing, Word::Less]);
    }

    #[test]
    fn of_two_that_leave_more_than_noise_neither_is_told_where_each_is_better_here_and_there() {
        let other = |doubt| [takes(0.9, 3), Evidence { doubt, ..takes(0.8, 2) }];
        assert_eq!(words(&BENT, &other(140.0)), [Word::Missing, Word::Less]);
        assert_eq!(words(&BENT, &other(160.0)), [Word::Alike, Word::Missing]);
        let richer = Evidence { parameters: 4, bent: 0, ..other(160.0)[1] };
        assert_eq!(
            words(&BENT, &[Evidence { bent: 1, ..takes(0.9, 3) }, richer]),
            [Word::Missing, Word::Alike]
        );
        // Nor where the motion cannot tell them, at the floor or not.
        let unseen = |rmse| [takes(0.9, 3), Evidence { doubt: f64::INFINITY, rmse, ..takes(0.8, 2) }];
        let either = |rmse: f64| words(&State { noise_floor: rmse, ..BENT }, &unseen(rmse));
        assert_eq!([either(1.0), either(1.3)], [(); 2].map(|()| [Word::Alike, Word::Missing].to_vec()));
        // Where noise alone is left its odds are known.
        let at_floor = State { rmse: 1.01, ..BENT };
        let plain = Evidence { gain: 40.0, rmse: 1.0, felt: 0.02, ..takes(0.99, 1) };
        let worse = Evidence { gain: 30.0, doubt: 160.0, ..plain };
        assert_eq!(words(&at_floor, &[plain, worse]), [Word::Missing, Word::Less]);
    }

    #[test]
    fn the_likelier_of_two_is_named_from_odds_of_19() {
        let at_floor = State { rmse: 1.01, ..BENT };
        let better = |by: f64| {
            let takes = Evidence { gain: 40.0, rmse: 1.0, felt: 0.02, ..takes(0.99, 1) };
            words(&at_floor, &[takes, Evidence { gain: 40.0 + by, ..takes }])
        };
        assert_eq!(better(2.0 * 19_f64.ln() - 0.2), [Word::Alike, Word::Missing]);
        assert_eq!(better(2.0 * 19_f64.ln() + 0.2), [Word::Less, Word::Missing]);
    }

    #[test]
    fn what_is_hardly_known_of_another_does_not_tell_it_from_the_one_that_is_named() {
        let at_floor = State { rmse: 1.01, ..BENT };
        let plain = Evidence { gain: 300.0, rmse: 1.0, felt: 0.02, ..takes(0.99, 2) };
        let rich = |charged| Evidence { gain: 305.0, parameters: 7, charged, ..plain };
        assert_eq!(words(&at_floor, &[plain, rich(3.0)]), [Word::Missing, Word::Less]);
        assert_eq!(words(&at_floor, &[plain, rich(2.5)]), [Word::Missing, Word::Alike]);
        assert_eq!(
            words(&at_floor, &[Evidence { bent: 1, ..plain }, rich(2.5)]),
            [Word::Missing, Word::Alike]
        );
    }

    #[test]
    fn of_those_alike_what_bends_nothing_below_zero_stands_before_what_is_simpler() {
        let bent = Evidence { bent: 1, ..takes(0.99, 1) };
        assert_eq!(words(&BENT, &[bent, takes(0.998, 3)]), [Word::Alike, Word::Missing]);
    }

    #[test]
    fn what_added_laws_may_be_off_by_names_nothing_more() {
        assert_eq!(words(&State { law: 1.9, ..BENT }, &[takes(0.6, 1)]), [Word::TooLittle]);
        assert_eq!(words(&State { law: 1.7, ..BENT }, &[takes(0.6, 1)]), [Word::Missing]);
    }

    #[test]
    fn what_cannot_be_is_no_rival_of_what_can() {
        let impossible = Evidence { implausible: true, ..takes(0.995, 1) };
        let judged = judge_by(&Rule::default(), &BENT, &[impossible, takes(0.99, 2)]);
        assert_eq!((judged[0].word, judged[1].word), (Word::Implausible, Word::Missing));
        assert!(judged[1].equivalent.is_empty());
    }

    #[test]
    fn where_chance_explains_the_error_it_takes_more_to_accuse() {
        let at_floor = State { rmse: 1.03, complete: true, ..BENT };
        let doubtful = Evidence {
            gain: 40.0,
            parameters: 1,
            charged: 1.0,
            p_value: 0.02,
            rmse: 1.01,
            felt: 0.02,
            doubt: 0.0,
            implausible: false,
            bent: 0,
        };
        assert_eq!(words(&at_floor, &[doubtful]), [Word::Chance]);
        assert_eq!(words(&at_floor, &[Evidence { p_value: 0.001, ..doubtful }]), [Word::Missing]);
    }

    #[test]
    fn what_is_not_worth_its_parameters_is_not_missing() {
        let dear = Evidence { gain: 30.0, ..takes(0.9, 3) };
        assert_eq!(words(&BENT, &[dear]), [Word::Unpaid]);
    }

    #[test]
    fn without_the_noise_nothing_is_told_and_rounding_is_nothing() {
        let all = [takes(0.9, 1)];
        for noise_floor in [f64::NAN, 0.0] {
            assert_eq!(words(&State { noise_floor, ..BENT }, &all), [Word::Untold]);
        }
        assert_eq!(words(&State { exact: true, complete: true, ..BENT }, &all), [Word::Chance]);
    }

    #[test]
    fn an_error_at_the_floor_is_complete_unless_a_part_of_it_is_felt() {
        let near = State { rmse: 1.04, ..BENT };
        assert!(complete(&near, &[0.02]) && !complete(&near, &[0.02, 0.04]) && !complete(&BENT, &[]));
        assert!(!complete(&State { noise_floor: f64::NAN, ..near }, &[]));
    }

    #[test]
    fn the_shorter_a_capture_the_less_is_known_of_its_floor() {
        let of = |rmse: f64, white_squares: f64| complete(&State { rmse, white_squares, ..BENT }, &[]);
        assert!(of(1.12, 400.0) && !of(1.13, 400.0));
        assert!(of(1.049, 1e4) && !of(1.051, 1e4) && of(1.049, f64::NAN));
    }
}
