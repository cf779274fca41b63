"""The reference of the `knobcam` command, from the parsers that read its arguments."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from knobcam.cli import command_parser

WIDTH = 88
HIDDEN = {"help", "json", "traceback"}
"""Options of every command, which the page tells once."""


def commands() -> str:
    """Return a section for each command: what it does, how it is called, its arguments in tables."""
    # argparse has no public way from a parser to its groups and sub-commands.
    groups = command_parser()._action_groups
    every = next(action for group in groups for action in group._group_actions if action.choices)
    return "\n".join(line for parser in dict(every.choices or {}).values() for line in _section(parser))


def _section(parser: argparse.ArgumentParser) -> Iterator[str]:
    yield from (f"## {parser.prog}", "", parser.description or "", "")
    yield from ("```text", _usage(parser), "```", "")
    rows = [_row(action) for group in parser._action_groups for action in group._group_actions]
    rows = [row for row in rows if row]
    if rows:
        yield from ("| argument | is |", "|---|---|", *rows, "")


def _usage(parser: argparse.ArgumentParser) -> str:
    """How it is called, without the options of every command; a line ends at no place inside of brackets."""
    usage = " ".join(parser.format_usage().removeprefix("usage: ").split())
    words = re.findall(r"\[(?:[^][]|\[[^]]*\])*\]|-\S+ \S+|\S+", usage)
    shown = [word for word in words if word not in ("[-h]", "[--json]", "[--traceback]")]
    lines = [shown[0]]
    for word in shown[1:]:
        if len(lines[-1]) + len(word) < WIDTH:
            lines[-1] += f" {word}"
        else:
            lines.append(f"    {word}")
    return "\n".join(lines)


def _row(action: argparse.Action) -> str:
    if action.dest in HIDDEN:
        return ""
    choices = "{" + ",".join(map(str, action.choices)) + "}" if action.choices else None
    value = action.metavar or choices or action.dest.upper()
    takes = "" if action.nargs == 0 else f" {value}" + (" ..." if action.nargs in ("+", "*") else "")
    names = ", ".join(f"`{name}{takes}`" for name in action.option_strings) or f"`{takes.strip()}`"
    return f"| {names} | {(action.help or '').replace('|', '&#124;')} |"
