"""What is named beside something that no effect explains: causes, and none that straightens a stand-in."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from known import BASE, climbed, comparison, split

from knobcam.learn import selection


@pytest.fixture(autouse=True)
def _nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selection, "width", lambda fit: None)
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {})
    monkeypatch.setattr(selection, "in_doubt", lambda *_: None)
    monkeypatch.setattr(selection, "tells_nothing", lambda prepared: None)


def named(*steps: tuple[str, float], complete: bool = False) -> tuple[str, ...]:
    left = comparison(complete, split("velocity", 0.3), split("time", 0.2))
    last = SimpleNamespace(comparison=left, candidates=())
    return selection.concluded(climbed(*steps), last, BASE).found


def test_of_more_than_are_believed_none_is_named_behind_one_that_is_no_cause() -> None:
    """Ten runs of one motor had `presliding`, and six of them `torque_drift`, `end_stop` or `torque_lag` too.

    Each came in behind an effect that took off a quarter; nothing drifts there, and the motor turns freely.
    """
    cause, stand_in, much, more = (
        ("presliding", 4.0),
        ("torque_lag", 3.7),
        ("torque_drift", 2.2),
        ("detent", 2.1),
    )
    assert named(cause, stand_in, much, more) == ("presliding",)
    assert named(cause, much, stand_in, more) == ("presliding", "torque_drift")
    assert named(("torque_lag", 9.5), cause, much, more) == ()
    # So few may all be there, of which one is small.
    assert named(cause, stand_in, much) == ("presliding", "torque_drift")


def test_a_cause_that_ended_at_a_bound_is_not_named_and_hides_none_behind_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its time was at the end of its range, beside friction of rate and state: `stribeck` is right."""
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {"torque_drift.tau": 1e3})
    steps = [("torque_drift", 4.0), ("stribeck", 1.9), ("detent", 1.8), ("unbalance", 1.7)]
    assert named(*steps) == ("stribeck",)
