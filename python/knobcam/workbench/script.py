"""A session as a Python script that does the same again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .._core import __version__
from ..capture.person import LEFT_OUT
from .sources import PARSED

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from .tree import Node, Opened, Start


def script(done: Sequence[Node], captures: Mapping[str, Opened], start: Start) -> str:
    """Return a script that makes the fit of the last of these nodes, named `fit`, step by step.

    Captures that were handed over by the browser are looked for in the folder where it runs.
    """
    used = list(dict.fromkeys(one for node in done for one in node.captures))
    names = {one: f"capture_{number}" for number, one in enumerate(used, 1)}
    lines = [f'"""A session at the workbench of knobcam {__version__}, step by step."""', ""]
    loads = [f"{names[one]} = {_load(captures[one])}" for one in used]
    lines += ["import knobcam as kc"]
    if any(captures[one].made and PARSED in captures[one].made for one in used):
        lines += ["from knobcam.capture.motion_plan import MotionPlan"]
    if any(node.along for node in done):
        lines += ["from knobcam.learn.exchanged import with_detents"]
    lines += ["", *loads]
    for before, node in zip([None, *done], done, strict=False):
        begins = node.rung is not None and not node.cut and (before is None or before.rung != node.rung - 1)
        lines += [_search(node, names, start)] if begins else []
        lines += [_step(node, names, start)]
    return "\n".join([*lines, "print(fit)", ""])


def _load(opened: Opened) -> str:
    if opened.made:
        out = () if LEFT_OUT in opened.options.get("overrule", ()) else opened.options.get("leave_out", ())
        return opened.made + (f".leave_out({', '.join(repr(tuple(one)) for one in out)})" if out else "")
    # repr() makes a literal of any text, so that no name can be more than a name.
    given = [repr(opened.path), *(f"{name}={value!r}" for name, value in opened.options.items())]
    handed_over = "" if Path(opened.path).is_absolute() else "  # handed over: put it where this runs"
    return f"kc.load({', '.join(given)}){handed_over}"


def _search(node: Node, names: Mapping[str, str], start: Start) -> str:
    """A search for everything, of which the nodes that follow are the steps."""
    return f"story = kc.learn({_given(node, names, start)})"


def _given(node: Node, names: Mapping[str, str], start: Start) -> str:
    given = [f"[{', '.join(names[one] for one in node.captures)}]"]
    if node.onward:
        given.append("fit.model")
    elif start.name:
        given.append(f"kc.Model.load({start.name!r})")
    return ", ".join([*given, *(f"{name}={value!r}" for name, value in start.options.items())])


def _step(node: Node, names: Mapping[str, str], start: Start) -> str:
    if node.how == "added" and node.effect is not None and node.effect in node.fit.model.laws:
        return "\n".join(_law(node, node.effect, [names[one] for one in node.captures], start))
    if node.cut:  # another run would end it elsewhere
        return "\n".join(_as_it_was(node, [names[one] for one in node.captures], start))
    if node.rung is not None:
        return f"fit = story.ladder[{node.rung}].fit"
    if node.how == "added":
        gone = "".join(f".drop({one!r})" for one in node.also_dropped)
        again = f".drop({node.again!r}).add({node.again!r})" if node.again else ""
        added = f"fit.add({node.effect!r})"
        return f"fit = {f'with_detents({added})' if node.along else added}{gone}{again}"
    if node.how == "dropped":
        return f"fit = fit.drop({node.effect!r})"
    return f"fit = kc.fit({_given(node, names, start)})"


def _as_it_was(node: Node, captures: Sequence[str], start: Start) -> Iterator[str]:
    """A model as it came to be, fitted once more from there."""
    yield f"model = kc.Model.parse({node.fit.model.text()!r})"
    # With a model detents are no choice.
    options = (f"{key}={value!r}" for key, value in start.options.items() if key != "detents")
    given = [f"[{', '.join(captures)}]", "model", *options]
    yield f"fit = kc.fit({', '.join(given)})"


def _law(node: Node, name: str, captures: Sequence[str], start: Start) -> Iterator[str]:
    """A formula, begun where it came to: it has no start of its own."""
    model = node.fit.model
    yield f"kc.own_law({name!r}, {model.laws[name]!r})"
    yield f"model = fit.model.with_effect({name!r})"
    own = [param for param in model.params if param.startswith(f"{name}.")]
    yield from (f"model = model.with_value({one!r}, {model.params[one].value!r})" for one in own)
    given = [
        f"[{', '.join(captures)}]",
        "model",
        *(f"{key}={value!r}" for key, value in start.options.items()),
    ]
    yield f"fit = kc.fit({', '.join(given)})"
