"""Noise that is louder the slower it is: its floor is read as it is, and it is no missing effect."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc


def with_noise(knob: kc.Model, memory: float, seed: int) -> kc.Capture:
    """A sweep whose torque has 1.8 mN m of noise, each sample keeping `memory` of the one before."""
    clean = kc.simulate(knob, "sweep", seed=seed)
    exact = kc.simulate(knob, "sweep", noise="none", seed=seed)
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
