"""Torque that is no reading for tens of rows: anything at all, or one and the same."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, chosen, groups, runs
from ...base.said import said
from ..finding import Finding, Rows, rows_in_words, spans
from .order import deviation, medians

_FEWEST = 1000  # rows from which it can be told what is usual
_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])  # what is left of a torque after it is noise
_GAIN = math.sqrt(20.0)
_SPAN = 9  # rows over which the noise is read
_LOUDER = {
    "alpha": 3.5,
    "omega": 6.0,
    "theta": 18.0,
}  # times the usual noise, by the best sensor there is
_LONG = 12  # rows, below which it may be an impact
_LONGEST = 500
_WITHIN = 12  # rows between two loud ones of the same run
_TURNS = 1.0 / 3.0  # of the rows at which what is anything turns back; white noise does at twice as many
_MOST = 0.05  # of the rows: beyond that it is the torque that is like that
_RUNS = 20
_FELT = (2.0, 24.0)  # times its usual noise that a motion sensor has meanwhile, which then felt it,
# and as many more over the rows: of few the noise is not well known
_PART = 0.2  # of the torque's deviation in the log: noise that is less may have grown with the torque
_LAGS = 3  # rows by which what a loop makes of the motion may stand before or after it
_FOLLOWED = 24  # rows from which so many lags say whether it does: of fewer they follow anything
_FOLLOWS = 0.6  # of its variance: what is anything reaches 0.35
_CHANCE = 1e-9  # that a torque repeats itself that often somewhere in the log
_LEAP = 8.0  # deviations of noise by which it leaps to where it stands, and away


def check_garbage(
    columns: dict[str, FloatArray], usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return the rows whose torque is garbage for a while, and the findings.

    Louder than its noise by far from row to row, a good part of what it is anywhere, with a motion that feels
    nothing of it; or the same reading again and again, far from those before and after, of a sensor that else
    never repeats itself so often.
    """
    bad = np.zeros(len(rows), dtype=np.bool_)
    index = np.flatnonzero(usable)
    if len(index) < _FEWEST:
        return bad, []
    tau = chosen(columns["tau"], index)
    noise = _noise(tau)
    findings = []
    for at, kind, what in (
        (_loud(columns, index, noise), "spike", "is anything"),
        (_standing(tau, noise), "dead", "repeats one reading that has nothing to do with those beside it"),
    ):
        if not at.any():
            continue
        bad[index[at]] = True
        found = rows[index[at]]
        told = said(
            "{tau}: {what} for {count} rows ({rows}), which no knob makes",
            what=what,
            count=len(found),
            rows=rows_in_words(found),
        )
        findings.append(Finding(kind, "tau", len(found), spans(found), told, "masked"))
    return bad, findings


def _noise(values: FloatArray) -> float:
    """Deviation of white noise with such third differences; the wider of two where its tails are heavier.

    Where nothing changes, as of a motor that is off, there is no noise to be read.
    """
    third = np.abs(np.convolve(values, _THIRD, "valid"))
    third = third[third > 0.0]
    if not third.size:
        return 0.0
    return deviation(third) / _GAIN


def _loudness(values: FloatArray) -> FloatArray:
    """Deviation of white noise with the third differences around each row, by their median."""
    third = np.abs(np.convolve(values, _THIRD, "valid"))
    around = np.lib.stride_tricks.sliding_window_view(np.pad(third, (_SPAN // 2 + 1, _SPAN // 2 + 2)), _SPAN)
    found: FloatArray = np.partition(around, _SPAN // 2, axis=1)[:, _SPAN // 2] / 0.6745 / _GAIN
    return found


def _loud(columns: dict[str, FloatArray], index: IntArray, noise: float) -> BoolArray:
    loud = np.zeros(len(index), dtype=np.bool_)
    if not noise > 0.0:
        return loud
    tau = chosen(columns["tau"], index)
    louder = next(times for name, times in _LOUDER.items() if name in columns)
    # Few rows are loud at all in nearly every log; only around them is it looked at closely.
    far = np.flatnonzero(np.abs(np.convolve(tau, _THIRD, "valid")) > louder * _GAIN * noise)
    few = _LONG // 2
    if len(far) < few or len(far) > _MOST * len(tau) or np.min(far[few - 1 :] - far[: 1 - few]) > 2 * _LONG:
        return loud
    level = _loudness(tau)
    noisy = groups(np.flatnonzero(level > louder * noise), _WITHIN)
    noisy = [run for run in noisy if _LONG <= run[-1] - run[0] < _LONGEST]
    if len(noisy) > _RUNS:
        return loud
    least = _PART * float(np.std(tau))
    for run in noisy:
        first, end = max(0, int(run[0]) - _SPAN // 2 - 1), min(len(tau), int(run[-1]) + _SPAN // 2 + 2)
        readings = tau[first:end]
        if _noise(readings) < least or not _to_and_fro(readings):
            continue
        if not _felt(columns, index, first, end) and not _follows(columns, index, first, end):
            loud[first:end] = True
    return loud


def _to_and_fro(values: FloatArray) -> bool:
    """Whether values turn back at every second row or so, as noise does and no torque that changes fast.

    By steps over two rows: of a reading that stands for two every second step is none.
    """
    steps = values[2:] - values[:-2]
    return bool(np.mean(steps[2:] * steps[:-2] < 0.0) > _TURNS)


def _felt(columns: dict[str, FloatArray], index: IntArray, first: int, end: int) -> bool:
    """Whether a motion sensor is louder than usual in these rows."""
    for name in ("theta", "omega", "alpha"):
        if name in columns:
            usual, here = _noise(chosen(columns[name], index)), _noise(columns[name][index[first:end]])
            if here > (_FELT[0] + _FELT[1] / (end - first)) * usual:
                return True
    return False


def _follows(columns: dict[str, FloatArray], index: IntArray, first: int, end: int) -> bool:
    """Whether the torque of these rows is made of the motion around them, as by a loop that chatters."""
    rows = np.arange(max(first, _LAGS), min(end, len(index) - _LAGS))
    if len(rows) < _FOLLOWED:
        return False
    tau = columns["tau"][index[rows]]
    for name in ("alpha", "omega", "theta"):
        if name not in columns:
            continue
        motion = chosen(columns[name], index)
        motion = np.gradient(motion) if name == "theta" else motion
        lagged = [motion[rows + lag] for lag in range(-_LAGS, _LAGS + 1)]
        around = np.column_stack([*lagged, np.ones(len(rows))])
        rest = tau - around @ np.linalg.lstsq(around, tau, rcond=None)[0]
        left = float(rest @ rest) / (len(rows) - around.shape[1])
        if left < (1.0 - _FOLLOWS) * float(np.var(tau, ddof=1)):
            return True
    return False


def _standing(tau: FloatArray, noise: float) -> BoolArray:
    stands = np.zeros(len(tau), dtype=np.bool_)
    same = np.diff(tau) == 0.0
    firsts, ends = runs(same)
    ends = ends + 1
    lengths = ends - firsts
    long = lengths >= _LONG
    chance = (same.sum() - (lengths[long] - 1).sum() + 1.0) / (len(same) - lengths[long].sum() + 1.0)
    if not long.any() or long.sum() > _RUNS or lengths[long].sum() > _MOST * len(tau) or not noise > 0.0:
        return stands
    for first, end in zip(firsts[long].tolist(), ends[long].tolist(), strict=True):
        # At zero a motor is off; a limit is not left by a leap.
        beside = [tau[max(0, first - 5) : first], tau[end : end + 5]]
        if tau[first] == 0.0 or min(map(len, beside)) < 5 or end - first >= _LONGEST:
            continue
        leaps = np.abs(medians(np.array(beside)) - tau[first])
        if leaps.min() > _LEAP * noise and len(tau) * chance ** (end - first - 1) < _CHANCE:
            stands[first:end] = True
    return stands
