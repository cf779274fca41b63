"""Columns that were sampled more slowly than they were logged: each reading stands until the next one."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray, chosen
from ...base.said import OfColumn, said
from ..finding import Finding, Rows, spans
from .order import quantile
from .ruled import Ruled

_LEAST = 0.3  # of the rows that repeat, below which nothing is held
_ALONE = 0.8  # of the steps that stand alone between repeats: a knob that moves and rests has them in a row
_NOTHING = 0.95  # of the rows that repeat an angle, in which a velocity that was computed from it is none
_COARSE = 3.0  # smallest steps in the usual one, below which it is the counts of an encoder that are seen
_FEWEST = 20  # steps
_REGULAR = 0.8  # of the holds that are the usual one, above which all are
_UNLIKE = 0.25  # of the usual hold, by which others differ where all columns are held together
_REST = 3  # times the usual hold: longer is a rest, read once per hold


def held(values: FloatArray) -> BoolArray:
    """Return which of the values, shape (samples,), only repeat a reading; none where the column is not held.

    An encoder that counts less than once a row repeats its angle too: there the usual step is a single count.
    """
    with np.errstate(invalid="ignore"):  # masked readings may be infinite; from one to the next is no step
        step = np.abs(np.diff(values))
    same, nothing = step == 0.0, np.zeros(len(values), dtype=np.bool_)
    if np.count_nonzero(same) < _LEAST * len(values):  # as in nearly every log
        return nothing
    repeats = np.concatenate(([False], same))
    fresh = np.flatnonzero(~repeats)
    if len(fresh) < _FEWEST:
        return nothing
    moves = step[step > 0.0]
    alone = np.append(repeats[fresh[:-1] + 1], True)
    if alone.mean() < _ALONE or quantile(moves, 0.5) < _COARSE * float(moves.min()):
        return nothing
    lengths = np.diff(np.append(fresh, len(values)))
    usual = max(1, round(quantile(lengths.astype(np.float64), 0.5)))
    since = np.arange(len(values)) - np.repeat(fresh, lengths)
    # Where it is as many rows every time, longer ones are several readings of the same.
    most = 2 * usual - 1 if np.mean(lengths == usual) > _REGULAR else _REST * usual
    rest = np.repeat(lengths > most, lengths)
    once: BoolArray = repeats & ~(rest & (since % usual == 0))
    return once


def check_held(columns: dict[str, FloatArray], usable: BoolArray, rows: Rows) -> list[Finding]:
    """Return which columns are held between readings."""
    findings = []
    for name in ("theta", "omega", "alpha", "tau"):
        if name not in columns:
            continue
        repeated = held(chosen(columns[name], usable))
        if not repeated.any():
            continue
        at = rows[usable][repeated]
        every = len(repeated) / max(1, len(repeated) - len(at))
        if name == "tau":
            remedy = "compared with the model where it was read, every other row tells of the motion alone"
        else:
            remedy = "only new readings count as measured"
        found = said(
            "{name}: {count} of {all} rows repeat the reading before, a new one comes every {every:.3g} "
            "rows: it was sampled more slowly than logged; {remedy}",
            name=OfColumn(name),
            count=len(at),
            all=len(repeated),
            every=every,
            remedy=remedy,
        )
        findings.append(Finding("held", name, len(at), spans(at), found, "mended"))
    return findings


def check_differenced(columns: dict[str, FloatArray], usable: BoolArray, rows: Rows) -> list[Finding]:
    """Return that a velocity was computed from row to row of an angle that is read more slowly.

    It is nothing wherever the angle repeats its reading, and too large where a new one comes: the mean of a
    stretch may be right, or be off by how many rows there are to a reading. The angle says all of it.
    """
    if "omega" not in columns:
        return []
    theta, omega = chosen(columns["theta"], usable), chosen(columns["omega"], usable)
    with np.errstate(invalid="ignore"):
        same = np.concatenate(([False], np.diff(theta) == 0.0))
    fresh, still = np.flatnonzero(~same), omega == 0.0
    if len(fresh) < _FEWEST or np.count_nonzero(same) < _LEAST * len(theta):
        return []
    # Of a knob that moves and rests new readings stand in a row, and there is no velocity at rest.
    alone = np.append(same, True)[fresh + 1]
    if alone.mean() < _ALONE or still[same].mean() < _NOTHING or still[fresh].mean() > 1.0 - _NOTHING:
        return []
    at = rows[usable][same & still]
    found = said(
        "{omega}: nothing in {count} rows in which {theta} repeats its reading, and too much in the others: "
        "it was computed row by row of a {theta} that is read more slowly; left out, since {theta} says it",
        omega=OfColumn("omega"),
        theta=OfColumn("theta"),
        count=len(at),
    )
    return [Finding("held", "omega", len(at), spans(at), found, "mended")]


def read_apart(columns: dict[str, FloatArray], rows: Rows, ruled: Ruled) -> BoolArray:
    """Return which rows are new readings where all columns are held together, else all of them.

    A log that is written more often than the machine is read: at the rate of the readings nothing is lost.
    """
    every = np.ones(len(rows), dtype=np.bool_)
    same = every[1:].copy()
    for values in (values for name, values in columns.items() if name != "t"):
        with np.errstate(all="ignore"):  # nobody has looked yet at what the columns hold
            same &= np.diff(values) == 0.0
        if 2 * np.count_nonzero(same) < len(same):  # as nearly every log by its first column
            return every
    repeats = np.concatenate(([False], same))
    fresh = np.flatnonzero(~repeats)
    if len(fresh) < _FEWEST:
        return every
    lengths = np.diff(np.append(fresh, len(repeats)))
    usual = round(quantile(lengths.astype(np.float64), 0.5))
    # What chance or a rest repeats, it repeats for any while.
    if usual < 2 or np.mean(np.abs(lengths - usual) <= max(1.0, _UNLIKE * usual)) < _REGULAR:
        return every
    since = np.arange(len(repeats)) - np.repeat(fresh, lengths)
    read = since % usual == 0
    # The last of the usual holds may be a row or a few longer.
    read &= ~repeats | (np.repeat(lengths, lengths) - since > usual // 2)
    found = said(
        "{t}: {count} of {all} rows repeat the row before in every column, a new one comes every {every:.3g} "
        "rows: the log was written more often than it was read; it is taken at the rate of the readings",
        count=int(np.sum(~read)),
        all=len(read),
        every=len(read) / int(read.sum()),
    )
    finding = Finding("held", "t", int(np.sum(~read)), spans(rows[~read]), found, "mended")
    return read if ruled.lets([finding]) else every
