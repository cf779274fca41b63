"""`knobcam workbench`: the loop of `learn` by hand and eye, in a browser."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .output import Answer, status

if TYPE_CHECKING:
    from argparse import Namespace

    from ..workbench.bench import Bench
    from ..workbench.tree import Start

_LEADS = """<!doctype html>
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}">
<title>knobcam</title>
<p>To <a href="{address}">the workbench</a>.</p>
"""


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands,
        "workbench",
        run,
        "Open the page on which a model is completed by hand and eye; its first line is the address.",
    )
    parser.add_argument(
        "captures", nargs="*", metavar="CAPTURE", help=f"{arguments.FILES}; several are of one knob"
    )
    parser.add_argument(
        "--port", type=arguments.whole, default=0, metavar="N", help="on this machine; default any free one"
    )
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    parser.add_argument(
        "--continue",
        dest="go_on",
        action="store_true",
        help="go on where the last session was left",
    )
    parser.add_argument("--model", metavar="MODEL", help="to start from; default the base")
    arguments.add_reading(parser)
    arguments.add_preparation(parser)


def run(args: Namespace) -> Answer:
    """Serve until interrupted."""
    from ..base.optional import require

    for package in ("starlette", "uvicorn"):
        require(package, "the workbench", "all")

    import tempfile

    from ..base.writing import remove_parts
    from ..workbench.bench import Bench
    from ..workbench.journal import usual_folder
    from ..workbench.serving import serve

    if args.go_on and (args.captures or args.model):
        raise InputError("--continue goes on with the captures and the model of then; leave others out")
    bench = Bench(_start(args), usual_folder())
    try:
        if args.captures:
            _open(bench, args)
        elif args.go_on:
            _go_on(bench)
        _tell_what_was_left(bench)
        with tempfile.TemporaryDirectory(prefix="knobcam-") as folder:

            def tell(address: str) -> None:
                print(address, flush=True)
                status("Ctrl-C ends the workbench")
                if not args.no_browser:
                    threading.Thread(target=_show, args=(address, Path(folder)), daemon=True).start()

            serve(bench, args.port, tell)
    finally:
        status(None)
        bench.end()
        if bench.busy:  # nobody wants to wait for what is given up, and the core cannot be interrupted
            remove_parts()
    if bench.busy:
        sys.stdout.flush()
        os._exit(0)
    bench.close()
    return Answer("", {"schema": "knobcam.workbench/1"})


def _open(bench: Bench, args: Namespace) -> None:
    """Open captures; a log whose columns have to be named is left to the page, which asks for them.

    Raises InputError for what is no log, or is read as it was asked for and still none.
    """
    from ..capture.formats import DEFAULT_MAX_BYTES
    from ..workbench.preview import Unmapped, explained

    asked = arguments.reading(args)
    try:
        bench.session.open(*args.captures, map=args.map, **asked)
    except InputError as error:
        named = args.map or any(value is not None for value in asked.values())
        unclear = (explained(error, Path(one), {}, DEFAULT_MAX_BYTES) for one in args.captures)
        if named or not any(isinstance(one, Unmapped) for one in unclear):
            raise
        bench.unread = [str(Path(one).absolute()) for one in args.captures]
        print(f"knobcam: {error}; the page asks for it, too", file=sys.stderr)


def _go_on(bench: Bench) -> None:
    newest = bench.keeper and bench.keeper.newest
    if not newest:
        raise InputError("--continue: there is no session that was left; start one without it")
    bench.go_on(newest, lambda what, *_, **__: status(what))
    for note in bench.document()["notes"]:
        print(f"knobcam: {note}", file=sys.stderr)


def _tell_what_was_left(bench: Bench) -> None:
    """Say of the last session that it can go on, where nobody ended it, or why it cannot."""
    left = bench.keeper.left[:1] if bench.keeper is not None else []
    for one in left:
        if one["wrong"] is not None:
            print(f"knobcam: {one['wrong']}", file=sys.stderr)
        elif not one["ended"] and not bench.session.captures:
            what = f"{', '.join(one['captures'])}; fits: {one['steps']}"
            said = f"a session broke off ({what}); the page offers it, and so does --continue"
            print(f"knobcam: {said}", file=sys.stderr)


def _start(args: Namespace) -> Start:
    from ..model import Model
    from ..workbench.tree import Start

    options: dict[str, Any] = arguments.preparation(args)
    if options or args.prepare != "smooth":
        options["prepare"] = args.prepare
    if not args.model:
        return Start(options=options)
    model = Model.load(args.model)
    # A file may be read again from another folder; the five knobs have names alone.
    path = Path(args.model)
    return Start(model, str(path.absolute()) if path.exists() else args.model, options)


def _show(address: str, folder: Path) -> None:
    """Lead the browser to an address by a file in a folder that no other user may enter.

    The address has the token in it, and every user of a machine can read every command line.
    """
    import html
    import webbrowser

    from ..base.writing import write

    page = write(folder / "workbench.html", _LEADS.format(address=html.escape(address)))
    webbrowser.open(page.as_uri())
