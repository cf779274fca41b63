#!/usr/bin/env python3
"""Make the documentation site: python docs/site/build.py.

Sphinx, MyST and the theme Furo make it: they read the same Markdown as a code host, know Python's docstrings,
fail on a dead reference, and make pages that open from disk, search included, with nothing from a network.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from pages import ROOT, Maker, pages, stage
from sphinx.cmd.build import main as sphinx

MAKERS: dict[str, Maker] = {}


def build(folder: Path) -> int:
    """Make the site in `folder`/html, anew, and return the exit code of Sphinx; a warning is an error."""
    for name in ("source", "doctrees", "html"):
        shutil.rmtree(folder / name, ignore_errors=True)
    stage(folder / "source", MAKERS)
    strict = ["--fail-on-warning", "--keep-going", "--nitpicky", "--quiet"]
    places = ["--conf-dir", str(Path(__file__).parent), "--doctree-dir", str(folder / "doctrees")]
    return sphinx([*strict, *places, str(folder / "source"), str(folder / "html")])


def main() -> None:
    """Make the site in its place and say where that is."""
    folder = ROOT / "site"
    if code := build(folder):
        sys.exit(code)
    print(f"{len(pages())} pages: {folder / 'html' / 'index.html'}")


if __name__ == "__main__":
    main()
