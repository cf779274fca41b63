"""A small fixed sitting of the examination: one capture of each kind, answered from its file alone.

The whole of it, over fresh seeds, is `python benches/study_hidden.py`; BENCHMARKS.md has its figures.
"""

from __future__ import annotations

import dataclasses

import pytest
from examiner import Case, known, marked
from marks import answered

EVERY = 4
"""Samples to one that is handed over: they show the same, and a search costs a fraction."""


@pytest.mark.parametrize(
    "case",
    [
        "faultless/knob:90001",
        "faultless/knob:90002",
        "single/stribeck:90001",
        "single/unbalance:90001",
        "single/position_friction:90001",
        "single/friction_drift:90001",
        "single/torque_lag:90001",
        "several/effects:90002",
        "several/effects:487009",
        "strange/mains_hum:90001",
        "strange/vibration:90001",
        "lag/sample:90001",
        "moving/compliance:90001",
        "moving/presliding:479002",
    ],
)
def test_what_is_hidden_in_a_knob_is_named_and_what_has_no_name_is_not(case: str) -> None:
    asked = Case.parse(case)
    knob = asked.make()
    if asked.sitting != "lag":  # that is of a sample
        fewer = {name: column[::EVERY] for name, column in knob.capture.items()}
        knob = dataclasses.replace(knob, capture=fewer)
    row = known(asked, knob) | marked(knob, asked.without)
    assert answered(row), row
    assert not row["wrong"]
    # A torque that is clipped has lost part of its noise.
    if "saturation" not in row["effects"]:
        assert row["floor"] == pytest.approx(1.0, abs=0.05)
    if row["verdict"] != "unexplained":
        assert row["error"] < 1.1
