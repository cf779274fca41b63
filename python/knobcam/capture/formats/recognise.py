"""Which column is which, without a map: where a file's names are plain and unique, and nowhere else."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ...base.arrays import FloatArray
from ...base.said import Advice, said
from ...errors import InputError
from ..finding import Finding
from .columnmap import TARGETS, Entry
from .header import Label, bracketed, parts_in, read_label
from .loggers import LOGGERS, simplefoc
from .table import Table
from .units import COUNTS, GIVEN, SI, Coordinate, fits, to_si

_UNIT_ALONE = {"current": "A", "voltage": "V", "duty": "duty"}
"""What may stand for a torque where no column is one, and its unit where none is said."""

_DERIVED = ("omega", "alpha")
_NEEDED = {"theta": "an angle", "tau": "a torque"}
_UNNAMED = "no column"
_NOT_PLAIN = "is not plain enough"
_FAR = 2000.0  # of an angle: what runs further is not in rad
_SLOWEST_S = 0.5  # between two samples of a log of motion: longer is another unit
_SAME = 0.05  # of how far a position goes, by which what was asked differs from what was done
_VELOCITY = 0.8  # correlation with how a position changes, of its velocity: read at other times it had 0.87
_COMPARED = 20  # columns, each with each
_MOST_NAMES = 1000  # of columns: what has more is no log
_FEW = 100  # times as many rows as an array has, from which on that holds parameters beside a log
_SEEN = 10  # rows: of fewer anything may go up by 1
_COUNTS_UP = 0.99  # of the steps of a column that are 1, from which on it counts: rows, or ms at 1 kHz
PLACEHOLDER = "COUNTS"
"""Stands in a map that a message shows for a number that no log says: the counts of a turn."""
UNKNOWN = "UNIT"
"""The same for a unit of time that no name says."""
_SLIDE = {"theta": ("x", "m"), "omega": ("v", "m/s"), "alpha": ("a", "m/s^2"), "tau": ("F", "N")}
"""Letters that a linear axis has in textbooks; that they are meant so is for the user to say."""
_LOOP = {"theta": "y", "tau": "u"}
"""Those of a control loop: what came out, and what was put in."""
_SIMPLE_NAME = re.compile(r"[A-Za-z_][\w.]*")


class Unclear(InputError):
    """A file whose columns nobody can be sure of; `entries` are what they would be taken for, to be asked.

    `by_names` says that nothing but names stands in the way: there are none, or they are not plain.
    """

    def __init__(self, said: str, entries: dict[str, Entry], by_names: bool) -> None:
        super().__init__(said)
        self.entries = entries
        self.by_names = by_names


@dataclass(frozen=True)
class Recognised:
    """The entries that a map would have, and one line that says what was taken for what."""

    entries: dict[str, Entry]
    note: Finding


def recognise(table: Table, coordinate: Coordinate | None) -> Recognised | None:
    """Return what the columns are taken for, None where no name says anything of an angle or a torque.

    Raises InputError where a name is not plain or not unique: it lists the columns and has the map that would
    be right.
    """
    if (monitor := simplefoc(table)) is not None:
        raise ask(table, f"a SimpleFOC monitor, which has no torque and no clock: {monitor}", monitor.entries)
    rows = max((column.size for column in table.columns.values()), default=0)
    names = [name for name, column in table.columns.items() if column.ndim and _FEW * column.size > rows]
    names += table.broken
    if len(names) > _MOST_NAMES:
        return None
    logger = next((one for one in LOGGERS if one.known(set(names))), None)
    labels = logger.labels(names) if logger else {name: _label(table, name) for name in names}
    entries, doubts = _chosen(table, {name: label for name, label in labels.items() if label.measured})
    if logger and logger.torque and "tau" not in entries and "duty" in table.columns:
        entries["tau"] = logger.torque
        del doubts["tau"]
    if not {"theta", "tau"} & set(entries):
        return None
    if table.si or (logger and logger.si):
        of_axis = SI[coordinate or "rotary"]
        entries = {
            target: Entry(one.expression, one.unit or of_axis[target]) for target, one in entries.items()
        }
    silent = [one for one in names if one in table.columns and _changes(table, one)]
    silent = [name for name in silent if name not in labels or labels[name].quantity is None]
    if doubts and "t" not in entries:  # for the map that is shown
        clock = next((name for name in silent if _is_clock(table.columns[name])), None)
        if clock is not None:
            entries["t"] = Entry(f"`{clock}`", None)
            silent.remove(clock)
    silent = [name for name in silent if not _counts_rows(table.columns[name])]
    doubts |= clock_in_doubt(table, entries)
    if len(lacking := [one for one in _NEEDED if one not in entries]) == len(silent) == 1:
        entries[lacking[0]] = Entry(f"`{silent[0]}`", None)
    if doubts and "theta" in entries and entries["theta"].unit == COUNTS:
        # A velocity that says no unit beside counts is a register, of which nobody knows what it counts.
        entries = {target: one for target, one in entries.items() if target not in _DERIVED or one.unit}
    if doubts:
        raise ask(table, next(doubts[one] for one in ("theta", "tau", *TARGETS) if one in doubts), entries)
    taken = ", ".join(_taken(name, entry, coordinate) for name, entry in entries.items())
    found = said("columns{of}: {taken}", of=f" of {logger.name}" if logger else "", taken=taken)
    advice = Advice("a map says otherwise", "columns")
    return Recognised(entries, Finding("columns", "theta", len(entries), (), found, "note", advice))


def _label(table: Table, name: str) -> Label:
    """Return what a name says, in the unit that the file states of it where it says none."""
    return read_label(name, table.units.get(name))


def _chosen(table: Table, labels: dict[str, Label]) -> tuple[dict[str, Entry], dict[str, str]]:
    """Return the best entry of each target, and what stands in the way of taking it."""
    entries: dict[str, Entry] = {}
    doubts: dict[str, str] = {}
    quantities = {label.quantity for label in labels.values()}
    torque = next((one for one in ("tau", *_UNIT_ALONE) if one in quantities), "tau")
    for target in TARGETS:
        quantity = torque if target == "tau" else target
        found = [name for name, label in labels.items() if label.quantity == quantity]
        found = [name for name in found if name in table.columns] or found
        found = [name for name in found if labels[name].joint is None] or found
        if target == "tau" and "theta" in entries:
            axis = _axis("theta", entries["theta"].unit)
            found = [one for one in found if _axis("tau", labels[one].unit) in (None, axis)] or found
        plain = [name for name in found if labels[name].plain]
        if not found:
            if target in _NEEDED:
                doubts[target] = f"{_UNNAMED} is {_NEEDED[target]}"
            continue
        # What stands still is no less in doubt: a joint may be held, and its torque beside another's angle.
        moving = [name for name in found if _changes(table, name)] or found
        name = next((one for one in moving if one in plain), moving[0])
        entries[target] = Entry(f"`{name}`", labels[name].unit or _UNIT_ALONE.get(quantity))
        if len(found) > 1 and (target != "t" or len(plain) != 1):  # beside the time there may be a loop's
            doubts[target] = f"{_listed(found)} could each be {target}"
            if target == "theta" and _counted(table, entries[target]):
                entries[target] = Entry(f"`{name}`", COUNTS)
        elif target == "tau" and parts_in(name) is not None:
            doubts[target] = f"{name!r} is in parts of what the drive is rated for"
        elif quantity == "current" and labels[name].unit is None:
            doubts[target] = f"no torque; {name} is a current that says no unit"
        elif quantity in _UNIT_ALONE and quantity != "current":
            unit = "" if quantity == "duty" else f" in {entries[target].unit}"
            # It may be the supply's.
            doubts[target] = f"no torque; {name} is a {GIVEN[_UNIT_ALONE[quantity]]}{unit}"
        elif not plain:
            doubts[target] = f"{name!r} {_NOT_PLAIN} to be taken for {target}"
        elif target == "theta" and _counted(table, entries[target]):
            entries[target] = Entry(f"`{name}`", COUNTS)
            doubts[target] = f"{name!r} holds counts of an encoder"
        elif target == "theta" and _in_degrees(table, entries[target]):
            entries[target] = Entry(f"`{name}`", "deg")
            doubts[target] = f"{name!r} has no unit and leaps by 360"
    return entries, doubts


def _changes(table: Table, name: str) -> bool:
    """Whether a column has two values at least: a gain, a flag, what is not connected is no motion."""
    column = table.columns.get(name)
    if column is None:
        return True  # of words, of which it is said where they are taken
    finite = column[np.isfinite(column)]
    return bool(finite.size) and bool(np.any(finite != finite[0]))


def _axis(target: str, unit: str | None) -> Coordinate | None:
    """Return the axis whose unit it is, None where both have it or nobody knows."""
    return to_si(target, unit).coordinate if unit is not None and fits(target, unit) else None


def by_content(table: Table) -> dict[str, Entry]:
    """Return a map for columns whose names say nothing: a clock advances evenly, counts run far.

    It is what a message shows, never what is taken.
    """
    longest = max((column.size for column in table.columns.values()), default=0)
    names = [name for name, column in table.columns.items() if column.size == longest and longest > 1]
    names = [name for name in names[:_MOST_NAMES] if _changes(table, name)]
    clock = next((name for name in names if _label(table, name).quantity == "t"), None)
    clock = clock or next((name for name in names if _is_clock(table.columns[name])), None)
    others = [name for name in names if name != clock and not _counts_rows(table.columns[name])]
    entries = {} if clock is None else {"t": Entry(f"`{clock}`", _label(table, clock).unit)}
    clock_in_doubt(table, entries)
    if {"x", "F"} <= set(others):
        return entries | {
            name: Entry(f"`{one}`", unit) for name, (one, unit) in _SLIDE.items() if one in others
        }
    if set(_LOOP.values()) <= set(others):
        return entries | {target: Entry(f"`{one}`", None) for target, one in _LOOP.items()}
    if others:
        # What was asked of the axis stands beside what it did, and is the smoother of the two.
        few = others[:_COMPARED]
        pair = next(
            (two for two in combinations(few, 2) if _follow(*(table.columns[one] for one in two))), None
        )
        alike = others[:1] if pair is None else list(pair)
        theta = max(alike, key=lambda name: _rough(table.columns[name], 2))
        entries["theta"] = Entry(f"`{theta}`", _label(table, theta).unit)
        others = [name for name in others if name not in alike]
        omega = max(few, key=lambda name: _goes_with(table.columns[theta], table.columns[name]))
        derived = _goes_with(table.columns[theta], table.columns[omega]) > _VELOCITY
        if derived and omega in others and len(others) > 1:  # the last one left has to be the torque
            entries["omega"] = Entry(f"`{omega}`", _label(table, omega).unit)
            others.remove(omega)
    if others:
        # A position is the integral of what moves it: the torque is what changes most from row to row.
        torque = max(others, key=lambda name: _rough(table.columns[name]))
        entries["tau"] = Entry(f"`{torque}`", _label(table, torque).unit)
    if "theta" in entries:
        far = float(np.ptp(np.nan_to_num(table.columns[entries["theta"].column]))) > _FAR
        if far or _counted(table, entries["theta"]):
            entries["theta"] = Entry(entries["theta"].expression, COUNTS)
    return entries


def _is_clock(column: FloatArray) -> bool:
    """Whether a column goes on evenly, and is not the number of its row, which says nothing of time."""
    if column.size < 2 or (_counts_rows(column) and column[0] in (0.0, 1.0)):
        return False
    with np.errstate(all="ignore"):
        steps = np.diff(column)
        return bool(np.all(steps > 0.0) and np.std(steps) < np.mean(steps))


def _counts_rows(column: FloatArray) -> bool:
    """Whether a column goes up by 1 from row to row, as a counter does and no angle."""
    with np.errstate(all="ignore"):
        return column.size >= _SEEN and bool(np.mean(np.diff(column) == 1.0) >= _COUNTS_UP)


def _rough(column: FloatArray, order: int = 1) -> float:
    """How far a column, or its difference of some order, goes from row to row, of how far it goes at all."""
    finite = column[np.isfinite(column)]
    spread = float(np.std(finite)) if finite.size > order else 0.0
    return float(np.std(np.diff(finite, order))) / spread if spread > 0.0 else 0.0


def _follow(a: FloatArray, b: FloatArray) -> bool:
    """Whether two columns are the same but for a twentieth of how far they go."""
    finite = np.isfinite(a) & np.isfinite(b)
    return bool(finite.any()) and bool(np.std(a[finite] - b[finite]) <= _SAME * np.std(b[finite]))


def _goes_with(position: FloatArray, column: FloatArray) -> float:
    """How far a column goes as a position changes: 1 for its velocity in whatever unit, if without noise."""
    steps = np.gradient(position)
    known = np.isfinite(steps) & np.isfinite(column)
    if not (known.any() and np.ptp(steps[known]) > 0.0 and np.ptp(column[known]) > 0.0):
        return 0.0
    return float(np.corrcoef(steps[known], column[known])[0, 1])


def _counted(table: Table, entry: Entry) -> bool:
    """Whether an angle is in counts, by its unit, or without one by values that are whole numbers."""
    values = table.columns.get(entry.column)
    if entry.unit is not None or values is None:
        return entry.unit == COUNTS
    finite = values[np.isfinite(values)]
    return bool(finite.size) and bool(np.all(finite == np.round(finite))) and float(np.ptp(finite)) > 1.0


def _in_degrees(table: Table, entry: Entry) -> bool:
    """Whether an angle without a unit wraps as one in degrees does."""
    values = table.columns.get(entry.column)
    if entry.unit is not None or values is None or values.ndim == 0:
        return False
    finite = values[np.isfinite(values)]
    leaps = np.abs(np.diff(finite))
    return bool(np.any((leaps > 330.0) & (leaps < 361.0))) and float(np.ptp(finite)) < 361.0


def clock_in_doubt(table: Table, entries: dict[str, Entry]) -> dict[str, str]:
    """Return why a time without a unit cannot be in s, if so; its entry gets the unit that is likely."""
    entry = entries.get("t")
    values = None if entry is None else table.columns.get(entry.column)
    if entry is None or entry.unit is not None or values is None or values.ndim == 0 or len(values) < 2:
        return {}
    with np.errstate(all="ignore"):
        steps = np.diff(values)
        steps = steps[np.isfinite(steps) & (steps > 0.0)]
    if not steps.size or (step := float(np.median(steps))) < _SLOWEST_S:
        return {}
    stated = bracketed(entry.column)
    if stated and fits("t", stated):  # a unit that headers seldom have
        entries["t"] = Entry(entry.expression, stated)
        return {}
    if stated:
        entries["t"] = Entry(entry.expression, UNKNOWN)
        return {"t": f"{entry.column!r} is in [{stated}], which is no unit of time"}
    unit = "ms" if step < 50.0 else "us" if step < 5e4 else "ns"
    entries["t"] = Entry(entry.expression, unit)
    return {"t": f"{entry.column!r} has no unit and advances by {step:.4g} a row"}


def ask(table: Table, why: str, entries: dict[str, Entry]) -> InputError:
    """Return the refusal, with the map that would be right as far as it is known."""
    parts = {target: _mapped(entries[target]) for target in TARGETS if target in entries}
    parts = {"theta": ("COLUMN", ""), "tau": ("COLUMN", "")} | parts
    shown = ", ".join(f"{target}={parts[target][0]}" for target in TARGETS if target in parts)
    rate = "" if "t" in entries else " --rate HZ"
    notes = [constant for _, constant in parts.values() if constant]
    if "tau" in entries and entries["tau"].unit is None and not parts["tau"][1]:
        name = parts["tau"][0]
        notes.append(f"tau: in N m, or {name} [A] of a current, {name} [V] of a voltage")
    if "theta" not in entries and "omega" in entries:
        notes.append(f"theta: of a log without an angle {_summed(entries['omega'])}, RATE in Hz")
    constants = "; ".join(notes)
    # A shell runs what stands between backquotes, but not within single quotes.
    mark = "'" if "`" in shown and "'" not in shown else '"'
    said = (
        f"{table.source}: {why}; the file has {table.listing()}; say which is which, for example "
        f"--map {mark}{shown}{mark}{rate}{f' ({constants})' if constants else ''}"
    )
    return Unclear(said, entries, why.startswith(_UNNAMED) or _NOT_PLAIN in why)


def _mapped(entry: Entry) -> tuple[str, str]:
    """Return an entry as a map has it, and what its word in capitals stands for."""
    name = entry.column
    text = name if _SIMPLE_NAME.fullmatch(name) or not entry.expression.startswith("`") else entry.expression
    if entry.unit == COUNTS:
        note = f"{PLACEHOLDER}: the number in a turn, as in {text}/8192 [turn]"
        return f"{text}/{PLACEHOLDER} [turn]", note
    if entry.unit == UNKNOWN:
        return f"{text} [{UNKNOWN}]", f"{UNKNOWN}: what it counts in, as in [ms]"
    parts = parts_in(name) if entry.plain else None
    if parts is not None:
        unit = "A" if read_label(name).quantity == "current" else "N m"
        return f"{text}/{parts}*RATED [{unit}]", f"RATED: what the drive is rated for, in {unit}"
    return text if entry.unit is None else f"{text} [{entry.unit}]", ""


def _summed(omega: Entry) -> str:
    """Return what a map makes an angle with, of a velocity; a unit stands behind the whole expression."""
    name, unit = _mapped(Entry(omega.expression, None))[0], omega.unit or ""
    if unit == "rpm":
        return f"cumsum({name})/60/RATE [turn]"
    length = unit.removesuffix("/s")
    return f"cumsum({name})/RATE" + ("" if unit in ("", "rad/s") or length == unit else f" [{length}]")


def _taken(target: str, entry: Entry, coordinate: Coordinate | None) -> str:
    unit = f"[{entry.unit}]" if entry.unit else f"(no unit said: {SI[coordinate or 'rotary'][target]})"
    return f"{target} = {entry.column} {unit}"


def _listed(names: list[str]) -> str:
    return ", ".join(names[:-1]) + f" and {names[-1]}" if len(names) < 6 else f"{len(names)} columns"
