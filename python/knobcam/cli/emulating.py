"""`knobcam emulate`: a rig for those who have none."""

from __future__ import annotations

import contextlib
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.strict_json import as_json
from . import arguments
from .output import status

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "emulate", run, "Run an emulated rig; its first line is the port to capture from."
    )
    arguments.add_model(parser, "model file, or knob1 to knob5; default knob3", required=False)
    parser.add_argument(
        "--effect", action="append", default=[], metavar="ID", help="hide it in the knob; may be repeated"
    )
    parser.add_argument("--fixture", default="knob", help="what is in the gripper: knob, free or anchor")
    parser.add_argument(
        "--seed", type=arguments.whole, default=0, metavar="N", help="of noise and serial number"
    )
    parser.add_argument("--noise", choices=("rig", "none"), default="rig", help="of the sensors")
    parser.add_argument(
        "--speed", type=arguments.number, default=1.0, metavar="X", help="times real time; default 1"
    )
    parser.add_argument(
        "--c-cal",
        type=arguments.number,
        default=1148.0,
        metavar="C",
        help="of the accelerometer, (rad/s^2)/V",
    )
    parser.add_argument(
        "--motion", metavar="NAME", help="what its hand does: sweep, multisine ... or a file (.toml)"
    )
    parser.add_argument("--link", type=Path, metavar="PATH", help="make this a symbolic link to the port")
    parser.add_argument("--leashed", action="store_true", help="end when standard input is closed")


def run(args: Namespace) -> None:
    """Serve until interrupted; all that it says comes first."""
    from ..rig.emulator import Emulation, serve

    emulation = Emulation(
        args.model or "knob3",
        tuple(args.effect),
        args.fixture,
        args.seed,
        args.speed,
        args.c_cal,
        args.noise == "rig",
        args.motion,
    )

    def tell(port: str) -> None:
        document = {"schema": "knobcam.emulate/1", "port": port, "serial": emulation.serial_number}
        print(as_json(document) if args.json else port, flush=True)
        status(f"emulating {emulation.serial_number}; Ctrl-C ends it")

    # Whoever ends it, the link goes.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with contextlib.suppress(KeyboardInterrupt):
        serve(emulation, link=args.link, tell=tell, leash=sys.stdin.fileno() if args.leashed else None)
