"""What was found in a log, as the workbench's page says it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import knobcam as kc
from knobcam.capture.finding import Finding, Severity
from knobcam.workbench.plain import in_words

T = np.arange(200) / 1000.0
CAPTURE = kc.Capture.from_arrays(t=T, theta=np.sin(9.0 * T), tau=0.01 * np.cos(9.0 * T))


@pytest.mark.parametrize(
    ("severity", "message", "said"),
    [
        ("masked", "tau: leaps at row 7; masked", "torque: leaps at row 7"),
        (
            "mended",
            "theta: stands 2 ms before the omega that belongs to it: omega is left out",
            "angle: stands 2 ms before the velocity that belongs to it: velocity is left out",
        ),
        (
            "mended",
            "theta: both are taken below 25 Hz (torque_edge_hz= sets another)",
            "angle: both are taken below 25 Hz",
        ),
        (
            "masked",
            "tau: the sensor is saturated; masked, unless it is the drive's limit (--limit actuator)",
            "torque: the sensor is saturated; masked, unless it is the drive's limit: then switch it off",
        ),
        (
            "masked",
            "theta: the shorter one, 9 rows, is masked; --start and --end choose the other",
            "angle: the shorter one, 9 rows, is masked",
        ),
        (
            "note",
            "columns: t = time (no unit said: s), tau = torque (no unit said: N m); a map says otherwise",
            "columns: t = time (no unit said: s), tau = torque (no unit said: N m); "
            "if it is otherwise, open the file once more and say which column is which",
        ),
        ("note", "t: from 1 to 2 ms (rows 1-4): they count", "time: from 1 to 2 ms (rows 1-4): they count"),
    ],
)
def test_a_finding_is_said_without_words_of_the_command_line(
    severity: Severity, message: str, said: str
) -> None:
    finding = Finding("any", "tau", 1, (), message, severity)
    assert in_words(finding, CAPTURE) == f"{severity}: {said}"


def test_what_is_overruled_is_not_said_to_be_masked() -> None:
    finding = Finding("spike", "tau", 1, ((7, 7),), "tau: leaps at row 7; masked", "masked").over()
    said = in_words(finding, CAPTURE)
    assert said == "note: overruled, so nothing was done about it: torque: leaps at row 7"


def test_columns_are_called_by_what_they_are_of_a_slide_and_of_a_motor() -> None:
    finding = Finding("any", "theta", 1, (), "theta: late against tau", "warning")
    slide = replace(CAPTURE, coordinate="linear", torque_unit="N")
    assert in_words(finding, slide) == "warning: position: late against force"
    motor = replace(CAPTURE, torque_unit="A")
    assert in_words(finding, motor) == "warning: angle: late against current"
