"""Order statistics without numpy.ma, which np.median and np.quantile import for 5 ms of every process."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.arrays import FloatArray

HALF_AND_MOST = ((0.5, 0.6745), (0.9, 1.6449))
"""Shares of normal values, and the deviations within which they lie."""


_LOOKED = 64
"""Values that tell whether many are the same, as the steps of a clock or of an encoder are."""


def quantile(values: FloatArray, share: float) -> float:
    """Return the value (n > 0) that `share` of `values` does not exceed, by nearest rank."""
    return quantiles(values, share)[0]


def quantiles(values: FloatArray, *shares: float) -> list[float]:
    """Return the same for several shares.

    Values of which many are the same are sorted in a sixth of the time in which they are parted at one rank;
    of others a part takes a third of a sort, and the next one is left of what is beyond the first.
    """
    ranks = [round(share * (len(values) - 1)) for share in shares]
    some = np.sort(values[:: 1 + len(values) // _LOOKED])
    if len(some) == len(values):
        return [float(some[rank]) for rank in ranks]
    if (some[1:] == some[:-1]).any():
        ranked = np.sort(values)
        return [float(ranked[rank]) for rank in ranks]
    found, left, first = {}, values, 0
    for rank in sorted(ranks):
        left, first = np.partition(left, rank - first)[rank - first :], rank
        found[rank] = float(left[0])
    return [found[rank] for rank in ranks]


def deviation(sizes: FloatArray, shares: Sequence[tuple[float, float]] = HALF_AND_MOST) -> float:
    """Return the deviation of normal values around zero of which these are the sizes.

    `shares` of them lie within so many deviations each: the widest counts, where there are others among them.
    """
    ends = quantiles(sizes, *(share for share, _ in shares))
    return max(end / deviations for end, (_, deviations) in zip(ends, shares, strict=True))


def medians(rows: FloatArray) -> FloatArray:
    """Return the median of each row, shape (rows, n > 0)."""
    ranked, half = np.sort(rows, axis=1), rows.shape[1] // 2
    if rows.shape[1] % 2:
        return ranked[:, half]
    return 0.5 * (ranked[:, half - 1] + ranked[:, half])
