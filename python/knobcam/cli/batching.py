"""`knobcam batch`: many captures, a row each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import arguments
from .output import Answer, status

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "batch", run, "Fit many captures on all cores, into a table with a row each."
    )
    parser.add_argument(
        "sources",
        nargs="+",
        metavar="SOURCES",
        help="folders, patterns, files, Parquet datasets with a column capture, or addresses (s3://...)",
    )
    add_what(parser)
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of Dask, as tcp://host:8786; default the cores of this machine",
    )
    parser.add_argument(
        "--learn",
        choices=("none", "outliers", "all"),
        default="outliers",
        help="look for missing effects in those unlike their lot or beyond limits (default), in all or none",
    )
    parser.add_argument(
        "--hints",
        choices=("all", "none"),
        help="keep how much each capture speaks for every effect, by which lots are compared; default all "
        "where a batch begins with up to 2000 captures",
    )
    parser.add_argument(
        "--count-gone",
        action="store_true",
        help="let rows whose captures are not there any more count in lots and limits, as those that are",
    )
    arguments.add_preparation(parser)
    arguments.add_reading(parser)


def add_what(parser: arguments.Parser) -> None:
    """Add the options that a batch and a station share."""
    parser.add_argument(
        "-o",
        "--output",
        type=arguments.folder,
        required=True,
        metavar="RESULTS",
        help="folder of the table; it goes on",
    )
    parser.add_argument("--model", metavar="MODEL", help="fitted to each; default the base model")
    parser.add_argument("--limits", metavar="FILE", help="TOML with [parameters], [curve.forward], [effects]")


def run(args: Namespace) -> Answer:
    """Make a batch, and say how many captures failed."""
    options: dict[str, Any] = arguments.preparation(args)

    from ..fleet import batch

    result = batch(
        args.sources,
        args.output,
        model=args.model,
        limits=args.limits,
        scheduler=args.scheduler,
        learn=args.learn,
        hints=None if args.hints is None else args.hints == "all",
        count_gone=args.count_gone,
        prepare=args.prepare,
        reading=reading(args),
        progress=status,
        **options,
    )
    failed = [row["error"] for row in result.failed]
    many = len(failed)
    count = (f"{many} of {len(result.asked)} captures failed; their rows say why",) if many else ()
    return Answer(repr(result), result.document(), (*failed[:MOST_ERRORS], *count), 1 if many else 0)


MOST_ERRORS = 20
"""Captures that failed, of which each is said in a line; the table has all."""


def reading(args: Namespace) -> dict[str, Any]:
    """Return what `knobcam.load` takes, of what was given."""
    every = {"map": args.map, **arguments.reading(args)}
    return {name: value for name, value in every.items() if value is not None}
