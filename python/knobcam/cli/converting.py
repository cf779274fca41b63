"""`knobcam convert`: a model in another form, and one of what a motor was given as one of its torque."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .fitting import put, said
from .output import Answer, check_file, check_folder, status

if TYPE_CHECKING:
    from argparse import Namespace

    from ..model import Model

FORMS = ("mujoco", "c", "fmu", "cogging-table", "urdf", "modelica")
"""What `--to` takes: the keys of `knobcam.render.convert.TARGETS`, without loading it."""


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands,
        "convert",
        run_convert,
        "Write a model in another form, with what becomes of each effect there; without --to, one in A or V, "
        "fitted to a motor, as one in N m.",
    )
    arguments.add_model(parser, "model file, or knob1 to knob5")
    parser.add_argument("--to", choices=FORMS, metavar="FORM", help=f"{', '.join(FORMS)}")
    parser.add_argument(
        "--without",
        nargs="+",
        action="extend",
        default=[],
        metavar="EFFECT",
        help="leave these out; `impossible`: all that have no place there",
    )
    parser.add_argument(
        "--motion",
        default="sweep",
        help="on which the error is foretold and measured: sweep, multisine, turns, hand, micro, or a file",
    )
    parser.add_argument("--rate", type=arguments.number, default=5000.0, metavar="HZ", help="default 5000 Hz")
    parser.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="version of a unit of FMI; default 2"
    )
    parser.add_argument(
        "--kt", type=arguments.number, metavar="NM_A", help="the motor's torque constant, N m/A"
    )
    parser.add_argument(
        "--resistance", type=arguments.number, metavar="OHM", help="of its winding, for a model in V"
    )
    arguments.add_output(parser, "file", required=True)
    arguments.add_plots(parser)


def run_convert(args: Namespace) -> Answer:
    """Convert a model and write it."""
    from ..capture.formats.units import GIVEN
    from ..model import Model

    check_file(args.output, [args.model])
    model = Model.load(args.model)
    if args.to is None:
        return _as_torque(args, model)
    if model.torque_unit in GIVEN and args.kt is not None:
        model = model.as_torque(kt=args.kt, resistance_ohm=args.resistance)
    elif args.resistance is not None:
        raise InputError("--resistance: is for a model in V; leave it out")
    return _to(args, model)


def _to(args: Namespace, model: Model) -> Answer:
    """Write the model in another form."""
    from ..base.writing import together
    from ..render.convert import convert

    check_folder(args.plots, args.output)
    if args.to == "fmu" and args.output.suffix.lower() != ".fmu":
        raise InputError(
            f"{args.output}: a unit of FMI ends in .fmu, by which it is known; choose another name"
        )
    status("converting")
    conversion = convert(
        model,
        args.to,
        without=args.without,
        motion=args.motion,
        rate_hz=args.rate,
        kt=args.kt,
        suffix=args.output.suffix,
        fmi=args.fmi,
    )
    with together():
        files: dict[str, object] = {"model": str(conversion.save(args.output))}
        if args.plots is not None:
            files["pictures"] = put(args, {"converted": conversion.plot})
    document = {"schema": "knobcam.convert/1", "model": args.model, **conversion.document(), "files": files}
    return Answer("\n".join([repr(conversion), *said(files)]), document)


def _as_torque(args: Namespace, model: Model) -> Answer:
    """Write a model in A or V as one in N m."""
    _alone(args)
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


def _alone(args: Namespace) -> None:
    """Refuse what belongs to another form where none is asked for."""
    usual: dict[str, Any] = {"without": [], "motion": "sweep", "rate": 5000.0, "fmi": 2, "plots": None}
    for name, value in usual.items():
        if getattr(args, name) != value:
            raise InputError(f"--{name}: belongs to another form; name it with --to")
    if args.kt is None:
        raise InputError(
            f"--to or --kt is needed: one of {', '.join(FORMS)}, or the torque constant of a motor"
        )
