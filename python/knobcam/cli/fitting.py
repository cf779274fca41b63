"""`knobcam fit` and `knobcam compare`: parameters, and where they fail."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from . import arguments
from .output import Answer, about, check_file, check_folder, findings, status, writing

if TYPE_CHECKING:
    from argparse import Namespace
    from pathlib import Path

    from ..fit import Fit
    from ..fit.compare import Comparison


def register(commands: arguments.Commands) -> None:
    """Add the commands of this file."""
    parser = arguments.add_command(
        commands, "fit", run_fit, "Fit a model: parameters with units and 95 % intervals."
    )
    parser.add_argument("captures", nargs="+", metavar="CAPTURE", help="several are fitted jointly")
    parser.add_argument("--model", metavar="MODEL", help="model file or knob1 to knob5; default the base")
    parser.add_argument(
        "--detents", choices=("auto", "yes", "no"), default="auto", help="of the base model; default auto"
    )
    arguments.add_output(parser, "model")
    arguments.add_plots(parser)
    arguments.add_preparation(parser)
    arguments.add_reading(parser)

    parser = arguments.add_command(
        commands, "compare", run_compare, "Split the error of a model over position, velocity, time and more."
    )
    parser.add_argument("capture", metavar="CAPTURE", help="what the model is held against")
    arguments.add_model(parser, "model file, or knob1 to knob5")
    parser.add_argument("--refit", action="store_true", help="fit the free parameters of the model first")
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
    captures = []
    for path in args.captures:
        status(f"reading {path}")
        captures.append(arguments.read(path, args))
    status("fitting")
    with about(*args.captures):
        fitted = fit(captures, model, prepare=args.prepare, detents=args.detents, **options)

    files: dict[str, object] = {}
    if args.output is not None:
        files["model"] = str(fitted.model.save(args.output))
    if args.plots is not None:
        files["pictures"] = draw(fitted, args.plots)
    stuck = fitted.stiction()
    shown = [repr(stuck)] if any(stuck.breakaways) else []
    text = "\n".join([repr(fitted), *shown, *said(files)])
    notes = [findings(*each) for each in zip(args.captures, captures, fitted.prepared, strict=True)]
    document = fitted.document() | {"stiction": stuck.document() if shown else None, "files": files}
    return Answer(text, document, tuple(chain.from_iterable(notes)))


def run_compare(args: Namespace) -> Answer:
    """Hold a model against a capture, its parameters as they are in the file unless they are refitted."""
    check_folder(args.plots)
    options = arguments.preparation(args)

    from ..fit import fit
    from ..model import Model

    model = Model.load(args.model)
    status(f"reading {args.capture}")
    capture = arguments.read(args.capture, args)
    status("comparing")
    with about(args.capture):
        held = fit(capture, model if args.refit else model.frozen(), prepare=args.prepare, **options)
    comparison = held.compare()

    files: dict[str, object] = {}
    if args.plots is not None:
        files["pictures"] = draw(held, args.plots, comparison)
    document = comparison.document() | {"model": args.model, "refitted": args.refit, "files": files}
    text = "\n".join([repr(comparison), *said(files)])
    return Answer(text, document, findings(args.capture, capture, held.signals))


def draw(fitted: Fit, folder: Path, comparison: Comparison | None = None) -> list[str]:
    """Write every picture of a fit and return the paths."""
    status("drawing")
    from ..show import plot

    with writing(folder):
        folder.mkdir(exist_ok=True)
        return [str(path) for path in plot.save_all(fitted, folder, comparison=comparison)]


def said(files: dict[str, object]) -> list[str]:
    """Return the lines that name written files."""
    lines = [f"{kind}: {files[kind]}" for kind in ("model", "report") if kind in files]
    pictures = files.get("pictures")
    return lines + [f"picture: {path}" for path in pictures] if isinstance(pictures, list) else lines
