"""`knobcam effects`: the catalogue of physical effects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .output import Answer, check_file, check_folder, status

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable

    from ..model.effects import Effect

_HEAD = ("effect", "acts on", "it says that", "law")
_PICTURES = tuple(f".{kind}" for kind in arguments.PICTURES)


def register(commands: arguments.Commands) -> None:
    """Add the command of this file."""
    parser = arguments.add_command(
        commands, "effects", run, "List the catalogue of effects, or show one: law, source and signature."
    )
    parser.add_argument("id", nargs="?", metavar="ID", help="effect to show; default all")
    parser.add_argument("--coordinate", choices=("rotary", "linear"), default="rotary", help="whose units")
    parser.add_argument("-o", "--output", type=Path, metavar="PICTURE", help="signature of effect ID")
    arguments.add_plots(parser)


def run(args: Namespace) -> Answer:
    """Show the catalogue or one effect, and draw signatures."""
    pictures = _targets(args, args.output, args.plots)

    from ..base.tables import text_table
    from ..base.writing import together
    from ..model.effects import effect, effects

    catalogue = effects(args.coordinate)
    if args.id is None:
        shown = list(catalogue.values())
        text = text_table(_HEAD, [(e.id, e.place, e.name, e.law) for e in shown])
    else:
        shown = [effect(args.id, args.coordinate)]
        text = repr(shown[0])
    with together():
        files = [_draw(one, path) for one in shown for path in pictures(one)]
    text = "\n".join([text, *(f"picture: {path}" for path in files)])
    document = {
        "schema": "knobcam.effects/1",
        "effects": [_document(one) for one in shown],
        "files": {"pictures": files},
    }
    return Answer(text, document)


def _targets(args: Namespace, picture: Path | None, folder: Path | None) -> Callable[[Effect], list[Path]]:
    """Return where the pictures of an effect go, after checking that they can be written there."""
    check_file(picture)
    check_folder(folder, picture)
    if picture is not None and args.id is None:
        raise InputError(f"{picture}: is one picture; name the effect, or give --plots FOLDER for all")
    if picture is not None and picture.suffix.lower() not in _PICTURES:
        raise InputError(f"{picture}: is no picture by its name; end it in {', '.join(_PICTURES)}")

    def targets(effect: Effect) -> list[Path]:
        in_folder = [] if folder is None else [folder / f"{effect.id}.{args.format}"]
        return in_folder + ([] if picture is None else [picture])

    return targets


def _draw(effect: Effect, path: Path) -> str:
    from ..base.writing import make_folder

    status(f"drawing {effect.id}")
    make_folder(path.parent)
    effect.plot().savefig(path)
    return str(path)


def _document(effect: Effect) -> dict[str, Any]:
    told = dict(effect.document())
    return {
        "id": told.pop("effect"),
        **told,
        "params": [param._asdict() for param in effect.params],
    }
