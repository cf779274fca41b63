"""The marks of an examination: what counts as right, for answers that are made up."""

from __future__ import annotations

from typing import Any

import hidden
import numpy as np
import pytest
from examiner import SAMPLE_S, Case, cases, covered, judged, several
from marks import answered, report, targets

NOISE = 6e-4


def knob(*effects: str) -> hidden.Hidden:
    """Something hidden, as far as marks look at it."""
    return hidden.Hidden(
        seed=0,
        motion="hand",
        effects=effects,
        accepted=tuple(tuple(hidden.ACCEPTED[name]) for name in effects),
        capture={},
        noise_floor=NOISE,
        strength=2.0,
        strengths=(2.0,) * len(effects),
        knob={"inertia.M": 1e-4, "coulomb.neg": 0.01, "detent.A": 0.01, "detent.S": 3.1},
        truth={},
    )


def answer(verdict: str, *found: str) -> dict[str, Any]:
    ladder = [{"added": name, "rmse": NOISE, "params": {}} for name in (None, *found)]
    axis = {"axis": "time"} if verdict == "unexplained" else None
    document = {"verdict": verdict, "found": list(found), "ladder": ladder}
    return document | {"noise_floor": NOISE, "unexplained": axis}


def row(sitting: str, hid: tuple[str, ...], given: dict[str, Any]) -> dict[str, Any]:
    case = {
        "case": f"{sitting}/x:0",
        "sitting": sitting,
        "topic": hid[0] if hid else "knob",
        "motion": "hand",
    }
    about = {"effects": hid, "strength": 2.0, "seconds": 1.0}
    return case | about | judged(knob(*hid), given, sitting == "left-out")


@pytest.mark.parametrize(
    ("sitting", "hid", "given", "right"),
    [
        ("single", ("stribeck",), answer("missing", "stribeck"), True),
        ("single", ("stribeck",), answer("missing", "presliding"), False),
        ("single", ("stribeck",), answer("missing", "stribeck", "presliding"), False),
        ("single", ("stribeck",), answer("unexplained", "stribeck"), False),
        ("single", ("stribeck",), answer("complete"), False),
        ("single", ("unbalance",), answer("missing", "return_spring"), True),
        ("several", ("stribeck", "unbalance"), answer("missing", "unbalance", "stribeck"), True),
        ("several", ("stribeck", "unbalance"), answer("missing", "stribeck"), False),
        ("faultless", (), answer("complete"), True),
        ("faultless", (), answer("missing", "stribeck"), False),
        ("faultless", (), answer("unexplained"), False),
        ("strange", ("mains_hum",), answer("unexplained"), True),
        ("strange", ("mains_hum",), answer("missing", "torque_drift"), False),
        ("strange", ("rough_map",), answer("missing", "wavelet"), True),
        ("left-out", ("stribeck",), answer("unexplained"), True),
        ("left-out", ("stribeck",), answer("missing", "presliding"), False),
        ("lag", ("torque_lag",), answer("complete"), True),
        ("lag", ("torque_lag",), answer("missing", "presliding"), False),
    ],
)
def test_an_answer_is_right_when_it_names_what_was_hidden_and_nothing_else(
    sitting: str, hid: tuple[str, ...], given: dict[str, Any], right: bool
) -> None:
    assert answered(row(sitting, hid, given)) is right


def test_a_wrong_name_is_confident_only_where_nothing_is_left_unexplained() -> None:
    assert row("strange", ("creep",), answer("missing", "stribeck"))["wrong"]
    assert not row("strange", ("creep",), answer("unexplained", "stribeck"))["wrong"]


def test_an_interval_holds_a_phase_that_is_a_turn_away() -> None:
    params = {
        "detent.S": {"ci95": [-3.3, -3.1]},
        "inertia.M": {"ci95": [2e-4, 3e-4]},
        "coulomb.neg": {"ci95": None},
    }
    assert covered(knob(), params) == {"detent.S": True, "inertia.M": False}


def test_coulombs_levels_are_not_examined_beside_an_effect_that_brings_a_constant() -> None:
    params = {"coulomb.neg": {"ci95": [0.0, 1.0]}}
    assert covered(knob("stribeck"), params) == {"coulomb.neg": True}
    assert covered(knob("return_spring"), params) == {}


def test_every_case_is_made_again_from_its_name() -> None:
    every = cases(2, 10)
    assert len({str(case) for case in every}) == len(every)
    assert all(Case.parse(str(case)) == case for case in every)


def test_the_sitting_with_a_lag_hides_one_sample_of_it() -> None:
    truth = Case("lag", "sample", 0).make().truth
    assert [value for name, value in truth.items() if name.endswith("_s")] == [SAMPLE_S]


def test_several_effects_are_two_or_three_of_different_groups() -> None:
    for seed in range(4):
        effects = several(seed)
        assert len(effects) == 2 + seed % 2
        assert len({hidden.NAMED[name].group for name in effects}) == len(effects)


def test_the_report_has_a_line_for_each_target_that_was_examined_and_names_the_failures() -> None:
    rows = [row("single", ("stribeck",), answer("complete")), row("faultless", (), answer("complete"))]
    measured = {target.what: target.measured for target in targets(rows)}
    assert measured["exactly the right set of one, %"] == 0.0
    assert measured["faultless knobs accused, %"] == 0.0
    assert all(np.isfinite(value) for value in measured.values())
    text = list(report(rows))
    assert any("single/x:0" in line for line in text)
    assert not any("faultless/x:0" in line for line in text)
