"""Modules that have another name now, found under their old one for one version, with a warning."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from importlib.abc import Loader, MetaPathFinder
    from types import ModuleType
else:
    Loader = MetaPathFinder = object  # importlib.abc takes 18 ms to import, all the rest here takes one


class _Under(Loader):
    """Loads the module of a new name under an old one: they are the same object."""

    def __init__(self, old: str, new: str) -> None:
        self.old, self.new = old, new

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        warnings.warn(f"{self.old} is {self.new} now", DeprecationWarning, stacklevel=2)
        module = import_module(self.new)
        self.spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self.spec  # the import system has put that of the old name there


class _Moved(MetaPathFinder):
    def __init__(self, places: Mapping[str, str]) -> None:
        self.places = places

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        new = self.places.get(name)
        return None if new is None else ModuleSpec(name, _Under(name, new))


def found_under(places: Mapping[str, str]) -> None:
    """Let modules be found under their old names (keys) too."""
    sys.meta_path.append(_Moved(places))
