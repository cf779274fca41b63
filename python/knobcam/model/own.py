"""Effects of one's own as Python functions: a load, a factor on friction, a sensor or a joint.

>>> import knobcam as kc
>>> @kc.own_effect("own_spring", law="k theta", k=kc.OwnParameter("N m/rad", linear=True))
... def own_spring(motion, k):
...     return k * motion.theta
>>> kc.effects()["own_spring"].params[0].unit
'N m/rad'
>>> kc.forget_effect("own_spring")
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar, get_type_hints

import numpy as np

from .. import _core
from ..base.door import check, checked
from ..errors import InputError

if TYPE_CHECKING:
    from ..base.arrays import FloatArray

Law = TypeVar("Law", bound=Callable[..., Any])
Acts = Literal["load", "friction", "sensor", "coupling"]
"""Where in the chain from the motion to the measured torque an effect of one's own acts."""

_GIVEN: dict[str, tuple[str, ...]] = {
    "load": ("motion",),
    "friction": ("motion",),
    "sensor": ("motion", "tau"),
    "coupling": (),
}
# What a function is given by position, before its parameters by name.

# How far three torques may be from one line before a parameter is not linear.
_STRAIGHT = 1e-6


class OwnParameter(NamedTuple):
    """A parameter of an effect of one's own: its unit in SI, such as `N m/rad`, and the bounds of its values.

    `neutral` is the value in a model until another is set. The torque of `linear` parameters together is
    proportional to them: a fit solves for them directly, so they need neither bounds nor a start.
    """

    unit: str
    lower: float = -math.inf
    upper: float = math.inf
    neutral: float = 0.0
    meaning: str = ""
    linear: bool = False


_KINDS = {name: kind.__name__ for name, kind in get_type_hints(OwnParameter).items()}


@dataclass(frozen=True, eq=False)
class OwnMotion:
    """The motion of a knob, as an effect of one's own gets it: arrays of shape (samples,), read-only, SI.

    `t` (s) grows; `theta` (rad), `omega` (rad/s) and `alpha` (rad/s^2); on a linear axis m instead of rad.
    `direction` is the sign of the motion, -1 backward to 1 forward, and between them where the sign of a
    measured omega is not certain: multiply friction by it.
    """

    t: FloatArray
    theta: FloatArray
    omega: FloatArray
    alpha: FloatArray
    direction: FloatArray


class OwnJoint(NamedTuple):
    """How an effect of one's own joins shaft and knob; the knob's side has `share` (0 to 1] of the inertia.

    Beyond half of the free play `gap` (rad) to either side a spring of `stiffness` (N m/rad) and a damper of
    `damping` (N m s/rad) push; where `pulls`, they hold on as well.
    """

    stiffness: float
    damping: float
    share: float
    gap: float = 0.0
    pulls: bool = True


@checked
def own_effect(
    name: str,
    /,
    *,
    law: str,
    acts: Acts = "load",
    source: str = "",
    shows: str = "",
    remembers: bool = False,
    starts: Iterable[Mapping[str, float]] = (),
    **params: OwnParameter,
) -> Callable[[Law], Law]:
    """Register the decorated function as the effect `name`; it is in the catalogue from then on.

    `acts` says where in the chain it acts, and so what the function gets beside its parameters by name and
    what it returns at each sample, shape (samples,):

    - `load`: `(motion, ...)`, the torque that the rig has to apply, N m (N);
    - `friction`: `(motion, ...)`, a factor on the dry friction (cut at 0.001: friction never pushes);
    - `sensor`: `(motion, tau, ...)`, the reading of the torque sensor where the torque is `tau`, N m (N);
    - `coupling`: `(...)` alone, an `OwnJoint` between shaft and knob.

    `motion` is an `OwnMotion`. The function must depend on nothing else: it is called with any stretch of any
    motion, in any order, and from several threads. With `remembers=True` it always gets a whole recording
    without gaps, so that what it returns may depend on the samples before.

    `law` is the equation in words, `source` where it is from (the function's name if empty), `shows` where
    in a measurement a person sees it; `starts` are parameter values from which a search starts, missing ones
    neutral (by default all neutral). An effect that is registered again replaces the one of the same name in
    models that are made from then on.

    Raises InputError for a name that is built in or no identifier, for parameters that are not those of the
    function, and for units, bounds, neutral values or starts that cannot be.
    """

    def register(function: Law) -> Law:
        _check(name, function, acts, params)
        _core.register_effect(
            name,
            acts,
            _line(law),
            _line(source or f"{function.__module__}.{function.__qualname__}"),
            _line(shows),
            [
                (key, p.unit, p.lower, p.upper, p.neutral, _line(p.meaning or key), p.linear)
                for key, p in params.items()
            ],
            remembers,
            [_start(name, params, start) for start in starts],
            _called(function, acts, params),
        )
        return function

    return register


@checked
def forget_effect(name: str) -> None:
    """Take an effect of one's own out of the catalogue; models that have it keep it.

    Raises InputError if none of that name is registered.
    """
    if not _core.forget_effect(name):
        raise InputError(f"effect '{name}' is none of your own that is registered")


def _line(text: str) -> str:
    """One printable line, as a comment of the model file has to be."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _check(name: str, function: Callable[..., Any], acts: str, params: Mapping[str, OwnParameter]) -> None:
    if acts not in _GIVEN:
        raise InputError(
            f"effect '{name}': acts={acts!r} is no place in the chain; choose {', '.join(_GIVEN)}"
        )
    for what, word in [("effect", name), *(("parameter", key) for key in params)]:
        check_name(what, word)
    if not params:
        raise InputError(f"effect '{name}': has no parameter, so nothing of it could be fitted; give it one")
    for key, param in params.items():
        if not isinstance(param, OwnParameter):
            raise InputError(f"parameter '{name}.{key}': is {param!r}; give an OwnParameter")
        for part, kind in _KINDS.items():
            check(f"parameter '{name}.{key}': {part}", getattr(param, part), kind)
        if param.linear and (param.lower, param.upper, param.neutral) != (-math.inf, math.inf, 0.0):
            raise InputError(
                f"parameter '{name}.{key}': a linear one has no bounds and is neutral at 0; leave out either"
            )
        if param.linear and acts in ("friction", "coupling"):
            raise InputError(
                f"parameter '{name}.{key}': no torque is proportional to it where the effect acts as {acts}; "
                "leave linear=True out"
            )
    try:
        inspect.signature(function).bind(*_GIVEN[acts], **dict.fromkeys(params, 0.0))
    except TypeError as error:
        takes = ", ".join([*_GIVEN[acts], *params])
        raise InputError(f"effect '{name}': its function must take ({takes}): {error}") from None


def check_name(what: str, word: str) -> None:
    """Raise InputError for what no model file could name."""
    if not (word.isidentifier() and word.isascii()):
        raise InputError(f"{what} {word!r}: its name must be letters a-z, digits and _, such as bump_2")


def _start(name: str, params: Mapping[str, OwnParameter], start: Mapping[str, float]) -> list[float]:
    check(f"effect '{name}': starts", start, "Mapping")
    unknown = sorted(start.keys() - params.keys())
    if unknown:
        raise InputError(f"effect '{name}': starts name '{unknown[0]}'; it has {', '.join(params)}")
    for key, value in start.items():
        check(f"effect '{name}': starts: {key}", value, "float")
    return [float(start.get(key, param.neutral)) for key, param in params.items()]


def _called(
    function: Callable[..., Any], acts: str, params: Mapping[str, OwnParameter]
) -> Callable[[list[float], list[FloatArray]], FloatArray]:
    """Return what the core calls: parameter values and columns (see its `Function`), to what the law says.

    Whatever is wrong with it is an InputError that says so in one line.
    """
    linear = [i for i, param in enumerate(params.values()) if param.linear]
    tested = not linear
    answers = "factor" if acts == "friction" else "torque"

    def call(values: list[float], given: tuple[Any, ...]) -> Any:
        try:
            return function(*given, **dict(zip(params, values, strict=True)))
        except Exception as error:
            raise InputError(f"raised {type(error).__name__}: {error}") from error

    def column(values: list[float], given: tuple[Any, ...]) -> FloatArray:
        own, samples = np.asarray(call(values, given)), given[0].t.shape
        if own.shape != samples:
            raise InputError(
                f"returned an array of shape {own.shape} for {samples}; it must be one {answers} a sample"
            )
        if own.dtype.kind not in "iuf":
            raise InputError(f"returned an array of {own.dtype}; a {answers} must be real numbers")
        return np.ascontiguousarray(own, dtype=np.float64)

    def joint(values: list[float], _: list[FloatArray]) -> FloatArray:
        made = call(values, ())
        if not isinstance(made, OwnJoint):
            raise InputError(f"returned {made!r}; a coupling returns an OwnJoint")
        try:
            sizes = [float(x) for x in (made.gap, made.stiffness, made.damping, made.share, made.pulls)]
        except (TypeError, ValueError) as error:
            raise InputError(f"returned {made!r}: {error}") from error
        return np.array(sizes)

    def answer(values: list[float], columns: list[FloatArray]) -> FloatArray:
        nonlocal tested
        for one in columns:
            one.setflags(write=False)
        t, theta, omega, alpha, forward, *tau = columns
        direction = 2.0 * forward - 1.0
        direction.setflags(write=False)
        given = (OwnMotion(t, theta, omega, alpha, direction), *tau)
        if not tested:
            _check_linear(lambda scale: column(_scaled(values, linear, scale), given), list(params), linear)
            tested = True
        return column(values, given)

    return joint if acts == "coupling" else answer


def _scaled(values: list[float], linear: list[int], scale: float) -> list[float]:
    """Values with so much of every linear parameter, none of them as large as another."""
    scaled = list(values)
    for i in linear:
        scaled[i] = scale * (1.0 + 0.5 * i)
    return scaled


def _check_linear(torque: Callable[[float], FloatArray], names: list[str], linear: list[int]) -> None:
    """Refuse a law that is not proportional to what is declared so: its fit would be wrong without a sign."""
    none, one, two = torque(0.0), torque(1.0), torque(2.0)
    size = float(np.max(np.abs(none) + np.abs(one) + np.abs(two), initial=0.0))
    if np.any(np.abs(two - 2.0 * one + none) > _STRAIGHT * size):
        which = ", ".join(names[i] for i in linear)
        raise InputError(f"is not proportional to {which}, as linear=True says; leave that out")
