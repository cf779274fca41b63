"""Anti-cogging tables: the torque by position of one turn, as motor drives add it to what they command.

moteus (mjbots, `motor.cogging_dq_comp`) has 1024 whole numbers from -127 to 127 around a turn of the rotor,
which it joins by straight lines and multiplies by a scale to a current in A. A CSV map, as ODrive and others
take it, has the torque at positions in turns.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ...model import Model
from .conversion import Fate, Form
from .target import BY_PLACE, OF_THE_SENSOR, Options, Target
from .terms import EXACT, Term

if TYPE_CHECKING:
    from ...base.arrays import FloatArray

_MOTEUS, _LARGEST = 1024, 127
_INTO_MOTEUS = (
    "Into the drive, whose rotor position 0 is the model's angle 0: moteus_tool --restore-config FILE"
)
_CSV_ROWS = 3600  # a tenth of a degree each
_TURN = 2.0 * math.pi
_REPEATS = 1e3 * EXACT


def judge(model: Model, terms: Mapping[str, Term], options: Options) -> tuple[Fate, ...]:
    """Judge each effect: a table has what repeats with every turn, as finely as it can."""
    if model.coordinate != "rotary":
        raise InputError(
            f"model '{model.name}': is of a linear axis, and a table of a turn; give a rotary one"
        )
    return tuple(_fate(term) for term in terms.values())


def _fate(term: Term) -> Fate:
    if term.place == "sensor":
        return Fate(term.effect, "impossible", OF_THE_SENSOR)
    if not term.by_position:
        return Fate(term.effect, "impossible", f"follows more than the angle, and {BY_PLACE}")
    theta = np.linspace(-_TURN, _TURN, 1001)
    torque = term.curve(theta)
    if np.abs(term.curve(theta + _TURN) - torque).max() > _REPEATS * np.abs(torque).max():
        return Fate(term.effect, "impossible", "does not repeat after a turn, as a table does")
    return Fate(term.effect, "approximate", "table")


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write the table, and say what its steps cost."""
    csv = options.suffix.lower() == ".csv"
    rows = _CSV_ROWS if csv else _MOTEUS
    theta = np.arange(rows) * (_TURN / rows)
    torque = np.sum([term.curve(theta) for term in terms.values()], axis=0)
    rounded, text, remarks = _csv(options, torque) if csv else _moteus(model, options, torque)
    bent = {name: _bent(term, _TURN / rows, options) for name, term in terms.items()}
    how = f"{rows} entries, joined by straight lines"
    fates = tuple(Fate(name, "approximate", how, _rms(lost)) for name, lost in bent.items())
    lost = _looked_up(rounded - torque, options) + np.sum(list(bent.values()), axis=0)
    return Form(fates, text, _rms(lost), remarks)


def _bent(term: Term, spacing: float, options: Options) -> FloatArray:
    """Return what straight lines between entries `spacing` rad apart add to a torque along the motion, N m.

    At s behind an entry that is f'' s (spacing - s) / 2.
    """
    theta = options.motion.theta
    before, here, behind = (term.curve(theta + step) for step in (-spacing, 0.0, spacing))
    since = np.mod(theta, spacing)
    return 0.5 * (behind - 2.0 * here + before) / spacing**2 * since * (spacing - since)


def _looked_up(table: FloatArray, options: Options) -> FloatArray:
    """Return what a drive makes of the entries of a turn along the motion."""
    place = np.mod(options.motion.theta / _TURN, 1.0) * len(table)
    return np.asarray(np.interp(place, np.arange(len(table) + 1), np.append(table, table[0])))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _csv(options: Options, torque: FloatArray) -> tuple[FloatArray, str, tuple[str, ...]]:
    """Return the torques that are written, the map, and what its user has to know."""
    lines = [f"# {line}" for line in options.header]
    lines.append("position_turns,torque_Nm")
    lines += [f"{i / len(torque):.9g},{value:.9g}" for i, value in enumerate(torque)]
    return torque, "\n".join(lines) + "\n", ("The model's angle 0 is the map's position 0.",)


def _moteus(model: Model, options: Options, torque: FloatArray) -> tuple[FloatArray, str, tuple[str, ...]]:
    """Return the torques that are written, the settings of a drive, and what its user has to know."""
    if options.kt is None or not options.kt > 0.0 or not math.isfinite(options.kt):
        raise InputError(
            f"kt={options.kt}: moteus has its table in A; give the torque constant of the motor with --kt, "
            "or write a map in N m to a file that ends in .csv"
        )
    peak = float(np.abs(torque).max())
    if not peak > 0.0:
        raise InputError(f"model '{model.name}': has no torque by position that a table could hold; fit one")
    step = peak / _LARGEST
    lines = [f"# {line}" for line in options.header]
    lines.append(f"motor.cogging_dq_scale {step / options.kt!r}")
    numbers = np.rint(torque / step).astype(int)
    lines += [f"motor.cogging_dq_comp.{i} {n}" for i, n in enumerate(numbers)]
    percent = 100.0 * _rms(numbers * step - torque) / _rms(torque)
    loss = (
        f"Rounded to 8 bits, in steps of {step:.3g} N m: {percent:.2g} % of the table's torque RMS is lost."
    )
    return (
        numbers * step,
        "\n".join(lines) + "\n",
        (loss, _INTO_MOTEUS),
    )


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that the written table has along the motion, N m."""
    text = str(form.content)
    if options.suffix.lower() == ".csv":
        rows = [line.split(",") for line in text.splitlines() if line[:1].isdigit()]
        table = np.array([float(torque) for _, torque in rows])
    else:
        scale = float(re.findall(r"cogging_dq_scale (\S+)", text)[0]) * (options.kt or 1.0)
        table = scale * np.array([int(n) for n in re.findall(r"cogging_dq_comp\.\d+ (\S+)", text)])
    return _looked_up(table, options)


TARGET = Target(judge, write, measure)
