"""Linked plots as a widget of a notebook: samples go there as bytes, and what is brushed comes back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import anywidget
import numpy as np
import traitlets

from ..base import pages
from ..base.arrays import IntArray
from ..base.strict_json import as_json
from ..errors import InputError
from . import samples
from .look_page import built
from .samples import Shown


def _bits(chosen: tuple[IntArray, ...], widget: Widget) -> bytes:
    """Chosen samples as web/src/bits.js has them."""
    flags = [np.zeros(count, bool) for count in widget.counts]
    for flag, rows in zip(flags, chosen, strict=True):
        flag[rows] = True
    whole = np.concatenate(flags)
    return np.packbits(whole, bitorder="little").tobytes() if whole.any() else b""


def _indices(bits: memoryview, widget: Widget) -> tuple[IntArray, ...]:
    flags = np.unpackbits(np.frombuffer(bits, np.uint8), bitorder="little").astype(bool)
    ends = np.cumsum(widget.counts)
    flags = np.append(flags, np.zeros(max(0, int(ends[-1]) - len(flags)), bool))
    return tuple(
        np.flatnonzero(flags[end - count : end]) for count, end in zip(widget.counts, ends, strict=True)
    )


class Widget(anywidget.AnyWidget):
    """What Python and the views of a notebook share; every trait can be observed.

    `step` is which of the models is shown, `chosen` are the indices of the chosen samples, an array for each
    capture, `looked` is the candidate that is looked at (empty for none).
    """

    _esm = built("widget.js")
    head = traitlets.Unicode().tag(sync=True)
    floats = traitlets.Bytes().tag(sync=True)
    step = traitlets.Int(0).tag(sync=True)
    chosen = traitlets.Any().tag(sync=True, to_json=_bits, from_json=_indices)
    looked = traitlets.Unicode("").tag(sync=True)
    overlay = traitlets.Dict().tag(sync=True)

    def __init__(self, steps: Sequence[Shown]) -> None:
        self.steps = steps
        fit = steps[-1].fit
        self.counts = [one.capture.samples for one in fit.prepared]
        shown = samples.head(steps)
        head: pages.Head = {**shown, "n": shown["all"]}
        columns = [*samples.measured(fit).values(), *(step.fit.residual for step in steps)]
        super().__init__(
            head=as_json(head, indent=None),
            floats=np.stack(columns).astype("<f4").tobytes(),
            chosen=[[] for _ in self.counts],
        )

    @traitlets.validate("step")
    def _there(self, proposal: Any) -> int:
        at: int = proposal["value"]
        if not 0 <= at < len(self.steps):
            raise InputError(f"step={at} is none of the {len(self.steps)} models that are shown, from 0")
        return at

    @traitlets.validate("chosen")
    def _sorted(self, proposal: Any) -> tuple[IntArray, ...]:
        value = proposal["value"]
        if not isinstance(value, Sequence) or isinstance(value, str):
            raise InputError(f"chosen={value!r}: give a list of index arrays, one for each capture")
        given = [np.atleast_1d(rows) for rows in value]
        if len(given) != len(self.counts):
            raise InputError(f"chosen has {len(given)} arrays; there are {len(self.counts)} captures")
        for rows, count in zip(given, self.counts, strict=True):
            if rows.size and rows.dtype.kind not in "iu":
                raise InputError(f"chosen: {rows.dtype} is no index; give numpy.flatnonzero(mask) of a mask")
            if rows.size and not 0 <= rows.min() <= rows.max() < count:
                raise InputError(f"chosen: samples are counted from 0 to {count - 1}")
        return tuple(np.unique(rows).astype(np.intp) for rows in given)

    @traitlets.observe("looked", "step")
    def _answer(self, _: Any) -> None:
        """Tell the views what the candidate that is looked at would explain of the model that is shown."""
        shown = self.steps[self.step]
        if self.looked in shown.effects:
            floats = shown.explained(self.looked).astype("<f4").tobytes()
            self.overlay = {"effect": self.looked, "step": self.step, "floats": floats}
