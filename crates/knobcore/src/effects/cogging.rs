//! Cogging: poles and slots pull at whole numbers of places per revolution.

use super::{Carrier, Context, Effect, Id, LoadEffect, Over, Section, Survey, Wave, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::prelude::*;
use crate::scalar::Scalar;
use core::f64::consts::TAU;

/// Sum of a_i sin(n_i theta/P + phi_i) over whole orders n_i; P is 1 on a rotary axis, so that they count per
/// revolution, and the pitch over 2 pi on a linear one. An order of nought is not used.
pub struct Cogging;

/// Orders at the most.
const TERMS: usize = 9;
/// The period, and three numbers an order.
const COUNT: usize = 1 + 3 * TERMS;
/// Highest order on any axis.
const HIGHEST: f64 = 1000.0;
/// The highest harmonic that a detent is given.
const HARMONICS: f64 = 5.0;
/// Whole numbers of waves are told apart from others up to this.
const WHOLE: f64 = 0.05;

const fn params() -> [Param; COUNT] {
    const NAMES: [[&str; 3]; TERMS] = [
        ["n1", "a1", "phi1"],
        ["n2", "a2", "phi2"],
        ["n3", "a3", "phi3"],
        ["n4", "a4", "phi4"],
        ["n5", "a5", "phi5"],
        ["n6", "a6", "phi6"],
        ["n7", "a7", "phi7"],
        ["n8", "a8", "phi8"],
        ["n9", "a9", "phi9"],
    ];
    let pitch = Param::shape("P", Unit::of(0, 1, 0), [1e-9, 1e6], 1.0, "revolution or pitch over 2 pi");
    let mut params = [pitch.usually(Usual::FreeAlong); COUNT];
    let mut i = 0;
    while i < TERMS {
        let ([order, a, phi], at) = (NAMES[i], 1 + 3 * i);
        let whole = Param::shape(order, Unit::NUMBER, [0.0, HIGHEST], 0.0, "order, 0 where not used");
        params[at] = whole.usually(Usual::Fixed);
        params[at + 1] = Param::linear(a, Unit::of(1, 0, 0), "its amplitude").usually(Usual::Beside(at));
        params[at + 2] = Param::phase(phi, at + 1, "its phase").usually(Usual::Beside(at));
        i += 1;
    }
    params
}

impl Effect<COUNT> for Cogging {
    const ID: &'static str = "cogging";
    const LAW: &'static str = "sum of a_i sin(n_i theta/P + phi_i), n_i whole, P = 1 on a rotary axis";
    const SOURCE: &'static str = "Zhu & Howe 2000 (cogging torque by its orders per revolution)";
    const SHOWS: &'static str = "over position, as lines at whole orders per revolution";
    const CONFUSED: &'static [&'static str] = &["detent", "position_friction", "unbalance"];
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "cogging",
        name: "a ripple of whole orders per turn, as of a motor",
        about: "Magnets pull at iron, or teeth at teeth, at whole numbers of places per turn; several such \
                numbers at once make the pattern of that machine.",
        causes: &[
            "magnets of a motor that pull at its slots",
            "gear teeth, balls of a bearing, lobes of a harmonic drive",
            "a ball screw, with so many waves per pitch",
        ],
        remedies: &[
            "skewed magnets or slots, or a slotless motor",
            "command the ripple that was found, with the other sign",
            "another gear or screw moves or removes its order",
        ],
        latex: r"\sum_i a_i \sin\!\left(\frac{n_i\,\theta}{P} + \varphi_i\right),\quad n_i \in \mathbb{N}",
    };
    const OVER: Over = Over::Position;
    const SECTION: Option<Section> = Some(Section::Poles);
    const SCAN: Option<Wave> = Some(Wave::Orders);
    const PARAMS: [Param; COUNT] = params();

    /// The waves that were found, or orders that any motion tells apart where none were looked for; what comes once per turn has a name
    /// of its own.
    fn starts(survey: &Survey) -> Vec<[f64; COUNT]> {
        let mut start = Self::PARAMS.map(|param| param.neutral);
        let Some(waves) = &survey.waves else {
            start[1..]
                .chunks_mut(3)
                .zip((15_u8..).step_by(15))
                .for_each(|(term, order)| term[0] = order.into());
            return vec![start];
        };
        let along = || waves.iter().map(|wave| wave[1]).reduce(together);
        let Some(pitch) = survey.revolution.or_else(along) else { return Vec::new() };
        let order = |period: f64| (pitch / period).round();
        let terms = waves.iter().filter(|wave| survey.revolution.is_none() || order(wave[1]) > 1.0);
        for (term, [a, period, phi]) in start[1..].chunks_mut(3).zip(terms) {
            term.copy_from_slice(&[order(*period), *a, *phi]);
        }
        start[0] = pitch;
        if start[1] > 0.0 { vec![start] } else { Vec::new() }
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; COUNT] {
        if carrier.survey.range() < carrier.survey.revolution.unwrap_or(0.0) * TAU {
            return Self::PARAMS.map(|param| param.neutral); // such a motion tells no order from the next
        }
        carrier.sized(Id::Cogging, [carrier.floor, 100.0 * carrier.floor], |a| {
            let mut values = Self::PARAMS.map(|param| param.neutral);
            values[1..10].copy_from_slice(&[7.0, a, 0.6, 12.0, 0.7 * a, 2.0, 36.0, 0.3 * a, 4.0]);
            values
        })
    }

    /// Waves that all return with the detents are theirs, as far as their harmonics go.
    fn implausible(p: &[f64; COUNT], context: &Context) -> Vec<String> {
        let Some([detents, error]) = context.detents() else { return Vec::new() };
        let orders: Vec<f64> = p[1..].chunks(3).map(|term| term[0]).filter(|order| *order > 0.0).collect();
        let alike = context.alike();
        let theirs = |order: f64| {
            let n = (order / p[0] / detents).round();
            (1.0..=HARMONICS).contains(&n) && alike([order / p[0], 0.0], [n * detents, n * error])
        };
        if !orders.is_empty() && orders.into_iter().all(theirs) {
            return vec!["it repeats with the detents: {detent_harmonics} would, by nature".into()];
        }
        Vec::new()
    }
}

/// The shortest pitch that holds whole numbers of both waves, up to the highest order.
fn together(a: f64, b: f64) -> f64 {
    let mut pitches = (1..=HIGHEST as u32).map(|waves| f64::from(waves) * a);
    let whole = |pitch: &f64| (pitch / b - (pitch / b).round()).abs() < WHOLE && pitch / b > 0.5;
    pitches.find(whole).unwrap_or(a)
}

impl LoadEffect<COUNT> for Cogging {
    #[inline(always)]
    fn load<T: Scalar>(p: &[T; COUNT], motion: &Motion<T>) -> Load<T> {
        let turned = motion.theta / p[0];
        let mut tau = T::of(0.0);
        let mut at = 1;
        while at < COUNT {
            tau = tau + p[at + 1] * (p[at] * turned + p[at + 2]).sin_cos().0;
            at += 3;
        }
        Load::position(tau)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_makes_so_many_waves_per_revolution() {
        let mut p = Cogging::PARAMS.map(|param| param.neutral);
        p[1..7].copy_from_slice(&[7.0, 2.0, 0.3, 12.0, 1.0, 0.0]);
        let torque = |theta: f64| Cogging::load(&p, &Motion::exact(0.0, theta, 0.0, 0.0)).drive;
        assert!((torque(0.0) - 2.0 * 0.3_f64.sin()).abs() < 1e-12);
        assert!(
            (torque(0.4) - torque(0.4 + TAU)).abs() < 1e-12
                && (torque(0.4) - torque(0.4 + TAU / 7.0)).abs() > 0.1
        );
    }

    #[test]
    fn along_an_axis_the_pitch_is_the_shortest_that_holds_all_waves() {
        assert_eq!(together(0.3, 0.3), 0.3);
        assert!((together(0.3, 0.2) - 0.6).abs() < 1e-12 && (together(0.1, 0.2) - 0.2).abs() < 1e-12);
    }
}
