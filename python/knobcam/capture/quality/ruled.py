"""What the quality check does about its findings, unless a person has overruled one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from ...base.arrays import BoolArray
    from ..finding import Finding, Rows


class Ruled:
    """The findings of a check, in order, and which of them are `overruled`, by their keys."""

    def __init__(self, overruled: Collection[str] = ()) -> None:
        self.overruled = overruled
        self.findings: list[Finding] = []

    def lets(self, found: Iterable[Finding]) -> bool:
        """Take in findings; return whether what is to be done about them shall be."""
        told = [one.over() if one.key in self.overruled and not one.stands else one for one in found]
        self.findings += told
        return not any(one.overruled for one in told)

    def masks(self, bad: BoolArray, found: Sequence[Finding], rows: Rows) -> BoolArray:
        """Take in findings; return which of their `bad` rows shall be masked."""
        if self.lets(found):
            return bad
        left = np.zeros(len(bad), dtype=np.bool_)
        for one in self.findings[len(self.findings) - len(found) :]:
            if not one.overruled:
                left |= within(one, rows)
        return bad & left


def within(finding: Finding, rows: Rows) -> BoolArray:
    """Return which of the ascending `rows` a finding names."""
    named = np.zeros(len(rows), dtype=np.bool_)
    for first, last in finding.spans:
        named[np.searchsorted(rows, first) : np.searchsorted(rows, last, side="right")] = True
    return named


def check_overruled(source: str, overruled: Collection[str], findings: Collection[Finding]) -> None:
    """Raise InputError for what was overruled and was not found, or stands whatever one says."""
    for key in overruled:
        of_key = [one for one in findings if one.key == key]
        if any(one.overruled for one in of_key):
            continue
        stands = next((f"{key} cannot be overruled: {one.stands}" for one in of_key if one.stands), None)
        there = ", ".join(dict.fromkeys(one.key for one in findings if not one.stands)) or "nothing"
        raise InputError(f"{source}: {stands or f'overrule={key!r} is not among what was found: {there}'}")
