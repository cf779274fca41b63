"""Linked plots as a page that holds all that it shows: nothing is fetched."""

from __future__ import annotations

import base64
import hashlib
from importlib import resources
from string import Template
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base import pages
from ..base.strict_json import island
from . import samples
from .packed import FINE, packed, step_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .samples import Shown

MOST = 250_000
"""Samples that a page carries at most; of more, that many at random, and it says so."""
_COARSE = 16.0
"""Step of what a candidate would explain, in steps of the residual that it is laid over."""
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


def section(steps: Sequence[Shown]) -> Section:
    """Return the plots for a page that has more."""
    script = built("report.js")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    markup = f'<div id="look"></div>{island(_kept(steps), "look-samples")}<script>{script}</script>'
    return Section(markup, built("report.css"), digest)


def html(steps: Sequence[Shown]) -> str:
    """Return a page of the plots alone."""
    return _PAGE.substitute(section(steps)._asdict())


def built(name: str) -> str:
    """Return a file of what `web/` builds."""
    return resources.files("knobcam").joinpath("workbench", "page", name).read_text("utf-8").strip()


def _kept(steps: Sequence[Shown]) -> pages.Kept:
    """What a page holds: columns, each step's residual, and what each candidate would explain of it."""
    head = samples.head(steps)
    count = head["all"]
    rows = np.arange(count)
    if count > MOST:
        rows = np.sort(np.random.default_rng(0).choice(rows, MOST, replace=False))
    measured = {name: column[rows] for name, column in samples.measured(steps[-1].fit).items()}
    residuals, signatures = [], []
    for step in steps:
        rest = step.fit.residual[rows]
        grain = step_of(rest)
        residuals.append(packed(rest, grain))
        signatures.append(
            {effect: packed(step.explained(effect)[rows], _COARSE * grain) for effect in step.effects}
        )
    return {
        **head,
        "n": len(rows),
        "columns": {
            name: packed(column, step_of(column, FINE) if name == "t" else step_of(column))
            for name, column in measured.items()
        },
        "residuals": residuals,
        "signatures": signatures,
    }
