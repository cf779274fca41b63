//! Every number that decides what is said to be missing: its meaning, its unit, and why it is as large as it is.
//!
//! What each of them does to an examination, halved and doubled, is measured by `benches/study_thresholds.py` and stands
//! in `docs/thresholds.md`. Constants of methods (steps, windows, how many starts are looked at) are where they are used,
//! and what values an effect may have is in the effect's file.

use crate::error::{Error, Result};
use std::sync::OnceLock;

/// A threshold in words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// By which it is called.
    pub name: &'static str,
    /// What it decides: a `verdict`, the `words` beside it, the `noise` that all is held against, or where a `search` goes.
    pub decides: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What it is counted in.
    pub unit: &'static str,
    /// Why it is so large.
    pub source: &'static str,
}

macro_rules! rules {
    ($($decides:ident { $($(#[doc = $meaning:literal])+ $name:ident: $value:literal, $unit:literal, $source:literal;)+ })+) => {
        /// The thresholds.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Rule {
            $($($(#[doc = $meaning])+ pub $name: f64,)+)+
        }

        impl Default for Rule {
            fn default() -> Self {
                Self { $($($name: $value,)+)+ }
            }
        }

        impl Rule {
            /// What each of them is, in the order of the table.
            pub const ROWS: &[Row] = &[$($(Row {
                name: stringify!($name),
                decides: stringify!($decides),
                meaning: concat!($($meaning),+).trim_ascii(),
                unit: $unit,
                source: $source,
            },)+)+];

            /// Their values, in the same order.
            pub fn values(&self) -> Vec<f64> {
                vec![$($(self.$name,)+)+]
            }

            fn named(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $($(stringify!($name) => Some(&mut self.$name),)+)+
                    _ => None,
                }
            }
        }
    };
}

rules! {
verdict {
    /// Times the noise floor up to which an error is no different from it, or, in a short capture, `steady` standard errors of either.
    at_floor: 1.05, "times the noise floor", "the floor is an estimate, good to a few percent; not studied apart";
    /// A part of the squared error on any axis that is this small, though beyond chance, leaves an error complete.
    felt: 0.03, "share of the squared error", "judgement: nothing that a hand would feel";
    /// An error that is this small beside the torque is rounding, and nothing is missing.
    rounding: 1e-10, "times the RMS torque", "double precision, with room for sums over a capture";
    /// An effect whose gain chance reaches oftener than so in the whole catalogue is no more than chance.
    chance: 0.05, "probability", "the usual 95 %";
    /// The same where chance explains the error already.
    rare: 0.005, "probability", "it takes more than one look in twenty to accuse a knob of which nothing is left";
    /// What a parameter must take off the sum of squares.
    price: 12.0, "variances of the raw noise", "BIC's for some thousands of independent samples, with the doubt about the noise on top";
    /// What an effect must take off the squared error.
    worth: 0.015, "share of the squared error", "judgement: less is nothing that a user would feel";
    /// What an effect must take off what noise does not explain; what takes off less is a stopgap, not the cause.
    share: 0.15, "share of the excess", "judgement: a line of the mains is drawn by many effects, by each a little; causes of a real axis, whose floor repeats tell, take a sixth each";
    /// What laws that were added may be off by, of what they took off: what is left at the floor and is less than that is no effect more.
    law: 0.025, "share of what was added", "judgement: as far as a textbook's law is that of a real knob";
    /// The same where a play is among them, or friction that builds up: what follows a knock or a reversal depends on all that came before.
    law_of_play: 0.05, "share of what was added", "of one knob with a gap another simulator's torque differs by 0.08 of it, most of that in a few late knocks; of 21 with friction that builds up by up to 0.03";
    /// What the cause must have taken off where something else stays unexplained, to be named beside that.
    mainly: 0.5, "share of the excess", "judgement: the better part";
    /// What a pair of a coupling and another effect may leave of what the search one by one left.
    pair_leaves: 0.5, "share of the excess", "judgement: the better part";
    /// Effects that come in one after the other, at most.
    most: 4.0, "effects", "one more than is believed, for one that goes again; half and twice as many changed no answer of the examination";
    /// Effects that are believed of one knob together, at most: what takes more of them is not explained by them.
    believed: 3.0, "effects", "of the examination's answers of more names than that none was right";
    /// Detents that a motion has to cross for a shape that returns with each to be no map of position.
    many: 4.0, "detents", "judgement: a polynomial does not follow four of them";
    /// Detents that a motion has to cross for a change of them to be told from any map of position.
    crossed: 1.0, "detents", "of less than one whole detent any map of position is a change; at 1.5 right names went, and none came";
    /// Gains, less the price of parameters, that differ by less tell no effect from another.
    alike: 6.0, "variances of the raw noise", "2 log(19): the likelier of two is the wrong one in 5 of 100";
    /// The same, as a share of what either leaves beyond the noise.
    relative: 0.02, "share of what is left", "judgement: where much is left, shapes differ by that much";
    /// Standard errors by which two effects that leave more than noise must differ in what they leave to be told apart.
    told_apart: 2.0, "standard errors", "the usual 95 %; of how they differ in one stretch and the next, as what is left is no noise";
    /// Of two effects that are one but for the sign of a motion that goes one way, what one may take off less than the other.
    one_way: 0.05, "share of what it takes off", "judgement: waves are chosen for each apart; not studied apart, as no capture of the examination goes one way";
    /// What a parameter that each of several runs has for itself must take off what noise does not explain.
    own_of_runs: 0.2, "share of the excess", "judgement, as share: what the model misses looks like a zero of the run that has more of it";
    /// Chance of detents that are not there, in a scan of their spatial frequency.
    detents_chance: 1e-4, "probability", "judgement: where they are taken for granted nobody looks at them again";
    /// Times what the median frequency of a scan takes off that detents must take off.
    detents_stand_out: 30.0, "times the background", "judgement: a missing effect fills the scan broadly, detents are a line";
    /// What detents must explain of what noise does not.
    detents_share: 0.15, "share of the excess", "judgement, as share";
    /// Standard errors by which a value must be out of its plausible range to be implausible.
    sure: 2.0, "standard errors", "95 % of a normal distribution";
    /// The same where the log itself is blamed.
    surely: 4.0, "standard errors", "judgement: who is told to mend a log has to be told right";
}
words {
    /// Chance of any false region on an axis, and of any false line in the spectrum.
    alarm: 0.05, "probability", "the usual 95 %";
    /// Times the power around it that a line stands out.
    line: 8.0, "times the power around", "judgement: a residual that lies over position fills the spectrum too, without lines";
    /// Weight of lines in frequency where the axis is named that shows most.
    frequency_leads: 0.5, "times the share", "judgement: any residual has lines where the motion repeats itself";
    /// The same of time.
    time_leads: 0.75, "times the share", "judgement: any residual changes with time too";
    /// Standard errors by which captures must ask for different values to disagree.
    apart: 5.0, "standard errors", "far beyond chance, also over many parameters and captures";
    /// Weight below which what could have been added is no rival.
    least_weight: 1e-3, "probability", "judgement: it changes no interval";
}
noise {
    /// Times the middle one by which a window is as loud as an impact, and does not count as noise.
    loud: 1.5, "times the power", "five standard deviations of noise alone";
    /// Times as much that the band below must hold for noise to be taken for coloured.
    falls: 1.4, "times the power", "judgement";
    /// Standard errors within which all stretches and the quiet ones must agree to be noise alone.
    steady: 2.5, "standard errors", "about 99 % of a normal distribution";
    /// A torque whose noise falls by so many times within the band that is taken for noise alone was smoothed before it was logged.
    smoothed: 8.0, "times the power", "judgement: that of control loops falls by three, and a taper lets through ten times as much where there is no noise";
    /// What the model's torque may differ by where a motion was made again for the two to be replicates.
    same_torque: 0.01, "share of the RMS torque", "judgement: what the model lacks differs by no more of itself; on a real axis 0.03 takes a tenth of it for noise";
    /// What the fastest wave that passes the torque's filter may turn by between them.
    same_way: 0.5, "rad", "judgement: an eighth of such a wave's variance is taken for noise at most";
}
search {
    /// An effect that takes off this share of what noise does not explain makes it needless to look at couplings.
    enough: 0.95, "share of the excess", "judgement: couplings take by far the longest, and can wait for what is left";
    /// What noise does not explain, and is less than this share of what it leaves, may be the noise's: no coupling is looked at.
    slight: 0.05, "share of the noise's squares", "the floor is an estimate, see at_floor";
    /// Where little is missing, an effect that leaves more than this share of it has not explained it: couplings are looked at.
    better: 0.3, "share of the excess", "judgement: what looks like it alone explains the better part of it";
    /// A sum of squares below this many times what noise leaves is explained: no coupling is looked at.
    explained: 1.1, "times the noise's squares", "at_floor, squared";
    /// A start of an effect is followed if it promises this share of what the best start does; with detents a third of that.
    rival_start: 0.7, "share of the best promise", "judgement";
    /// Beside a coupling, and where chance explains the error, a start is followed only if it promises this share of the sum of squares.
    worth_following: 0.005, "share of the sum of squares", "a third of worth: a first step tells a part of the gain";
    /// Before a coupling a start is followed only if it promises this share of what noise does not explain.
    worth_at_shaft: 0.1, "share of the excess", "two thirds of share: of what loads the shaft the first step tells nearly all";
    /// Beside a coupling a start is followed only if it promises this share of what the best of all effects does.
    rival_beside: 0.25, "share of the best promise", "judgement";
    /// What a coupling must explain through the coarse filter to be followed.
    worth_coarse: 0.1, "share of the excess", "two thirds of share";
    /// A coupling that leaves more than so many times what its best rival does through the coarse filter is not followed.
    rival_coarse: 2.0, "times the rival's excess", "judgement";
    /// The same as a share of all the excess, for where the best leaves next to nothing.
    close_coarse: 0.02, "share of the excess", "judgement";
    /// An error with a coupling that is this close to the noise floor needs no better end, and nothing beside it.
    converged: 1.01, "times the noise floor", "judgement: well within at_floor";
    /// An error with a coupling beyond this shows that more is missing: no better end is looked for.
    hopeless: 2.0, "times the noise floor", "judgement";
    /// A joint whose error ends lower by less has not moved.
    helped: 1e-3, "share of the error", "judgement: a tenth of converged";
    /// A knob that knocks in more of a capture tells nothing between its knocks.
    knocks: 0.4, "share of the rows", "judgement: more than half of what was measured is held on to";
    /// Where less of what a play leaves lies at its knocks, it is not they that hide what else is missing.
    knocking: 0.5, "share of what noise does not explain", "judgement: most of it";
    /// An effect that is worth so much, by first order or by a sketch without it, is needed: no fit without it is followed to see.
    needed: 10.0, "times what it has to be worth", "judgement: a fit that follows a bent surface loses less";
}
}

impl Rule {
    /// The rule with some of its values changed: `name=value` with commas between.
    ///
    /// # Errors
    /// For a name that no threshold has, and for what is no finite number.
    pub fn with(changes: &str) -> Result<Self> {
        let mut rule = Self::default();
        for change in changes.split(',').map(str::trim).filter(|change| !change.is_empty()) {
            let (name, value) = change.split_once('=').unwrap_or((change, ""));
            let known = rule.named(name.trim()).ok_or_else(|| {
                Error::invalid(name, "no threshold is called that; docs/thresholds.md has their names")
            })?;
            *known = value.trim().parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                Error::invalid(name, format!("'{value}' is no number; give name=value with commas between"))
            })?;
        }
        Ok(rule)
    }
}

static RULE: OnceLock<Rule> = OnceLock::new();

/// The rule of this process.
pub fn rule() -> &'static Rule {
    RULE.get_or_init(Rule::default)
}

/// Makes another rule that of this process, before anything has asked for it; false afterwards. For studies of the
/// thresholds alone.
pub fn settle(rule: Rule) -> bool {
    RULE.set(rule).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_of_the_threshold_that_is_named_and_of_no_other() {
        let (usual, changed) = (Rule::default(), Rule::with(" enough=0.5, hopeless = 3").unwrap());
        assert_eq!((changed.enough, changed.hopeless), (0.5, 3.0));
        let apart = usual.values().iter().zip(changed.values()).filter(|(a, b)| **a != *b).count();
        assert_eq!(apart, 2);
        assert_eq!(Rule::with("").unwrap(), usual);
    }

    #[test]
    fn what_is_no_change_is_refused_by_name() {
        for wrong in ["magic=1", "enough", "enough=", "enough=nan"] {
            let said = Rule::with(wrong).unwrap_err().to_string();
            assert!(said.starts_with(wrong.split('=').next().unwrap()), "{said}");
        }
    }

    #[test]
    fn names_are_met_once_and_every_threshold_has_a_reason() {
        let mut names: Vec<&str> = Rule::ROWS.iter().map(|row| row.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Rule::default().values().len());
        assert!(
            Rule::ROWS
                .iter()
                .all(|row| !row.meaning.is_empty() && row.source.len() > 8 && !row.unit.is_empty())
        );
    }
}
