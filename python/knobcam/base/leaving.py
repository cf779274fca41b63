"""How a model leaves for another form: it asks here, and `knobcam.render.convert`, unknown to it, answers.

What answers is named once, when the package is imported (`answered_by`), and loaded when it is needed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import os
    from collections.abc import Callable
    from pathlib import Path

    from .showing import Figure


class Left(Protocol):
    """A model in another form; see `knobcam.render.convert.Conversion`."""

    @property
    def predicted_error(self) -> float:
        """RMS torque that the approximations cost, as foretold; N m."""

    @property
    def measured_error(self) -> float | None:
        """RMS torque by which the written form misses the model, N m; None where it was not measured."""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write its file and return the path."""

    def plot(self) -> Figure:
        """The torque of the model and of the other form, and their difference."""

    def document(self) -> dict[str, Any]:
        """Return it as JSON can keep it."""


_find: Callable[[], Callable[..., Left]]


def answered_by(find: Callable[[], Callable[..., Left]]) -> None:
    """Name what answers from now on; `find` is called for every question, so that it can load it late."""
    global _find
    _find = find


def convert(model: object, to: str, **options: Any) -> Left:
    """Return a model in another form."""
    return _find()(model, to, **options)
