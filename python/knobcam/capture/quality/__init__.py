"""What is wrong with a capture: found, said, masked; mended only where the evidence leaves no doubt."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.said import OfColumn, said
from ...errors import InputError
from ..finding import Finding, Rows, rows_in_words, spans
from ..formats.units import Coordinate
from .dead import check_dead
from .garbage import check_garbage
from .held import check_differenced, check_held, held
from .late import check_late
from .let_go import check_let_go
from .motion import check_few_values, check_stuck, check_wrapped
from .ruled import Ruled
from .scales import check_scales
from .size import check_size
from .steps import check_steps
from .timing import check_times, run_on, spread
from .torque import Limit, check_clipping, check_spikes

__all__ = ["Checked", "Finding", "Rows", "check", "check_size"]

LARGEST = 1e30
"""A sample beyond (SI) is no measurement: its fourth power, which a covariance holds, must fit a float64."""


@dataclass(frozen=True)
class Checked:
    """The verdict: which samples are usable, what was found, the rate, and the columns that hold anything."""

    mask: BoolArray
    findings: tuple[Finding, ...]
    rate_hz: float
    columns: dict[str, FloatArray]


def check(
    columns: dict[str, FloatArray],
    coordinate: Coordinate,
    rows: Rows,
    source: str,
    limit: Limit = "sensor",
    overruled: Collection[str] = (),
    *,
    voltage: bool = False,
) -> Checked:
    """Check the columns t, theta, tau and, where there, omega and alpha: SI, shape (samples,) each.

    `rows` is the data row of each sample, from 1; `limit` whose it is where the torque sits at one,
    `voltage` that the torque is one, which holds a motor's back-EMF. About a finding whose key is `overruled`
    nothing is done. Raises InputError when there is nothing to work with: fewer than two samples, a needed
    column without a number, time that stands still.
    """
    if limit not in ("sensor", "actuator"):
        raise InputError(f"limit={limit!r} is unknown; choose sensor or actuator")
    if len(rows) < 2:
        raise InputError(f"{source}: {len(rows)} rows of data; a capture needs at least 2, better thousands")
    with np.errstate(all="ignore"):
        return _check(columns, coordinate, rows, source, limit, Ruled(overruled), voltage)


def _check(
    columns: dict[str, FloatArray],
    coordinate: Coordinate,
    rows: Rows,
    source: str,
    limit: Limit,
    ruled: Ruled,
    voltage: bool,
) -> Checked:
    findings = ruled.findings
    present = dict(columns)
    for name, values in columns.items():
        if _measured(values).any():
            continue
        if name not in ("omega", "alpha"):
            raise InputError(
                f"{source}: column {name} has no number in any of its {len(rows)} rows ({LARGEST:g} and more "
                f"is none); map another"
            )
        del present[name]
        nothing = said(
            "{name}: no number in any row; it is derived from {theta} as if the column were absent",
            name=OfColumn(name),
        )
        findings.append(Finding("empty", name, len(rows), spans(rows), nothing, "note"))

    mask = np.ones(len(rows), dtype=np.bool_)
    for name, values in present.items():
        measured = _measured(values)
        mask &= measured
        if not measured.all():
            at = rows[~measured]
            wild = said(
                "{name}: {count} samples are not finite or beyond {largest:g} ({rows})",
                name=OfColumn(name),
                count=len(at),
                largest=LARGEST,
                rows=rows_in_words(at),
            )
            findings.append(Finding("non-finite", name, len(at), spans(at), wild, "masked"))

    t, found = run_on(present["t"], rows)
    present["t"] = t if ruled.lets(found) else present["t"]
    others = [values for name, values in present.items() if name != "t"]
    t, found = spread(present["t"], others, rows)
    present["t"] = t if ruled.lets(found) else present["t"]
    rising, found, rate = check_times(present["t"], rows, source)
    ruled.lets(found)
    mask &= rising
    _check_left(mask, findings, source)
    steps = check_steps(present, mask, rows, coordinate, rate, ruled.overruled)
    ruled.lets(steps.findings)
    present |= {"t": steps.t, "theta": steps.theta}
    mask &= ~steps.bad
    spikes, found = _spikes(present, mask, rows)
    mask &= ~ruled.masks(spikes, found, rows)
    garbage, found = check_garbage(present, mask, rows)
    mask &= ~ruled.masks(garbage, found, rows)
    off, found = check_let_go(present, mask, rows) if voltage else (~mask, [])
    mask &= ~ruled.masks(off, found, rows)
    # A voltage whose motor was off is known to have been none, whoever overrules that.
    dead, found = check_dead(present, mask & ~off, rows, limit)
    mask &= ~ruled.masks(dead, found, rows)
    _check_left(mask, findings, source)
    clipped, found = check_clipping(present["tau"], present["theta"], mask, rows, limit)
    clipped = ruled.masks(clipped, found, rows)
    if ruled.lets(found := check_differenced(present, mask, rows)) and found:
        del present["omega"]
    ruled.lets(check_held(present, mask, rows))
    for name in ("theta", "omega", "alpha", "tau"):
        if name in present:
            ruled.lets(check_stuck(name, present[name], mask))
    if not voltage and limit == "sensor":
        ruled.lets(check_few_values(present["tau"], mask))
    ruled.lets(check_wrapped(present["theta"], mask, rows, coordinate))
    scaled, found = check_scales(present, mask, coordinate)
    present = scaled if ruled.lets(found) else present
    placed, found = check_late(present, mask, rate)
    present = placed if ruled.lets(found) else present
    mask &= _measured(present["theta"])
    return Checked(mask & ~clipped, tuple(findings), rate, present)


def _check_left(mask: BoolArray, findings: list[Finding], source: str) -> None:
    if mask.sum() < 2:
        blank = any(one.column == "tau" and 2 * one.count > len(mask) for one in findings)
        command = "; if tau is a command that holds until the next one, map tau=hold(COLUMN)"
        raise InputError(
            f"{source}: fewer than 2 usable samples are left of {len(mask)}: "
            + "; ".join(finding.message for finding in findings)
            + (command if blank else "")
        )


def _spikes(columns: dict[str, FloatArray], usable: BoolArray, rows: Rows) -> tuple[BoolArray, list[Finding]]:
    """Return the rows of wild torques; of one that stands between readings these alone are looked at."""
    read = np.ones(len(rows), dtype=np.bool_)
    read[usable] = ~held(columns["tau"][usable])
    spikes = np.zeros(len(rows), dtype=np.bool_)
    there = {name: values[read] for name, values in columns.items()} if not read.all() else columns
    spikes[read], found = check_spikes(there, usable[read], rows[read])
    return spikes, found


def _measured(values: FloatArray) -> BoolArray:
    """Return which values can have come from a sensor; NaN cannot."""
    return np.abs(values) <= LARGEST
