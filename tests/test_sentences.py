"""Sentences as data: text to who prints them, and to a page what it writes in its own way."""

from __future__ import annotations

import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from told import check

import knobcam as kc
from knobcam.base.pages_said import Part
from knobcam.base.said import Advice, OfColumn, OfEffect, Said, Stretch, joined, number, said
from knobcam.capture.finding import Finding
from knobcam.capture.formats.document import stored_findings
from knobcam.workbench import state
from knobcam.workbench.session import Session

SENTENCE = said(
    "{tau}: {size} is more than {names} takes at {where}; {advice}",
    size=number(0.35641, "N m"),
    names=joined(" and ", map(OfEffect, ("detent", "hum"))),
    where=Stretch("position", -0.5, 0.25, "rad", 1),
    advice=Advice("map tau=... [mNm]", "unit"),
)
TEXT = "tau: 0.3564 N m is more than detent and hum takes at -0.5 to 0.25 rad forward; map tau=... [mNm]"


def spoiled(tmp_path: Path) -> kc.Capture:
    """A knob whose torque leaps for one row and whose stamps are in a unit that is unusual."""
    clean = kc.simulate("knob3", "sweep", duration_s=2, seed=4)
    tau = clean.tau.copy()
    tau[5000] += 5.0 * np.ptp(tau)
    path = tmp_path / "log.csv"
    columns = np.column_stack([clean.t, clean.theta, tau])
    np.savetxt(path, columns, delimiter=",", header="time (s),angle (rad),torque (N m)", comments="")
    return kc.load(path)


def test_a_sentence_is_text_and_keeps_what_it_is_made_of() -> None:
    assert SENTENCE == TEXT and json.loads(json.dumps(SENTENCE)) == TEXT
    assert SENTENCE.parts[0] == OfColumn("tau") and SENTENCE.parts[2] == number(0.35641, "N m")
    check(SENTENCE.document(), list[Part])
    for again in (Said.of(json.loads(json.dumps(SENTENCE.document()))), pickle.loads(pickle.dumps(SENTENCE))):
        assert again == SENTENCE and again.parts == SENTENCE.parts
    with pytest.raises(ValueError, match="no part of a sentence"):
        Said.of([{"effect": "detent", "more": 1}])


def test_a_stretch_that_has_words_is_told_by_them_and_one_that_was_kept_before_it_could_comes_back() -> None:
    near = Stretch("position", -5.049e-8, 0.4, "rad", 1)
    assert (
        str(near) == "0 to 0.4 rad forward" and str(near._replace(low=-4e-4)) == "-0.0004 to 0.4 rad forward"
    )
    (told,) = Said(near).document()
    assert isinstance(told, dict) and (told["low"], told["ends"]) == (
        -5.049e-8,
        [0.0, 0.4],
    )  # samples are chosen by the one
    line = Said(Stretch("frequency", 10.0, 20.0, "Hz", 0, "a line at 15.0 Hz"))
    assert line == "a line at 15.0 Hz" == Said.of(line.document())
    check(line.document(), list[Part])
    older = {"axis": "position", "low": -0.5, "high": 0.25, "unit": "rad", "direction": 1}
    assert Said.of([older]) == "-0.5 to 0.25 rad forward"


def test_what_says_nothing_is_joined_to_nothing() -> None:
    assert joined("; ", ("", None, "a", Said(), "b")) == "a; b"
    assert not joined("; ", ("", None))


def test_a_finding_has_what_was_found_and_what_could_be_done_apart() -> None:
    found = Finding(
        "clipped", "tau", 3, ((1, 3),), said("{tau}: at a limit"), "masked", Advice("see", "drive")
    )
    assert found.message == "tau: at a limit; masked; see"
    told = found.document()
    assert (told["found"], told["advice"], told["way"]) == (
        [{"column": "tau"}, ": at a limit"],
        "see",
        "drive",
    )
    over = found.over()
    assert over.message == "overruled, so nothing was done about it: tau: at a limit"
    assert (over.severity, over.overruled) == ("note", True)


def test_findings_come_back_from_a_saved_capture_as_they_were(tmp_path: Path) -> None:
    capture = spoiled(tmp_path)
    assert {one.kind for one in capture.findings} == {"columns", "spike"}
    again = kc.load(capture.save(tmp_path / "saved.npz"))
    assert again.findings == capture.findings
    assert [one.found.parts for one in again.findings] == [one.found.parts for one in capture.findings]


@pytest.mark.parametrize(
    ("message", "overruled", "found", "advice"),
    [
        ("tau: leaps at row 7; masked", False, "tau: leaps at row 7", None),
        (
            "tau: at a limit; masked, unless --limit actuator",
            False,
            "tau: at a limit",
            "unless --limit actuator",
        ),
        ("overruled, so nothing was done about it: tau: leaps; masked", True, "tau: leaps", None),
        ("overruled, so nothing is to be done about waves", True, "waves", None),
    ],
)
def test_a_capture_saved_by_an_older_version_keeps_its_findings(
    message: str, overruled: bool, found: str, advice: str | None
) -> None:
    entry = {"kind": "spike", "column": "tau", "count": 1, "rows": [[7, 7]], "message": message}
    severity = "note" if overruled else "masked"
    (one,) = stored_findings({"findings": [entry | {"severity": severity, "overruled": overruled}]})
    assert one.found == found and one.overruled == overruled
    assert (None if one.advice is None else str(one.advice)) == advice


def test_the_page_is_told_torques_effects_and_columns_as_data_and_no_option(tmp_path: Path) -> None:
    session = Session()
    session.take(spoiled(tmp_path), "log.csv")
    session.add("stribeck")
    session.weigh()
    document = state.document(session)
    sentences = [document["verdict"], *(one["said"] for one in document["captures"][0]["findings"])]
    words = [part for parts in sentences for part in parts if isinstance(part, str)]
    assert len(words) > 4
    for part in words:
        assert not re.search(r"\d N m\b", part), f"a torque is no data: {part!r}"
        assert not re.search(r"--[a-z]|\bmap \w+=", part), f"words of the command line: {part!r}"
        named = [one for one in document["titles"] if re.search(rf"\b{one}\b", part) and "_" in one]
        assert not named, f"an id: {part!r}"
    kinds = {key for parts in sentences for part in parts if isinstance(part, dict) for key in part}
    assert {"value", "effect", "column", "topic"} <= kinds


def test_every_effect_has_a_title_of_its_own() -> None:
    titles = [one.title for one in kc.effects().values()]
    assert len(set(titles)) == len(titles)
    assert all(title and "_" not in title and len(title) <= 27 for title in titles), titles


@pytest.mark.parametrize("axis", ["rotary", "linear"])
def test_friction_that_no_speed_changes_is_called_dry_by_all_that_speak_of_it(axis: str) -> None:
    for one in kc.effects(axis).values():
        words = (one.title, one.name, one.about, one.shows, *one.causes, *one.remedies)
        for text in (*words, *(row.meaning for row in one.params), one.taken_up.why if one.taken_up else ""):
            assert "coulomb" not in text.lower(), f"{one.id}: {text}"
