"""Pieces of a report; nothing that stands in one can become markup."""

from __future__ import annotations

import base64
import io
from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from .tables import html_table

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.figure import Figure


def style() -> str:
    """Return how every report looks, on a light or dark screen and on paper."""
    return resources.files("knobcam.show").joinpath("report.css").read_text("utf-8")


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph of text."""
    return f'<p class="{kind}">{escape(text)}</p>' if kind else f"<p>{escape(text)}</p>"


def law(latex: str, plain: str) -> str:
    """Return a law: plain, until the script of the page has typeset it."""
    return f'<p class="law" data-latex="{escape(latex)}"><code>{escape(plain)}</code></p>'


def bullets(items: Iterable[str]) -> str:
    """Return a list of texts."""
    return "<ul>" + "".join(f"<li>{escape(item)}</li>" for item in items) + "</ul>"


def wide_table(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table that may be wider than the page."""
    return f'<div class="wide">{html_table(caption, head, rows)}</div>'


def figure(drawn: Figure, caption: str) -> str:
    """Return a picture as an image within the file: what is written in it can never become markup."""
    stream = io.BytesIO()
    drawn.savefig(stream, format="svg", metadata={"Date": None})
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    said = escape(caption)
    image = f'<img alt="{said}" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{image}<figcaption>{said}</figcaption></figure>"
