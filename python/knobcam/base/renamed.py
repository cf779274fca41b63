"""Arguments that have another name now, taken under their old one for one version, with a warning."""

from __future__ import annotations

import functools
import warnings
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

Given = ParamSpec("Given")
Returned = TypeVar("Returned")


def renamed(**names: str) -> Callable[[Callable[Given, Returned]], Callable[Given, Returned]]:
    """Let a function take arguments (values) under their old names (keys) too."""

    def wrap(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
        @functools.wraps(function)
        def taking(*args: Given.args, **given: Given.kwargs) -> Returned:
            for old in names.keys() & given.keys():
                new = names[old]
                if new in given:
                    raise TypeError(f"{function.__name__}() got {old}, which is now called {new}, and {new}")
                said = f"{function.__name__}({old}=...) is now called {new}"
                warnings.warn(said, DeprecationWarning, stacklevel=2)
                given[new] = given.pop(old)
            return function(*args, **given)

        return taking

    return wrap
