"""`knobcam next`: the motion that would tell apart what captures cannot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from . import arguments
from .fitting import answer, put, said
from .output import about, check_file, check_folder, status

if TYPE_CHECKING:
    from argparse import Namespace

    from .output import Answer


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "next", run_next, "Design the motion that tells apart what captures cannot, within limits."
    )
    arguments.add_captures(parser, "several are of one knob")
    parser.add_argument(
        "--rivals",
        metavar="A,B",
        help="effects, or sets as A+B, to be told apart (base: none); default what cannot be told now",
    )
    parser.add_argument(
        "--sharpen", metavar="PARAMETER", help="in place of rivals: to be known best, as inertia.M"
    )
    parser.add_argument(
        "--limits", metavar="FILE", help="TOML with torque_Nm, omega_rad_s ...; default what was reached"
    )
    parser.add_argument(
        "--by-hand", action="store_true", help="only what a hand can make, without a motor: no waves"
    )
    arguments.add_output(parser, "motion")
    arguments.add_plots(parser)
    arguments.add_preparation(parser)
    arguments.add_reading(parser)


def run_next(args: Namespace) -> Answer:
    """Learn what captures tell, and design the motion for the rest."""
    inputs = [*args.captures, *([args.limits] if args.limits else [])]
    check_file(args.output, inputs)
    check_folder(args.plots, args.output)
    _check(args)
    options = arguments.preparation(args)
    rivals = [] if args.rivals is None else [one.strip() for one in args.rivals.split(",")]

    from ..base.writing import together
    from ..capture.by_hand import by_hand, hand_can, in_words
    from ..learn import learn
    from ..learn.contenders import check_rivals
    from ..learn.designing import next_experiment
    from ..learn.limits import Limits
    from ..learn.sharpening import check_sharpen

    # What is wrong with the call is said before the minutes that learning may take.
    if args.limits is not None:
        Limits.load(args.limits, Limits.furthest())
    captures = arguments.read_all(args)
    check_rivals(rivals, captures[0].coordinate)
    if args.sharpen is not None:
        check_sharpen(args.sharpen, captures[0].coordinate)
    with about(*args.captures):
        story = learn(captures, prepare=args.prepare, progress=status, **options)
    designed = next_experiment(
        story, rivals=rivals, sharpen=args.sharpen, limits=args.limits, by_hand=args.by_hand, progress=status
    )
    files: dict[str, object] = {}
    with together():
        if args.output is not None:
            files["motion"] = str(designed.save(args.output))
        if args.plots is not None:
            files["pictures"] = put(args, {"experiment": designed.plot})
    steps = by_hand(designed.plan, story.model.coordinate)
    hand = {"possible": hand_can(steps), "steps": [one._asdict() for one in steps]}
    lines = [repr(designed), in_words(steps)]
    lines += [*([f"motion: {files['motion']}"] if "motion" in files else []), *said(files)]
    document = designed.document() | {"by_hand": hand, "files": files}
    return answer(args, "\n".join(lines), document, story.fit)


def _check(args: Namespace) -> None:
    if args.output is not None and Path(args.output).suffix.lower() != ".toml":
        raise InputError(f"{args.output}: a motion file ends in .toml; choose another name")
    if args.rivals is not None and args.sharpen is not None:
        raise InputError("--sharpen: is in place of --rivals; leave one out")
    if args.rivals is not None and not all(one.strip() for one in args.rivals.split(",")):
        raise InputError(f"--rivals {args.rivals!r}: names nothing between commas; write A,B")
