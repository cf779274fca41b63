"""What a capture cannot tell is said, not printed with digits."""

import dataclasses
import pickle

import numpy as np
import pytest

import knobcam as kc


def test_a_parameter_at_its_bound_is_named_unless_it_is_the_one_of_no_effect() -> None:
    capture = kc.simulate(kc.Model.load("knob4"), "multisine")
    lag = kc.Model.load("knob4").with_effect("torque_lag")
    assert not any("bound" in said for said in kc.fit(capture, lag).warnings)
    late = dataclasses.replace(capture, tau=np.roll(capture.tau, 150))  # 30 ms, and 20 are the most
    said = kc.fit(late, lag).warnings
    assert any(one.startswith("torque_lag.delay is at its bound, 0.02") for one in said)
    # Of a load some part is in the friction, or all or none of it.
    pressed = kc.Model.load("knob4").with_effect("load_friction")
    by_detent = pressed.with_value("load_friction.mu", 0.5).with_value("load_friction.s_alpha", 0.0)
    fit = kc.fit(kc.simulate(by_detent, "multisine"), pressed)
    assert fit.params["load_friction.s_alpha"].value == 0.0
    assert not any("bound" in said for said in fit.warnings)


def test_a_direction_that_never_happens_has_no_friction():
    """A filter smears a trace of the one backward moment into counted samples; it must not be fitted."""
    fit = kc.fit(kc.simulate(kc.Model.load("knob4"), "sweep", duration_s=1.0, seed=2))
    assert {"coulomb.neg", "viscous.neg"} <= set(fit.undetermined)
    assert not fit.params["coulomb.neg"].determined


def test_an_oscillation_of_one_frequency_cannot_tell_inertia_from_stiffness():
    fit = kc.fit(kc.simulate(kc.Model.load("knob5"), "micro"))
    assert any("inertia cannot be told from a stiffness" in warning for warning in fit.warnings)
    assert not kc.fit(kc.simulate(kc.Model.load("knob4"), "multisine")).warnings


def test_a_torque_of_the_wrong_sign_is_named():
    capture = kc.simulate(kc.Model.load("knob4"), "sweep")
    wrong = kc.Capture.from_arrays(t=capture.t, theta=capture.theta, tau=-capture.tau)
    assert any("other sign" in warning for warning in kc.fit(wrong).warnings)


def test_a_model_against_its_own_noise_free_torque_is_complete():
    knob = kc.Model.load("knob3")
    capture = kc.simulate(knob, "sweep", noise="none")
    for fit in (kc.fit(capture), kc.fit(capture, knob.frozen())):
        comparison = fit.compare()
        assert comparison.complete and comparison.worst is None
        assert "rounding" in comparison.summary


def test_without_a_noise_floor_nothing_is_blamed():
    capture = kc.simulate(kc.Model.load("knob4"), "sweep", rate_hz=25.0)
    comparison = kc.fit(capture, prepare="none").compare()
    assert np.isnan(comparison.fit.noise_floor)
    assert comparison.worst is None
    assert all(np.isnan(split.share) and not split.regions for split in comparison.splits)


def test_a_capture_does_not_count_twice():
    capture = kc.simulate(kc.Model.load("knob4"), "sweep")
    with pytest.raises(kc.InputError, match="captures 1 and 2 are the same"):
        kc.fit([capture, capture])


def test_axes_do_not_mix():
    fit = kc.fit(kc.simulate(kc.Model.load("knob4"), "sweep"))
    sled = kc.Model.of(["inertia", "coulomb"], "linear", inertia__M=1.0, coulomb__pos=2.0, coulomb__neg=2.0)
    with pytest.raises(kc.InputError, match="linear"):
        fit.predict(kc.simulate(sled, "sweep"))


def test_models_are_values():
    knob = kc.Model.load("knob4")
    assert kc.Model.parse(knob.text()) == knob == pickle.loads(pickle.dumps(knob))
    assert knob != knob.with_value("detent.P", 0.08)
    with pytest.raises(kc.InputError, match="needs an effect"):
        kc.Model.of([])


def test_files_and_names_serve_where_captures_and_models_do(tmp_path):
    path = kc.simulate("knob4", "sweep").save(tmp_path / "run.npz")
    fit = kc.fit(path, "knob4")
    assert fit.rmse == kc.fit(kc.load(path), kc.Model.load("knob4")).rmse
    with pytest.raises(kc.InputError, match=r"nowhere\.npz"):
        kc.fit("nowhere.npz")
