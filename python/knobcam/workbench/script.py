"""A session as a Python script that does the same again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._core import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from .tree import Node, Opened


def script(done: Sequence[Node], captures: Mapping[str, Opened]) -> str:
    """Return a script that makes the fit of the last of these nodes, named `fit`, step by step.

    Captures that were handed over by the browser are looked for beside the script.
    """
    used = list(dict.fromkeys(one for node in done for one in node.captures))
    names = {one: f"capture_{number}" for number, one in enumerate(used, 1)}
    lines = [f'"""A session at the workbench of knobcam {__version__}, step by step."""', ""]
    lines += ["import knobcam as kc", ""]
    lines += [f"{names[one]} = {_load(captures[one])}" for one in used]
    lines += [_step(node, names) for node in done]
    return "\n".join([*lines, "print(fit)", ""])


def _load(opened: Opened) -> str:
    if opened.made:
        return opened.made
    # repr() makes a literal of any text, so that no name can be more than a name.
    given = [repr(opened.path), *(f"{name}={value!r}" for name, value in opened.options.items())]
    return f"kc.load({', '.join(given)})"


def _step(node: Node, names: Mapping[str, str]) -> str:
    if node.how == "added":
        return f"fit = fit.add({node.effect!r})"
    if node.how == "dropped":
        return f"fit = fit.drop({node.effect!r})"
    captures = f"[{', '.join(names[one] for one in node.captures)}]"
    return f"fit = kc.fit({captures}, fit.model)" if node.onward else f"fit = kc.fit({captures})"
