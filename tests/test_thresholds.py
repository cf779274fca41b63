"""The table of thresholds: documented as it is, changed for a study alone, nothing that decides beside it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from study_thresholds import FACTORS, PAGE, TABLE, page

import knobcam as kc
from knobcam.fit.rule import RULE, thresholds

ROOT = Path(__file__).resolve().parents[1]


def test_the_page_of_the_thresholds_is_the_table_and_what_was_measured_of_it() -> None:
    written = PAGE.read_text("utf-8")
    assert written == page(json.loads(TABLE.read_text("utf-8")))
    assert all(f"| `{one.name}` | {one.value:g} {one.unit} |" in written for one in thresholds())


def test_what_was_measured_is_of_thresholds_that_there_are_on_as_many_captures_as_are_said() -> None:
    table = json.loads(TABLE.read_text("utf-8"))
    assert table["thresholds"].keys() <= {one.name for one in thresholds()}
    assert len(table["usual"]) == table["cases"] > 0
    for entry in (one for row in table["thresholds"].values() for one in row.values()):
        assert set(entry["changed"]) <= set(table["usual"])
        assert abs(entry["right"] - table["right"]) <= len(entry["changed"])
    assert {factor for row in table["thresholds"].values() for factor in row} <= {str(one) for one in FACTORS}


def test_every_threshold_that_is_asked_for_is_in_the_table() -> None:
    package = Path(kc.__file__).parent
    code = "\n".join(path.read_text("utf-8") for path in package.rglob("*.py"))
    assert set(re.findall(r"\bRULE\.(\w+)", code)) <= {one.name for one in thresholds()}
    with pytest.raises(AttributeError, match="no threshold is called 'magic'"):
        _ = RULE.magic


def test_every_threshold_of_the_table_is_asked_for_somewhere() -> None:
    places = [*(ROOT / "crates" / "knobcore" / "src").rglob("*.rs"), *Path(kc.__file__).parent.rglob("*.py")]
    code = "\n".join(path.read_text("utf-8") for path in places if path.name != "rule.rs")
    asked = set(re.findall(r"\b(?:RULE|rule\(\)|rule)\.(\w+)", code))
    assert {one.name for one in thresholds()} <= asked


def told(changes: str) -> subprocess.CompletedProcess[str]:
    code = "from knobcam.fit.rule import RULE; print(RULE.price, RULE.worth)"
    environment = os.environ | {"KNOBCAM_RULE": changes}
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )


def test_a_study_changes_the_thresholds_of_its_own_process() -> None:
    assert told("price=24").stdout.split() == ["24.0", str(RULE.worth)]
    assert "prize: no threshold is called that" in told("prize=24").stderr
