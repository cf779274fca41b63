"""Options that several commands share, and a parser whose complaints are one line."""

from __future__ import annotations

import argparse
import math
import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from ..base.meant import meant
from ..base.reading import is_folder
from ..errors import InputError
from .examples import EXAMPLES
from .output import status

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..capture import Capture
    from ..rig.link import Clears
    from .output import Answer

    Commands = argparse._SubParsersAction[Any]  # argparse has no public name for it


PICTURES = ("png", "svg", "pdf")
"""The kinds of pictures that are written."""

_CHOICE = re.compile(
    r"argument (?P<what>.*): invalid choice: '?(?P<word>.*?)'? \(choose from (?P<known>.*)\)"
)

FILES = "a capture, or a log with its columns (CSV, .mat, .npz, JSON, Parquet ...)"
"""What may be named where captures are."""

_LARGEST = 2**53  # whole numbers that a program of any language tells apart


class Parser(argparse.ArgumentParser):
    """An argument parser that raises what is wrong with the call as InputError."""

    def __init__(self, **settings: Any) -> None:
        # Abbreviations would tie scripts to the options of today.
        super().__init__(allow_abbrev=False, **settings)
        self.by_place: list[argparse.Action] = []
        self.behind: bool | None = None
        """Whether a model must stand behind the captures, if none is given by its option; None: none may."""
        self.command = False
        """Whether it is that of a command, behind which nothing else comes."""
        self.instead: tuple[str, str] | None = None
        """An option, and the word before the captures that it stands for: there is no such word then."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Ask for no model by its place where it is given by its option; a folder of runs is its captures."""
        if any(word.partition("=")[0] == "--model" for word in args or ()):
            for one in self.by_place:
                one.nargs, one.required = "?", False
        found, rest = super().parse_known_args(args, namespace)
        if self.command and rest:
            word = next((one for one in rest if one.startswith("-")), "").partition("=")[0]
            near = meant(word, self._option_string_actions) if word else ""
            self.error(f"unrecognized arguments: {' '.join(rest)}{f'; {near}' if near else ''}")
        if self.instead is not None and getattr(found, self.instead[0]) is not None:
            found.captures = [getattr(found, self.instead[1]), *found.captures]
            setattr(found, self.instead[1], None)
        if self.behind is not None:
            self._part_model(found)
        if getattr(found, "captures", None):
            found.captures = [run for path in found.captures for run in _runs(path)]
        return found, rest

    def _part_model(self, args: argparse.Namespace) -> None:
        """Take the model behind the captures for what it is."""
        from ..model import Model

        *captures, last = args.captures
        if args.model is None and captures and (self.behind or Model.is_named(last)):
            args.captures, args.model = captures, last
        elif args.model is None and self.behind:
            self.error("the following arguments are required: MODEL")
        elif args.model is not None and captures and Model.is_named(last):
            self.error(f"MODEL is given twice, {last} and {args.model}; leave one out")

    def error(self, message: str) -> NoReturn:
        """Raise `message` with the place to look."""
        if wrong := _CHOICE.fullmatch(message):
            known = [one.strip(" '") for one in wrong["known"].split(",")]
            near = meant(wrong["word"], known) or f"choose {', '.join(known)}"
            message = f"{wrong['what']}: '{wrong['word']}' is none that there is; {near}"
        raise InputError(f"{message}; see {self.prog} --help")


def _runs(path: str) -> list[str]:
    if not is_folder(path):
        return [path]
    from ..capture.formats import runs_in

    return [str(run) for run in runs_in(Path(path))] or [path]


class _Given(argparse.Action):
    """Takes what may come in two forms; both at once are refused."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, value: Any, *_: Any
    ) -> None:
        """Keep the value."""
        if getattr(namespace, self.dest, None) is not None:
            parser.error(f"{self.metavar} is given twice, by its place and by --{self.dest}; leave one out")
        setattr(namespace, self.dest, value)


class VersionAction(argparse.Action):
    """Prints the version; reads it only then, because it is the core's."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print and end, as --help does."""
        from .._core import __version__

        print(f"knobcam {__version__}")
        parser.exit()


def add_command(
    commands: Commands, name: str, run: Callable[[argparse.Namespace], Answer | int | None], about: str
) -> Parser:
    """Return the parser of a new command, with what every command takes."""
    example = f"Example: {EXAMPLES[name]}"
    parser: Parser = commands.add_parser(
        name, help=about.replace("%", "%%"), description=about, epilog=example.replace("%", "%%")
    )
    parser.set_defaults(run=run)
    parser.command = True
    parser.add_argument("--json", action="store_true", help="print one JSON document instead of text")
    parser.add_argument("--traceback", action="store_true", help="show where an error arose")
    return parser


def add_captures(parser: argparse.ArgumentParser, about: str, number: str = "+") -> None:
    """Add CAPTURE, one or several, or also none."""
    parser.add_argument("captures", nargs=number, metavar="CAPTURE", help=f"{FILES}; {about}")


def add_captures_and_model(parser: Parser, about: str, default: str | None = None) -> None:
    """Add CAPTURE, one or several, and MODEL behind them or by its option, or by default what is said."""
    add_captures(parser, f"{about}; several are of one knob. The last of two or more may be MODEL")
    needed = f"default {default}" if default else "needed, here or behind the captures"
    parser.add_argument("--model", metavar="MODEL", help=f"model file, or knob1 to knob5; {needed}")
    parser.behind = default is None


def add_model(parser: Parser, about: str, required: bool = True) -> None:
    """Add MODEL, which can be given by its place or, as in the commands of several captures, by `--model`."""
    both: dict[str, Any] = {"action": _Given, "metavar": "MODEL"}
    by_place = parser.add_argument(
        "model", nargs=None if required else "?", default=argparse.SUPPRESS, help=about, **both
    )
    parser.add_argument("--model", help="the same as MODEL", **both)
    parser.by_place.append(by_place)


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how a foreign file becomes a capture."""
    group = parser.add_argument_group("reading")
    group.add_argument(
        "--map",
        nargs="+",
        action="extend",
        type=assignment,
        metavar="COLUMN=EXPRESSION",
        help="t, theta, omega, alpha, tau from columns of the file: t=c0 'theta=enc/8192 [turn]' tau=35*i",
    )
    group.add_argument(
        "--coordinate",
        choices=("rotary", "linear"),
        help="whether the axis turns or slides; default by the units",
    )
    group.add_argument("--rate", type=number, metavar="HZ", help="sampling rate, for a file without times")
    group.add_argument("--joint", metavar="NAME", help="one of several in a bag or a log")
    group.add_argument(
        "--kt", type=number, metavar="NM_A", help="N m/A of a motor: torque of its current in A"
    )
    group.add_argument(
        "--resistance", type=number, metavar="OHM", help="beside --kt: torque of its voltage in V"
    )
    group.add_argument(
        "--limit",
        choices=("sensor", "actuator"),
        help="whether a torque that sits at its extreme is at the limit of its sensor, and masked, or of the "
        "actuator; default the actuator in A, V or duty",
    )
    group.add_argument(
        "--overrule",
        nargs="+",
        action="extend",
        metavar="KIND:COLUMN",
        help="leave a finding of the quality check undone: wrap:theta, clipped:tau, spike:tau",
    )
    group.add_argument(
        "--leave-out",
        nargs="+",
        action="extend",
        type=stretch,
        metavar="S:S",
        help="mask what lies between two times, as 3.2:4.1, where a hand touched the knob, say",
    )
    group.add_argument("--start", type=number, metavar="S", help="leave out what is before this time")
    group.add_argument("--end", type=number, metavar="S", help="leave out what is after this time")


def read(path: str, args: argparse.Namespace) -> Capture:
    """Return the capture in a file, read as the options say."""
    from ..capture import load

    return load(path, map=args.map, **reading(args))


def read_all(args: argparse.Namespace) -> list[Capture]:
    """Return the captures of a call, several by the names of their files; show which is being read."""
    captures = []
    for path in args.captures:
        status(f"reading {path}")
        captures.append(read(path, args))
    if len(captures) == 1:
        return captures
    from dataclasses import replace

    named = zip(captures, args.captures, strict=True)
    return [replace(one, meta={**one.meta, "source": str(path)}) for one, path in named]


def reading(args: argparse.Namespace) -> dict[str, Any]:
    """Return the options of `knobcam.load` that `add_reading` adds, but for the map."""
    options = {"coordinate": args.coordinate, "rate_hz": args.rate, "joint": args.joint}
    options |= {"kt": args.kt, "resistance_ohm": args.resistance, "limit": args.limit}
    options |= {"overrule": args.overrule} if args.overrule else {}
    options |= {"leave_out": args.leave_out} if args.leave_out else {}
    return options | {"start": args.start, "end": args.end}


def add_preparation(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how signals are prepared."""
    group = parser.add_argument_group("preparation")
    group.add_argument(
        "--prepare",
        default="smooth",
        metavar="METHOD",
        help="how motion and torque are filtered: smooth (default), paper, differences or none",
    )
    group.add_argument(
        "--option",
        nargs="+",
        action="extend",
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help="settings of that: torque_edge_hz, motion_edge_hz, cutoff_hz, decimate",
    )


def preparation(args: argparse.Namespace) -> dict[str, Any]:
    """Return the options of the preparation, checked before a file is read."""
    options: dict[str, float] = {}
    for text in args.option:
        name, value = (part.strip() for part in text.split("=", 1))
        if name in options:
            raise InputError(f"--option {name} is given twice; leave one out")
        options[name] = sized(f"--option {name}", value)
    from ..capture.prepare import check_options

    check_options(args.prepare, options)
    return options


def add_output(parser: argparse.ArgumentParser, what: str, required: bool = False) -> None:
    """Add `-o`, the file that the command writes."""
    parser.add_argument(
        "-o", "--output", type=Path, required=required, metavar=what.upper(), help=f"{what} to write"
    )


def add_plots(parser: argparse.ArgumentParser) -> None:
    """Add `--plots`, the folder for pictures, and `--format`, their kind."""
    parser.add_argument("--plots", type=Path, metavar="FOLDER", help="folder for pictures, made if need be")
    parser.add_argument(
        "--format",
        choices=PICTURES,
        default="png",
        help="of the pictures; default png",
    )


def add_fault(parser: argparse._ActionsContainer) -> None:
    """Add `--clear-fault`, for a rig that has latched one."""
    parser.add_argument(
        "--clear-fault", action="store_true", help="clear what the rig has latched; default: say it, and ask"
    )


def clear_fault(args: argparse.Namespace) -> Clears:
    """Return whether a fault is cleared: as the option says, or as a person at the terminal does."""
    return bool(args.clear_fault) or (_asked if sys.stdin.isatty() and sys.stderr.isatty() else False)


def _asked(fault: str) -> bool:
    status(None)
    sys.stderr.write(f"knobcam: {fault}\nClear it and go on? [y/N] ")
    sys.stderr.flush()
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def sized(what: str, text: str) -> float:
    """Return the number that is given for one of several names."""
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{what}: {text!r} is no number; give one in SI") from None


def folder(text: str) -> Path:
    """Return a folder for argparse; an empty name would be the one that the shell is in."""
    if not text:
        raise argparse.ArgumentTypeError("'' names no folder; is a variable of the shell empty?")
    return Path(text)


def number(text: str) -> float:
    """Return a number for argparse, which names the option when there is none."""
    with suppress(ValueError):
        if not math.isnan(value := float(text)):
            return value
    raise argparse.ArgumentTypeError(f"{text!r} is no number")


def stretch(text: str) -> tuple[float, float]:
    """Return two times for argparse."""
    first, colon, last = text.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError(f"{text!r} is no stretch of time; write it as 3.2:4.1")
    return number(first), number(last)


def whole(text: str) -> int:
    """Return a whole number from 0 for argparse."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number from 0")
    if int(text) > _LARGEST:
        raise argparse.ArgumentTypeError(f"{text!r} is too large; the most is {_LARGEST}")
    return int(text)


def assignment(text: str) -> str:
    """Return `text` if it assigns something: a file name behind a list of assignments would join it."""
    if "=" not in text:
        raise argparse.ArgumentTypeError(f"{text!r} assigns nothing; write NAME=..., and files in front")
    return text
