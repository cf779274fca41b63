"""`knobcam watch`: a folder at a station, a line of JSON for each part."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from ..base.strict_json import as_json
from . import arguments
from .batching import add_what, reading

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "watch", run, "Judge each capture as its file is complete: a line of JSON a part."
    )
    parser.add_argument(
        "folder", type=arguments.folder, metavar="FOLDER", help="where the station puts its captures"
    )
    add_what(parser)
    parser.add_argument(
        "--learn",
        choices=("none", "outliers", "all"),
        default="outliers",
        help="look for missing effects where more than chance is left or a limit is passed (default), or not",
    )
    parser.add_argument(
        "--patience",
        type=arguments.number,
        default=5.0,
        metavar="S",
        help="how long a file may stand still that cannot be read or is still open, before it is told; "
        "default 5 s",
    )
    parser.add_argument("--once", action="store_true", help="end with what is there now, in place of Ctrl-C")
    arguments.add_preparation(parser)
    arguments.add_reading(parser)


def run(args: Namespace) -> int:
    """Say each part's verdict as it is known, until Ctrl-C; then make the table."""
    options: dict[str, Any] = arguments.preparation(args)

    from ..fleet.watch import Watch, document

    watch = Watch.of(
        args.folder,
        args.output,
        model=args.model,
        limits=args.limits,
        learn=args.learn,
        patience_s=args.patience,
        prepare=args.prepare,
        reading=reading(args),
        **options,
    )
    lines = sys.stderr if args.json else sys.stdout  # which then has one document alone
    try:
        for row in watch.rows(once=args.once):
            print(as_json(document(row), None), file=lines, flush=True)
    except KeyboardInterrupt:  # which is how a station is closed
        pass
    finally:
        result = watch.finish()
    if args.json:
        print(as_json(result.document()))
    print(result.headline, file=sys.stderr)
    return 1 if any(row["capture"] in watch.fresh for row in result.failed) else 0
