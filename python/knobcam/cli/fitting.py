"""`knobcam fit` and `knobcam compare`: parameters, and where they fail."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .output import Answer, about, check_file, check_folder, findings, status

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Mapping

    from ..base.showing import Figure
    from ..fit import Fit
    from ..fit.compare import Comparison
    from ..fit.forward import Forward
    from ..model import Model


def register(commands: arguments.Commands) -> None:
    """Add the commands of this file."""
    parser = arguments.add_command(
        commands, "fit", run_fit, "Fit a model: parameters with units and 95 % intervals."
    )
    parser.add_argument(
        "captures",
        nargs="+",
        metavar="CAPTURE",
        help=f"{arguments.FILES}; several of one knob are fitted jointly",
    )
    parser.add_argument("--model", metavar="MODEL", help="model file or knob1 to knob5; default the base")
    parser.add_argument(
        "--detents", choices=("auto", "yes", "no"), default="auto", help="of the base model; default auto"
    )
    parser.add_argument(
        "--free",
        nargs="+",
        action="extend",
        metavar="NAME",
        help="constants in tau of the map, to be fitted: tau='kt/R*(duty*U-ke*omega*on)' --free kt R ke",
    )
    parser.add_argument(
        "--known",
        nargs="+",
        action="extend",
        type=arguments.assignment,
        metavar="PARAMETER=VALUE",
        help="with --free: parameters that are known in N m, of which the first gives what scales the torque",
    )
    arguments.add_output(parser, "model")
    arguments.add_plots(parser)
    arguments.add_preparation(parser)
    arguments.add_reading(parser)

    parser = arguments.add_command(
        commands, "compare", run_compare, "Split the error of a model over position, velocity, time and more."
    )
    arguments.add_captures_and_model(parser, "what the model is held against")
    parser.add_argument("--refit", action="store_true", help="fit the free parameters of the model first")
    parser.add_argument(
        "--forward", action="store_true", help="simulate the motion from the measured torque as well"
    )
    parser.add_argument(
        "--horizon",
        type=arguments.number,
        metavar="S",
        help="with --forward: begin anew from the measured state after each S seconds",
    )
    arguments.add_plots(parser)
    arguments.add_preparation(parser)
    arguments.add_reading(parser)


def run_fit(args: Namespace) -> Answer:
    """Fit a model to captures, write it, draw it."""
    inputs = [*args.captures, *([args.model] if args.model else [])]
    check_file(args.output, inputs)
    check_folder(args.plots, args.output)
    options = arguments.preparation(args)

    from ..fit import fit
    from ..model import Model

    model = Model.load(args.model) if args.model else None
    how: dict[str, Any] = {"prepare": args.prepare, "detents": args.detents}
    if args.free:
        fitted = with_constants(args, model, options, **how)
    else:
        if args.known:
            raise InputError(
                "--known: is of --free, which is not given; in a model file such values are fixed"
            )
        captures = arguments.read_all(args)
        status("fitting")
        with about(*args.captures):
            fitted = fit(captures, model, **how, **options)

    files = kept(args, fitted)
    stuck = fitted.stiction()
    shown = [repr(stuck)] if any(stuck.breakaways) else []
    text = "\n".join([repr(fitted), *shown, *said(files)])
    document = fitted.document() | {"stiction": stuck.document() if shown else None, "files": files}
    return answer(args, text, document, fitted)


def with_constants(args: Namespace, model: Model | None, options: dict[str, float], **how: Any) -> Fit:
    """Fit constants of the map's torque beside the model."""
    from ..fit.constants import fit_constants

    if args.map is None:
        raise InputError("--free: names constants in a formula of tau, and there is no --map; add it")
    known = {}
    for text in args.known or ():
        name, value = (part.strip() for part in text.split("=", 1))
        if name in known:
            raise InputError(f"--known {name} is given twice; leave one out")
        known[name] = arguments.sized(f"--known {name}", value)
    status("fitting")
    own: dict[str, Any] = {"map": args.map, "free": args.free, "known": known, "options": options}
    with about(*args.captures):
        fitted = fit_constants(args.captures, model, **own, **how, **arguments.reading(args))
    if fitted.constants and fitted.constants.unscaled and args.output is not None:
        raise InputError(
            f"{args.output}: what scales the torque is not determined, so there is no model in N m to write; "
            "say what is known, as --known inertia.M=VALUE, or fit in V or A"
        )
    return fitted


def run_compare(args: Namespace) -> Answer:
    """Hold a model against captures, its parameters as they are in the file unless they are refitted."""
    check_folder(args.plots)
    if args.horizon is not None and not args.forward:
        raise InputError("--horizon: is of --forward, which is not asked for; add it, or leave both out")
    options = arguments.preparation(args)

    from ..fit import fit
    from ..model import Model

    model = Model.load(args.model)
    captures = arguments.read_all(args)
    status("comparing")
    with about(*args.captures):
        held = fit(captures, model if args.refit else model.frozen(), prepare=args.prepare, **options)
        comparison = held.compare()
        if args.forward:
            status("simulating")
        forward = held.forward(horizon_s=args.horizon) if args.forward else None

    files: dict[str, object] = {}
    if args.plots is not None:
        files["pictures"] = draw(args, held, comparison, forward)
    document = comparison.document() | {"model": args.model, "refitted": args.refit, "files": files}
    if forward is not None:
        document["forward"] = forward.document()
    shown = [forward.text] if forward is not None else []
    return answer(args, "\n".join([*shown, repr(comparison), *said(files)]), document, held)


def answer(args: Namespace, text: str, document: dict[str, Any], fitted: Fit) -> Answer:
    """Return what a command answers of captures: the document has their paths, the messages findings."""
    for described in (document, document.get("forward", {})):
        for one, path in zip(described.get("captures", []), args.captures, strict=False):
            one["path"] = path
    each = zip(args.captures, fitted.prepared, strict=True)
    notes = [findings(path, signals.capture, signals) for path, signals in each]
    return Answer(text, document, tuple(chain.from_iterable(notes)))


def draw(
    args: Namespace, fitted: Fit, comparison: Comparison | None = None, forward: Forward | None = None
) -> list[str]:
    """Write every picture of a fit where the call wants them, and return the paths."""
    status("drawing")
    from ..show import plot

    drawn = plot.save_all(fitted, args.plots, comparison, forward, kind=args.format)
    return [str(path) for path in drawn]


def kept(args: Namespace, fitted: Fit) -> dict[str, object]:
    """Write the model and the pictures that were asked for, all or none, and return the paths."""
    from ..base.writing import together

    files: dict[str, object] = {}
    with together():
        if args.output is not None:
            files["model"] = str(fitted.model.save(args.output))
        if args.plots is not None:
            files["pictures"] = draw(args, fitted)
    return files


def put(args: Namespace, pictures: Mapping[str, Callable[[], Figure]]) -> list[str]:
    """Write pictures by name where the call wants them, all or none, and return the paths."""
    from ..base.writing import make_folder, together

    paths = [args.plots / f"{name}.{args.format}" for name in pictures]
    with together():
        make_folder(args.plots)
        for path, picture in zip(paths, pictures.values(), strict=True):
            picture().savefig(path)
    return [str(path) for path in paths]


def said(files: dict[str, object]) -> list[str]:
    """Return the lines that name written files."""
    lines = [f"{kind}: {files[kind]}" for kind in ("model", "report", "dfq") if kind in files]
    pictures = files.get("pictures")
    return lines + [f"picture: {path}" for path in pictures] if isinstance(pictures, list) else lines
