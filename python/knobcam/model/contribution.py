"""From a law of one's own to an effect of the catalogue: the Rust file that says the same, in a checkout."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from .. import _core
from ..base.reading import read_text
from ..base.writing import together, write
from ..errors import InputError
from .effects import effects

if TYPE_CHECKING:
    from .model import Model

_EFFECTS = Path("crates/knobcore/src/effects")
_REGISTRY = _EFFECTS / "mod.rs"
_NAME = re.compile(r"[a-z][a-z0-9_]*")
_MOST_BYTES = 1_000_000


def contribute(model: Model, effect: str | None, name: str, checkout: Path) -> tuple[Path, Path]:
    """Write a formula of a model as the effect `name` into a checkout; return its file and the registry.

    `effect` may be None where the model has one formula alone. Both files appear, or none does. Raises
    InputError for a name that is taken or none of a Rust module, for what is no formula or asks for memory
    (`s`), and for a folder that is no checkout.
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name}: must be small letters, digits and _, such as eddy_brake")
    registry, file = checkout / _REGISTRY, checkout / _EFFECTS / f"{name}.rs"
    if not registry.is_file():
        raise InputError(
            f"{checkout}: is no checkout of knobcam, for it has no {_REGISTRY}; give --into FOLDER"
        )
    if name in effects():
        raise InputError(f"{name}: is in the catalogue already; choose another name")
    if file.exists():
        raise InputError(f"{file}: is there already; choose another name")
    text, line, part = _core.effect_source(model.core, effect or _only(model), name)
    catalogue = read_text(registry, "registry", _MOST_BYTES)
    # The effects of a part stand in the order of the chain; a new one comes last.
    found = re.search(rf"(?m)^registry! \{{$[\s\S]*?^    {part} \{{$[\s\S]*?(?=^    \}}$)", catalogue)
    if found is None:
        raise InputError(
            f"{registry}: has no list of {part} that a line could be added to; check the checkout"
        )
    with together():
        write(file, text)
        write(registry, f"{catalogue[: found.end()]}        {line}\n{catalogue[found.end() :]}")
    return file, registry


def _only(model: Model) -> str:
    """Return the one effect of a model that its file has a formula of."""
    own = [row["id"] for row in model.core.own_rows()]
    if len(own) != 1:
        has = f"has {', '.join(own)}; say which with --law" if own else "has no law of its own; add one first"
        raise InputError(f"model '{model.name}': {has}")
    return str(own[0])
