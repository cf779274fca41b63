"""`knobcam report`: what a batch found, as one page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from . import arguments
from .fitting import said
from .output import Answer, check_file, check_kind, status

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands,
        "report",
        run,
        "Show what a batch found: one page with pictures, and statistics of its lots.",
    )
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder that knobcam batch wrote")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE.html", help="page to write; default RESULTS.html"
    )
    parser.add_argument(
        "--dfq", type=Path, metavar="FILE.dfq", help="parameters and limits for statistics programs (AQDEF)"
    )


def run(args: Namespace) -> Answer:
    """Write the page, and say what lots and stations tell."""
    from ..base.writing import together
    from ..fleet import BatchResult

    output = args.output or args.results.absolute().with_name(f"{args.results.absolute().name}.html")
    for path in (output, args.dfq):
        if path is not None and path.absolute().is_relative_to(args.results.absolute()):
            raise InputError(f"{path}: is within the table, which is read as a whole; write it elsewhere")
    check_kind(output, "a report", ".html", ".htm")
    status("reading the results")
    result = BatchResult.read(args.results)
    check_file(output)
    check_file(args.dfq)
    status("comparing lots")
    study = result.study
    status("drawing")
    with together():
        files: dict[str, object] = {"report": str(result.report(output))}
        if args.dfq is not None:
            files["dfq"] = str(result.dfq(args.dfq))
    text = "\n".join([repr(result), *study.said, *said(files)])
    document = result.document() | {"schema": "knobcam.report/1", "study": study.document()}
    return Answer(text, document | {"files": files})
