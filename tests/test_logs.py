"""Logs of simulated knobs with the faults of real ones: what is wrong is said, what is not is not.

The whole of it, over many knobs, is `python benches/study_logs.py`; BENCHMARKS.md has its figures.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import hidden
import numpy as np
import pytest
from hidden import FAULTS
from hidden.motions import Track
from hidden.sensors import RATE_HZ, measured
from logs import Log, answered, asked, examine, judged
from marks_logs import failures, report, right

SEED = 90000
SOUND = ["clean", "angle only", "16384 counts, angle only", "AR(1) noise 0.9", "AR(1) noise 0.97"]
MENDED = [
    "stale rows",
    "lost rows, clock too",
    "lost rows, clock not",
    "torque spikes",
    "angle spikes",
    "alpha spikes",
    "wild runs of omega",
    "omega in rpm",
    "alpha in g",
    "theta late 5 rows",
    "wrap",
    "1 % NaN",
    "2 % repeated stamps",
    "clock jitters",
    "clock restarts",
    "torque off, first half",
    "angle held 10 rows",
    "angle only + stale rows",
    "torque spikes + wrap",
]
BARRING = [
    "torque's sign",
    "torque in mN m",
    "angle in degrees",
    "alpha's sign",
    "two joined, step",
    "t in ms",
    "alpha and tau swapped",
]


@pytest.mark.parametrize("fault", SOUND)
def test_nothing_is_said_of_a_log_without_a_fault(fault: str) -> None:
    row = examine(Log(fault, SEED, learned=False))
    assert row["besides"] == []
    assert row["floor"] == pytest.approx(1.0, abs=0.1)


@cache
def off_percent(fault: str) -> float:
    """How far the inertia of a fit is from the truth."""
    return float(examine(Log(fault, SEED, learned=False))["off_percent"])


@pytest.mark.parametrize("fault", MENDED)
def test_a_fault_is_said_and_the_inertia_stays_what_it_was(fault: str) -> None:
    log = Log(fault, SEED, learned=False)
    row = examine(log)
    assert row["said"], row
    sound = "clean" if "omega_rad_s" in log.make()[1] else "angle only"
    assert abs(row["off_percent"] - off_percent(sound)) < 2.0 or row["holds"], row


@pytest.mark.parametrize("fault", BARRING)
def test_a_fault_that_no_fit_gets_over_is_said(fault: str) -> None:
    # Turned so fast that degrees taken for radians are beyond a hand.
    assert examine(Log(fault, 90002, learned=False))["said"]


@pytest.mark.parametrize("fault", ["stale rows", "alpha spikes", "torque ahead 5 rows", "torque's sign"])
def test_the_knob_of_a_faulty_log_is_accused_of_nothing(fault: str) -> None:
    row = examine(Log(fault, SEED))
    assert right(row), row


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_changes_a_log_the_same_way_every_time_and_leaves_the_capture_as_it_was(fault: str) -> None:
    log = Log(fault, SEED)
    knob, columns = log.make()
    again = log.make()[1]
    assert {"t_s", "theta_rad", "tau_Nm"} <= columns.keys()
    for name, values in columns.items():
        np.testing.assert_array_equal(values, again[name])
    if fault not in ("clean", "AR(1) noise 0.9", "AR(1) noise 0.97"):
        same = [np.array_equal(values, columns.get(name)) for name, values in knob.capture.items()]
        assert not all(same)


@pytest.mark.parametrize("keep", [0.9, 0.97])
def test_coloured_noise_has_the_same_size_and_is_followed_by_more_of_itself(keep: float) -> None:
    still = Track(np.arange(100_000) / RATE_HZ, *np.zeros((3, 100_000)))
    white, coloured = (
        measured(np.random.default_rng(1), still, still.theta, np.inf, own) for own in (0.0, keep)
    )
    for name in ("theta_rad", "omega_rad_s", "alpha_rad_s2"):
        np.testing.assert_array_equal(white[name], coloured[name])
    noise = coloured["tau_Nm"]
    assert np.std(noise) == pytest.approx(np.std(white["tau_Nm"]), rel=0.05)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(keep, abs=0.02)


def answer(verdict: str, *found: str, kinds: tuple[str, ...] = ()) -> dict[str, Any]:
    findings = [{"kind": kind, "column": "tau"} for kind in kinds]
    params = {"inertia.M": {"value": 1.02e-4, "ci95": [0.99e-4, 1.05e-4]}}
    document = {"verdict": verdict, "found": list(found), "findings": findings, "noise_floor": 6e-4}
    return document | {"ladder": [{"params": params}]}


@pytest.mark.parametrize(
    ("fault", "given", "good"),
    [
        ("clean", answer("complete"), True),
        ("clean", answer("complete", kinds=("gap",)), False),
        ("clean", answer("unexplained"), False),
        ("torque spikes", answer("complete"), False),
        ("torque spikes", answer("complete", kinds=("spike",)), True),
        ("torque spikes", answer("missing", "stribeck", kinds=("spike",)), False),
        ("torque ahead 5 rows", answer("missing", "actuation_delay"), True),
        ("torque ahead 5 rows", answer("complete"), False),
        ("torque in mN m", answer("complete", kinds=("unit",)), False),
        ("torque in mN m", answer("unexplained", kinds=("unit",)), True),
    ],
)
def test_an_answer_is_right_when_it_names_the_fault_and_nothing_of_the_knob(
    fault: str, given: dict[str, Any], good: bool
) -> None:
    knob = hidden.make(SEED, motion="hand")
    row = {"fault": fault, "seed": SEED, "motion": "hand", "hid": [], "learned": True, "seconds": 1.0}
    row |= judged(fault, knob, given) | answered(fault, knob, given)
    assert right(row) is good
    assert any(line.startswith(fault) for line in failures([row])) is not good
    assert any(line.startswith(fault) for line in report([row]))


def test_every_fault_is_learned_without_and_with_an_effect_and_fitted_more_often() -> None:
    logs = asked("wrap", 2, 5, 0)
    assert [(log.hides, log.learned) for log in logs[:4]] == [(False, True), (True, True)] * 2
    assert len(set(logs)) == 9
    assert logs[1].effects != logs[3].effects
