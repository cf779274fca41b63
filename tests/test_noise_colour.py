"""Noise that is louder the slower it is: its floor is read as it is, and it is no missing effect."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import knobcam as kc


def with_noise(knob: kc.Model, memory: float, seed: int) -> kc.Capture:
    """A sweep whose torque has 1.8 mN m of noise, each sample keeping `memory` of the one before."""
    clean = kc.simulate(knob, "sweep", seed=seed, rate_hz=2000.0)
    exact = kc.simulate(knob, "sweep", noise="none", seed=seed, rate_hz=2000.0)
    noise = np.random.default_rng(seed).standard_normal(clean.samples + 2000)
    for at in range(1, len(noise)):
        noise[at] = memory * noise[at - 1] + np.sqrt(1.0 - memory**2) * noise[at]
    columns = dict(clean.columns) | {"tau": exact.tau + 1.8e-3 * noise[2000:]}
    return kc.Capture.from_arrays(**columns)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.97])
def test_coloured_noise_has_its_floor_and_accuses_no_knob(memory: float) -> None:
    learned = kc.learn(with_noise(kc.Model.load("knob3"), memory, 5))
    assert learned.verdict == "complete"
    assert learned.noise_floor == pytest.approx(learned.fit.rmse, rel=0.06)


def test_an_effect_is_found_in_coloured_noise() -> None:
    hidden = kc.hiding("knob4", "return_spring")
    stronger = hidden.with_value("return_spring.k", 2.0 * hidden.params["return_spring.k"].value)
    learned = kc.learn(with_noise(stronger, 0.9, 6))
    assert learned.verdict == "missing"
    assert {"return_spring", "position_polynomial", "unbalance"} & set(learned.found)


@pytest.mark.parametrize("seed", [10, 18, 26])
def test_a_slow_hand_does_not_hide_how_the_torques_noise_falls(seed: int) -> None:
    """Near a standstill its direction is uncertain: the model is loud where the noise is quiet."""
    rng = np.random.default_rng(seed)
    rows, rate = 30_000, 5000.0
    force = np.exp(-0.5 * (np.arange(-1500, 1501) / 400.0) ** 2)
    omega = np.convolve(rng.standard_normal(rows + 3000), force, "valid")
    omega *= 5.0 / omega.std()
    theta, alpha = np.cumsum(omega) / rate, np.gradient(omega, 1.0 / rate)
    noise = rng.standard_normal(rows + 2000)
    for at in range(1, len(noise)):
        noise[at] = 0.97 * noise[at - 1] + np.sqrt(1.0 - 0.97**2) * noise[at]
    noise = 1.8e-3 * noise[2000:]
    columns = {
        "theta": np.round(theta / 9.8e-6) * 9.8e-6,
        "omega": omega + 5e-3 * rng.standard_normal(rows),
        "alpha": alpha + 0.41 * rng.standard_normal(rows),
    }
    torque = 1e-4 * alpha + 0.02 * np.sign(omega) + 1e-3 * omega
    fitted = kc.fit(kc.Capture.from_arrays(**columns, tau=torque + noise, rate_hz=rate))
    alone = kc.Capture.from_arrays(**columns, tau=noise, rate_hz=rate).prepare()
    assert fitted.noise_floor == pytest.approx(np.sqrt(np.mean(alone.tau[alone.used] ** 2)), rel=0.05)


@pytest.mark.parametrize("gap", [False, True])
def test_what_is_fast_and_mostly_filtered_off_is_no_floor_with_gaps_in_the_log_either(
    gap: bool, tmp_path: Path
) -> None:
    """A gear that whines above the band: the filter takes it off, so that it tells no noise below."""
    clean = kc.simulate("knob3", "sweep", seed=4)
    waves = np.fft.rfft(np.random.default_rng(4).standard_normal(clean.samples))
    hz = np.fft.rfftfreq(clean.samples, 2e-4)
    whine = np.fft.irfft(np.where((hz > 1300.0) & (hz < 2450.0), waves, 0.0), clean.samples)
    columns = dict(clean.columns) | {"tau": clean.tau + 0.02 * whine}
    there = np.ones(clean.samples, dtype=bool)
    if gap:
        there[9000:9400] = False
    capture = kc.Capture.from_arrays(**{name: column[there] for name, column in columns.items()})
    learned = kc.learn(capture, without=["backlash", "compliance"])
    assert math.isnan(learned.noise_floor) and learned.verdict == "unexplained"
    assert "more than noise is fast in the torque" in learned.fit.compare().summary
    assert learned.rows()[-1][:2] == ("sensor noise alone", "unknown")
    report = learned.report(tmp_path / "report.html").read_text("utf-8")
    assert "more than noise is fast in the torque" in report and ">nan" not in report
