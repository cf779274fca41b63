"""The examination in strata: every stratum is met, a run goes on where it was killed, answers are counted."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hidden
import pytest
from examiner import SILENT, judged
from marks_strata import at_length, report, shares
from resumed import kept, resumed, version
from sitters import marked
from strata import BANDS, PAIRS, Stratum, strata

ABOUT = {"who": "me", "version": "1"}
QUIET = {"verdict": "no answer", "exact": False}


def test_every_case_is_made_again_from_its_name() -> None:
    every = strata(2, 10)
    assert len({str(case) for case in every}) == len(every)
    assert all(Stratum.parse(str(case)) == case for case in every)


def test_in_twenty_knobs_an_effect_is_met_in_every_motion_at_every_strength() -> None:
    met = {(seed % 4, Stratum("one", "stribeck", seed).band) for seed in range(20)}
    assert len(met) == 4 * len(BANDS)


def test_in_sixteen_knobs_a_pair_is_met_in_every_motion_at_every_strength_that_is_not_weak() -> None:
    met = {(seed % 4, Stratum("pair", "cogging+compliance", seed).band) for seed in range(16)}
    assert {band for _, band in met} == set(BANDS[1:])
    assert len(met) == 16


def test_beside_a_coupling_every_second_knob_is_loaded_at_the_shaft() -> None:
    coupled = [Stratum("pair", "compliance+cogging", seed).at_shaft for seed in range(20)]
    assert sum(coupled) == 10
    assert not any(Stratum("pair", "bristles+compliance", seed).at_shaft for seed in range(20))
    assert not any(Stratum("pair", "bristles+cogging", seed).at_shaft for seed in range(20))


def test_pairs_are_of_different_groups_and_leave_out_what_the_core_shares_a_formula_with() -> None:
    assert not {"stribeck", "presliding", "backlash"} & {name for pair in PAIRS for name in pair}
    assert all(hidden.KINDS[one].group != hidden.KINDS[other].group for one, other in PAIRS)


def examine(case: str) -> Iterator[dict[str, Any]]:
    yield {"topic": case}
    while case == "slow":
        pass
    if case == "dies":
        os._exit(1)
    yield {"exact": True}


def impossible(case: str) -> Iterator[dict[str, Any]]:
    raise SystemExit(0)
    yield {}


def test_a_run_goes_on_where_it_was_killed(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    known = ABOUT | {"case": "a", "exact": False}
    other = ABOUT | {"case": "b", "version": "0"}
    path.write_text(json.dumps(known) + "\n" + json.dumps(other) + '\n{"who": "me", "ca', "utf-8")
    rows = resumed(examine, ["a", "b"], path, ABOUT, 2, 30.0, QUIET)
    assert rows[0] == known
    assert rows[1].pop("processor_s") < 1.0
    assert rows[1] == ABOUT | {"case": "b", "topic": "b", "exact": True}
    kept_rows = kept(path, ABOUT)
    assert [row["case"] for row in kept_rows] == ["a", "b"]
    assert resumed(impossible, ["a", "b"], path, ABOUT, 1, 30.0, QUIET) == kept_rows


@pytest.mark.parametrize("case", ["slow", "dies"])
def test_who_does_not_answer_is_silent_and_the_others_go_on(case: str, tmp_path: Path) -> None:
    rows = resumed(examine, [case, "b"], tmp_path / "rows.jsonl", ABOUT, 1, 1.0, QUIET)
    assert rows[0]["verdict"] == "no answer"
    assert rows[0]["topic"] == case
    assert rows[0]["processor_s"] <= 1.5
    assert rows[1]["exact"]


def test_a_case_that_cannot_be_made_has_no_row(tmp_path: Path) -> None:
    assert resumed(impossible, ["a"], tmp_path / "rows.jsonl", ABOUT, 1, 1.0, QUIET) == []


def test_a_version_is_what_stands_in_the_files(tmp_path: Path) -> None:
    file = tmp_path / "program" / "a.py"
    file.parent.mkdir()
    file.write_text("1", "utf-8")
    first = version(file.parent)
    assert version(file.parent) == first
    file.write_text("2", "utf-8")
    assert version(file.parent) != first


def strange(misfit: float) -> hidden.Hidden:
    knob = {"inertia.M": 1e-4}
    said = (("stribeck",),)
    return hidden.Hidden(0, "hand", ("rate_and_state",), said, {}, 1.0, 2.0, (2.0,), knob, {}, misfit)


@pytest.mark.parametrize(("misfit", "exact"), [(0.05, False), (0.5, True)])
def test_the_rest_may_be_called_unexplained_where_no_textbook_law_explains_it(
    misfit: float, exact: bool
) -> None:
    document = {"verdict": "unexplained", "found": ["stribeck"], "ladder": [], "noise_floor": 1.0}
    assert judged(strange(misfit), document, False)["exact"] is exact
    assert not judged(strange(misfit), document | {"found": ["presliding"]}, False)["exact"]


def answered(case: str, **marks: Any) -> dict[str, Any]:
    stratum = Stratum.parse(case)
    known = {"case": case, "sitting": stratum.sitting, "topic": stratum.topic, "processor_s": 1.0}
    return SILENT | known | {"motion": "hand", "strengths": [1.0], "misfit": 0.0} | marks


def test_the_tables_count_each_answer_once_and_list_those_that_are_not_right() -> None:
    rows = [
        answered("one/cogging:1", exact=True, found=["cogging"], covered={"inertia.M": True}),
        answered("one/cogging:2", wrong=True, found=["detent"], verdict="missing"),
        answered("one/cogging:3"),
        answered("pair/compliance+cogging:0", wrong=True, found=["cogging"], verdict="missing"),
    ]
    assert shares(rows[:3]) == pytest.approx((100 / 3, 100 / 3, 100 / 3))
    every = {"knobcam": rows, "stepwise": rows[:1], "stlsq": [], "bam": []}
    assert any(line.startswith("one effect") and "  3 |" in line for line in report(every))
    long = list(at_length(every))
    assert any(line.startswith("cogging") and "  3 |" in line for line in long)
    assert any(line.startswith("compliance+cogging") for line in long)
    assert not any(line.startswith("one/cogging:1") for line in long)
    assert any(line.startswith("one/cogging:2") and "missing: detent" in line for line in long)


@pytest.mark.parametrize("peer", ["stepwise", "stlsq", "bam"])
def test_peers_name_nothing_of_a_faultless_knob_or_what_they_know(peer: str) -> None:
    if peer == "stlsq":
        pytest.importorskip("pysindy")
    knob = hidden.make(2, ["load_friction"], "multisine", 8.0, duration_s=2.0)
    assert "load_friction" in marked(peer, knob)["found"]
