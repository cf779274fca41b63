#!/usr/bin/env python3
"""Make the documentation site: python docs/site/build.py.

Sphinx, MyST and the theme Furo make it: they read the same Markdown as a code host, know Python's docstrings,
fail on a dead reference, and make pages that open from disk, search included, with nothing from a network.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from catalogue import catalogue
from commands import commands
from pages import ROOT, pages, stage
from reference import exam, examples, measured, names
from sphinx.cmd.build import main as sphinx


def build(folder: Path) -> int:
    """Make the site in `folder`/html, anew, and return the exit code of Sphinx; a warning is an error."""
    for name in ("source", "doctrees", "html"):
        shutil.rmtree(folder / name, ignore_errors=True)
    source = folder / "source"
    makers = {
        "commands": lambda _: commands(),
        "catalogue": lambda _: catalogue(source),
        "examples": lambda _: examples(),
        "names": names,
        "exam": exam,
        "measured": measured,
    }
    stage(source, makers)
    strict = ["--fail-on-warning", "--keep-going", "--nitpicky", "--quiet"]
    places = ["--conf-dir", str(Path(__file__).parent), "--doctree-dir", str(folder / "doctrees")]
    return sphinx([*strict, *places, str(source), str(folder / "html")])


def main() -> None:
    """Make the site in its place and say where that is."""
    folder = ROOT / "site"
    if code := build(folder):
        sys.exit(code)
    print(f"{len(pages())} pages: {folder / 'html' / 'index.html'}")


if __name__ == "__main__":
    main()
