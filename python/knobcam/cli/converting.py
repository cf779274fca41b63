"""`knobcam convert`: a model of what a motor was given, as one of its torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import arguments
from .output import Answer, check_file

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "convert", run_convert, "Write a model in A or V, fitted to a motor, as one in N m."
    )
    arguments.add_model(parser, "model file")
    parser.add_argument(
        "--kt",
        type=arguments.number,
        required=True,
        metavar="NM_A",
        help="the motor's torque constant, N m/A",
    )
    parser.add_argument(
        "--resistance", type=arguments.number, metavar="OHM", help="of its winding, for a model in V"
    )
    arguments.add_output(parser, "model", required=True)


def run_convert(args: Namespace) -> Answer:
    """Convert a model and write it."""
    from ..model import Model

    check_file(args.output, [args.model])
    model = Model.load(args.model)
    converted = model.as_torque(kt=args.kt, resistance_ohm=args.resistance)
    path = converted.save(args.output)
    document = {
        "schema": "knobcam.convert/1",
        "model": args.model,
        "kt": args.kt,
        "resistance_ohm": args.resistance,
        "unit": converted.torque_unit,
        "params": {p.name: {"value": p.value, "unit": p.unit} for p in converted.params.values()},
        "files": {"model": str(path)},
    }
    return Answer(f"{converted!r}\nmodel: {path}", document)
