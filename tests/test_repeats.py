"""Noise that repeats of a motion tell, where a spectrum of the torque cannot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal  # type: ignore[import-untyped]

import knobcam as kc

RATE_HZ = 200.0
Column = NDArray[np.float64]


def rubs(theta: Column, omega: Column, alpha: Column) -> Column:
    """A knob whose friction falls with speed, and that catches at one place: no base model."""
    friction = 0.3 * np.sign(omega) * (1.0 + 0.6 * np.exp(-np.abs(omega) / 0.15))
    return 0.02 * alpha + friction + 0.2 * np.exp(-(((theta - 0.3) / 0.05) ** 2))


def turned(seconds: float, *hertz: float) -> tuple[Column, Column, Column, Column]:
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    theta, omega, alpha = np.zeros((3, len(t)))
    for at, hz in enumerate(hertz):
        w, phase = 2.0 * np.pi * hz, 0.7 * at
        theta += 0.8 / len(hertz) * np.sin(w * t + phase)
        omega += 0.8 / len(hertz) * w * np.cos(w * t + phase)
        alpha -= 0.8 / len(hertz) * w**2 * np.sin(w * t + phase)
    return t, theta, omega, alpha


def slow(seed: int, many: int, memory: float = 0.9) -> Column:
    noise = np.random.default_rng(seed).standard_normal(many + 500)
    for at in range(1, len(noise)):
        noise[at] = memory * noise[at - 1] + math.sqrt(1.0 - memory**2) * noise[at]
    return np.asarray(0.02 * noise[500:])


def left(captures: list[kc.Capture], noises: list[Column]) -> float:
    """What noise alone leaves behind the filters of these captures, RMS."""
    squares = []
    for capture, noise in zip(captures, noises, strict=True):
        alone = kc.Capture.from_arrays(t=capture.t, theta=capture.theta, tau=noise)
        edge = capture.prepare().core.edge_hz
        assert edge is not None
        signals = alone.prepare(torque_edge_hz=edge)
        squares.append(signals.tau[signals.used] ** 2)
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def test_a_torque_that_was_smoothed_has_a_floor_where_the_motion_returns_and_none_where_not() -> None:
    filters = signal.butter(4, 20.0, fs=RATE_HZ, output="sos")
    told = {}
    for name, drift in {"returns": 0.0, "goes on": 1.5}.items():
        t, theta, omega, alpha = turned(40.0, 0.1, 0.3)
        theta, omega = theta + drift * t, omega + drift
        raw = 0.05 * np.random.default_rng(1).standard_normal(len(t))
        noise = signal.sosfiltfilt(filters, raw)
        torque = signal.sosfiltfilt(filters, rubs(theta, omega, alpha)) + noise
        capture = kc.Capture.from_arrays(t=t, theta=theta, tau=torque)
        told[name] = (kc.fit(capture), left([capture], [noise]))
    fit, true = told["returns"]
    assert fit.rmse > 2.0 * true
    assert fit.noise_floor == pytest.approx(true, rel=0.1)
    unknown, _ = told["goes on"]
    assert math.isnan(unknown.noise_floor)
    assert "smoothed before it was logged" in repr(unknown)
    assert "smoothed before it was logged" in unknown.compare().summary


def test_short_captures_of_one_motion_tell_slow_noise_of_a_knob_that_the_model_does_not_know() -> None:
    t, theta, omega, alpha = turned(5.0, 0.4, 1.2)
    noises = [slow(seed, len(t)) for seed in range(5)]
    torque = rubs(theta, omega, alpha)
    captures = [kc.Capture.from_arrays(t=t, theta=theta, tau=torque + noise) for noise in noises]
    fit, true = kc.fit(captures), left(captures, noises)
    assert fit.rmse > 1.5 * true
    assert fit.noise_floor == pytest.approx(true, rel=0.15)


def test_too_few_samples_are_called_so() -> None:
    t, theta, omega, alpha = turned(1.0, 1.0, 2.0)
    torque = rubs(theta, omega, alpha) + 0.02 * np.random.default_rng(3).standard_normal(len(t))
    fit = kc.fit(kc.Capture.from_arrays(t=t[:156], theta=theta[:156], tau=torque[:156]))
    assert math.isnan(fit.noise_floor) and "too few samples in a row" in repr(fit)
