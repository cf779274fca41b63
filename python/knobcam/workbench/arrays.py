"""Columns of samples as bytes: a line of JSON, then 32-bit floats, which a browser reads without a copy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

import numpy as np

from ..base import pages_sources
from ..base.strict_json import as_json
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from ..base.arrays import FloatArray
    from ..fit.diagnose import Candidate
    from ..model import Model
    from .view import View

_MOTION = ("theta", "omega", "alpha", "tau", "tau_raw")
_MODEL: Mapping[str, Callable[[View, int], FloatArray]] = {
    "t": lambda view, at: view.fit.prepared[at].capture.t,
    "masked": lambda view, at: view.masked(at),
    "model": lambda view, at: view.torque(at),
    "residual": lambda view, at: view.residual(at),
    "history": lambda view, at: view.since_reversal(at),
    "band": lambda view, at: view.band(at),
    "position_part": lambda view, at: view.part(at, "position"),
    "velocity_part": lambda view, at: view.part(at, "velocity"),
}
NAMES = (*_MOTION, *_MODEL)
_ALIGNED = 4  # bytes of a 32-bit float
_FIRST = ("t", "theta", "omega", "tau", "residual", "masked")
"""What the page draws before anybody chooses: of other columns it asks beside these."""


def ahead(document: Mapping[str, Any], token: str) -> str:
    """Return links by which a browser asks for the first samples while it still reads the page."""
    node, captures = document["node"], document["active"] if document["node"] else ()
    found = []
    for capture in captures:
        asked = urlencode({"node": node, "capture": capture, "names": ",".join(_FIRST), "token": token})
        link = f"/api/arrays?{asked}".replace("&", "&amp;")
        found.append(f'<link rel="preload" as="fetch" crossorigin="anonymous" href="{link}">')
    return "".join(found)


def columns(view: View, at: int, names: Sequence[str]) -> bytes:
    """Return columns over all samples of a capture, `at` its place in the fit; NaN at masked samples.

    `t` has them all, and `masked` has the torque of the masked ones alone, as it was recorded. Measured
    torque and everything modelled are after the measurement filter, `tau_raw` is before it. Raises
    InputError for an unknown name.
    """
    for name in names:
        if name not in NAMES:
            raise InputError(f"names: {name!r} is no column; there are {', '.join(NAMES)}")
    if not names:
        raise InputError(f"names is empty; there are {', '.join(NAMES)}")
    signals = view.fit.prepared[at]
    found = {}
    for name in names:
        found[name] = _MODEL[name](view, at) if name in _MODEL else signals.on_capture(getattr(signals, name))
    return packed(found)


def signature(candidate: Candidate, view: View, at: int) -> bytes:
    """Return what an effect would explain of the residual on a capture, N m: one column, its id the name."""
    return explained(candidate.effect, candidate.fit.model, view, at)


def own(candidate: Candidate, view: View, at: int) -> bytes:
    """Return the torque of a weighed effect itself, N m, without what the others give up for it."""
    signals, model = view.fit.prepared[at], candidate.fit.model
    others = model.core.only([one for one in model.effects if one != candidate.effect])
    step = model.core.torque(signals.core) - others.torque(signals.core)
    return packed({candidate.effect: signals.on_capture(step)})


def explained(name: str, model: Model, view: View, at: int) -> bytes:
    """Return what another model would explain of the residual on a capture, N m, as a column of this name."""
    signals = view.fit.prepared[at]
    step = model.core.torque(signals.core) - view.model.core.torque(signals.core)
    return packed({name: signals.on_capture(step)})


def packed(found: Mapping[str, FloatArray], live: pages_sources.Live | None = None) -> bytes:
    """Return columns of one length as a header line, filled up to whole floats, and their values."""
    n = len(next(iter(found.values())))
    told: pages_sources.ColumnsHead = {"names": list(found), "n": n, "dtype": "f32"}
    if live is not None:
        told["live"] = live
    head = as_json(told, indent=None).encode() + b"\n"
    head += bytes(-len(head) % _ALIGNED)
    return head + b"".join(np.ascontiguousarray(values, dtype="<f4").tobytes() for values in found.values())
