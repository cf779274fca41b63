"""From a file's columns to the five of a capture, in SI: by the contract's names or by a map."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.said import Advice, said
from ...errors import InputError
from ..finding import Finding
from .columnmap import TARGETS, ColumnMap, Entry, lacking, parse_map
from .expression import evaluate
from .header import bracketed, parts_in, read_label, without_brackets
from .merged import at_one_time
from .recognise import PLACEHOLDER, Unclear, ask, by_content, clock_in_doubt, recognise
from .table import Table
from .units import GIVEN, SI, Coordinate, fits, is_unit, to_si

CONTRACT: dict[Coordinate, dict[str, str]] = {
    "rotary": {
        "t": "t_s",
        "theta": "theta_rad",
        "omega": "omega_rad_s",
        "alpha": "alpha_rad_s2",
        "tau": "tau_Nm",
    },
    "linear": {"t": "t_s", "theta": "theta_m", "omega": "omega_m_s", "alpha": "alpha_m_s2", "tau": "tau_N"},
}
"""Column names that are understood without a map, by coordinate and column of a capture."""
_WORDS = re.compile(r"[A-Za-z_][\w.]*(\s+[\w.]+)+")
"""What is no expression, and can only have been meant as a name."""


def contract(coordinate: Coordinate, torque_unit: str) -> dict[str, str]:
    """Return these names for a torque in such a unit: `tau_Nm`, `tau_A`."""
    return CONTRACT[coordinate] | {"tau": f"tau_{torque_unit.replace(' ', '')}"}


@dataclass(frozen=True)
class Resolved:
    """The columns of a capture in SI, shape (samples,) each, with where they came from.

    `torque_unit` is empty where the torque is one.
    """

    columns: dict[str, FloatArray]
    coordinate: Coordinate
    entries: dict[str, Entry]
    torque_unit: str
    notes: tuple[Finding, ...] = ()


@np.errstate(all="ignore")  # what is beyond any float is found by the quality check, and said there
def resolve(table: Table, column_map: ColumnMap | None, coordinate: Coordinate | None) -> Resolved:
    """Return the columns of a capture; InputError names the columns found and an example of a map."""
    if coordinate is not None and coordinate not in SI:
        raise InputError(f"coordinate={coordinate!r} is unknown; choose rotary or linear")
    notes: tuple[Finding, ...] = ()
    if column_map is not None:
        entries, notes = _completed(table, parse_map(column_map), coordinate)
        # Who copies a name says nothing of its unit; who means s writes [s].
        if doubts := clock_in_doubt(table, entries):
            raise ask(table, f"map: {doubts['t']}", entries)
    elif (found := _by_contract(table, coordinate)) is not None:
        entries, coordinate = found
    else:
        entries, notes = _by_words(table, coordinate)
    columns: dict[str, FloatArray] = {}
    torque_unit = ""
    for target in TARGETS:
        if target not in entries:
            continue
        entry = entries[target]
        factor, implied, unit = (1.0, None, "") if entry.unit is None else to_si(target, entry.unit)
        torque_unit = unit if unit in GIVEN else torque_unit
        if implied is not None and coordinate is not None and implied != coordinate:
            raise InputError(
                f"{table.source}: {target} in [{entry.unit}] is for a {implied} axis, but it is "
                f"{coordinate}; change the unit or the coordinate"
            )
        coordinate = implied or coordinate
        if PLACEHOLDER not in table.columns and re.search(rf"\b{PLACEHOLDER}\b", entry.expression):
            example = re.sub(rf"\b{PLACEHOLDER}\b", "8192", str(entry))
            raise InputError(
                f"map: {PLACEHOLDER} in {target}={entry} stands for the counts of a turn, which the file "
                f"does not say; write the number, as in {target}={example}"
            )
        values = evaluate(entry.expression, table.column)
        if values.ndim == 0:
            raise InputError(
                f"{table.source}: {target}={entry.expression} is a single value, not a column of samples"
            )
        columns[target] = values if factor == 1.0 else values * factor
    _check_lengths(table, columns, entries)
    columns, merged = at_one_time(columns)
    return Resolved(columns, coordinate or "rotary", entries, torque_unit, (*notes, *merged))


def _without_unit(table: Table, entry: Entry) -> Entry:
    """Return an entry by the whole name of the column that it names without its unit, if it is one."""
    name = entry.expression.strip("`")
    same = [column for column in table.columns if without_brackets(column) == name]
    if len(same) == 1:
        return Entry(f"`{same[0]}`", entry.unit)
    if _WORDS.fullmatch(name):
        table.column(name)  # says which there are
    return entry


def _completed(
    table: Table, given: dict[str, Entry], coordinate: Coordinate | None
) -> tuple[dict[str, Entry], tuple[Finding, ...]]:
    """Return the entries of a map, and where it says of one column alone what it is, the others by name.

    Who knows that an effort is a current says so, and no more.
    """
    if (target := lacking(given)) is None:
        return _by_map(table, given, coordinate)
    entries, notes = _by_map(table, given, coordinate)
    rest: dict[str, Entry] = {}
    if (found := _by_contract(table, coordinate)) is not None:
        rest = found[0]
    else:
        try:
            recognised = recognise(table, coordinate)
            rest = recognised.entries if recognised else by_content(table)
        except Unclear as unclear:
            raise ask(table, f"map: {target} is missing", unclear.entries | entries) from None
        if recognised is None or target not in rest:
            raise ask(table, f"map: {target} is missing", rest | entries)
    added = {name: one for name, one in rest.items() if name not in entries}
    taken = ", ".join(f"{name} = {one.column}" for name, one in added.items())
    words = said("columns: {taken}, by their names beside the map", taken=taken)
    advice = Advice("a map says otherwise", "columns")
    note = Finding("columns", "theta", len(added), (), words, "note", advice)
    return rest | entries, (*notes, note)


def _by_map(
    table: Table, entries: dict[str, Entry], coordinate: Coordinate | None
) -> tuple[dict[str, Entry], tuple[Finding, ...]]:
    """Return the entries of a map with the units that its columns say of themselves, and a note of these.

    A bare column called `pos_deg` is in degrees whatever a map leaves out, and a name with a unit in brackets
    is a name before it is an expression with a unit. `a1 position` is `a1 position [rad]` where that is the
    only one.
    """
    known = {}
    for target, entry in entries.items():
        whole = str(entry)
        if whole in table.columns and not (entry.plain and entry.expression in table.columns):
            entry = Entry(f"`{whole}`", None)
        elif not entry.plain or entry.column not in table.columns:
            entry = _without_unit(table, entry)
        bare = entry.plain and entry.unit is None
        parts = parts_in(entry.column) if target == "tau" and bare else None
        if parts is not None:
            raise InputError(
                f"map: {entry.column} is in parts of what the drive is rated for; make it a torque, as in "
                f"tau={entry.expression}/{parts}*RATED [N m] with that in N m, or say [%] of a duty cycle"
            )
        unit = _unit_of(table, entry.column) if bare else None
        if bare and table.si:
            unit = SI[coordinate or "rotary"][target]
        known[target] = Entry(entry.expression, unit) if unit and fits(target, unit) else entry
    taken, foreign = [], []
    for target, entry in known.items():
        if entry.unit is None and entry.plain and is_unit(_unit_of(table, entry.column) or ""):
            foreign.append((target, entry.column))
        if entry.unit is None or entries[target].unit is not None:
            continue
        factor, _, unit = to_si(target, entry.unit)
        if factor != 1.0 or unit in GIVEN:  # that a number is in SI is taken without a word
            taken.append(f"{target} = {entry.column} [{entry.unit}]")
    notes = []
    if taken:
        beside = any(entries[target].column in table.units for target in known)
        found = said(
            "columns: {taken}, as {what}",
            taken=", ".join(taken),
            what="the file says" if beside else "their names say",
        )
        advice = Advice("a unit in the map says otherwise", "columns")
        notes.append(Finding("columns", "theta", len(taken), (), found, "note", advice))
    for target, column in foreign:
        found = said(
            "{target}: taken in SI, though {column} names another unit", target=target, column=column
        )
        advice = Advice("say its unit in the map", "columns")
        notes.append(Finding("header", target, 1, (), found, "warning", advice))
    return known, tuple(notes)


def _unit_of(table: Table, column: str) -> str | None:
    """Return the unit that a name says: one that headers have, or whatever stands in brackets behind it.

    Else that which the file states beside the name.
    """
    said = read_label(column).unit or bracketed(column)
    return said or table.units.get(column)


def _by_contract(table: Table, coordinate: Coordinate | None) -> tuple[dict[str, Entry], Coordinate] | None:
    known = {*table.columns, *table.broken}
    for candidate, units in SI.items():
        for unit in (units["tau"], *GIVEN):
            names = contract(candidate, unit)
            if coordinate in (None, candidate) and {names["theta"], names["tau"]} <= known:
                found = {target: Entry(f"`{name}`", None) for target, name in names.items() if name in known}
                if unit in GIVEN:
                    found["tau"] = Entry(found["tau"].expression, unit)
                return found, candidate
    return None


def _by_words(table: Table, coordinate: Coordinate | None) -> tuple[dict[str, Entry], tuple[Finding, ...]]:
    recognised = recognise(table, coordinate)
    if recognised is not None:
        return recognised.entries, (recognised.note,)
    wanted = CONTRACT[coordinate or "rotary"]
    raise ask(table, f"no columns {wanted['theta']} and {wanted['tau']}", by_content(table))


def _check_lengths(table: Table, columns: dict[str, FloatArray], entries: dict[str, Entry]) -> None:
    first = next(iter(columns))
    for target, values in columns.items():
        if len(values) != len(columns[first]):
            raise InputError(
                f"{table.source}: columns of different length: {first}={entries[first]} has "
                f"{len(columns[first])} rows, {target}={entries[target]} has {len(values)}; "
                f"cut them to one length, or write nan where a value is missing"
            )
