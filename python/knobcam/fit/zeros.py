"""Where each of several captures counts its angle from: an incremental encoder starts anew with every run.

Torque over position is one map of the knob, whatever else acts; by how far the maps of two captures are
shifted against each other says how far their counting is. The coarse shift comes from maps in cells, all
shifts at once (products of masked maps are correlations: Padfield 2012), the fine one from Gauss-Newton steps
over the samples.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..base.said import number, said
from ..capture import run
from ..capture.finding import Finding
from ..capture.prepare import prepare

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import FloatArray

    Cells = np.ndarray[Any, np.dtype[np.int64]]
    from ..capture.prepare import Prepared

_CELLS = 4096  # over the longest way
_SMOOTH = 2.0  # cells, of the map that samples are held against
_IN_CELL = 8  # samples, at least and on average
_FEWEST_CELLS = 32  # of a way that a map is drawn of
_FEWEST = _IN_CELL * _FEWEST_CELLS
_ENOUGH = 20_000  # samples of a capture; of more, every second or third
_STEPS = 8
_RIVAL = 0.25  # of what may differ: lags that come as near to the best are tried
_TRIED = 8
_FAR = 4.0  # cells, of a step
_AS_WELL = 0.02  # of the mean square
_WORSE = 1.5  # times the mean square must be left without a shift
_OVERLAP = 0.5  # of the shorter way, that two captures must share
_ALIKE = 0.15  # of the maps' own variance: what may differ where the shift is right
_APART = 2.0  # times as much must differ without it
_LEAST = 0.02  # of the maps' variance: less is no shift that anyone would feel
_SHOWS = 4.0  # times its noise: the variance of a map that can be told from none
_SURE = 6.0  # standard errors of a shift


class _Run(NamedTuple):
    """Samples that count: angle, torque, the columns of inertia and friction, and the cell of each."""

    theta: FloatArray
    tau: FloatArray
    base: FloatArray
    cell: Cells

    def within(self, values: FloatArray) -> FloatArray:
        """Return values less their mean in each cell: what is no map of position."""
        counts = np.maximum(np.bincount(self.cell), 1.0)
        columns = values.reshape(len(values), -1).T
        means = np.stack([np.bincount(self.cell, column) / counts for column in columns], 1)
        return values - means[self.cell].reshape(values.shape)


class _Trial(NamedTuple):
    """A shift, its standard error, and the mean square that it leaves."""

    by: float
    error: float
    left: float


class _Map(NamedTuple):
    """Torque over position in cells, N m, with how many samples are in each."""

    values: FloatArray
    counts: FloatArray
    noise: float


def aligned(prepared: Sequence[Prepared]) -> tuple[Prepared, ...]:
    """Return the captures with their angles counted from where the first one counts, if they count elsewhere.

    An angle is shifted where two maps of torque over position agree with the shift and do not without it.
    """
    if len(prepared) < 2:
        return tuple(prepared)
    used = [min(int(np.count_nonzero(one.used)), _ENOUGH // 2) for one in prepared]
    if min(used) < _FEWEST:
        return tuple(prepared)
    ways = [float(np.ptp(one.theta[one.used])) for one in prepared]
    width = max(ways) / min(_CELLS, min(used) // _IN_CELL)
    if min(ways) < _FEWEST_CELLS * width:
        return tuple(prepared)
    runs = [_samples(one, width) for one in prepared]
    first, *maps = [_mapped(one) for one in _without_friction(runs)]
    found = [
        None if first is None or map_ is None else _shift((runs[0], first), (one, map_), width)
        for one, map_ in zip(runs[1:], maps, strict=True)
    ]
    return (prepared[0], *(_shifted(one, by) for one, by in zip(prepared[1:], found, strict=True)))


def _samples(prepared: Prepared, width: float) -> _Run:
    used = np.flatnonzero(prepared.used)
    used = used[:: 1 + len(used) // _ENOUGH]
    theta, omega, alpha = prepared.theta[used], prepared.omega[used], prepared.alpha[used]
    forth = omega > 0.0
    base = np.stack([alpha, 1.0 * forth, omega * forth, omega * ~forth], 1)
    cell = np.floor((theta - theta.min()) / width).astype(np.int64)
    return _Run(theta, prepared.tau[used], base, cell)


def _without_friction(runs: Sequence[_Run]) -> list[_Run]:
    """Return the captures without inertia and friction, fitted to all of them beside a free map in each.

    What is the same in a cell falls out of the differences there (Frisch & Waugh 1933).
    """
    base = np.concatenate([one.within(one.base) for one in runs])
    tau = np.concatenate([one.within(one.tau) for one in runs])
    size = np.maximum(np.sqrt(np.mean(base**2, axis=0)), 1e-300)
    parameters = np.linalg.lstsq(base / size, tau, rcond=None)[0] / size
    return [one._replace(tau=one.tau - one.base @ parameters) for one in runs]


def _mapped(one: _Run) -> _Map | None:
    """Return the map of a capture; None where it does not show above its noise."""
    counts = np.bincount(one.cell).astype(np.float64)
    there = counts > 0.0
    values = np.bincount(one.cell, one.tau) / np.maximum(counts, 1.0)
    values[there] -= np.average(values, weights=counts)
    left = one.within(one.tau)
    spare = max(len(left) - int(np.count_nonzero(there)), 1)
    noise = float(left @ left) / spare * float(np.mean(1.0 / counts[there]))
    shows = float(np.var(values[there])) > _SHOWS * noise
    return _Map(values, counts, noise) if shows else None


def _shift(ours: tuple[_Run, _Map], theirs: tuple[_Run, _Map], width: float) -> float | None:
    """Return how far another capture's angle has to be moved; None where not at all."""
    (first, map_), (other, their_map) = ours, theirs
    apart = (float(other.theta.min()) - float(first.theta.min())) / width
    lags, differ = _differences(map_, their_map)
    still = int(np.argmin(np.abs(lags - apart)))
    best = float(np.nanmin(differ, initial=np.inf))
    if not best < _ALIKE or not (np.isnan(differ[still]) or differ[still] > max(_APART * best, _LEAST)):
        return None
    lowest = (differ <= np.roll(differ, 1)) & (differ <= np.roll(differ, -1))
    alike = np.flatnonzero(lowest & (differ <= best + _RIVAL * (_ALIKE - best)))
    shortest = alike[np.argsort(np.abs(lags[alike] - apart))][:_TRIED]
    trials = [_refined(first, other, width, float(lags[at] - apart) * width, _FAR * width) for at in shortest]
    least = min(one.left for one in trials)
    # What is late, say, keeps two maps apart as well, and is no shift.
    if not np.isnan(differ[still]) and _refined(first, other, width, 0.0, 0.0).left < _WORSE * least:
        return None
    # Detents alone return with each: of shifts that do as well the shortest.
    by = next(one for one in trials if one.left <= (1.0 + _AS_WELL) * least)
    return by.by if abs(by.by) > _SURE * by.error else None


def _differences(a: _Map, b: _Map) -> tuple[FloatArray, FloatArray]:
    """Return by how many cells the second map may be moved, and the share of the maps that then differs.

    NaN where they share too little. What noise makes of both is taken off.
    """
    size = 1 << int(np.ceil(np.log2(len(a.counts) + len(b.counts))))

    def product(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.fft.irfft(np.fft.rfft(x, size) * np.conj(np.fft.rfft(y, size)), size)

    there = [(one.counts > 0.0).astype(np.float64) for one in (a, b)]
    count = np.maximum(product(*there), 1.0)
    sum_a, sum_b = product(a.values, there[1]), product(there[0], b.values)
    squares = product(a.values**2, there[1]), product(there[0], b.values**2)
    mixed = product(a.values, b.values)
    own = sum(
        square / count - (total / count) ** 2 for square, total in zip(squares, (sum_a, sum_b), strict=True)
    )
    difference = own - 2.0 * (mixed / count - sum_a * sum_b / count**2)
    noise = a.noise + b.noise
    share = (difference - noise) / np.maximum(own - noise, 1e-300)
    enough = count >= _OVERLAP * min(one.sum() for one in there)
    lags = np.arange(size, dtype=np.float64)
    lags[len(a.counts) :] -= size
    return lags, np.where(enough & (own > 2.0 * noise), share, np.nan)


def _refined(first: _Run, other: _Run, width: float, start: float, far: float) -> _Trial:
    """Return the shift to which Gauss-Newton steps lead, beside inertia, friction and one map of both.

    No step is longer than `far`.
    """
    base = np.concatenate([first.base, other.base])
    theirs = np.repeat([0.0, 1.0], [len(first.tau), len(other.tau)])
    tau = np.concatenate([first.tau, other.tau])
    best = _Trial(start, np.inf, np.inf)
    by, parameters = start, np.zeros(base.shape[1])
    for _ in range(_STEPS if far > 0.0 else 2):
        theta = np.concatenate([first.theta, other.theta + by])
        both = _Run(theta, tau, base, np.floor((theta - theta.min()) / width).astype(np.int64))
        # The slope of the map that the last step left.
        counts = np.bincount(both.cell).astype(np.float64)
        sums = np.bincount(both.cell, tau - base @ parameters)
        kernel = np.exp(-0.5 * (np.arange(-8, 9) / _SMOOTH) ** 2)
        smooth = np.convolve(sums, kernel, "same") / np.maximum(np.convolve(counts, kernel, "same"), 1e-12)
        slope = np.gradient(smooth, width)[both.cell]
        # A torque that is late moves both directions apart, and a motion of mainly one direction with it.
        late = slope * (base[:, 2] + base[:, 3])
        columns = np.column_stack([base, late, slope * theirs, theirs])
        scales = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
        columns = both.within(columns / scales)
        within = both.within(tau)
        inverse = np.linalg.pinv(columns.T @ columns, rcond=1e-10, hermitian=True)
        solved = inverse @ (columns.T @ within)
        left = within - columns @ solved
        squares = float(left @ left) / len(left)
        spread = inverse[-2, -2] * squares
        if squares < best.left and np.any(parameters):
            best = _Trial(by, float(np.sqrt(spread)) / float(scales[-2]), squares)
        parameters = (solved / scales)[: base.shape[1]]
        by += float(np.clip((solved / scales)[-2], -far, far))
    return best


def _shifted(prepared: Prepared, by: float | None) -> Prepared:
    if by is None:
        return prepared
    capture = prepared.capture
    unit = "rad" if capture.coordinate == "rotary" else "m"
    found = said(
        "{theta}: counted from elsewhere than in the first capture: {by} were added, with which torque over "
        "position is the same",
        by=number(by, unit, ".5g"),
    )
    finding = Finding("origin", "theta", capture.samples, (), found, "mended")
    moved = replace(capture, theta=capture.theta + by, findings=(*capture.findings, finding))
    return prepare(run.same(moved, capture), prepared.method, **prepared.options)
