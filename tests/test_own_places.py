"""Effects of one's own at every place of the chain: what repeats one of the catalogue is that one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import knobcam as kc

KNOB = kc.Model.load("knob3")
RISE = kc.OwnParameter("1", -0.9, 9.0, 0.0)
SPEED = kc.OwnParameter("rad/s", 0.01, 20.0, 0.5)
LIMIT = kc.OwnParameter("N m", 1e-4, 10.0, 10.0)
STIFFNESS = kc.OwnParameter("N m/rad", 1e-3, 1e5, 1e5)
DAMPING = kc.OwnParameter("N m s/rad", 1e-9, 1e2, 1e2)


def own_stribeck(motion: kc.OwnMotion, rise: float, vs: float) -> Any:
    return 1.0 + rise * np.exp(-((np.abs(motion.omega) / vs) ** 2))


def own_limit(motion: kc.OwnMotion, tau: Any, limit: float) -> Any:
    return np.clip(tau, -limit, limit)


def own_shaft(k: float, d: float) -> kc.OwnJoint:
    return kc.OwnJoint(stiffness=k, damping=d, share=0.7)


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    kc.own_effect("own_stribeck", acts="friction", law="1 + rise exp(-(omega/vs)^2)", rise=RISE, vs=SPEED)(
        own_stribeck
    )
    kc.own_effect("own_limit", acts="sensor", law="clamp(tau)", limit=LIMIT)(own_limit)
    kc.own_effect("own_shaft", acts="coupling", law="k twist + d twist'", k=STIFFNESS, d=DAMPING)(own_shaft)
    yield
    for name in ("own_stribeck", "own_limit", "own_shaft"):
        kc.forget_effect(name)


PAIRS = [
    ("own_stribeck", "stribeck", {"rise": 1.5, "vs": 0.7}, {"delta": 2.0}),
    ("own_limit", "saturation", {"limit": 0.004}, {}),
    ("own_shaft", "compliance", {"k": 0.8, "d": 0.002}, {"share": 0.7}),
]


def hidden(effect: str, values: dict[str, float]) -> kc.Model:
    model = KNOB.with_effect(effect)
    for name, value in values.items():
        model = model.with_value(f"{effect}.{name}", value)
    return model


@pytest.mark.parametrize(("own", "catalogued", "values", "more"), PAIRS)
@pytest.mark.parametrize("motion", ["sweep", "push"])
def test_what_repeats_the_catalogue_makes_the_same_capture(
    own: str, catalogued: str, values: dict[str, float], more: dict[str, float], motion: str
) -> None:
    made: Any = {"rate_hz": 1000.0, "noise": "none"}
    mine = kc.simulate(hidden(own, values), motion, **made)
    theirs = kc.simulate(hidden(catalogued, values | more), motion, **made)
    plain = kc.simulate(KNOB, motion, **made)
    assert np.max(np.abs(mine.tau - theirs.tau)) < 1e-9
    assert np.max(np.abs(mine.theta - theirs.theta)) < 1e-9
    assert np.max(np.abs(mine.tau - plain.tau)) > 1e-4


@pytest.mark.parametrize(("own", "catalogued", "values", "more"), PAIRS)
def test_it_is_fitted_as_the_one_that_it_repeats(
    own: str, catalogued: str, values: dict[str, float], more: dict[str, float]
) -> None:
    capture = kc.simulate(hidden(own, values), "sweep", rate_hz=2000.0)
    near = {name: 1.1 * value for name, value in values.items()}
    theirs = hidden(catalogued, near | more)
    for name in more:
        theirs = theirs.with_fixed(f"{catalogued}.{name}")
    mine, theirs_fitted = kc.fit(capture, model=hidden(own, near)), kc.fit(capture, model=theirs)
    assert mine.rmse == pytest.approx(theirs_fitted.rmse, rel=1e-3)
    for name in values:
        here, there = mine.params[f"{own}.{name}"], theirs_fitted.params[f"{catalogued}.{name}"]
        assert here.determined == there.determined
        assert not here.determined or abs(here.value - there.value) < 0.1 * there.se


def test_a_place_that_is_none_and_a_linear_factor_are_refused() -> None:
    with pytest.raises(kc.InputError, match="choose load, friction, sensor, coupling"):
        kc.own_effect("nowhere", acts="table", law="-", a=RISE)(lambda motion, a: a)  # type: ignore[arg-type]
    linear = kc.OwnParameter("1", linear=True)
    with pytest.raises(kc.InputError, match=r"nowhere\.a.*acts as friction"):
        kc.own_effect("nowhere", acts="friction", law="-", a=linear)(lambda motion, a: a)


def test_a_joint_that_cannot_be_is_named_with_its_values() -> None:
    kc.own_effect("bad_shaft", acts="coupling", law="-", k=STIFFNESS)(
        lambda k: kc.OwnJoint(stiffness=-k, damping=0.0, share=0.5)
    )
    kc.own_effect("no_shaft", acts="coupling", law="-", k=STIFFNESS)(lambda k: k)
    try:
        for name, said in [("bad_shaft", "stiffness above 0"), ("no_shaft", "returns an OwnJoint")]:
            with pytest.raises(kc.InputError, match=said):
                kc.simulate(KNOB.with_effect(name), "sweep", noise="none")
    finally:
        kc.forget_effect("bad_shaft")
        kc.forget_effect("no_shaft")
