"""Wrong values for every parameter of the public functions: each is taken, or refused by a KnobcamError."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

import knobcam as kc
from knobcam.rig.calibration import Calibration

WRONG: dict[str, Any] = {
    "None": None,
    "five": 5,
    "minus one": -1,
    "zero": 0,
    "a half": 0.5,
    "nan": float("nan"),
    "inf": float("inf"),
    "a whole number beyond any float": 10**400,
    "a text": "x",
    "an empty text": "",
    "a text with a zero in it": "a\0b",
    "bytes": b"x",
    "True": True,
    "a complex number": 1j,
    "an empty list": [],
    "a list of None": [None],
    "a dict": {},
    "an object": object(),
    "zeros": np.zeros(3),
    "an array of no axis": np.array(1j),
    "complex numbers": np.zeros(2500) + 1j,
    "truths": np.zeros(2500, dtype=bool),
    "objects": np.full(2500, None),
    "infinities": np.full(2500, np.inf),
    "a matrix": np.zeros((2500, 2)),
    "a function": len,
}
_NOT_VALUES = {"cls", "self", "progress"}


class Call(NamedTuple):
    """A public function, whose signature it has, and how it is called with some arguments changed."""

    function: Callable[..., Any]
    run: Callable[..., Any]


def calls() -> dict[str, Call]:
    """Return the public functions by name, each with arguments that are right."""
    capture = kc.simulate("knob3", duration_s=0.5)
    fit = kc.fit(capture)
    t = np.arange(2500) / 5000.0
    sine, cosine = np.sin(9.0 * t), np.cos(9.0 * t)
    track = {"t": t, "theta": sine, "omega": 9.0 * cosine, "alpha": -81.0 * sine}
    arrays = {"theta": capture.theta, "tau": capture.tau, "rate_hz": 5000.0}
    own = {**arrays, "t": t, "omega": None, "alpha": None, "mask": t >= 0.0, "coordinate": "rotary"}

    def usual(function: Callable[..., Any], **right: Any) -> Call:
        return Call(function, lambda **wrong: function(**{**right, **wrong}))

    def simulated(**parts: Any) -> kc.Capture:
        return kc.simulate("knob3", kc.MotionTrack(**{**track, **parts}))

    def noisy(**parts: Any) -> kc.Capture:
        return kc.simulate("knob3", noise=kc.SensorNoise(**parts), duration_s=0.1)

    def on_device(**parts: Any) -> kc.Stability:
        return kc.check_stability("knob3", kc.Device(**parts))

    def own_effect(name: Any = "wrongly_called", **wrong: Any) -> None:
        law = kc.own_effect(name, **{"law": "k theta", "k": kc.OwnParameter("N m/rad"), **wrong})
        law(lambda motion, k: k * motion.theta)

    def own_parameter(**parts: Any) -> None:
        own_effect(k=kc.OwnParameter(**{"unit": "1", **parts}))

    knob = kc.Renderer("knob3")
    return {
        "fit": usual(kc.fit, captures=capture),
        "load": usual(kc.load, path="no such file"),
        "simulate": usual(kc.simulate, model="knob3", duration_s=0.1),
        "prepare": usual(kc.prepare, capture=capture),
        "motion": usual(kc.motion, name="sweep", duration_s=0.1),
        "compare": usual(kc.compare, fit=fit),
        "stiction": usual(kc.stiction, fit=fit),
        "diagnose": usual(kc.diagnose, fit=fit, only=["bias"]),
        "check_stability": usual(kc.check_stability, model="knob3"),
        "effects": usual(kc.effects),
        "forget_effect": usual(kc.forget_effect, name="nobody's"),
        "Renderer": Call(kc.Renderer.__new__, lambda **wrong: kc.Renderer(**{"model": "knob3", **wrong})),
        "Capture": usual(kc.Capture, **own),
        "Capture.from_arrays": usual(kc.Capture.from_arrays, **arrays),
        "Capture.prepare": usual(capture.prepare),
        "Capture.as_torque": usual(capture.as_torque, kt=1.0),
        "Fit.predict": usual(fit.predict, capture=capture),
        "Fit.add": usual(fit.add, effect="bias"),
        "Fit.drop": usual(fit.drop, effect="viscous"),
        "Fit.compare": usual(fit.compare),
        "Fit.forward": usual(fit.forward),
        "Model.load": usual(kc.Model.load, path="knob3"),
        "Model.parse": usual(kc.Model.parse, text=""),
        "Model.with_value": usual(fit.model.with_value, name="inertia.M", value=1.0),
        "Model.with_fixed": usual(fit.model.with_fixed, name="inertia.M"),
        "Model.with_effect": usual(fit.model.with_effect, effect="bias"),
        "Model.renamed": usual(fit.model.renamed, name="x"),
        "Model.of": usual(kc.Model.of, effects=["inertia"]),
        "Model.with_tie": usual(fit.model.with_tie, name="viscous.pos", to="viscous.neg"),
        "Model.with_reach": usual(fit.model.with_reach, angle=6.0),
        "Model.with_at_shaft": usual(fit.model.with_at_shaft, effect="coulomb"),
        "Model.as_torque": usual(fit.model.as_torque, kt=1.0),
        "learn": usual(kc.learn, captures=capture, budget_s=0.01),
        "hiding": usual(kc.hiding, knob="knob3"),
        "fit_constants": usual(kc.fit_constants, paths="no such file", map="tau=k*x, theta=y", free="k"),
        "Renderer.step": usual(knob.step, theta=0.0, omega=0.0),
        "Renderer.along": usual(knob.along, theta=sine, omega=cosine),
        "Device": Call(kc.Device, on_device),
        "EmulatedHandle": Call(kc.EmulatedHandle.__new__, lambda **wrong: kc.EmulatedHandle(**wrong)),
        "start_loop": usual(kc.start_loop, controller=None, device=None, seconds=0.01),
        "own_effect": Call(kc.own_effect, own_effect),
        "OwnParameter": Call(kc.OwnParameter, own_parameter),
        "record": usual(kc.record, port="no such port", output="no such folder/run.npz"),
        "Link": usual(kc.Link, port="no such port"),
        "WireLog.load": usual(kc.WireLog.load, path="no such file"),
        "Calibration.load": usual(Calibration.load, path="no such file"),
        "MotionTrack": Call(kc.MotionTrack, simulated),
        "SensorNoise": Call(kc.SensorNoise, noisy),
    }


def parameters(call: Call) -> list[str]:
    """Return the names of what a function is given."""
    kinds = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
    every = inspect.signature(call.function).parameters.values()
    return [one.name for one in every if one.kind not in kinds and one.name not in _NOT_VALUES]


def tried(call: Call, parameter: str, value: Any) -> str | None:
    """Return what is wrong with how a call ended; None where it was taken, or refused in one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call.run(**{parameter: value})
        except kc.KnobcamError as error:
            return None if error.exit_code == 2 and str(error) and "\n" not in str(error) else repr(error)
        except BaseException as error:  # a panic of the core is no Exception
            return f"{type(error).__name__}: {error}"
    return None


def every() -> Iterator[tuple[str, str | None]]:
    """Try each value for each parameter of each function."""
    for name, call in calls().items():
        for parameter in parameters(call):
            for said, value in WRONG.items():
                yield f"{name}({parameter}={said})", tried(call, parameter, value)
