"""Loggers that are known by the names of their columns, and what theirs are in.

moteus (revolutions): mjbots/moteus, `lib/python/examples/csv_output.py` and the logs of tview. ODrive
(turns): firmware 0.5 and newer. PlotJuggler: its CSV of `sensor_msgs/JointState`. BAM: Rhoban/bam,
`bam/dynamixel/record.py`. SimpleFOC: `FOCMotor::monitor()`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from .columnmap import Entry
from .header import Label
from .table import Table

TABS = "CSV with tabs"
"""The kind of a text table that has tabs between its cells and no header."""


@dataclass(frozen=True)
class Logger:
    """A logger: which names are its own, and what a column with one of its endings holds.

    `torque` is what it logs in place of a torque, when no column is one; `si` says that what has no unit here
    is in that of SI, whichever axis it is of.
    """

    name: str
    known: Callable[[set[str]], bool]
    endings: Mapping[str, Label]
    torque: Entry | None = None
    si: bool = False

    def labels(self, names: Iterable[str]) -> dict[str, Label]:
        """Return what its columns hold; the others say nothing."""
        found = {}
        for name in names:
            ending = next((one for one in self.endings if _ends(name, one)), None)
            if ending is not None:
                found[name] = self.endings[ending]
        return found


def _ends(name: str, ending: str) -> bool:
    pattern = rf"(.*[^a-z])?{re.escape(ending)}(\[\d+\])?"
    return re.fullmatch(pattern, name, re.IGNORECASE | re.DOTALL) is not None


def _is(quantity: str, unit: str) -> Label:
    return Label(quantity, unit, plain=True)


_TIMES = {name: _is("t", "s") for name in ("time", "timestamp", "t", "time_s")}
_REGISTERS = {
    "mode",
    "fault",
    "q_current",
    "d_current",
    "abs_position",
    "trajectory_complete",
    "rezero_state",
}


def _by_registers(names: set[str]) -> bool:
    lower = {name.lower() for name in names}
    others = _REGISTERS & lower
    return {"position", "torque"} <= lower and len(others) > (0 if "POSITION" in names else 1)


def _by_servo_stats(names: set[str]) -> bool:
    last = {name.rpartition(".")[2] for name in names}
    return {"position", "velocity", "torque_Nm", "q_A", "d_A"} <= last


def _by_estimates(names: set[str]) -> bool:
    def has(ending: str) -> bool:
        return any(_ends(name, ending) for name in names)

    of_axis = any(re.search(r"\baxis\d", name) for name in names)
    return has("pos_estimate") and (has("vel_estimate") or has("Iq_measured") or of_axis)


def _by_places(names: set[str]) -> bool:
    """By PlotJuggler's clock, beside a joint's state under the place that it has in its message."""
    places = [name for name in names if name.startswith("/")]
    return "__time" in names and all(any(_ends(name, one) for name in places) for one in _STATE)


_STATE = {"position": Label("theta", plain=True), "effort": Label("tau", plain=True)}
_OTHER = Label(None)
_COMMANDED = {
    f"{kind}_{name}": _OTHER
    for kind in ("abs", "control", "command", "pid", "max", "base", "feedforward")
    for name in ("position", "velocity", "torque", "torque_Nm")
}
"""Names of moteus that end like those of what is measured."""

LOGGERS = (
    Logger(
        "moteus registers",
        _by_registers,
        _TIMES
        | _COMMANDED
        | {"position": _is("theta", "turn"), "velocity": _is("omega", "turn/s"), "torque": _is("tau", "N m")},
    ),
    Logger(
        "moteus servo_stats",
        _by_servo_stats,
        {"timestamp": _is("t", "s")}
        | _COMMANDED
        | {
            "position": _is("theta", "turn"),
            "velocity": _is("omega", "turn/s"),
            "torque_Nm": _is("tau", "N m"),
        },
    ),
    Logger(
        "ODrive",
        _by_estimates,
        {
            **_TIMES,
            "pos_estimate": _is("theta", "turn"),
            "vel_estimate": _is("omega", "turn/s"),
            "torque_estimate": _is("tau", "N m"),
            "Iq_measured": _is("current", "A"),
        },
    ),
    Logger(
        "PlotJuggler",
        _by_places,
        {"__time": _is("t", "s"), **_STATE, "velocity": Label("omega", plain=True)},
        si=True,
    ),
    Logger(
        "BAM",
        lambda names: {"timestamp", "position", "goal_position", "torque_enable"} <= names,
        {
            "timestamp": _is("t", "s"),
            "goal_position": _OTHER,
            "position": _is("theta", "rad"),
            "speed": _is("omega", "rad/s"),
            "control": _is("current", "A"),
        },
        Entry("duty*input_volts", "V"),
    ),
)


@dataclass(frozen=True)
class Monitor:
    """A SimpleFOC monitor's columns, and the rate at which its own velocity says that rows came, Hz."""

    entries: dict[str, Entry]
    rate_hz: float

    def __str__(self) -> str:
        return f"{self.rate_hz:.4g} rows a second by its own velocity"


def simplefoc(table: Table) -> Monitor | None:
    """Return what a SimpleFOC monitor logged: tabs, no header, no clock; at the end velocity and angle.

    It is known by its last two columns, of which one is the change of the other. What stands before them is a
    matter of the monitor's variables; with its usual four, or all seven, it is known.
    """
    names = list(table.columns)
    if table.kind != TABS or not 3 <= len(names) <= 7 or table.broken:
        return None
    omega, theta = table.columns[names[-2]], table.columns[names[-1]]
    rate = _rate(omega, theta)
    if rate is None:
        return None
    entries = {"theta": Entry(names[-1], "rad"), "omega": Entry(names[-2], "rad/s")}
    if len(names) == 7:
        entries["tau"] = Entry(names[3], "mA")
    elif len(names) == 4:
        entries["tau"] = Entry(names[1], "V")
    return Monitor(entries, rate)


def _rate(omega: FloatArray, theta: FloatArray) -> float | None:
    if len(omega) != len(theta) or len(theta) < 10:
        return None
    speed, step = 0.5 * (omega[1:] + omega[:-1]), np.diff(theta)
    good = np.isfinite(speed) & np.isfinite(step) & (np.abs(speed) < 1e9) & (np.abs(step) < 1e9)
    speed, step = speed[good], step[good]
    both = float(speed @ step)
    alike = both / float(np.sqrt((speed @ speed) * (step @ step)) or 1.0)
    return float(speed @ speed) / both if both > 0.0 and alike > _ALIKE else None


_ALIKE = 0.8
