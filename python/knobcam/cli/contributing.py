"""`knobcam new-effect`: from a law of one's own to the Rust file of the catalogue."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import arguments
from .output import Answer

if TYPE_CHECKING:
    from argparse import Namespace

_NEXT = (
    "fill in its source, its words and when it shows; then rustfmt it, and run cargo test --package knobcore"
)


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands,
        "new-effect",
        run,
        "Write a law of your own as an effect of the catalogue: its Rust file, test and registry line.",
    )
    parser.add_argument("name", metavar="NAME", help="of the new effect, such as eddy_brake")
    parser.add_argument("--from", dest="model", required=True, metavar="MODEL", help="that has the law")
    parser.add_argument("--law", metavar="EFFECT", help="which of its laws; default the only one")
    parser.add_argument(
        "--into", type=Path, default=Path(), metavar="FOLDER", help="checkout of knobcam; default this folder"
    )


def run(args: Namespace) -> Answer:
    """Write the files, and say what a person has to fill in."""
    from ..model import Model
    from ..model.contribution import contribute

    file, registry = contribute(Model.load(args.model), args.law, args.name, args.into)
    files = {"effect": str(file), "registry": str(registry)}
    text = "\n".join([f"effect: {file}", f"registry: {registry}", _NEXT])
    return Answer(text, {"schema": "knobcam.new-effect/1", "effect": args.name, "files": files})
