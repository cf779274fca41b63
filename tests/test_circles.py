"""No circles in a crate: of two files that know each other neither can be read first."""

from __future__ import annotations

import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from test_house import CRATE_ORDER, CRATES, rust_code, rust_files

Name = tuple[str, ...]


def named(path: Path, crate: str) -> Name:
    """The module that a file is: `a/b.rs` and `a/b/mod.rs` are a::b, `lib.rs` is none."""
    parts = path.relative_to(CRATES / crate / "src").with_suffix("").parts
    return parts[:-1] if parts[-1] in ("mod", "lib") else parts


def branches(tree: str) -> Iterator[str]:
    """The paths of a `use`, one by one: `a::{b, c::{d, e}}` is a::b, a::c::d and a::c::e."""
    stem, brace, rest = tree.strip().partition("{")
    if not brace:
        yield stem.partition(" as ")[0].strip()
        return
    depth, inner = 0, ""
    for letter in rest.rpartition("}")[0] + ",":
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            yield from (stem + branch for branch in branches(inner) if branch)
            inner = ""
        else:
            inner += letter


def known_to(module: Name, code: str, modules: set[Name]) -> set[Name]:
    """Modules of its crate that a module names, but for those that it lies in."""
    paths = [path for tree in re.findall(r"\buse\s+([^;]+);", code) for path in branches(tree)]
    paths += re.findall(r"\b(?:crate|super)(?:::\w+)+", re.sub(r"\buse\s+[^;]+;", "", code))
    found = set()
    for path in paths:
        words = [word.strip() for word in path.split("::")]
        at: Name = () if words[0] == "crate" else module
        while words and words[0] in ("crate", "self", "super"):
            at = at[:-1] if words.pop(0) == "super" else at
        while words and (*at, words[0]) in modules:
            at = (*at, words.pop(0))
        found.add(at)
    return {own for own in found & modules if module[: len(own)] != own}


def around(code: dict[Name, str]) -> list[Name]:
    """A circle of modules, if there is one."""
    try:
        TopologicalSorter({name: known_to(name, own, set(code)) for name, own in code.items()}).prepare()
    except CycleError as circle:
        return list(circle.args[1])
    return []


@pytest.mark.parametrize("crate", CRATE_ORDER)
def test_files_of_a_crate_know_each_other_in_one_direction(crate: str):
    assert around({named(path, crate): rust_code(path) for path in rust_files(crate)}) == []


def test_a_circle_would_be_seen():
    law, user, block = ("effects", "law"), ("effects", "user"), ("effects", "law", "block")
    code = {
        (): "",
        ("effects",): "mod law; pub use user::User;",
        law: "",
        user: "use super::law::{self, Law};",
    }
    assert around(code) == []
    assert set(around(code | {block: "let x = crate::effects::user::LEAST;", law: "use block::Block;"})) == {
        law,
        user,
        block,
    }
    assert set(around(code | {law: "use crate::{error::Result, effects::{Info, user::{A, B}}};"})) == {
        law,
        user,
    }
