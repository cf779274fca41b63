"""The linked plots within a report: its samples, and the script that shows them, in the file itself."""

from __future__ import annotations

import base64
import hashlib
import json
import math
from importlib import resources
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .formats.table import FloatArray
    from .learn import Story

SHOWN = 60_000
"""Samples that a report carries at most; of more, that many at random."""
_MOTION = ("theta", "omega", "tau")


class Section(NamedTuple):
    """A piece of a page: its markup, its style, and the hash by which its one script is allowed to run."""

    markup: str
    style: str
    script_hash: str


def section(story: Story) -> Section:
    """Return linked plots of torque and residual over position, velocity and time, for every rung."""
    script = _built("report.js")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    # No text of a file can end the element: JSON has another way to write its first letter.
    samples = json.dumps(_samples(story), allow_nan=False).replace("<", "\\u003c")
    markup = (
        '<div id="look"></div>'
        f'<script type="application/json" id="look-samples">{samples}</script>'
        f"<script>{script}</script>"
    )
    return Section(markup, _built("plots.css"), digest)


def _built(name: str) -> str:
    return resources.files("knobcam").joinpath("workbench", "page", name).read_text("utf-8").strip()


def _samples(story: Story) -> dict[str, object]:
    prepared = story.fit.prepared
    columns = [_times([signals.capture.t for signals in prepared])]
    for name in _MOTION:
        columns.append(np.concatenate([one.on_capture(getattr(one, name)) for one in prepared]))
    columns += [rung.fit.residual for rung in story.ladder]
    rows = np.arange(len(columns[0]))
    if len(rows) > SHOWN:
        rows = np.sort(np.random.default_rng(0).choice(rows, SHOWN, replace=False))
    floats = np.stack([column[rows] for column in columns]).astype("<f4")
    floor = story.fit.noise_floor
    rotary = story.model.axis == "rotary"
    return {
        "unit": "N m" if rotary else "N",
        "axis": story.model.axis,
        "noise": floor if math.isfinite(floor) else None,
        "n": len(rows),
        "columns": ["t", *_MOTION],
        "rungs": [
            {"label": f"+ {rung.added}" if rung.added else "first model", "rmse": rung.rmse}
            for rung in story.ladder
        ],
        "floats": base64.b64encode(floats.tobytes()).decode("ascii"),
    }


def _times(captures: list[FloatArray]) -> FloatArray:
    """Time of captures one after the other, s."""
    parts, elapsed = [], 0.0
    for t in captures:
        parts.append(t - t[0] + elapsed)
        elapsed = float(parts[-1][-1])
    return np.concatenate(parts)
