"""Linked plots to brush in, as they are in the workbench: alive in a notebook, or as a page of their own."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.door import checked
from ..base.optional import require
from ..base.writing import write
from ..errors import InputError
from .look_page import html

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import IntArray
    from .notebook import Widget
    from .samples import Shown


@dataclass(eq=False, repr=False)
class Look:
    """Linked plots of torque and residual over position, velocity and time; a notebook shows them.

    In a notebook with anywidget they are alive: `chosen` are the samples that are brushed, `share` their
    part of the squared error, and `step` is which of the models is shown. `save` writes them as a page.
    """

    steps: tuple[Shown, ...]

    @cached_property
    def widget(self) -> Widget:
        """The widget itself, to be observed or put beside others. Raises InputError without anywidget."""
        require("anywidget", "a live plot", extra="notebook")
        from .notebook import Widget

        return Widget(self.steps)

    @property
    def chosen(self) -> tuple[IntArray, ...]:
        """Indices of the chosen samples, one array for each capture; those that are set light up."""
        chosen: tuple[IntArray, ...] = self.widget.chosen
        return chosen

    @chosen.setter
    def chosen(self, indices: Sequence[IntArray]) -> None:
        self.widget.chosen = indices

    @property
    def share(self) -> float:
        """The part of the shown model's squared error that the chosen samples have, 0 to 1."""
        residuals = self.steps[self.step].fit.residuals
        whole = sum(float(np.nansum(np.square(rest))) for rest in residuals)
        parts = (rest[rows] for rest, rows in zip(residuals, self.chosen, strict=True))
        return sum(float(np.nansum(np.square(part))) for part in parts) / whole if whole > 0.0 else 0.0

    @property
    def step(self) -> int:
        """Which of the models is shown, from 0; it can be set."""
        return self.widget.step

    @step.setter
    def step(self, at: int) -> None:
        self.widget.step = at

    @property
    def rung(self) -> int:
        """The older name of `step`."""
        warnings.warn("Look.rung is now called step", DeprecationWarning, stacklevel=2)
        return self.step

    @rung.setter
    def rung(self, at: int) -> None:
        warnings.warn("Look.rung is now called step", DeprecationWarning, stacklevel=2)
        self.step = at

    @property
    def rungs(self) -> tuple[Shown, ...]:
        """The older name of `steps`."""
        warnings.warn("Look.rungs is now called steps", DeprecationWarning, stacklevel=2)
        return self.steps

    def html(self) -> str:
        """Return a page of the plots alone."""
        return html(self.steps)

    @checked
    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write that page and return its path; it appears whole or not at all."""
        return write(path, self.html())

    def __repr__(self) -> str:
        labels = ", ".join(step.label for step in self.steps)
        return f"Look({labels}): a notebook shows it, .save(path) writes it as a page"

    def _repr_html_(self) -> str:
        inside = escape(self.html(), quote=True)
        style = "width: 100%; height: 52rem; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{inside}"></iframe>'

    def _repr_mimebundle_(self, **_: object) -> tuple[dict[str, Any], dict[str, Any]]:
        """The page for what shows no widgets, and beside it the widget where there can be one."""
        page = {"text/plain": repr(self), "text/html": self._repr_html_()}
        try:
            view, metadata = self.widget._repr_mimebundle_() or ({}, {})
        except InputError:
            return page, {}
        return view | page, metadata
