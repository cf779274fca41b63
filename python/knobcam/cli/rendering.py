"""`knobcam render`: feel a model, on an emulated handle in an emulated hand."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from ..errors import InputError
from . import arguments
from .fitting import said
from .output import Answer, check_folder, status, writing

if TYPE_CHECKING:
    from argparse import Namespace

    from ..loop_report import LoopReport
    from ..model import Model
    from ..render import Device, Stability


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "render", run, "Feel a model: render it in a loop on an emulated handle that a hand turns."
    )
    parser.add_argument("model", metavar="MODEL", help="model file, or knob1 to knob5")
    parser.add_argument("--seconds", type=arguments.number, default=5.0, metavar="S", help="default 5 s")
    parser.add_argument("--rate", type=arguments.number, default=5000.0, metavar="HZ", help="default 5000 Hz")
    parser.add_argument(
        "--rt",
        choices=("warn", "enforce", "off"),
        default="warn",
        help="real-time priority: go on without (warn), refuse without (enforce), do not ask; default warn",
    )
    parser.add_argument(
        "--time", choices=("real", "virtual"), default="real", help="of the loop; virtual waits for nothing"
    )
    parser.add_argument(
        "--delay",
        type=arguments.whole,
        default=1,
        metavar="SAMPLES",
        help="from a measurement to its torque; default 1",
    )
    arguments.add_plots(parser)


def run(args: Namespace) -> Answer:
    """Check the stability, run the loop, say what it reached."""
    check_folder(args.plots)
    if args.time == "virtual" and args.rt == "enforce":
        raise InputError("--rt enforce: virtual time has no priority to enforce; leave one of them out")

    from ..emulated import EmulatedHandle, to_and_fro
    from ..loop import run_loop
    from ..model import Model
    from ..render import Device, Renderer, check_stability

    model, device = Model.load(args.model), Device(delay_samples=args.delay)
    stability = check_stability(model, device, rate=args.rate)
    renderer = Renderer(model, args.rate, device=device)
    handle = EmulatedHandle(device, to_and_fro())
    status(f"rendering for {args.seconds:g} s")
    report = run_loop(renderer, handle, args.seconds, rate_hz=args.rate, rt=args.rt, time=args.time)
    files: dict[str, object] = {}
    if args.plots is not None:
        files["pictures"] = _draw(args, report, model, device, stability)
    work = f"the hand's work on the handle: {handle.work_J:.3g} J in {report.periods / args.rate:.3g} s"
    text = "\n".join([repr(stability), "", repr(report), work, *said(files)])
    document = {
        "schema": "knobcam.render/1",
        "model": model.name,
        "on": {"kind": "emulated", **asdict(device)},
        "stability": stability.document(),
        "loop": report.document(),
        "work_J": handle.work_J,
        "files": files,
    }
    messages = [] if stability.stable else [f"warning: {stability.verdict}"]
    if not report.well:
        messages.append(f"warning: the loop {report.remarks[0]}")
    return Answer(text, document, tuple(messages))


def _draw(
    args: Namespace, report: LoopReport, model: Model, device: Device, stability: Stability
) -> list[str]:
    from .. import plot

    status("drawing")
    figures = {
        "timing": plot.timing(report),
        "felt": plot.felt(report, model, device),
        "stability": plot.stability(stability),
    }
    with writing(args.plots):
        args.plots.mkdir(exist_ok=True)
        for name, figure in figures.items():
            figure.savefig(args.plots / f"{name}.png")
    return [str(args.plots / f"{name}.png") for name in figures]
