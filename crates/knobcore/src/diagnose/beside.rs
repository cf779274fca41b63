//! What is missing beside a coupling: a descent there takes a hundred times as long as beside a rigid shaft, so that of
//! all starts of all effects only those are followed that the first step promises most of.

use super::coupled::{Ways, led, squares, strode};
use super::ends::{Ends, at_most, cost, on, rivals};
use super::screen::{Screen, Start};
use super::slower::{COARSE_HZ, MIDDLE_HZ, enough, floor, slowed};
use crate::effects::Id;
use crate::fit::{glance, sketch};
use crate::model::Model;
use crate::order::Ascending;
use crate::rule::rule;
use crate::signals::Signals;

/// Starts that are looked at by a few steps, and those of them that are followed; as many again where these do not explain
/// what is left: what else is missing bends the joint, and the first step with it.
const LOOKED: usize = 6;
const FOLLOWED: usize = 3;
const ROUNDS: usize = 2;

/// Effects beside a screen's model that has a coupling, fitted where they may be what is missing: as loads of the knob, or
/// of the shaft. `left` is what noise leaves of the sum of squares.
pub fn beside(screen: &Screen<'_>, effects: &[Id], left: f64) -> Vec<Ways> {
    let mut started = screen.watch.each(effects, |id| {
        let starts = screen.starts(*id);
        let before = screen.at_shaft(*id, &starts);
        (*id, starts, before)
    });
    started.sort_by_cached_key(|(id, ..)| *id);
    let promise = |start: &Start| screen.squares - start.predicted;
    let mut first: Vec<(usize, &Start)> = Vec::new();
    for (of, (id, starts, before)) in started.iter().enumerate() {
        let own = starts.iter().position(|start| screen.has_own(*id, start)).filter(|at| *at > 0);
        let starts = [starts.first(), own.map(|at| &starts[at]), before.first()];
        first.extend(starts.into_iter().flatten().map(|start| (of, start)));
    }
    first.sort_by_cached_key(|(_, start)| Ascending(start.predicted));
    let most = first.first().map_or(0.0, |(_, start)| promise(start));
    let least = (rule().rival_beside * most).max(rule().worth_following * screen.squares);
    // Beside what leaves noise alone nothing can be worth it.
    let worth = screen.squares > rule().converged.powi(2) * left || left.is_nan();
    // Who asks for one alone wants it followed, however little it explains.
    first.retain(|(_, start)| worth && promise(start) >= least || effects.len() == 1);
    let (view, left) = (View::of(screen), if left.is_finite() { left } else { 0.0 });
    let mut ends: Ends = Vec::new();
    for few in first.chunks(LOOKED).take(ROUNDS) {
        let few: Vec<Tried<'_>> = few.iter().map(|(of, start)| (*of, started[*of].0, *start)).collect();
        ends.extend(view.followed(&few, left));
        if ends.iter().any(|(_, (_, found))| found.cost <= rule().explained * left) {
            break;
        }
    }
    let mut ways: Vec<Ways> =
        started.into_iter().map(|(id, starts, _)| Ways { id, starts, end: None }).collect();
    led(&mut ways, ends);
    ways
}

/// A start, of which effect it is, and which place that has.
type Tried<'a> = (usize, Id, &'a Start);

/// The captures through slower filters, and what noise and the screen's model leave of the sum of squares in the coarse
/// one.
struct View<'a> {
    screen: &'a Screen<'a>,
    coarse: Vec<Signals>,
    middle: Vec<Signals>,
    floor: f64,
    without: f64,
}

impl<'a> View<'a> {
    fn of(screen: &'a Screen<'a>) -> Self {
        let [coarse, middle] = [COARSE_HZ, MIDDLE_HZ].map(|edge| slowed(screen.data, edge));
        let seen: Vec<&Signals> = coarse.iter().collect();
        let floor = floor(screen.data, COARSE_HZ, &seen, screen.model);
        let without = squares(&seen, screen.model);
        Self { screen, coarse, middle, floor, without }
    }

    /// Where those of a few starts lead to that a slow filter, and then a finer one, shows no reason against.
    fn followed(&self, few: &[Tried<'_>], left: f64) -> Ends {
        let (data, watch) = (self.screen.data, self.screen.watch);
        let [coarse, middle]: [Vec<&Signals>; 2] =
            [&self.coarse, &self.middle].map(|view| view.iter().collect());
        let (floor, without) = (self.floor, self.without);
        // A wave may be too fast for a slower filter.
        let direct = |at: usize| few[at].1.info().scan.is_some() || coarse.len() < data.len();
        let (fast, slow): (Vec<usize>, Vec<usize>) = (0..few.len()).partition(|at| direct(*at));
        let followed = |model: &Model| on(model, |model| glance(data, model));
        // What the slow filter shows is seen first: where one leaves much less of it than another, that one is none.
        let close = |ends: Ends| {
            let most = at_most(&ends, without, floor).max(enough(&coarse, floor));
            rivals(most, ends).0
        };
        let began = watch.each(&slow, |at| (*at, on(&few[*at].2.model, |model| sketch(&coarse, model))));
        let strode =
            |(at, end): &(usize, _)| (*at, strode(&coarse, Clone::clone(end), floor, without, watch));
        let went = close(watch.each(&close(began), strode));
        let mut looked: Ends = watch.each(&went, |(at, (model, _))| {
            let (of, _, start) = few[*at];
            let end = followed(&on(model, |model| glance(&middle, model)).0);
            // The joint is where the finest filter has it: a slower one may lead it away, and no way back.
            let lost = end.1.cost >= self.screen.squares;
            let again = lost.then(|| followed(&start.model)).filter(|(_, again)| again.cost < end.1.cost);
            (of, again.unwrap_or(end))
        });
        looked.extend(watch.each(&fast, |at| (few[*at].0, followed(&few[*at].2.model))));
        looked.sort_by_cached_key(cost);
        looked.truncate(FOLLOWED);
        let best = looked.first().map_or(0.0, |(_, (_, found))| found.cost - left);
        let rival = rule().rival_coarse * best.max(0.0) + rule().close_coarse * (self.screen.squares - left);
        looked.retain(|(_, (_, found))| found.cost - left <= rival);
        watch.each(&looked, |(of, (model, _))| (*of, on(model, |model| sketch(data, model))))
    }
}
