"""Effects that installed packages bring along: entry points of the group `knobcam.effects`."""

from __future__ import annotations

import threading
import warnings
from importlib.metadata import entry_points

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
