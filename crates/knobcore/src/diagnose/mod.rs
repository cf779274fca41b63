//! Where a model fails, and which effect it lacks.

mod bands;
mod beside;
mod bins;
mod candidate;
mod candidates;
mod chance;
mod chosen;
mod converge;
mod coupled;
mod divided;
mod elsewhere;
mod ends;
mod fine;
mod hints;
mod implausible;
mod in_place;
mod joined;
mod locate;
mod null;
mod pairs;
mod promise;
mod rest;
mod screen;
mod sets;
mod shown;
mod slower;
mod spectrum;
mod strides;
#[cfg(test)]
mod tests;
mod thinned;
mod unseen;
mod verdict;
mod watch;

pub use bins::since_reversal;
pub use candidate::Candidate;
pub use candidates::{diagnose, worth_adding};
pub use converge::converge;
pub use elsewhere::elsewhere;
pub use hints::{Hint, hints};
pub use implausible::implausible;
pub use in_place::in_place;
pub use locate::locate;
pub use pairs::{Pair, pairs};
pub use rest::{Region, Split};
pub use sets::{Set, sets};
pub use verdict::{Evidence, Judgement, State, at_floor, complete, exact, judge};
pub use watch::Tell;

pub(crate) use thinned::Thinned;
pub(crate) use watch::Watch;
