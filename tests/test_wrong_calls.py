"""Every array and number of the public functions is taken, or refused by its name in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from wrong_calls import WRONG, Call, calls, every, parameters, tried

import knobcam as kc
from knobcam.base.door import checked
from knobcam.errors import InputError


def test_no_wrong_value_of_any_parameter_ends_in_anything_but_a_refusal() -> None:
    ended = list(every())
    assert len(ended) > 4000
    assert [(what, why) for what, why in ended if why is not None] == []


@pytest.fixture(scope="module")
def public() -> dict[str, Call]:
    return calls()


ODD = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.floats(),
        st.complex_numbers(),
        st.text(max_size=5),
        st.binary(max_size=5),
    )
    | st.integers(-(10**30), 5)
    | st.sampled_from(list(WRONG.values())),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=6,
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), value=ODD)
def test_no_value_at_all_does(data: st.DataObject, value: object, public: dict[str, Call]) -> None:
    name = data.draw(st.sampled_from(sorted(public)))
    parameter = data.draw(st.sampled_from(parameters(public[name])))
    assert tried(public[name], parameter, value) is None


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: kc.Renderer("knob3").step("x", 0.0), "theta: is a str and no number"),
        (lambda: kc.Device(held=3), r"held: is 3 \(int\); give True or False"),
        (lambda: kc.Model.of(["inertia"], "round"), "coordinate='round' is unknown; choose rotary or linear"),
        (lambda: kc.Link("a\0b"), "there is no such port"),
        (lambda: kc.fit(None), "captures: is None; give a Capture"),
        (lambda: kc.fit(5), r"captures: is 5 \(int\); give"),
        (lambda: kc.load("a.csv", rate_hz="x"), "rate_hz: is the text 'x'; give a number or None"),
        (lambda: kc.simulate("knob3", rate_hz=0), "a rate of 0 Hz"),
        (lambda: kc.simulate("knob3", rate_hz=float("nan")), "rate_hz: is NaN; give a number"),
        (lambda: kc.simulate("knob3", seed=-1), "seed=-1"),
        (lambda: kc.simulate("knob3", noise=kc.SensorNoise(tau_sd=-1.0)), "noise.tau_sd"),
    ],
)
def test_a_refusal_says_the_name_what_came_and_what_is_wanted(call: object, words: str) -> None:
    assert callable(call)
    with pytest.raises(InputError, match=words):
        call()


@pytest.mark.parametrize(
    ("dtype", "words"), [(complex, "complex numbers"), (bool, "truths"), (object, "objects"), (str, "text")]
)
def test_arrays_of_anything_but_real_numbers_are_refused(dtype: type, words: str) -> None:
    theta = np.sin(np.arange(3000) / 300.0)
    with pytest.raises(InputError, match=f"theta: holds {words}; give an array of real numbers"):
        kc.Capture.from_arrays(theta=theta.astype(dtype), tau=theta, rate_hz=1000.0)


def test_what_a_mask_hides_is_no_reading() -> None:
    theta = np.sin(np.arange(3000) / 300.0)
    hidden = np.ma.masked_array(theta, np.arange(3000) == 7)
    capture = kc.Capture.from_arrays(theta=theta, tau=hidden, rate_hz=1000.0)
    assert np.flatnonzero(~capture.mask).tolist() == [7]


def test_infinite_stamps_are_masked_or_refused(tmp_path: Path) -> None:
    t, theta = np.arange(3000) / 1000.0, np.sin(np.arange(3000) / 300.0)
    t[5] = np.inf
    np.save(tmp_path / "some.npy", np.stack([t, theta, theta], axis=1))
    some = kc.load(tmp_path / "some.npy", map="t=c0, theta=c1, tau=c2")
    assert not some.mask[5] and some.mask.sum() >= 2990
    np.save(tmp_path / "all.npy", np.stack([np.full(3000, np.inf), theta, theta], axis=1))
    with pytest.raises(InputError, match="column t has no number"):
        kc.load(tmp_path / "all.npy", map="t=c0, theta=c1, tau=c2")


def test_a_motion_at_one_velocity_is_named_as_the_cause() -> None:
    t = np.arange(6000) / 1000.0
    tau = 0.01 + 0.001 * np.random.default_rng(1).standard_normal(6000)
    with pytest.raises(
        InputError, match=r"theta moves at one velocity, 2 rad/s; record a motion that changes"
    ):
        kc.fit(kc.Capture.from_arrays(t=t, theta=2.0 * t, tau=tau))


def test_a_track_of_columns_that_do_not_fit_is_refused() -> None:
    t = np.arange(1000) / 1000.0
    with pytest.raises(InputError, match=r"motion.omega: is not as long as t, 1000 samples"):
        kc.simulate("knob3", kc.MotionTrack(t, t, t[:9], t))
    with pytest.raises(InputError, match=r"motion.t: does not advance"):
        kc.simulate("knob3", kc.MotionTrack(t[::-1], t, t, t))


def test_the_door_lets_through_what_fits_and_keeps_defaults() -> None:
    @checked
    def asked(name: str, rate_hz: float = 2.0, *more: int, **options: float) -> tuple[object, ...]:
        return name, rate_hz, more, options

    assert asked("a") == ("a", 2.0, (), {})
    assert asked("a", np.float32(1.0), 3, b=4) == ("a", 1.0, (3,), {"b": 4})
    for wrong in ({"name": 1}, {"name": "a", "rate_hz": True}, {"name": "a", "b": "c"}):
        with pytest.raises(InputError):
            asked(**wrong)  # type: ignore[arg-type]
