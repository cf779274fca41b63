"""Tables as HTML; nothing that stands in one can become markup."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.tables import Rows, TextTable

_PER_CENT = re.compile(r"(?<=\d) %")


def html_table(caption: str, head: Sequence[str], rows: Rows) -> str:
    """Return a table; without a head, the first cell of each row says what the others are."""
    if not head:
        return _table(caption, "".join(_fact(*cells) for cells in rows))
    body = "".join(_row(cells, "td") for cells in rows)
    return _table(caption, f"<thead>{_row(head, 'th')}</thead><tbody>{body}</tbody>")


def html(tables: Sequence[TextTable]) -> str:
    """Return tables one below the other."""
    return "".join(html_table(*table) for table in tables)


def _table(caption: str, inside: str) -> str:
    return f"<table><caption>{escape(caption)}</caption>{inside}</table>"


def _row(cells: Sequence[str], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(_whole(cell))}</{tag}>" for cell in cells) + "</tr>"


def _whole(cell: str) -> str:
    """Return a cell in which no line ends between a number and its per cent."""
    return _PER_CENT.sub("\u00a0%", cell)


def _fact(name: str, value: str) -> str:
    left = "style='text-align:left'"
    return f"<tr><th {left}>{escape(name)}</th><td {left}>{escape(value)}</td></tr>"
