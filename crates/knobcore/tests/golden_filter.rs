//! The measurement filter gives SciPy's numbers; `golden/make_filter_golden.py` made them.

use knobcore::filter::{Sos, ZeroPhase, butter, cheby2};
use serde::Deserialize;

const RATE_HZ: f64 = 5000.0;

#[derive(Deserialize)]
struct Golden {
    input: Vec<f64>,
    design: Vec<Design>,
}

#[derive(Deserialize)]
struct Design {
    kind: String,
    order: usize,
    edge_hz: f64,
    sos: Vec<[f64; 6]>,
    zi: Vec<[f64; 2]>,
    output: Vec<f64>,
}

impl Design {
    fn sos(&self) -> Sos {
        match self.kind.as_str() {
            "cheby2" => cheby2(self.order, 20.0, self.edge_hz, RATE_HZ),
            _ => butter(self.order, self.edge_hz, RATE_HZ),
        }
        .unwrap()
    }
}

fn golden() -> Golden {
    toml::from_str(include_str!("golden/filter.toml")).unwrap()
}

fn assert_close(ours: f64, scipy: f64, scale: f64, design: &Design) {
    let name = format!("{} {} at {} Hz", design.kind, design.order, design.edge_hz);
    assert!((ours - scipy).abs() <= 1e-10 * scale, "{name}: {ours} instead of {scipy}");
}

#[test]
fn designs_have_scipys_coefficients_in_scipys_order() {
    for design in golden().design {
        let sos = design.sos();
        assert_eq!(sos.sections().len(), design.sos.len());
        for (section, [b0, b1, b2, _, a1, a2]) in sos.sections().iter().zip(&design.sos) {
            for (ours, scipy) in section.b.iter().zip([b0, b1, b2]) {
                assert_close(*ours, *scipy, b0.abs(), &design);
            }
            for (ours, scipy) in section.a.iter().zip([a1, a2]) {
                assert_close(*ours, *scipy, 1.0, &design);
            }
        }
    }
}

#[test]
fn the_steady_state_is_scipys_sosfilt_zi() {
    for design in golden().design {
        for (ours, scipy) in design.sos().steady_state().iter().zip(&design.zi) {
            let scale = scipy[0].abs().max(1.0);
            assert_close(ours[0], scipy[0], scale, &design);
            assert_close(ours[1], scipy[1], scale, &design);
        }
    }
}

#[test]
fn any_number_of_channels_comes_out_as_from_sosfiltfilt() {
    let golden = golden();
    for design in &golden.design {
        let filter = ZeroPhase::new(design.sos());
        for count in 1..=6 {
            let mut channels = vec![golden.input.clone(); count];
            for (scale, channel) in channels.iter_mut().enumerate() {
                channel.iter_mut().for_each(|x| *x *= (scale + 1) as f64);
            }
            let source = channels.clone();
            let source: Vec<_> = source.iter().map(Vec::as_slice).collect();
            let mut target = vec![vec![0.0; golden.input.len()]; count];
            let mut target: Vec<_> = target.iter_mut().map(Vec::as_mut_slice).collect();
            filter.filter_into(&source, &mut target).unwrap();
            let mut in_place: Vec<_> = channels.iter_mut().map(Vec::as_mut_slice).collect();
            filter.filter_channels(&mut in_place).unwrap();
            assert_eq!(in_place, target);
            for (scale, channel) in in_place.iter().enumerate() {
                for (ours, scipy) in channel.iter().zip(&design.output) {
                    let scipy = scipy * (scale + 1) as f64;
                    assert_close(*ours, scipy, 10.0 * (scale + 1) as f64, design);
                }
            }
        }
    }
}
