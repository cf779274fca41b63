"""Linked plots to brush in, as they are in the workbench: within a report, in a notebook, as a file.

Their samples and their script stand in the page itself; nothing is fetched.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
import os
from dataclasses import dataclass
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .formats.atomic import write_atomically

if TYPE_CHECKING:
    from .fit import Fit
    from .formats.table import FloatArray

SHOWN = 60_000
"""Samples that a page carries at most; of more, that many at random."""
_MOTION = ("theta", "omega", "tau")
_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; \
script-src 'sha256-$script_hash'">
<title>knobcam</title>
<style>
$style
body { margin: 0; padding: .4rem; background: var(--paper); color: var(--ink);
  font: 14px/1.4 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
</style>
</head>
<body>
$markup
</body>
</html>
""")


class Section(NamedTuple):
    """A piece of a page: its markup, its style, and the hash by which its one script is allowed to run."""

    markup: str
    style: str
    script_hash: str


@dataclass(frozen=True, eq=False)
class Look:
    """Linked plots of torque and residual over position, velocity and time; a notebook shows them.

    `fits` with their labels, all of the same captures: the plots show one of them at a time.
    """

    fits: tuple[tuple[str, Fit], ...]

    def section(self) -> Section:
        """Return the plots for a page that has more."""
        script = _built("report.js")
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
        # No text of a file can end the element: JSON has another way to write its first letter.
        samples = json.dumps(_samples(self.fits), allow_nan=False).replace("<", "\\u003c")
        markup = (
            '<div id="look"></div>'
            f'<script type="application/json" id="look-samples">{samples}</script>'
            f"<script>{script}</script>"
        )
        return Section(markup, _built("plots.css"), digest)

    def html(self) -> str:
        """Return a page of the plots alone."""
        return _PAGE.substitute(self.section()._asdict())

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write that page and return its path; it appears whole or not at all."""
        target, page = Path(path), self.html()
        write_atomically(target, lambda part: _write(part, page))
        return target

    def __repr__(self) -> str:
        labels = ", ".join(label for label, _ in self.fits)
        return f"Look({labels}): a notebook shows it, .save(path) writes it as a page"

    def _repr_html_(self) -> str:
        inside = escape(self.html(), quote=True)
        style = "width: 100%; height: 52rem; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{inside}"></iframe>'


def _write(path: Path, text: str) -> None:
    path.write_text(text, "utf-8")


def _built(name: str) -> str:
    return resources.files("knobcam").joinpath("workbench", "page", name).read_text("utf-8").strip()


def _samples(fits: tuple[tuple[str, Fit], ...]) -> dict[str, object]:
    last = fits[-1][1]
    prepared = last.prepared
    columns = [_times([signals.capture.t for signals in prepared])]
    for name in _MOTION:
        columns.append(np.concatenate([one.on_capture(getattr(one, name)) for one in prepared]))
    columns += [fit.residual for _, fit in fits]
    rows = np.arange(len(columns[0]))
    if len(rows) > SHOWN:
        rows = np.sort(np.random.default_rng(0).choice(rows, SHOWN, replace=False))
    floats = np.stack([column[rows] for column in columns]).astype("<f4")
    return {
        "unit": "N m" if last.model.axis == "rotary" else "N",
        "axis": last.model.axis,
        "noise": last.noise_floor if math.isfinite(last.noise_floor) else None,
        "n": len(rows),
        "columns": ["t", *_MOTION],
        "rungs": [{"label": label, "rmse": fit.rmse} for label, fit in fits],
        "floats": base64.b64encode(floats.tobytes()).decode("ascii"),
    }


def _times(captures: list[FloatArray]) -> FloatArray:
    """Time of captures one after the other, s."""
    parts, elapsed = [], 0.0
    for t in captures:
        parts.append(t - t[0] + elapsed)
        elapsed = float(parts[-1][-1])
    return np.concatenate(parts)
