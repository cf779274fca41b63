"""How Sphinx makes the site; docs/site/build.py says from what."""

from __future__ import annotations

from importlib.metadata import version as installed

project = "knobcam"
author = "the knobcam authors"
release = version = installed("knobcam")

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_heading_anchors = 4  # links to a section work as on a code host

html_theme = "furo"
html_title = "knobcam"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
