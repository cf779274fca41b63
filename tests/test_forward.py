"""The motion that the measured torque makes of a model, beside the measured one."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import knobcam as kc

KNOB = {"inertia__M": 5e-4, "coulomb__pos": 0.01, "coulomb__neg": 0.012}
KNOB |= {"viscous__pos": 0.003, "viscous__neg": 0.003}


def knob(**values: float) -> kc.Model:
    return kc.Model.of(["inertia", "coulomb", "viscous"], **(KNOB | values))


@pytest.fixture(scope="module")
def run() -> kc.Capture:
    return kc.simulate(knob(), "sweep")


@pytest.fixture(scope="module")
def forward(run: kc.Capture) -> kc.Forward:
    return kc.fit(run, knob()).forward()


def test_the_torque_of_a_simulated_knob_makes_its_motion(forward: kc.Forward, run: kc.Capture) -> None:
    assert forward.r2 > 0.999 and forward.rmse < 0.02
    assert forward.runs[0].starts.tolist() == [0] and forward.runs[0].counts.all()
    spread = float(np.std(run.theta))
    assert forward.nrmse == pytest.approx(forward.rmse / spread)
    assert forward.r2 == pytest.approx(1.0 - forward.nrmse**2)
    assert forward.largest == pytest.approx(np.max(np.abs(forward.runs[0].simulated - run.theta)))


def test_a_wrong_model_strays_and_a_horizon_shows_how_long_it_holds(run: kc.Capture) -> None:
    wrong = kc.fit(run, knob(viscous__pos=0.006).frozen())
    once, often = wrong.forward(), wrong.forward(horizon_s=0.5)
    assert once.r2 < 0.9 < often.r2
    assert "horizon" in once.remarks[-1] and "open loop" in once.summary
    assert len(often.runs[0].starts) == 12 and "up to 0.5 s ahead" in often.summary


def test_a_gap_is_not_simulated_and_what_is_masked_does_not_count(run: kc.Capture) -> None:
    keep = np.r_[0:10_000, 12_000:30_000]
    columns = {name: values[keep].copy() for name, values in run.columns.items()}
    columns["theta"][5000] = math.nan
    forward = kc.fit(kc.Capture.from_arrays(**columns), knob()).forward()
    assert forward.runs[0].starts.tolist() == [0, 10_000]
    assert not forward.runs[0].counts[5000] and forward.r2 > 0.999
    assert "anew after each gap (2 starts)" in forward.summary


def test_what_a_sensor_of_the_model_did_is_taken_off_the_torque() -> None:
    drifting = knob().with_effect("torque_drift").with_value("torque_drift.d", 0.002)
    run = kc.simulate(drifting, "sweep")
    with_it, without = (kc.fit(run, model.frozen()).forward() for model in (drifting, knob()))
    assert with_it.r2 > 0.999 > without.r2
    assert any("torque_drift" in one for one in with_it.remarks)
    assert not any("torque_drift" in one for one in without.remarks)


def test_other_captures_are_simulated_as_the_model_is(run: kc.Capture) -> None:
    fit = kc.fit(run, knob())
    others = [kc.simulate(knob(), "multisine", seed=seed) for seed in (3, 4)]
    forward = fit.forward(others)
    assert forward.fit.model.params["inertia.M"].value == fit.model.params["inertia.M"].value
    assert forward.r2 > 0.99 and "The model was not fitted to these captures" in repr(forward)
    said = forward.document()
    assert [one["starts"] for one in said["captures"]] == [1, 1]
    assert repr(forward).count("simulated") >= 3
    json.dumps(said)


def test_positions_of_a_linear_axis_are_said_in_millimetres_and_written_in_metres() -> None:
    values = {"inertia__M": 2.0, "coulomb__pos": 5.0, "coulomb__neg": 5.0, "viscous__pos": 8.0}
    axis = kc.Model.of(["inertia", "coulomb", "viscous"], "linear", viscous__neg=8.0, **values)
    forward = kc.fit(kc.simulate(axis, "sweep", noise=kc.SensorNoise(tau_sd=0.1)), axis).forward()
    assert forward.document()["unit"] == "m"
    assert f"RMSE {1e3 * forward.rmse:.4g} mm, R2 {forward.r2:.4f}" in forward.summary
    assert "measured force" in forward.summary


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (
            kc.Model.of(["coulomb", "viscous"], coulomb__pos=0.01, coulomb__neg=0.01),
            ["inertia.M", "positive"],
        ),
        (knob(viscous__pos=-0.1, viscous__neg=-0.1), ["runs away", "horizon"]),
    ],
)
def test_what_cannot_be_simulated_is_refused_with_the_way_out(
    model: kc.Model, words: list[str], run: kc.Capture
) -> None:
    with pytest.raises(kc.InputError) as refused:
        kc.fit(run, model.frozen()).forward()
    assert all(word in str(refused.value) for word in words)


def test_the_picture_shows_both_positions_their_error_and_every_beginning(run: kc.Capture) -> None:
    forward = kc.fit(run, knob()).forward(horizon_s=1.0)
    above, below = forward.plot().axes
    assert [line.get_label() for line in above.lines] == ["measured", "simulated"]
    assert below.get_ylabel() == "error (rad)"
    assert sum(line.get_linestyle() == ":" for line in below.lines) == len(forward.runs[0].starts) == 6
    assert "<table>" in forward._repr_html_()
