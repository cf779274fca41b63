"""What a model was fitted to: its file names the captures, so that others are known to be others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..capture import run
from ..model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..capture import Capture
    from ..capture.prepare import Prepared


def with_origin(model: Model, prepared: Sequence[Prepared]) -> Model:
    """Return a fitted model that names its captures; one of which nothing was fitted keeps what it says."""
    if not any(one.role == "free" for one in model.params.values()):
        return model
    return Model(model.core.with_fitted_to([_entry(one.capture) for one in prepared]))


def fitted_to(model: Model, capture: Capture) -> bool | None:
    """Return whether a model was fitted to a capture; None where it does not say what it was fitted to."""
    if not model.fitted_to:
        return None
    return run.fingerprint(capture) in {entry.rpartition(" ")[2] for entry in model.fitted_to}


def in_words(model: Model, prepared: Sequence[Prepared], names: Sequence[str]) -> str:
    """Return what has to be known of a model that was fitted to other captures than these; else nothing."""
    told = [fitted_to(model, one.capture) for one in prepared]
    if None in told:
        return "Nothing was fitted here, and the model does not say what it was fitted to."
    others = [name for name, fitted in zip(names, told, strict=True) if not fitted]
    if not others:
        return ""
    its = " and ".join(entry.rpartition(" ")[0] for entry in model.fitted_to)
    these = ("this capture" if len(told) == 1 else "these captures") if len(others) == len(told) else ""
    return f"The model was not fitted to {these or ' and '.join(others)}: it was fitted to {its}."


def _entry(capture: Capture) -> str:
    return f"{run.name(capture) or 'a capture'} {run.fingerprint(capture)}"
