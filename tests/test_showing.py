"""Results ask to be shown, and one module answers; it is found late, and refuses what it does not know."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import knobcam as kc
from knobcam.base import showing


def test_a_result_needs_nothing_that_shows_it_until_it_is_shown() -> None:
    code = "import sys, knobcam as kc; repr(kc.Model.load('knob3')); sys.exit('knobcam.show' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_table_in_a_notebook_needs_no_matplotlib() -> None:
    shown = "kc.Model.load('knob3')._repr_html_()"
    code = f"import sys, knobcam as kc; {shown}; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("ask", "what"),
    [
        (showing.plot, "picture"),
        (showing.look, "linked plots"),
        (lambda result: showing.report(result, Path("report.html")), "report"),
    ],
)
def test_what_cannot_be_shown_is_refused(ask: Callable[[object], object], what: str) -> None:
    parameter = kc.Model.load("knob3").params["inertia.M"]
    with pytest.raises(TypeError, match=f"Parameter has no {what}"):
        ask(parameter)
