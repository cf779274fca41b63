"""What is hidden can be found: its size shows in the motion, and with it nothing is left but chance."""

from __future__ import annotations

import numpy as np
import pytest
from study_pairs import solve

import knobcam as kc
from knobcam.model.hiding import hideable
from knobcam.model.typical import Carrier
from knobcam.rig.emulator import Emulation

# Every effect once; `benches/study_pairs.py` goes through all knobs and motions.
PAIRS = {
    "backlash": ("knob4", "sweep"),
    "compliance": ("knob2", "multisine"),
    "stribeck": ("knob1", "sweep"),
    "quadratic_drag": ("knob3", "multisine"),
    "detent_harmonics": ("knob4", "turns"),
    "second_detent": ("knob5", "turns"),
    "directional_detent": ("knob5", "sweep"),
    "position_polynomial": ("knob3", "hand"),
    "return_spring": ("knob2", "hand"),
    "unbalance": ("knob4", "turns"),
    "cogging": ("knob1", "turns"),
    "end_stop": ("knob3", "sweep"),
    "position_friction": ("knob1", "multisine"),
    "load_friction": ("knob4", "sweep"),
    "friction_drift": ("knob2", "multisine"),
    "presliding": ("knob1", "micro"),
    "torque_lag": ("knob4", "multisine"),
    "actuation_delay": ("knob4", "multisine"),
    "torque_drift": ("knob3", "sweep"),
    "saturation": ("knob5", "sweep"),
}


def test_every_effect_that_a_search_names_is_hidden_in_some_knob() -> None:
    # Whole orders per revolution take a revolution.
    motions = ("sweep", "turns")
    assert set(PAIRS) == {one for knob in kc.KNOBS for motion in motions for one in hideable(knob, motion)}


@pytest.mark.parametrize("effect", PAIRS)
def test_the_truth_explains_what_the_base_model_misses(effect: str) -> None:
    knob, motion = PAIRS[effect]
    solved = solve(knob, effect, motion)
    assert solved.before >= 1.5
    assert solved.after <= 1.05


@pytest.mark.parametrize("effect", PAIRS)
def test_an_effect_is_of_ordinary_size_and_within_the_range_of_the_sensor(effect: str) -> None:
    knob, motion = PAIRS[effect]
    carrier = Carrier.of(kc.Model.load(knob), motion)
    cost = carrier.cost(kc.effects()[effect])
    assert cost is not None
    assert cost.times < 25.0
    assert cost.peak < carrier.limit - 3.0 * carrier.noise


def test_an_effect_that_needs_another_is_refused_with_the_knobs_that_have_it() -> None:
    assert "detent_harmonics" not in hideable("knob1")
    with pytest.raises(kc.InputError, match=r"changes 'detent'.* hide it in knob3 or knob4 or knob5"):
        kc.hiding("knob1", "detent_harmonics")


def test_an_effect_that_would_not_show_is_refused_with_the_knobs_in_which_it_does() -> None:
    assert "saturation" not in hideable("knob3")
    with pytest.raises(kc.InputError, match=r"noise floors, and .* hide it in .*knob5"):
        kc.hiding("knob3", "saturation")


def test_sizes_follow_the_motion_and_the_noise() -> None:
    def lag(**given: str) -> float:
        return kc.hiding("knob4", "torque_lag", **given).params["torque_lag.lag"].value

    assert lag(motion="micro", noise="none") != pytest.approx(lag(noise="none")) and lag(noise="none") < lag()
    drift = kc.hiding("knob3", "torque_drift", duration_s=12.0)
    assert drift.params["torque_drift.L"].value == pytest.approx(12.0, rel=1e-3)


def test_a_knob_is_recorded_by_a_sensor_that_reaches_its_torque() -> None:
    for knob in kc.KNOBS:
        capture = kc.simulate(knob, "sweep")
        limit = capture.meta["noise"]["tau_limit"]
        assert np.max(np.abs(capture.tau)) < limit
        assert limit == Emulation(knob).sensors().tau_limit == (0.36 if knob == "knob5" else 0.18)
    assert np.max(np.abs(kc.simulate("knob5", "sweep", noise="rig").tau)) == 0.18  # the paper's own
