"""Columns that stand still while others say that the knob moves: a sensor that was off."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, chosen, runs
from ...base.said import OfColumn, said
from ..finding import Finding, Rows, rows_in_words, spans
from .torque import Limit

_FEWEST = 100  # rows in a row, below which a value that stands is no fault
_TIMES = 10  # as long as the longest stand but for the dead ones
_PART = 0.02  # of all the way that the knob goes: what it must go meanwhile
_OFTEN = 2  # stands: what stands still again and again is a motor that is off, or dry friction
_EVEN = 1e-6  # steps that differ by less are those of a motion without noise, as simulations have
_WINDOW = (7, 25)  # samples at least and most, over which a parabola tells angle, velocity, acceleration
_JUDGES = 40  # windows elsewhere, without which nobody can tell
_TOLD = 0.1  # of the other rows' torque, that a rigid knob may leave unexplained and still be a judge
_MEANT = 0.15  # of what a torque that was lost would leave: a stand that leaves less was the torque


def check_dead(
    columns: dict[str, FloatArray], usable: BoolArray, rows: Rows, limit: Limit
) -> tuple[BoolArray, list[Finding]]:
    """Return the rows at which torque or angle stand still while the knob moves, and the findings.

    What moves the knob changes from row to row, if only by noise; and where a velocity is measured the angle
    follows it. A motor's torque may stand, as at zero when it is switched off: the motion then agrees, or, of
    what a motor was given (whose `limit` is the actuator's), does not say anything else.
    """
    dead = np.zeros(len(rows), dtype=np.bool_)
    findings = []
    index = np.flatnonzero(usable)
    theta = chosen(columns["theta"], index)
    moved = {"tau": np.abs(np.diff(theta, prepend=theta[0]))}
    if "omega" in columns:
        moved["theta"] = np.abs(chosen(columns["omega"], index))
    for name, way in moved.items():
        at = np.zeros(len(index), dtype=np.bool_)
        standing = stands(chosen(columns[name], index))
        # What hardly ever does anything else is no sensor that was off: a torque of steps was commanded.
        if not 1 <= len(standing) <= _OFTEN or _elsewhere(index, standing) < _FEWEST:
            continue
        if name == "tau":
            off = limit == "actuator" and not any(columns[name][index[first]] for first, _ in standing)
            if _acted(columns, index, standing, unless_told=off):
                continue
        for first, end in standing:
            part = way[first + 1 : end]
            if part.sum() >= _PART * way.sum() and np.ptp(part) > _EVEN * part.max():
                at[first:end] = True
        if not at.any():
            continue
        dead[index[at]] = True
        found = rows[index[at]]
        what = said(
            "{name}: stands still in {count} rows ({rows}) while the knob moves, as if its sensor was off",
            name=OfColumn(name),
            count=len(found),
            rows=rows_in_words(found),
        )
        findings.append(Finding("dead", name, len(found), spans(found), what, "masked"))
    return dead, findings


def _elsewhere(index: IntArray, standing: list[tuple[int, int]]) -> int:
    return len(index) - sum(end - first for first, end in standing)


def _acted(
    columns: dict[str, FloatArray], index: IntArray, standing: list[tuple[int, int]], unless_told: bool
) -> bool:
    """Return whether one rigid knob moves under the torque as it is, where it stands and elsewhere.

    A torque that was lost pulls the parameters of that knob towards zero: per row it costs p (1 - p) of the
    torque's mean square, p being the share of the rows in which it stands. `unless_told` is the answer where
    the motion cannot tell.
    """
    windows = rigid_windows(columns, index, standing)
    if windows is None:
        return unless_told
    signatures, torque, still = windows
    if _left(signatures[~still], torque[~still]) > _TOLD * np.sum(torque[~still] ** 2):
        return unless_told
    return agrees(signatures, torque, still)


def agrees(signatures: FloatArray, torque: FloatArray, still: BoolArray) -> bool:
    """Return whether the windows in which a torque stands ask for the same factors of it as the others."""
    size = np.sum(torque[~still] ** 2)
    more = _left(signatures, torque) - _left(signatures[~still], torque[~still])
    return bool(more <= _MEANT * size * still.mean())


def rigid_windows(
    columns: dict[str, FloatArray], index: IntArray, standing: list[tuple[int, int]]
) -> tuple[FloatArray, FloatArray, BoolArray] | None:
    """Return what makes a rigid knob's torque in each window, the torque, and which windows it stands in.

    None where too few rows are left beside those in which it stands.
    """
    edges = [0, *(edge for stand in standing for edge in stand), len(index)]
    pieces = [index[first:end] for first, end in pairwise(edges)]
    window = min(_WINDOW[1], sum(map(len, pieces[::2])) // _JUDGES)
    if window < _WINDOW[0]:
        return None
    still = np.concatenate([np.full(len(p) // window, n % 2 == 1) for n, p in enumerate(pieces)])
    span = np.linspace(-0.5, 0.5, window) * window * np.median(np.diff(columns["t"][index]))
    parabola = np.asarray(np.linalg.pinv(np.vander(span, 3, increasing=True)), dtype=np.float64)
    parts = [_rigid(columns, p, parabola) for p in pieces]
    signatures, torque = (np.concatenate(part) for part in zip(*parts, strict=True))
    signatures /= np.sqrt(np.mean(signatures**2, axis=0)) + np.finfo(float).tiny
    return signatures, torque, still


def _rigid(
    columns: dict[str, FloatArray], rows: IntArray, parabola: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what makes a rigid knob's torque, shape (windows, 7), and the torque of each window."""
    window = parabola.shape[1]
    theta, tau = (
        columns[name][rows][: len(rows) // window * window].reshape(-1, window) for name in ("theta", "tau")
    )
    at, omega, half_alpha = parabola @ theta.T
    loads = (half_alpha, omega, np.sign(omega), np.ones_like(at), at, np.sin(at), np.cos(at))
    return np.column_stack(loads), np.mean(tau, axis=1)


def _left(signatures: FloatArray, torque: FloatArray) -> float:
    """Return the squares that least squares leave."""
    factors = np.linalg.lstsq(signatures, torque, rcond=1e-8)[0]
    return float(np.sum((torque - signatures @ factors) ** 2))


def stands(values: FloatArray) -> list[tuple[int, int]]:
    """Return the runs of one value, first and end, that are far longer than all others."""
    firsts, ends = runs(np.diff(values) == 0.0)
    ends = ends + 1
    lengths = ends - firsts
    long = lengths >= _FEWEST
    ordinary = int(lengths[~long].max(initial=1))
    long &= (lengths >= _TIMES * ordinary) & (lengths < len(values))  # a column that never changes is stuck
    return list(zip(firsts[long].tolist(), ends[long].tolist(), strict=True))
