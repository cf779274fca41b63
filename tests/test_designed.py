"""A design in its parts: of rivals, motions and limits of which everything is known."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from known import estimate

import knobcam as kc
from knobcam.errors import InputError
from knobcam.learn import designing
from knobcam.learn.contenders import BASE
from knobcam.learn.designing import _Design
from knobcam.learn.experiment import Change, Expected, Experiment, Sharpened, _percent
from knobcam.learn.limits import Limits
from knobcam.learn.ranked import Scored
from knobcam.learn.telling import TOLD, Rival, Told, apart

LIMITS = Limits(0.2, 6.0, 80.0, -1.0, 3.0, duration_s=8.0, sample_rate_hz=1000.0)


def designed(*d: float, **more: Any) -> Experiment:
    fit = SimpleNamespace(torque_unit="N m")
    names = (BASE, "stribeck", "offset")
    rivals: Any = tuple(SimpleNamespace(name=name, effects=(name,), fit=fit) for name in names)
    pairs = ((0, 1), (0, 2), (1, 2))
    expected = tuple(Expected(pair, one, 0.5 * one) for pair, one in zip(pairs, d, strict=False))
    track: Any = SimpleNamespace(t=np.array([0.0, 4.0]), theta=np.array([0.0, 1.0]))
    plan: Any = SimpleNamespace(about="to and fro")
    return Experiment(rivals, LIMITS, plan, track, expected, (0.1, 5.0, 70.0), **more)


def test_an_experiment_says_what_it_tells_and_what_it_would_take():
    both = designed(30.0, TOLD, 50.0)
    assert both.separable and both.headline.startswith(
        "4 s tell base, stribeck and offset apart (the wrong one is chosen in 5 % of cases)"
    )
    short = designed(30.0, 0.99 * TOLD, 50.0)
    assert not short.separable and short.headline.endswith("alone is made up to five times as wide helps.")
    assert "tells base and offset apart: D is 10.7 at most" in short.headline
    wider = replace(short, change=Change("omega_rad_s", 12.0, 20.0))
    assert wider.headline.endswith("With omega_rad_s = 12 it would be 20.")
    (worst,) = (one for one in short.expected if one.d < TOLD)
    usual = tuple(one._replace(standard_d=38.5) if one is worst else one for one in short.expected)
    missed = replace(short, expected=usual).headline
    assert "No runnable motion" not in missed, "a standard one is one"
    assert (
        "does not tell base and offset apart, D is 10.7; a standard one as large as the limits would"
        in missed
    )
    assert both.rows() == [
        ("base or stribeck", "30", "0.31 %", "15"),
        ("base or offset", "10.8", "5 %", "5.4"),
        ("stribeck or offset", "50", "0.02 %", "25"),
    ]
    rivals = (("stribeck", "unbalance"), ("stribeck", "detent", "offset"))
    fit: Any = None
    names = [Rival(one, fit) for one in rivals]
    assert apart(names) == ("unbalance", "detent + offset")
    assert apart([names[0], Rival(("stribeck",), fit)]) == ("stribeck + unbalance", "stribeck")
    sharp = designed(sharpened=(Sharpened("inertia.M", 0.4, 0.1, 0.2),))
    assert sharp.headline == "inertia.M would be known 4 times as well after 4 s: to and fro."
    assert sharp.headline == replace(sharp, untied=True).headline.removeprefix(
        "These captures leave nothing tied, so the widest parameter is to be known better. "
    )
    blunt = designed(sharpened=(Sharpened("detent.S", 0.4, 0.38, 0.4),))
    assert (blunt.useful, sharp.useful) == (False, True) and blunt.promise is None
    assert blunt.headline.endswith("limits makes detent.S known better than these captures do.")
    plain = replace(both, expected=tuple(one._replace(standard_d=TOLD) for one in both.expected))
    assert plain.headline.endswith(": to and fro. Standard motions within these limits would, too.")
    assert both.headline.endswith(": to and fro.")
    assert (
        sharp.rows() == [("inertia.M", "0.4", "0.1", "0.2")]
        and sharp.tables()[0].head == Experiment.SHARPENED
    )
    assert "At most 0.1 N m (limit 0.2), 5 rad/s (6), 70 rad/s^2 (80)" in repr(both)
    said = wider.document()
    assert said["change"] == {"limit": "omega_rad_s", "to": 12.0, "d": 20.0} and said["separable"] is False
    assert [one["standard_D"] for one in said["expected"]] == [15.0, 0.5 * 0.99 * TOLD, 25.0]
    assert (_percent(0.9e-4), _percent(1.1e-4), _percent(0.5)) == ("< 0.01 %", "0.011 %", "50 %")


def test_a_limit_is_widened_and_the_others_are_not():
    assert LIMITS.widened("torque_Nm", 2.0) == replace(LIMITS, torque_Nm=0.4)
    # The range about its middle.
    assert LIMITS.widened("theta", 2.0) == replace(LIMITS, theta_min_rad=-3.0, theta_max_rad=5.0)


def design(monkeypatch: pytest.MonkeyPatch, asks: float, told: float = 5.0, n: int = 2) -> _Design:
    """A search whose rivals ask for so much torque at full speed, and D is so large at the full rate."""

    def peak(track: Any, *, draws: bool) -> float:
        return asks * float(np.max(np.abs(track.omega))) / LIMITS.omega_rad_s

    known = {"inertia.M": estimate(1e-4, 1e-5), "coulomb.pos": estimate(0.02, 4e-3)}
    known["detent.S"] = estimate(1e-6, 0.1)  # a phase near zero is known as well as any other
    model = SimpleNamespace(params=known, catalogue=kc.effects, phases={"detent.S"})
    fit = SimpleNamespace(core=SimpleNamespace(free=[*known]), params=known, model=model)
    telling: Any = SimpleNamespace(
        peak=peak,
        rivals=[SimpleNamespace(fit=fit)] * n,
        evidence=lambda track, rate_hz: Told(np.full((n, n), told * rate_hz / 1000.0), np.zeros(n)),
        pairs=lambda all_: [float(all_.d[i, j]) for i in range(n) for j in range(i)],
    )
    return _Design(telling, LIMITS, None)


def test_a_motion_is_eased_until_no_rival_asks_for_more_than_there_is(monkeypatch: pytest.MonkeyPatch):
    (pieces,) = [one for one in designing.bank() if one[0].kind == "passes" and one[0].numbers[1] == 1.0][:1]
    whole = design(monkeypatch, 0.199)._runnable(pieces, draws=True)
    assert whole is not None and np.max(np.abs(whole[1].omega)) > 0.99 * LIMITS.omega_rad_s
    assert len(whole[1].t) == pytest.approx(whole[0].seconds * 1000.0, abs=1)
    eased = design(monkeypatch, 0.3)._runnable(pieces, draws=True)
    assert eased is not None and 0.5 < np.max(np.abs(eased[1].omega)) / LIMITS.omega_rad_s <= 0.67
    assert design(monkeypatch, 1e3)._runnable(pieces, draws=True) is None
    tracks = design(monkeypatch, 0.3)._standard(500.0)
    assert len(tracks) == len(designing.STANDARD)
    assert all(np.max(np.abs(one.omega)) / LIMITS.omega_rad_s <= 0.67 for one in tracks)
    assert design(monkeypatch, 1e3)._standard(500.0) == []


def test_a_search_looks_at_fewer_samples_and_counts_them_all(monkeypatch: pytest.MonkeyPatch):
    track: Any = None
    one = design(monkeypatch, 0.1)
    assert one._search_hz() == 500.0 and one._told(track)[0].d[1, 0] == pytest.approx(5.0)
    fast = replace(LIMITS, sample_rate_hz=5000.0)
    assert replace(one, limits=fast)._search_hz() == 1250.0
    slow = replace(design(monkeypatch, 0.1), limits=replace(LIMITS, sample_rate_hz=200.0))
    assert slow._search_hz() == 200.0


def test_a_motion_that_tells_one_pair_is_not_hidden_by_another_that_none_tells(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def score(*pairs: float) -> float:
        one = design(monkeypatch, 0.1, n=3)
        one.telling.pairs = lambda told: list(pairs)  # type: ignore[method-assign,assignment]
        track: Any = None
        return one._told(track)[1]

    assert score(5.0 * TOLD, 0.1) > score(2.0 * TOLD, 0.1) > score(TOLD, TOLD / 2.0)
    # What is told beyond doubt may be less for the sake of another.
    assert score(30.0 * TOLD, 0.1) < score(4.0 * TOLD, TOLD)


def test_rivals_are_twins_where_no_first_motion_tells_them_nor_in_far_wider_limits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def twins(here: float, wide: float) -> bool:
        one = design(monkeypatch, 0.1, n=3)

        def score(self: _Design, pieces: Any, scored: list[Any]) -> None:
            wider = self.limits.omega_rad_s > LIMITS.omega_rad_s and self.limits.torque_Nm > LIMITS.torque_Nm
            d = wide if wider else here
            # One pair of three is a pair of twins in any case.
            scored.append(Scored(d, 0.0, d, pieces))

        monkeypatch.setattr(_Design, "_score", score)
        return one._twins(one._banked(math.inf))

    assert twins(0.9, 0.9)
    assert not twins(1.1, 1.1) and not twins(0.9, 1.1)
    assert not design(monkeypatch, 0.1)._twins([])


def test_the_parameter_to_be_sharpened_is_the_one_that_is_known_worst(monkeypatch: pytest.MonkeyPatch):
    alone = design(monkeypatch, 0.1, n=1)
    assert alone.param == "coulomb.pos" and design(monkeypatch, 0.1).param is None
    assert replace(alone, sharpen="inertia.M").param == "inertia.M"
    with pytest.raises(InputError, match=r"known are inertia\.M, coulomb\.pos, detent\.S"):
        _ = replace(alone, sharpen="viscous.pos").param
    alone.telling.errors = lambda track, rate_hz: {"coulomb.pos": 300.0 / rate_hz}  # type: ignore[method-assign,assignment]
    track: Any = None
    assert alone._told(track)[1] == -0.3
