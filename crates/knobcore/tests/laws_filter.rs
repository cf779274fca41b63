//! What a forward-backward filter must do, whatever its design.

use knobcore::filter::{Section, Sos, ZeroPhase, butter, cheby2};

const RATE_HZ: f64 = 5000.0;

fn designs() -> Vec<Sos> {
    let mut designs = Vec::new();
    for order in 1..=12 {
        for edge_hz in [25.0, 500.0, 2000.0] {
            designs.push(cheby2(order, 20.0, edge_hz, RATE_HZ).unwrap());
            designs.push(butter(order, edge_hz, RATE_HZ).unwrap());
        }
    }
    designs
}

/// Impulse response of the forward-backward filter, from its peak outwards to `reach` samples.
fn impulse_response(sos: &Sos, reach: usize) -> Vec<f64> {
    let mut response = vec![0.0; 2 * reach + 1];
    response[reach] = 1.0;
    ZeroPhase::new(sos.clone()).padded_by(0).filter_in_place(&mut response).unwrap();
    response.split_off(reach)
}

#[test]
fn after_the_settling_time_nothing_is_left_of_an_impulse() {
    for sos in designs() {
        let settle = sos.settle();
        let response = impulse_response(&sos, settle + 500);
        let peak = response.iter().fold(0.0, |peak: f64, y| peak.max(y.abs()));
        let rest = response[settle..].iter().fold(0.0, |rest: f64, y| rest.max(y.abs()));
        assert!(rest < 1e-16 * peak, "{rest} of {peak} after {settle}: {sos:?}");
        let early = response[settle / 8..].iter().fold(0.0, |rest: f64, y| rest.max(y.abs()));
        assert!(early > 1e-16 * peak, "{settle} samples are far too many: {sos:?}");
    }
}

#[test]
fn the_mean_power_is_the_energy_of_the_impulse_response() {
    for sos in designs() {
        let response = impulse_response(&sos, 2 * sos.settle());
        let one_side: f64 = response[1..].iter().map(|y| y * y).sum();
        let energy = response[0] * response[0] + 2.0 * one_side;
        assert!((sos.mean_power() / energy - 1.0).abs() < 1e-9, "{sos:?}");
    }
}

#[test]
fn a_block_with_a_settled_halo_equals_the_same_stretch_of_the_whole() {
    let sos = cheby2(3, 20.0, 500.0, RATE_HZ).unwrap();
    let halo = sos.settle();
    let filter = ZeroPhase::new(sos);
    let signal: Vec<f64> = (0..4000).map(|n| (0.01 * (n * n % 977) as f64).sin()).collect();
    let mut whole = signal.clone();
    filter.filter_in_place(&mut whole).unwrap();
    let mut block = signal[1000 - halo..2000 + halo].to_vec();
    filter.padded_by(0).filter_in_place(&mut block).unwrap();
    for (ours, reference) in block[halo..halo + 1000].iter().zip(&whole[1000..2000]) {
        assert!((ours - reference).abs() < 1e-14);
    }
}

#[test]
fn a_channel_that_is_not_finite_leaves_the_others_alone() {
    let filter = ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap());
    let clean: Vec<f64> = (0..300).map(|n| (0.1 * f64::from(n)).sin()).collect();
    let mut alone = clean.clone();
    filter.filter_in_place(&mut alone).unwrap();
    let (mut a, mut b, mut c) = (clean.clone(), clean.clone(), clean);
    b[150] = f64::NAN;
    c[150] = f64::INFINITY;
    filter.filter_channels(&mut [&mut a, &mut b, &mut c]).unwrap();
    assert_eq!(a, alone);
    assert!(b.iter().all(|y| y.is_nan()));
}

#[test]
fn a_short_channel_is_told_how_many_samples_are_needed() {
    let filter = ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap());
    let needed = filter.padding() + 1;
    assert!(filter.filter_in_place(&mut vec![0.0; needed]).is_ok());
    let error = filter.filter_in_place(&mut vec![0.0; needed - 1]).unwrap_err();
    assert!(error.to_string().contains(&format!("at least {needed}")), "{error}");
}

#[test]
fn channels_of_different_length_are_refused_by_number() {
    let filter = ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap());
    let (mut a, mut b) = (vec![0.0; 100], vec![0.0; 99]);
    let error = filter.filter_channels(&mut [&mut a, &mut b]).unwrap_err().to_string();
    assert!(error.contains("channel 2 has 99 samples"), "{error}");
}

#[test]
fn no_channels_are_nothing_to_do() {
    let filter = ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap());
    assert!(filter.filter_channels(&mut []).is_ok());
}

#[test]
fn an_unstable_or_non_finite_chain_is_refused() {
    let unstable = Section { b: [1.0, 0.0, 0.0], a: [-2.0, 1.0] };
    assert!(Sos::new(vec![unstable], RATE_HZ).unwrap_err().to_string().contains("unstable"));
    let broken = Section { b: [f64::NAN, 0.0, 0.0], a: [0.0, 0.0] };
    assert!(Sos::new(vec![broken], RATE_HZ).unwrap_err().to_string().contains("not finite"));
    assert!(Sos::new(Vec::new(), RATE_HZ).is_err());
}
