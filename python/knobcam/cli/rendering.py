"""`knobcam render`: feel a model, on an emulated handle in an emulated hand, or on the device of a rig."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from . import arguments
from .fitting import put, said
from .output import Answer, Unfinished, check_folder, findings, status

if TYPE_CHECKING:
    from argparse import Namespace

    from ..model import Model
    from ..render import Device, Stability
    from ..render.loop_report import LoopReport
    from ..rig.figures import Figures


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "render", run, "Feel a model: render it in a loop on an emulated handle that a hand turns."
    )
    arguments.add_model(parser, "model file, or knob1 to knob5")
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
    parser.add_argument("--port", metavar="PORT", help="render on the device of this rig, in your own hand")
    parser.add_argument(
        "--log", type=Path, metavar="FILE", help="with --port: keep the wire log there, .kcwire"
    )
    parser.add_argument(
        "--force",
        action="store_true",
        help="render what would feed a hand or ring, until it has given out 0.1 J more than it took",
    )
    arguments.add_fault(parser)
    arguments.add_plots(parser)


def run(args: Namespace) -> Answer:
    """Check that the model feeds no hand and does not ring, run the loop, say what it reached."""
    check_folder(args.plots)
    if args.port is not None:
        return _on_a_rig(args)
    if args.log is not None or args.clear_fault:
        raise InputError("--log and --clear-fault: belong to a rig; name its port with --port")
    if args.time == "virtual" and args.rt == "enforce":
        raise InputError("--rt enforce: virtual time has no priority to enforce; leave one of them out")

    from dataclasses import asdict

    from ..model import Model
    from ..render import Device, Renderer, check_rotary, check_stability
    from ..render.emulated import EmulatedHandle, to_and_fro
    from ..render.loop import run_loop

    model, device = Model.load(args.model), Device(delay_samples=args.delay)
    check_rotary(model)
    stability = check_stability(model, device, rate_hz=args.rate)
    if stability.refusal is not None and not args.force:
        raise InputError(f"{args.model}: {stability.refusal}")
    renderer = Renderer(model, args.rate, device=device, force=args.force)
    handle = EmulatedHandle(device, to_and_fro())
    status(f"rendering for {args.seconds:g} s")
    report = run_loop(renderer, handle, args.seconds, rate_hz=args.rate, rt=args.rt, time=args.time)
    if report.ending == "fault":
        raise InputError(f"{args.model}: the step let go after {report.steps} samples: {report.why}")
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
    messages = [] if stability.refusal is None else [f"warning: {stability.verdict}"]
    if not report.well:
        messages.append(f"warning: the loop {report.remarks[0]}")
    answer = Answer(text, document, tuple(messages))
    if report.ending == "interrupted":
        raise Unfinished(answer)
    return answer


def _on_a_rig(args: Namespace) -> Answer:
    """Let the device render by its own loop, and record what a person feels."""
    from dataclasses import asdict

    from ..model import Model
    from ..rig.feel import feel

    for name, usual in (("rate", 5000.0), ("rt", "warn"), ("time", "real"), ("delay", 1)):
        if getattr(args, name) != usual:
            raise InputError(f"--{name}: is for the emulated handle; the device behind a port has its own")
    if args.plots is not None:
        raise InputError("--plots: is for the emulated handle; draw the capture of --log with `knobcam fit`")
    model = Model.load(args.model)

    def watch(figures: Figures) -> None:
        status(f"rendering: {figures.received} samples, {figures.missing} lost")

    felt = feel(
        args.port,
        model,
        args.seconds,
        log=args.log,
        force=args.force,
        clear_fault=arguments.clear_fault(args),
        progress=watch,
    )
    capture = felt.capture
    work = float(capture.tau[1:] @ (capture.theta[1:] - capture.theta[:-1]))
    text = (
        f"{felt.stability!r}\n\n{felt.serial} rendered it for {capture.duration_s:.3g} s at its own "
        f"{capture.rate_hz:g} Hz: {capture.samples} samples, {felt.samples_missing} lost on the way\n"
        f"the hand's work on the handle: {work:.3g} J"
    )
    files: dict[str, object] = {} if args.log is None else {"log": str(args.log)}
    document = {
        "schema": "knobcam.render/1",
        "model": model.name,
        "on": {"kind": "device", "serial": felt.serial, **asdict(felt.device)},
        "stability": felt.stability.document(),
        "samples": capture.samples,
        "samples_missing": felt.samples_missing,
        "findings": [finding.document() for finding in capture.findings],
        "sample_rate_hz": capture.rate_hz,
        "work_J": work,
        "files": files,
    }
    return Answer("\n".join([text, *said(files)]), document, findings(args.log or args.port, capture))


def _draw(
    args: Namespace, report: LoopReport, model: Model, device: Device, stability: Stability
) -> list[str]:
    from ..show import plot

    status("drawing")
    pictures = {
        "timing": lambda: plot.timing(report),
        "felt": lambda: plot.felt(report, model, device),
        "stability": lambda: plot.stability(stability),
    }
    return put(args, pictures)
