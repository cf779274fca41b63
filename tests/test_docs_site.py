"""The documentation site builds without a warning, leads from any page to every other, needs no network."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

import pytest
from test_browser import needs_browser, script

import knobcam
from knobcam import plot

ROOT = Path(__file__).resolve().parents[1]
SITE = ROOT / "site" / "html"
PAGES = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "BENCHMARKS.md"]
MADE_BY_SPHINX = {"genindex.html", "search.html"}


class Reference(NamedTuple):
    """What an attribute of a page's markup refers to."""

    tag: str
    target: str
    inside: str


class Markup(HTMLParser):
    """Gathers the references of a page, and in which part of it each stands."""

    def __init__(self) -> None:
        super().__init__()
        self.references: list[Reference] = []
        self.asides: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "aside":
            self.asides.append(dict(attrs).get("class") or "")
        inside = " ".join(self.asides)
        self.references += [
            Reference(tag, value, inside)
            for name, value in attrs
            if value and name in ("src", "href", "srcset", "data")
        ]

    def handle_endtag(self, tag: str) -> None:
        if tag == "aside":
            self.asides.pop()


@cache
def references(page: Path) -> list[Reference]:
    markup = Markup()
    markup.feed(page.read_text("utf-8"))
    return markup.references


def test_the_reference_has_every_public_name() -> None:
    named = (ROOT / "docs" / "api.md").read_text("utf-8")
    public = [name for name in knobcam.__all__ if not name.startswith("_")]
    assert [name for name in public if not re.search(rf"\b{name}\b", named)] == []
    assert [name for name in plot.__all__ if f"knobcam.show.plot.{name}" not in named] == []


def test_every_example_is_listed() -> None:
    listed = (ROOT / "docs" / "examples.md").read_text("utf-8")
    assert [path.name for path in (ROOT / "examples").glob("*.py") if path.name not in listed] == []


@pytest.fixture(scope="module")
def site() -> Path:
    """The site, made as `python3 dev.py docs` makes it; where CI has just made it, the one that is there."""
    if os.environ.get("KNOBCAM_SITE") == "made":
        return SITE
    made = subprocess.run(
        [sys.executable, ROOT / "docs" / "site" / "build.py"], capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stdout + made.stderr
    assert str(SITE / "index.html") in made.stdout
    return SITE


def test_the_site_has_every_page_of_the_docs(site: Path) -> None:
    wanted = {page.with_suffix(".html").name.lower() for page in PAGES}
    assert {path.name for path in site.glob("*.html")} == wanted | MADE_BY_SPHINX


def test_the_navigation_of_every_page_leads_to_every_other(site: Path) -> None:
    wanted = {page.with_suffix(".html").name.lower() for page in PAGES} - {"index.html"}
    for page in site.glob("*.html"):
        menu = {one.target for one in references(page) if one.tag == "a" and "sidebar-drawer" in one.inside}
        # A page calls itself "#".
        assert wanted - menu <= {page.name}, page.name


def test_nothing_that_a_page_loads_comes_from_a_network(site: Path) -> None:
    for page in site.glob("*.html"):
        loaded = [one for one in references(page) if one.tag != "a"]
        assert loaded and [one for one in loaded if re.match(r"(?:\w+:)?//", one.target)] == [], page.name
    for style in site.rglob("*.css"):
        assert re.findall(r"(?:url\(|@import)\s*[\"']?(?:\w+:)?//", style.read_text("utf-8")) == [], (
            style.name
        )


@needs_browser
def test_no_page_scrolls_sideways_on_an_ordinary_screen_and_every_picture_is_there(site: Path) -> None:
    seen = script("docs.js", site)
    assert seen["pages"] >= len(PAGES)
    assert seen["wide"] == {} and seen["lost"] == {}


def test_links_of_the_site_lead_to_files_in_it(site: Path) -> None:
    for page in site.glob("*.html"):
        targets = [one.target.split("#")[0].split("?")[0] for one in references(page)]
        inside = [target for target in targets if target and not re.match(r"\w+:", target)]
        assert [target for target in inside if not (site / target).is_file()] == [], page.name
