"""`knobcam demo`: the whole job without hardware."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .output import Answer, check_folder, findings, status

if TYPE_CHECKING:
    from argparse import Namespace


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands,
        "demo",
        run,
        "Hide an effect in an emulated knob, record it, find it, feel it: no hardware needed.",
    )
    parser.add_argument("--knob", default="3", metavar="1..5|NAME", help="one of the five knobs; default 3")
    parser.add_argument("--effect", metavar="ID", help="what it hides, of `knobcam effects`")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FOLDER", help="for all files; default ./knobcam-demo-knobN"
    )


def run(args: Namespace) -> Answer:
    """Run the demonstration and print where its files are."""
    from ..model.hiding import hiding, knob_name
    from . import demonstration

    knob, effect = knob_name(args.knob), args.effect or demonstration.HIDDEN
    hiding(knob, effect)  # refuses before anything is written
    folder = args.output or Path(f"knobcam-demo-{knob}")
    check_folder(folder)
    shown = demonstration.run(knob, effect, folder, status)
    fitted = shown.learned.fit
    text = f"{shown!r}\nreport: {shown.files['report']}\nfiles in {folder.absolute()}"
    rendered = {"rmse": shown.rendered.rmse, "params": shown.rendered.document()["params"]}
    document = shown.learned.document()
    document |= {"hidden": list(shown.hidden), "rendered": rendered, "files": shown.files}
    return Answer(text, document, findings(shown.files["capture"], fitted.signals.capture, fitted.signals))
