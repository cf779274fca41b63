"""What would come in, but for the filter of the torque."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest

from knobcam.learn import selection


def test_what_would_come_in_but_for_the_filter_is_not_named_and_leaves_no_clean_verdict(
    monkeypatch: pytest.MonkeyPatch,
):
    @dataclass
    class Weighed:
        effect: str
        implausible: tuple[str, ...]
        fit: Any = None
        word: str = "implausible"

    def words(_: object, candidates: list[Weighed]) -> list[Weighed]:
        return [replace(one, word="implausible" if one.implausible else "part") for one in candidates]

    monkeypatch.setattr(selection, "judged", words)
    monkeypatch.setattr(selection, "filtered_off", lambda effect, fit: ["filtered off"])
    fast = Weighed("position_friction", ("filtered off",))
    others = [Weighed("offset", ("too large",)), Weighed("presliding", ("filtered off", "too large"))]
    known: Any = SimpleNamespace(comparison=None, candidates=[*others, fast])
    found = selection._out_of_sight(known)
    assert found is not None and found.effect == "position_friction"
    known.candidates = others
    assert selection._out_of_sight(known) is None
    # What another effect would explain is that one's.
    known.candidates = [Weighed("stribeck", ()), fast]
    assert selection._out_of_sight(known) is None
