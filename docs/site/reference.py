"""What pages take from elsewhere: docstrings of the package, example scripts, figures of BENCHMARKS.md."""

from __future__ import annotations

import ast
import inspect
from importlib import import_module

from pages import MEASURED, ROOT


def names(words: list[str]) -> str:
    """Return the reference of public names, such as `knobcam.fit`, from their docstrings."""
    lines = ["```{eval-rst}"]
    for word in words:
        module, _, name = word.rpartition(".")
        thing = getattr(import_module(module), name)
        kind = "function"
        if inspect.isclass(thing):
            kind = "exception" if issubclass(thing, Exception) else "class"
        lines += ["", f".. auto{kind}:: {word}"]
    return "\n".join([*lines, "```"])


def examples() -> str:
    """Return the example scripts, each with its own description and its code."""
    lines: list[str] = []
    for path in sorted((ROOT / "examples").glob("*.py")):
        text = path.read_text("utf-8")
        code = text.partition('"""\n\n')[2]
        lines += [f"## {path.name}", "", ast.get_docstring(ast.parse(text)) or "", ""]
        lines += ["```python", code.strip(), "```", ""]
    return "\n".join(lines)


def measured(words: list[str]) -> str:
    """Return what stands under a heading of BENCHMARKS.md."""
    title = " ".join(words)
    _, found, rest = MEASURED.read_text("utf-8").partition(f"\n## {title}\n")
    if not found:
        raise LookupError(f"{MEASURED.name}: has no section {title!r}")
    return rest.partition("\n## ")[0].strip()


def exam(words: list[str]) -> str:
    """Return the part of the examination's figures that begins with a word; columns become a table."""
    _, _, block = measured(["Knobs with something hidden in them"]).partition("```\n")
    parts = block.strip("`\n").split("\n\n")
    head, *rows = next(part for part in parts if part.split()[0] == words[0]).splitlines()
    if "|" not in head:
        return "\n".join(["```text", *rows, "```"])
    lines = [head, "|".join("---" for _ in head.split("|")), *rows]
    return "\n".join(f"| {line} |" for line in lines)
