"""The paper's own test (section 2.2): known parameters, simulated, come back from the fit."""

from __future__ import annotations

import numpy as np
import pytest
from knobs import PAPER_KNOB as TRUTH

import knobcam as kc

# Standard deviation of the least-squares estimate under Equation 6: sigma sqrt(diag((J'J)^-1)) with sigma^2 =
# 4^2 / 12, as `benches/study_table2.py` derives it and confirms it over draws of the noise.
SD = {
    "inertia.M": 0.00065,
    "coulomb.neg": 0.02279,
    "coulomb.pos": 0.01387,
    "viscous.neg": 0.00754,
    "viscous.pos": 0.00576,
    "detent.A": 0.01030,
    "detent.P": 0.00071,
    "detent.S": 0.01091,
}


def knob(factor: float = 1.0) -> kc.Model:
    """The knob of Equation 5, every parameter `factor` times its value."""
    model = kc.Model.of(["inertia", "coulomb", "viscous", "detent"])
    for name, value in TRUTH.items():
        model = model.with_value(name, factor * value)
    return model


def values(fit: kc.Fit) -> dict[str, float]:
    return {name: estimate.value for name, estimate in fit.params.items()}


@pytest.mark.parametrize("prepare", ["none", "smooth"])
@pytest.mark.parametrize("start", [None, knob(0.5), knob(1.5)], ids=["none", "half", "half more"])
def test_without_noise_the_fit_is_exact_in_fewer_steps_than_the_paper_needed(
    start: kc.Model | None, prepare: str
) -> None:
    capture = kc.simulate(knob(), "sweep", noise="none")
    fit = kc.fit(capture, start, prepare=prepare, detents="yes" if start is None else "auto")
    assert values(fit) == pytest.approx(TRUTH, rel=1e-9)
    assert fit.core.iterations <= 7
    assert fit.core.evaluations < 43
    assert fit.core.status == "exact"


@pytest.mark.parametrize("prepare", ["none", "smooth"])
@pytest.mark.parametrize("seed", range(5))
def test_with_noise_estimates_scatter_as_least_squares_must(seed: int, prepare: str) -> None:
    fit = kc.fit(kc.simulate(knob(), "sweep", noise="paper", seed=seed), prepare=prepare)
    for name, sd in SD.items():
        assert abs(fit.params[name].value - TRUTH[name]) < 4.0 * sd, name
        assert fit.params[name].se == pytest.approx(sd, rel=0.15), name
    assert fit.core.iterations <= 7
    assert fit.core.evaluations < 43


def test_the_same_capture_gives_the_same_fit_to_the_last_bit() -> None:
    def fitted() -> kc.Fit:
        return kc.fit(kc.simulate(knob(), "sweep", noise="paper", seed=7))

    one, two = fitted(), fitted()
    assert one.document() == two.document()
    for name, draws in one.bootstrap(50, seed=3).items():
        np.testing.assert_array_equal(draws, two.bootstrap(50, seed=3)[name])


def test_refits_of_drawn_blocks_scatter_as_the_intervals_say() -> None:
    fit = kc.fit(kc.simulate(knob(), "sweep", noise="paper", seed=2), prepare="none")
    for name, draws in fit.bootstrap(1000, seed=1).items():
        assert np.std(draws) == pytest.approx(fit.params[name].se, rel=0.25), name
