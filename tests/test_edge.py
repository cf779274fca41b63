"""The edge of the torque's filter, on logs of a motor that this file simulates itself."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc

RATE_HZ = 1000.0


def motor(cogging: dict[int, float], top: float = 50.0, seconds: float = 20.0) -> kc.Capture:
    """A motor at up to `top` rad/s, with so many waves per turn of an amplitude (N m); 5 mN m of noise."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    fine = np.arange(0.0, seconds, 0.05 / RATE_HZ)
    omega = top * (1.0 + 0.1 * np.sin(3.0 * fine))
    theta = (np.cumsum(omega) * 0.05 / RATE_HZ)[::20]
    alpha = np.gradient(omega, 0.05 / RATE_HZ)[::20]
    tau = 2e-4 * alpha + 0.02 + 3e-4 * omega[::20] + np.random.default_rng(1).normal(size=len(t)) * 5e-3
    for order, amplitude in cogging.items():
        tau += amplitude * np.sin(order * theta + 0.4)
    counts = np.round(theta / 2.0 / np.pi * 65536.0)
    return kc.Capture.from_arrays(t=t, theta=counts / 65536.0 * 2.0 * np.pi, tau=tau)


def test_the_edge_goes_up_to_where_a_motor_cogs_at_its_speed() -> None:
    fit = kc.fit(motor({12: 0.02}))
    assert [finding for finding in fit.signals.findings if finding.kind == "edge"] == []
    assert any("12 waves per turn" in note and "raised from 100 Hz" in note for note in fit.signals.notes)
    assert fit.params["detent.P"].value == pytest.approx(1.0 / 12.0, rel=1e-3)
    assert fit.params["detent.A"].value == pytest.approx(0.02, rel=0.02)
    assert fit.rmse == pytest.approx(fit.noise_floor, rel=0.05)


def test_a_motor_without_waves_keeps_the_edge_of_its_rate() -> None:
    signals = motor({}).prepare()
    assert any("lowered to 100 Hz" in note for note in signals.notes)
    assert signals.findings == ()


def test_waves_beyond_every_edge_are_a_finding_and_in_the_way_of_an_all_clear() -> None:
    story = kc.learn(motor({12: 0.02}, top=240.0, seconds=10.0))
    assert story.verdict == "unexplained"
    assert story.found == ()
    assert "12 waves per turn" in story.headline
    assert "beyond the torque filter's edge of 400 Hz" in story.headline
    document = story.document()
    said = [finding for finding in document["findings"] if finding["kind"] == "edge"]
    assert len(said) == 1
    assert "log faster, or turn slower" in said[0]["message"]
    assert document["unexplained"]["axis"] == "position"
    assert "Not weighed: 12 waves per turn" in story.last.summary


def test_an_edge_that_is_given_stays_and_what_it_takes_off_is_said() -> None:
    signals = motor({12: 0.02}).prepare(torque_edge_hz=50.0)
    assert signals.core.edge_hz == 50.0
    (finding,) = signals.findings
    assert finding.kind == "edge"
    assert "raise torque_edge_hz" in finding.message


def test_waves_that_the_model_has_are_weighed_wherever_they_lie() -> None:
    capture = motor({12: 0.02})
    model = kc.fit(capture).model
    held = kc.fit(capture, model.frozen(), torque_edge_hz=50.0)
    assert held.signals.core.lost
    assert held.beyond is None
