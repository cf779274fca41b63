"""The catalogue of effects as sections of a page, each with its law, parameters and signature picture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import matplotlib

import knobcam as kc

PLACES = {
    "coupling": "Between shaft and knob",
    "load": "On the knob",
    "sensor": "In the torque sensor",
}


def catalogue(folder: Path) -> str:
    """Return the effects by the place where they act; their pictures go into `folder`/signatures."""
    matplotlib.use("agg")
    (folder / "signatures").mkdir()
    lines: list[str] = []
    for place, title in PLACES.items():
        lines += [f"## {title}", ""]
        for effect in kc.effects().values():
            if effect.place == place:
                picture = f"signatures/{effect.id}.png"
                effect.plot().savefig(folder / picture, dpi=75)
                lines += [*_section(effect), f"![What {effect.id} adds to a small knob]({picture})", ""]
    return "\n".join(lines)


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _section(effect: kc.Effect) -> Iterator[str]:
    yield from (f"### {effect.id}", "", f"*{_sentence(effect.name)}* {effect.about}", "")
    yield from ("```text", effect.law, "```", "")
    yield from (f"Usual causes: {'; '.join(effect.causes)}.", "")
    yield from (f"What helps: {'; '.join(effect.remedies)}.", "")
    yield from (f"Shows {effect.shows}. Source: {effect.source}.", "")
    if effect.needs:
        yield from (f"Needs [{effect.needs}](#{effect.needs}) in the model.", "")
    if effect.confused:
        alike = ", ".join(f"[{one}](#{one})" for one in effect.confused)
        yield from (f"Easily confused with {alike}.", "")
    if effect.describes:
        yield from ("It describes a torque and names no cause, so no search adds it.", "")
    if effect.params:
        yield from ("| parameter | unit | bounds | neutral | meaning |", "|---|---|---|---|---|")
        for one in effect.params:
            bounds = "any" if math.isinf(one.upper) else f"{one.lower:g} to {one.upper:g}"
            unit = one.unit.replace(" ", "&nbsp;")
            yield f"| `{effect.id}.{one.name}` | {unit} | {bounds} | {one.neutral:g} | {one.meaning} |"
        yield ""
