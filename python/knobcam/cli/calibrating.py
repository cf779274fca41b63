"""`knobcam calibrate`: the sensor tests of a rig."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .output import Answer, check_file, check_folder, status

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "calibrate", run, "Test the sensors of a rig; captures use the result from then on."
    )
    parser.add_argument("--port", required=True, metavar="PORT", help="of the rig, such as /dev/ttyACM0")
    parser.add_argument("--baud", type=arguments.whole, metavar="N", help="of a port that needs one")
    parser.add_argument(
        "--test",
        choices=("spatial", "torque"),
        default="spatial",
        help="spatial: with nothing in the gripper; torque: with the gripper anchored",
    )
    parser.add_argument(
        "--runs", type=arguments.whole, default=3, metavar="N", help="default 3, as in the paper"
    )
    parser.add_argument("--logs", type=Path, metavar="FOLDER", help="keep the wire logs of the runs there")
    arguments.add_fault(parser)
    arguments.add_plots(parser)
    arguments.add_output(parser, "file")


def run(args: Namespace) -> Answer:
    """Run a test, merge it with what is known of the rig, keep it."""
    from ..base.writing import make_folder, together
    from ..rig.calibrate import calibrate
    from ..rig.calibration import Calibration, usual_path
    from ..rig.port import BAUD

    if args.output is not None:
        check_file(args.output, [])
    for folder in (args.plots, args.logs):
        if folder is not None:
            check_folder(folder)
    found = calibrate(
        args.port,
        args.test,
        runs=args.runs,
        logs=args.logs,
        baud=args.baud or BAUD,
        clear_fault=arguments.clear_fault(args),
        progress=status,
    )
    target = args.output or usual_path(found.serial)
    known = Calibration.load(target) if target.is_file() else None
    if known is not None and known.serial == found.serial:
        found = known.merged(found)
    with together():
        files = {"calibration": str(found.save(target))}
        if args.plots is not None:
            make_folder(args.plots)
            picture = args.plots / f"calibration.{args.format}"
            found.plot().savefig(picture, dpi=130)
            files["picture"] = str(picture)
    return Answer(f"{found!r}\nkept in {target}", found.document() | {"files": files})
