"""How Sphinx makes the site; docs/site/build.py says from what."""

from __future__ import annotations

from typing import TYPE_CHECKING

from signatures import as_written, skip_fields

import knobcam

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "knobcam"
author = "the knobcam authors"
release = version = knobcam.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_heading_anchors = 4  # links to a section work as on a code host

# Docstrings write code in single backquotes.
default_role = "literal"
autodoc_default_options = {
    "members": True,
    "special-members": "__getitem__",
    "member-order": "bysource",
    # What the compiled core gives a class belongs to it; what Python gives every class does not.
    "inherited-members": "object, tuple, Exception, Warning",
}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 90
# Types in signatures that have no entry here: other packages' (their documentation is on a network), and the
# package's own that nobody makes by hand.
nitpick_ignore_regex = [
    ("py:.*", r"(os|pathlib|collections|typing|np|numpy|matplotlib)\..*"),
    ("py:.*", r"(knobcam\.)?(_core|pages|pages_said)\..*"),
    ("py:.*", r"knobcam\.fleet\.limits\.Limits"),  # of a batch, read from a file; `Limits` are those of a rig
    ("py:.*", r"(.*\.)?(FloatArray|IntArray|BoolArray|ArrayLike|NDArray|ColumnMap|Figure|Path|Law)"),
    ("py:.*", r"(.*\.)?(Clears|Left|Form|Kind|Study|Said|Advice|Quantity)"),
    (
        "py:.*",
        r"(.*\.)?(Coordinate|Watch|Picture|Window|Figures|Content|Severity|Shown|TextTable|Widget|Over|TakenUp|Acts|Limit)",
    ),
]

highlight_language = "text"  # of what names no language
smartquotes = False  # quotes in the text are those that a person types

html_theme = "furo"
html_title = "knobcam"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-signature", as_written)
    app.connect("autodoc-skip-member", skip_fields)
