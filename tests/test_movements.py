"""How far parameters went when something came into a model, and how that is said."""

from __future__ import annotations

import math

import pytest
from known import Known, estimate

import knobcam as kc
from knobcam.fit import refit


def test_a_phase_moves_by_an_angle_the_shorter_way_round_and_never_by_percent():
    old = Known(1.0, params={"a": estimate(3.1, 0.1), "b": estimate(3.1, 0.1)})
    new = Known(1.0, params={"a": estimate(-3.1, 0.1), "b": estimate(-3.1, 0.1)}, phases=frozenset("a"))
    moved = refit.moved(old, new)
    assert moved["a"].by == pytest.approx(2.0 * math.pi - 6.2) and moved["a"].sizeless
    assert moved["a"].by_se == pytest.approx(10.0 * moved["a"].by)
    assert moved["b"].by == pytest.approx(-6.2) and moved["b"].by_percent == pytest.approx(-200.0)
    # Which of a model's parameters are phases its effects say themselves.
    assert kc.Model.of(["inertia", "unbalance", "detent"]).phases == {"unbalance.phi", "detent.S"}
