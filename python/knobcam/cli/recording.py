"""`knobcam import` and `knobcam simulate`: captures from files and from models."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import arguments
from .output import Answer, check_file, findings, status

if TYPE_CHECKING:
    from argparse import Namespace
    from pathlib import Path

    from ..capture import Capture


def register(commands: arguments.Commands) -> None:
    """Add the commands of this file."""
    parser = arguments.add_command(
        commands,
        "import",
        run_import,
        "Read CSV, JSON, MATLAB .mat, NumPy, HDF5, Parquet or a ROS 2 bag into a capture.",
    )
    parser.add_argument("file", metavar="FILE", help="what to read")
    arguments.add_output(parser, "capture", required=True)
    arguments.add_reading(parser)

    parser = arguments.add_command(
        commands, "simulate", run_simulate, "Write the capture that a rig would record of a model."
    )
    arguments.add_model(parser, "model file, or knob1 to knob5")
    parser.add_argument(
        "--motion",
        default="sweep",
        metavar="NAME",
        help="sweep, multisine, turns, hand, micro, push, or a file (.toml)",
    )
    parser.add_argument(
        "--noise",
        default="ranged",
        metavar="NAME",
        help="of the sensors: rig, paper, none, or ranged (default): the rig's, where its torque never clips",
    )
    parser.add_argument(
        "--seed",
        type=arguments.whole,
        default=0,
        metavar="N",
        help="of the noise: another number, another noise",
    )
    parser.add_argument("--duration", type=arguments.number, default=6.0, metavar="S", help="default 6 s")
    parser.add_argument("--rate", type=arguments.number, default=5000.0, metavar="HZ", help="default 5000 Hz")
    arguments.add_output(parser, "capture", required=True)


def run_import(args: Namespace) -> Answer:
    """Read a foreign file, check it, write the capture."""
    check_file(args.output, [args.file])
    status(f"reading {args.file}")
    capture = arguments.read(args.file, args)
    return _written(capture, capture.save(args.output), "knobcam.import/1")


def run_simulate(args: Namespace) -> Answer:
    """Simulate a model and write the capture."""
    from ..model import Model
    from ..model.simulate import simulate

    check_file(args.output, [args.model])
    model = Model.load(args.model)
    status("simulating")
    capture = simulate(
        model,
        args.motion,
        noise=args.noise,
        seed=args.seed,
        duration_s=args.duration,
        rate_hz=args.rate,
    )
    return _written(capture, capture.save(args.output), "knobcam.simulate/1")


def _written(capture: Capture, path: Path, schema: str) -> Answer:
    document: dict[str, Any] = {
        "schema": schema,
        "capture": {
            "path": str(path),
            "samples": capture.samples,
            "masked": int((~capture.mask).sum()),
            "duration_s": capture.duration_s,
            "sample_rate_hz": capture.rate_hz,
            "axis": capture.coordinate,
            "columns": list(capture.columns),
        },
        "findings": [finding.document() for finding in capture.findings],
        "files": {"capture": str(path)},
    }
    masked = document["capture"]["masked"]
    text = (
        f"{path}: {capture.samples} samples ({masked} masked) of {', '.join(capture.columns)}, "
        f"{capture.duration_s:.4g} s at {capture.rate_hz:.6g} Hz, {capture.coordinate} axis"
    )
    return Answer(text, document, findings(path, capture))
