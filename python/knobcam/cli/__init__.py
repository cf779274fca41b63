"""The `knobcam` command: what a command answers, how the program ends.

Nothing heavy is imported here: a command imports what it needs when it runs.
"""

from __future__ import annotations

import io
import os
import sys
import warnings
from typing import TYPE_CHECKING

from ..base.ended import Ended, asked, by_exception
from ..base.strict_json import as_json
from ..errors import KnobcamError, KnobcamWarning
from . import (
    batching,
    calibrating,
    capturing,
    catalogue,
    contributing,
    converting,
    demonstrate,
    designing,
    emulating,
    fitting,
    learning,
    recording,
    rendering,
    reporting,
    watching,
    workbench,
)
from .arguments import Parser, VersionAction
from .output import Unfinished, status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .output import Answer

_INTERRUPTED = 130  # what a shell reports for Ctrl-C
_GROUPS = (
    *(capturing, calibrating, recording, fitting, learning, designing, batching),
    *(watching, reporting, rendering, converting, workbench, catalogue, contributing, demonstrate, emulating),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command in `argv` (by default the process's own) and return its exit code.

    0: done. 2: the call or its input is wrong; one line on standard error says what, where and what to do,
    and nothing is written. 1: the program failed.
    """
    if argv is None:
        if sys.stderr is None:
            sys.stderr = io.StringIO()  # what nobody hears
        if sys.stdout is None:  # closed by who started the program, as `>&-` does
            return _end("standard output: is closed; open it, or send it to a file", 2)
        _be_a_process()
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        with by_exception():
            code = _run(words)
            sys.stdout.flush()
    except OSError as error:  # of standard output: a file that cannot be written is an InputError
        # What is still in the buffer would fail once more when Python flushes it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # the reader has seen enough
            return 0
        return _end(f"standard output: cannot be written ({error.strerror or error}); free some space", 2)
    return code


def _run(words: list[str]) -> int:
    try:
        args = command_parser().parse_args(words)
        answer = args.run(args)
    except Ended as ended:
        return _stopped(ended)
    except SystemExit:  # --help and --version
        return 0
    except Unfinished as interrupt:
        _say(interrupt.answer, as_document=args.json)
        return _end(f"interrupted; {interrupt}", _INTERRUPTED)
    except KeyboardInterrupt as interrupt:
        kept = str(interrupt)  # what a recording says that it has saved
        return _end(f"interrupted; {kept}" if kept else "interrupted", _INTERRUPTED)
    except BaseException as error:  # a panic of the core is no Exception
        if (by := asked()) is not None:  # in the midst of an import another error may come of it
            return _stopped(by)
        if "--traceback" in words:
            import traceback

            status(None)
            traceback.print_exc()
        if isinstance(error, KnobcamError):
            return _end(str(error), error.exit_code)
        what = " ".join(f"{type(error).__name__}: {error}".split())
        return _end(f"the program failed ({what}); --traceback shows where, please report it", 1)
    status(None)
    if answer is None or isinstance(answer, int):  # it has said all while it ran
        return answer or 0
    _say(answer, as_document=args.json)
    return int(answer.code)


def _say(answer: Answer, *, as_document: bool) -> None:
    status(None)
    for message in answer.messages:
        print(message, file=sys.stderr)
    print(as_json(answer.document) if as_document else answer.text)


def command_parser() -> Parser:
    """Return the parser of the whole command."""
    parser = Parser(
        prog="knobcam",
        description="A haptic camera: measure a knob, fit its physics, learn which effect is missing.",
        epilog="Every command takes --help and --json.",
    )
    parser.add_argument("--version", action=VersionAction, nargs=0, help="print the version")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for group in _GROUPS:
        group.register(commands)
    return parser


def _stopped(ended: Ended) -> int:
    return _end(str(ended), int(ended.code or 0))


def _end(message: str, code: int) -> int:
    status(None)
    print(f"knobcam: {message}", file=sys.stderr)
    return code


def _be_a_process() -> None:
    """End as others ask for it; print as escapes what the terminal cannot show, no warnings of libraries."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", KnobcamWarning)
        warnings.formatwarning = lambda message, *_, **__: f"knobcam: warning: {message}\n"
