"""Faults beside what they replace: all mutants of a sample in one source tree, and one build for them all.

`cargo mutants` compiles the crates anew for every mutant. Here each one is written next to the original,
`if mutant::is(17) { mutated } else { original }`, and a variable of the environment says which one lives.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import tree_sitter
import tree_sitter_rust

VARIABLE = "PLANTED"
EVERY = 2**32 - 2  # none lives, but what comes past one notes it
LIB = "crates/knobcore/src/lib.rs"
HOLE = "\0"  # in the text of an edit: what stood there before
MODULE = f"""//! Which planted fault lives in this process.

use std::io::Write;
use std::sync::LazyLock;
use std::sync::atomic::{{AtomicBool, Ordering}};

static LIVING: LazyLock<u32> =
    LazyLock::new(|| std::env::var("{VARIABLE}").ok().and_then(|name| name.parse().ok()).unwrap_or(u32::MAX));
static PASSED: [AtomicBool; 10000] = [const {{ AtomicBool::new(false) }}; 10000];

/// Whether this one lives.
#[inline]
pub fn is(number: u32) -> bool {{
    let living = *LIVING;
    if living == {EVERY} {{
        note(number);
    }}
    living == number
}}

#[cold]
fn note(number: u32) {{
    if !PASSED[number as usize].swap(true, Ordering::Relaxed) {{
        let notes = std::env::var("{VARIABLE}_NOTES").unwrap();
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(notes).unwrap();
        file.write_all(format!("{{number}}\\n").as_bytes()).unwrap();
    }}
}}
"""
_WORK_OF_COMPILER = {"const_item", "static_item", "array_type", "type_arguments", "const_block"}
_PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))


class Mutant(NamedTuple):
    """One of `cargo mutants --list --json`."""

    number: int
    name: str
    file: str
    package: str
    genre: str
    replacement: str
    start: tuple[int, int]
    end: tuple[int, int]
    function: str

    @classmethod
    def listed(cls, number: int, entry: dict[str, Any]) -> Mutant:
        """Of an entry of the list."""
        start, end = (
            (entry["span"][side]["line"] - 1, entry["span"][side]["column"] - 1) for side in ("start", "end")
        )
        function = (entry.get("function") or {}).get("function_name", "")
        said = (entry[key] for key in ("name", "file", "package", "genre", "replacement"))
        return cls(number, *said, start, end, function)


class Edit(NamedTuple):
    """What a mutant makes of the bytes from start to end; a hole stands for them, other edits included."""

    start: int
    end: int
    text: str
    mutant: Mutant


def planted(root: Path, tree: Path, files: list[str], mutants: list[Mutant]) -> dict[int, str]:
    """Write the files with all mutants in them; return those that have no place there, with the reason."""
    impossible = {}
    # What is removed and written again would be compiled again.
    known = {tree / file for file in files} | {(tree / LIB).with_name("mutant.rs")}
    for path in tree.rglob("*.rs"):
        if path not in known:  # of an earlier state: the compiler takes a module's file for the module
            path.unlink()
    for file in files:
        source = (root / file).read_bytes()
        edits = []
        for mutant in mutants:
            if mutant.file == file:
                found = edit(source, mutant)
                if isinstance(found, Edit):
                    edits.append(found)
                else:
                    impossible[mutant.number] = found
        text = woven(source, 0, len(source), edits).encode() if edits else source
        if file == LIB:
            text += b"\npub mod mutant;\n"
        _write(tree / file, text)
    _write((tree / LIB).with_name("mutant.rs"), MODULE.encode())
    return impossible


def _write(path: Path, text: bytes) -> None:
    """What stands there already is not written again, so that it is not compiled again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_bytes() != text:
        path.write_bytes(text)


def edit(source: bytes, mutant: Mutant) -> Edit | str:
    """The edit that plants a mutant, or why there is none."""
    start, end = (_offset(source, place) for place in (mutant.start, mutant.end))
    node = _PARSER.parse(source).root_node.descendant_for_byte_range(start, end)
    assert node is not None
    above = [node]
    while above[-1].parent is not None:
        above.append(above[-1].parent)
    # A function is where what a compiler works out ends, unless it is one itself.
    inside = [one.type for one in above]
    inside = inside[: inside.index("function_item") + 1] if "function_item" in inside else inside
    if not _WORK_OF_COMPILER.isdisjoint(inside):
        return "a constant"
    function = next((one for one in above if one.type == "function_item"), None)
    if function is not None and any(
        child.type == "function_modifiers" and b"const" in (child.text or b"") for child in function.children
    ):
        return "a constant function"
    if "token_tree" in inside:
        return "inside a macro"
    is_living = f"{'crate' if mutant.package == 'knobcore' else 'knobcore'}::mutant::is({mutant.number})"
    match mutant.genre:
        case "FnValue":
            text = f"if {is_living} {{ return {mutant.replacement}; }} {HOLE}"
            return Edit(start, end, _marked(text, mutant), mutant)
        case "BinaryOperator":
            whole = next(one for one in above if one.start_byte < start and one.end_byte > end)
            if whole.type == "let_chain":
                return "in a chain of patterns"
            mutated = source[whole.start_byte : start].decode() + mutant.replacement
            mutated += source[end : whole.end_byte].decode()
        case "UnaryOperator":
            whole = next(one for one in above if one.type == "unary_expression")
            mutated = source[end : whole.end_byte].decode()
        case "StructField":
            whole = next(one for one in above if one.type == "struct_expression")
            rest = source[end : whole.end_byte].decode().lstrip().removeprefix(",")
            mutated = source[whole.start_byte : start].decode() + rest
        case "MatchArmGuard":
            text = f"(if {is_living} {{ {mutant.replacement} }} else {{ {HOLE} }})"
            return Edit(start, end, _marked(text, mutant), mutant)
        case "MatchArm":
            arm = next(one for one in above if one.type == "match_arm")
            pattern = arm.child_by_field_name("pattern")
            assert pattern is not None
            guard = pattern.child_by_field_name("condition")
            if guard is not None:
                text = f"(!{is_living}) && ({HOLE})"
                return Edit(guard.start_byte, guard.end_byte, _marked(text, mutant), mutant)
            text = f"{HOLE} if !{is_living}"
            return Edit(pattern.start_byte, pattern.end_byte, _marked(text, mutant), mutant)
        case _:
            return f"no way to plant a {mutant.genre}"
    if whole.type == "compound_assignment_expr":
        text = f"if {is_living} {{ {mutated}; }} else {{ {HOLE}; }}"
    else:
        text = f"(if {is_living} {{ {mutated} }} else {{ {HOLE} }})"
    return Edit(whole.start_byte, whole.end_byte, _marked(text, mutant), mutant)


def _marked(text: str, mutant: Mutant) -> str:
    """With comments around it, by which an error of the compiler's finds the mutant."""
    return f"/*<{mutant.number}*/{text}/*{mutant.number}>*/"


def _offset(source: bytes, place: tuple[int, int]) -> int:
    """Of a line and a column in characters, the byte."""
    lines = source.split(b"\n")
    return sum(len(line) + 1 for line in lines[: place[0]]) + len(
        lines[place[0]].decode()[: place[1]].encode()
    )


def woven(source: bytes, start: int, end: int, edits: list[Edit]) -> str:
    """The text from start to end with all edits inside, the inner ones in the outer ones' original."""
    text, at = [], start
    outer = sorted(edits, key=lambda one: (one.start, -one.end, one.mutant.number))
    while outer:
        first = outer.pop(0)
        inner = [one for one in outer if one.end <= first.end and one.start >= first.start]
        outer = [one for one in outer if one not in inner]
        original = (
            woven(source, first.start, first.end, inner)
            if inner
            else source[first.start : first.end].decode()
        )
        before, _, after = first.text.partition(HOLE)
        text += [source[at : first.start].decode(), before, original, after]
        at = first.end
    return "".join([*text, source[at:end].decode()])
