"""Effects that installed packages bring along: entry points of the group `knobcam.effects`."""

from __future__ import annotations

import sys
import threading
import warnings
from pathlib import Path

from ..errors import KnobcamWarning

GROUP = "knobcam.effects"

_lock = threading.RLock()  # a plugin may use the catalogue while it is loaded
_loaded = False


def load_plugins() -> None:
    """Load the plugins of this installation if that was not done yet; each registers its effects.

    A plugin that fails is named in a KnobcamWarning, and its effects are left out.
    """
    global _loaded
    with _lock:
        if _loaded:
            return
        _loaded = True
        if not _may_be():
            return
        from importlib.metadata import entry_points

        for plugin in sorted(entry_points(group=GROUP)):
            try:
                plugin.load()
            except Exception as error:
                why = " ".join(f"{type(error).__name__}: {error}".split())
                package = f" of {plugin.dist.name}" if plugin.dist else ""
                warnings.warn(
                    f"the effects '{plugin.name} = {plugin.value}'{package} are left out: {why}; "
                    "mend or uninstall that package",
                    KnobcamWarning,
                    stacklevel=2,
                )


def _may_be() -> bool:
    """Whether a package may bring effects: no is said at once, and `importlib.metadata` says yes.

    To load that and to look by it is a tenth of a whole `knobcam fit`, and hardly anyone has a plugin.
    """
    if any(hasattr(finder, "find_distributions") for finder in sys.meta_path if not _looks_at_path(finder)):
        return True
    return any(_names_group(Path(folder)) for folder in sys.path)


def _looks_at_path(finder: object) -> bool:
    return getattr(finder, "__name__", "") == "PathFinder"


def _names_group(folder: Path) -> bool:
    """Whether a package in a folder has entry points of the group, or its files cannot be seen."""
    try:
        inside = list(folder.iterdir())
    except NotADirectoryError:  # an archive
        return True
    except OSError:
        return False
    about = (one / "entry_points.txt" for one in inside if one.suffix in (".dist-info", ".egg-info"))
    return any(_is_in(file) for file in about)


def _is_in(file: Path) -> bool:
    try:
        return GROUP.encode() in file.read_bytes()
    except OSError:  # most have none
        return False
