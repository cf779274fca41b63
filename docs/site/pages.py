"""The pages of the site: those of docs/, which read well without it, and what is made for it alone.

A page of docs/ is Markdown that any code host shows. On its way into the site

- a line `<!-- site: NAME WORDS -->`, which no host shows, becomes what the maker of that name makes;
- a link to another file of the repository becomes one to a copy of it;
- the links of index.md, in their order and under their headings, become the navigation.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
MEASURED = ROOT / "BENCHMARKS.md"
FILES = "files"
"""Folder of the site for copies of files that are no pages."""

Maker = Callable[[list[str]], str]

_MARK = re.compile(r"^<!-- site: (?P<name>\w+)(?P<words>[^>]*) -->$", re.M)
_LINK = re.compile(r"(?P<head>\]\()(?P<target>[^)\s#]+)")


def pages() -> list[Path]:
    """Return the pages of the site, each a file of the repository."""
    return [*sorted(DOCS.glob("*.md")), MEASURED]


def stage(folder: Path, makers: dict[str, Maker]) -> None:
    """Write the pages into `folder` as Sphinx reads them, with the pictures and files that they link to."""
    folder.mkdir(parents=True)
    for page in pages():
        (folder / _name(page)).write_text(_staged(page, folder, makers), "utf-8")


def _staged(page: Path, folder: Path, makers: dict[str, Maker]) -> str:
    text = page.read_text("utf-8")
    # Links first: what is made leads to pages of the site already.
    text = _LINK.sub(lambda link: link["head"] + _lead(link["target"], page, folder), text)
    text = _MARK.sub(lambda mark: makers[mark["name"]](mark["words"].split()), text)
    return text + navigation(text) if page.stem == "index" else text


def navigation(index: str) -> str:
    """Return the tree of pages that the headings and links of a staged index.md make."""
    trees: list[str] = []
    for section in index.split("\n## ")[1:]:
        caption = section.partition("\n")[0]
        linked = [target.removesuffix(".md") for target in re.findall(r"\]\(([\w-]+\.md)", section)]
        trees += ["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *linked, "```"]
    return "\n".join([*trees, ""])


def _name(page: Path) -> str:
    """The name of a page in the site, where all are in one folder."""
    return page.name.lower()


def _lead(target: str, page: Path, folder: Path) -> str:
    """Where a link of a page leads in the site."""
    if target.startswith(("https:", "http:", "mailto:")):
        return target
    path = Path(os.path.normpath(page.parent / target))
    if path in pages():
        return _name(path)
    name = Path(FILES, path.relative_to(ROOT)).as_posix()
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, folder / name)
    return name
