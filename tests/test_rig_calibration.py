"""The sensor tests of the rig: what was put into the sensors comes out."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc
from knobcam.rig.calibration import Calibration, Run, anchored, phase_lag, spatial

TRUE, NOMINAL = 1160.0, 1148.0


def spatial_run(seed: int) -> Run:
    track = kc.motion("sweep", 5.0)
    rng = np.random.default_rng(seed)
    volts = (track.alpha + 0.4148 * rng.standard_normal(25_000)) / TRUE
    recorded = kc.Capture.from_arrays(
        t=track.t,
        theta=track.theta + 0.3,  # an encoder counts from anywhere
        omega=track.omega + 0.0244 * rng.standard_normal(25_000),
        alpha=NOMINAL * volts,
        tau=1e-3 * rng.standard_normal(25_000),
    )
    return Run(track, recorded, NOMINAL)


def anchored_run(theta: float = 0.0) -> Run:
    track = kc.motion("sweep", 5.0, c=0.02)
    rng = np.random.default_rng(5)
    tau = 5.0 * track.theta + 0.0018 * rng.standard_normal(25_000)
    still = np.zeros(25_000)
    recorded = kc.Capture.from_arrays(t=track.t, theta=theta * track.theta, omega=still, alpha=still, tau=tau)
    return Run(track, recorded, NOMINAL)


def test_the_accelerometer_and_table_4_are_found_from_three_runs():
    found = spatial("KC-7", [spatial_run(seed) for seed in range(3)])
    assert found.c_cal == pytest.approx(TRUE, rel=1e-3)
    assert found.c_cal_variance is not None
    assert found.c_cal_variance < 4.0
    assert found.omega_sd_rad_s == pytest.approx(0.0244, rel=0.02)
    assert found.alpha_sd_rad_s2 == pytest.approx(0.4148, rel=0.02)
    assert found.theta_sd_rad == pytest.approx(0.0, abs=1e-9)
    assert abs(found.lag_s or 0.0) < 1e-4


def test_the_torque_sensor_is_tested_against_an_anchor():
    found = anchored("KC-7", [anchored_run()])
    assert found.tau_sd_Nm == pytest.approx(0.0018, rel=0.02)
    assert found.anchor_Nm_rad == pytest.approx(5.0, rel=1e-3)


def test_a_gripper_that_turns_is_no_anchor():
    with pytest.raises(kc.InputError, match="anchor it"):
        anchored("KC-7", [anchored_run(theta=1.0)])


def test_a_phase_lag_is_found_to_a_fraction_of_a_sample():
    t = np.arange(25_000) / 5000.0
    for late in (0.0, 3e-5, 1e-3):
        found = phase_lag(np.sin(6.0 * t), 2.0 * np.sin(6.0 * (t - late)), 5000.0)
        assert found == pytest.approx(late, abs=2e-6)


def test_a_calibration_comes_back_from_its_file_and_both_tests_merge(tmp_path):
    both = spatial("KC-7", [spatial_run(1)]).merged(anchored("KC-7", [anchored_run()]))
    assert both.c_cal is not None
    assert both.tau_sd_Nm is not None
    again = Calibration.load(both.save(tmp_path / "deep" / "KC-7.toml"))
    assert again == both
    assert again.document() == both.document()
    assert "C_cal" in repr(again)


@pytest.mark.parametrize(
    "text",
    ["", "not toml [", 'schema = "knobcam.model/1"', 'schema = "knobcam.calibration/1"\nserial = "x"\n',
     'schema = "knobcam.calibration/1"\nserial = "x"\ndate = "y"\nc_cal = "much"\n'],
)  # fmt: skip
def test_what_is_no_calibration_is_refused_in_one_line(tmp_path, text):
    path = tmp_path / "c.toml"
    path.write_text(text)
    with pytest.raises(kc.InputError, match=r"c\.toml") as refused:
        Calibration.load(path)
    assert "\n" not in str(refused.value)


def test_missing_samples_are_no_test():
    run = spatial_run(0)
    short = kc.Capture.from_arrays(
        t=run.recorded.t[:500],
        theta=run.recorded.theta[:500],
        omega=run.commanded.omega[:500],
        alpha=run.commanded.alpha[:500],
        tau=run.recorded.tau[:500],
    )
    with pytest.raises(kc.InputError, match="run 1"):
        spatial("KC-7", [run._replace(recorded=short)])


def test_the_tests_are_drawn(tmp_path):
    both = spatial("KC-7", [spatial_run(1)]).merged(anchored("KC-7", [anchored_run()]))
    both.plot().savefig(tmp_path / "tests.png")
    assert len(both.plot().axes) == 4
