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
    /// What it decides: `verdict`, `name`, `axis`, `noise` or `search`.
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
search {
    /// Effects that leave so little of what noise does not explain make it needless to look at couplings: 1 less this share.
    enough: 0.95, "share of the excess", "couplings take by far the longest, and of 5 % too little is left to tell one";
    /// Where noise does not explain less than this share of what it leaves, that may be the noise's, and no coupling is looked at.
    slight: 0.05, "share of the noise's squares", "the floor is known to a few percent, see at_floor";
    /// Where little is missing, an effect that leaves more than this share of it has not explained it, and couplings are looked at.
    better: 0.3, "share of the excess", "judgement: an effect that stands in for a weak coupling explains half of it";
    /// A sum of squares below this many times what noise leaves is explained: no coupling is looked at.
    explained: 1.1, "times the noise's squares", "at_floor, squared";
    /// A start of an effect is followed if it promises this share of what the best start does; a third of it with detents.
    rival_start: 0.7, "share of the best promise", "judgement: first steps tell the gain of most effects to some 10 %";
    /// Beside a coupling a start is followed only if it promises this share of the sum of squares.
    worth_following: 0.005, "share of the sum of squares", "a third of worth: the first step tells part of a gain";
    /// Before a coupling a start is followed only if it promises this share of the excess.
    worth_at_shaft: 0.1, "share of the excess", "half of share: of what loads the shaft the first step tells nearly all";
    /// Beside a coupling an effect's start is followed only if it promises this share of what the best of all does.
    rival_beside: 0.25, "share of the best promise", "judgement: couplings bend what first steps promise several times over";
    /// Share of the excess that a coupling must explain through the coarse filter to be followed.
    worth_coarse: 0.1, "share of the excess", "half of share: what the coarse filter shows of a coupling is a part of it";
    /// A coupling that leaves so many times what its best rival leaves through the coarse filter is not followed.
    rival_coarse: 2.0, "times the rival's excess", "judgement: ends through the coarse filter are known to a fraction";
    /// The same as a share of all the excess, where the best leaves next to nothing.
    close_coarse: 0.02, "share of the excess", "judgement: less cannot be told through the coarse filter";
    /// An error with a coupling that is this close to the noise floor needs no better end.
    converged: 1.01, "times the noise floor", "a tenth of what the floor is known to";
    /// An error with a coupling beyond this shows that more is missing, and no better end is looked for.
    hopeless: 1.5, "times the noise floor", "judgement: rough ends of the right coupling are within a fifth of the floor";
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
