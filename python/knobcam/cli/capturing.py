"""`knobcam capture` and `knobcam export`: a recording from the rig, and other files from its wire log."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .output import Answer, check_file, check_kind, findings, status

if TYPE_CHECKING:
    from argparse import Namespace
    from pathlib import Path

    from ..capture import Capture
    from ..rig.figures import Figures

_TOLD_EVERY_S = 1.0


def register(commands: arguments.Commands) -> None:
    """Add the commands of this file."""
    parser = arguments.add_command(
        commands, "capture", run_capture, "Record from the rig: the wire log, and the capture that is in it."
    )
    parser.add_argument(
        "--port", required=True, help="serial port of the rig, or serial:NUMBER to look for it on every port"
    )
    parser.add_argument("--baud", type=arguments.whole, metavar="N", help="bits a second; default 1000000")
    parser.add_argument(
        "--motion",
        default="sweep",
        metavar="NAME",
        help="sweep, multisine, turns, micro, a file (.toml), or hand: you turn it",
    )
    parser.add_argument(
        "--limits", metavar="FILE", help="TOML with omega_rad_s, torque_Nm ...; nothing moves beyond them"
    )
    parser.add_argument("--duration", type=arguments.number, default=6.0, metavar="S", help="default 6 s")
    parser.add_argument(
        "--model", metavar="MODEL", help="let the rig render this model while the motion turns it"
    )
    parser.add_argument("--calibration", metavar="FILE", help="default: the one that is kept of this rig")
    parser.add_argument(
        "--force",
        action="store_true",
        help="with --model: one that may feed a hand, as long as its tank lasts",
    )
    arguments.add_fault(parser)
    parser.add_argument("--overwrite", action="store_true", help="write over a capture (a log never is)")
    arguments.add_output(parser, "capture", required=True)

    parser = arguments.add_command(
        commands,
        "export",
        run_export,
        "Write a wire log, or any capture, as HDF5, Parquet, CSV, .mat or .npz.",
    )
    parser.add_argument("file", metavar="LOG", help="what to read")
    parser.add_argument(
        "--run",
        type=int,
        dest="place",
        metavar="N",
        help="which run of the log: 0 the first, -1 the last (default)",
    )
    parser.add_argument("--calibration", metavar="FILE", help="default: the one of the recording")
    arguments.add_output(parser, "file", required=True)


def run_capture(args: Namespace) -> Answer:
    """Record a run."""
    from ..rig.port import BAUD
    from ..rig.record import log_path, record

    if args.force and args.model is None:
        raise InputError("--force: is about a model that is rendered; name one with --model, or leave it out")
    log = log_path(args.output)
    if args.output != log:  # which the recorder begins, and never over another
        check_file(args.output)
    status("looking for the rig")
    recorded = record(
        args.port,
        args.motion,
        output=args.output,
        duration_s=args.duration,
        model=args.model,
        calibration=args.calibration,
        limits=args.limits,
        progress=_Teller(),
        told=_say,
        baud=BAUD if args.baud is None else args.baud,
        force=args.force,
        clear_fault=arguments.clear_fault(args),
        overwrite=args.overwrite,
    )
    return _answer(recorded, args.output, log)


KINDS = (".h5", ".hdf5", ".parquet", ".csv", ".csv.gz", ".mat", ".npz")
"""The files that a capture is exported as."""


def run_export(args: Namespace) -> Answer:
    """Work out the capture in a log and write it."""
    from ..capture import load
    from ..rig.calibration import Calibration
    from ..rig.wirelog import WireLog, is_log

    check_file(args.output, [args.file])
    check_kind(args.output, "an export", *KINDS)
    status(f"reading {args.file}")
    if is_log(args.file):
        calibration = None if args.calibration is None else Calibration.load(args.calibration)
        recorded = WireLog.load(args.file).capture(-1 if args.place is None else args.place, calibration)
    elif args.place is not None or args.calibration is not None:
        raise InputError(f"{args.file}: is no wire log; --run and --calibration are for those alone")
    else:
        recorded = load(args.file)
    path = recorded.save(args.output)
    return _written(recorded, path, "knobcam.export/1", {"file": str(path)}, str(path))


def _say(words: str) -> None:
    """Say what is done before the motion; it stays to be read."""
    status(None)
    print(words, file=sys.stderr, flush=True)


class _Teller:
    """Shows figures: on a terminal in place, in a file a line a second."""

    def __init__(self) -> None:
        self._next = time.monotonic() + _TOLD_EVERY_S

    def __call__(self, figures: Figures) -> None:
        if sys.stderr.isatty():
            status(str(figures))
        elif time.monotonic() >= self._next:
            self._next += _TOLD_EVERY_S
            print(figures, file=sys.stderr, flush=True)


def _answer(recorded: Capture, output: Path, log: Path) -> Answer:
    files = {"log": str(log)} | ({} if output == log else {"capture": str(output)})
    where = str(output) if output == log else f"{output} from {log}"
    return _written(recorded, output, "knobcam.capture/1", files, where)


def _told(recorded: Capture, name: str) -> Mapping[str, Any]:
    """What a recording says of itself under a name; nothing where it is none, as one that was simulated."""
    told = recorded.meta.get(name)
    return told if isinstance(told, Mapping) else {}


def _written(recorded: Capture, path: Path, schema: str, files: dict[str, str], where: str) -> Answer:
    account = _told(recorded, "account")
    document: dict[str, Any] = {
        "schema": schema,
        "capture": {
            "path": str(path),
            "samples": recorded.samples,
            "masked": int((~recorded.mask).sum()),
            "missing": account.get("missing"),
            "planned": _told(recorded, "motion").get("samples"),
            "duration_s": recorded.duration_s,
            "sample_rate_hz": recorded.rate_hz,
            "columns": list(recorded.columns),
        },
        "rig": {name: recorded.meta.get(name) for name in ("serial", "firmware", "run", "calibration")},
        "findings": [finding.document() for finding in recorded.findings],
        "files": files,
    }
    lost = "" if account.get("missing") is None else f", {account['missing']} lost"
    text = (
        f"{where}: {recorded.samples} samples{lost} ({document['capture']['masked']} masked), "
        f"{recorded.duration_s:.4g} s at {recorded.rate_hz:.6g} Hz"
    )
    return Answer(text, document, findings(path, recorded))
