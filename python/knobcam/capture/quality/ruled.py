"""What the quality check does about its findings, unless a person has overruled one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...base.said import said
from ...errors import InputError
from ..finding import Finding

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from ...base.arrays import BoolArray
    from ..finding import Rows


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


LATER = {
    "spike:theta": "readings of {theta} that all the others contradict",
    "spike:omega": "readings of {omega} that all the others contradict",
    "spike:alpha": "readings of {alpha} that all the others contradict",
    "band:theta": "a band in which the motion is not what the torque made",
    "edge:tau": "waves of the torque that its filter takes off",
    "late_column:tau": "a torque that stands before the motion that it makes, or after it",
}
"""What a preparation or a fit finds, which can be overruled before it was looked for; in words."""


def awaited(overruled: Collection[str], findings: Collection[Finding]) -> tuple[Finding, ...]:
    """Return notes of what was overruled of that which is found later."""
    there = {one.key for one in findings}
    notes = []
    for key in (one for one in dict.fromkeys(overruled) if one in LATER and one not in there):
        kind, column = key.split(":")
        notes.append(Finding(kind, column, 0, (), said(LATER[key]), "note", overruled=True))
    return tuple(notes)


def with_later(findings: Collection[Finding], later: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return findings with those that came later, which are overruled where their keys are already.

    What was overruled at once is said once; a note of what was awaited makes room for what came.
    """
    over = {one.key for one in findings if one.overruled}
    said = {one.key for one in findings if one.overruled and one.count}
    new = [one.over() if one.key in over else one for one in later if one.key not in said]
    came = {one.key for one in new}
    return (*(one for one in findings if one.count or one.key not in came), *new)


def check_overruled(source: str, overruled: Collection[str], findings: Collection[Finding]) -> None:
    """Raise InputError for what was overruled and was not found, or stands whatever one says.

    What is found later cannot be known yet.
    """
    for key in overruled:
        of_key = [one for one in findings if one.key == key]
        if any(one.overruled for one in of_key) or (key in LATER and not of_key):
            continue
        stands = next((f"{key} cannot be overruled: {one.stands}" for one in of_key if one.stands), None)
        there = ", ".join(dict.fromkeys(one.key for one in findings if not one.stands)) or "nothing"
        raise InputError(f"{source}: {stands or f'overrule={key!r} is not among what was found: {there}'}")
