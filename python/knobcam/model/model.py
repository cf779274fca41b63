"""Models: effects of the catalogue with their parameters, as files that a person can read and edit."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import _core
from ..base import leaving, showing
from ..base.door import checked
from ..base.reading import open_file, read_text
from ..base.renamed import renamed
from ..base.tables import TextTable, text_table
from ..base.writing import write
from ..capture.formats.units import torque_unit_of
from ..capture.motor import torque_per_unit
from ..errors import InputError
from .effects import Effect, effects, of_rows
from .plugins import load_plugins

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from ..base.leaving import Left
    from ..base.showing import Figure
    from ..capture.formats.units import Coordinate

KNOBS = ("knob1", "knob2", "knob3", "knob4", "knob5")
_HEAD_BYTES = 4096  # in which a model file has its schema, below whatever its author remarks
_MOST_BYTES = 1_000_000  # of a file that takes a few thousand


class Parameter(NamedTuple):
    """One parameter of a model: its value in SI, unit, and role (free, fixed, or what it is tied to)."""

    name: str
    value: float
    unit: str
    role: str


@dataclass(frozen=True, eq=False, repr=False)
class Model(showing.Tabled):
    """An immutable chain of effects with values; changing one returns a new model."""

    core: _core.Model

    @classmethod
    @renamed(axis="coordinate")
    @checked
    def of(
        cls, effects: Iterable[str], coordinate: Coordinate = "rotary", torque_unit: str = "", **values: float
    ) -> Model:
        """Return a model of these effects; values by `effect__parameter=1.0`, others are neutral.

        `torque_unit` is A, V or duty for one of what a motor is given.
        """
        load_plugins()
        unit = torque_unit_of(torque_unit, coordinate)
        model = cls(_core.Model(list(effects), coordinate, torque_unit=unit))
        if not model.effects:
            raise InputError("a model needs an effect, such as inertia; `effects()` lists them")
        for name, value in values.items():
            model = model.with_value(name.replace("__", "."), value)
        return model

    @classmethod
    @checked
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model file, or one of the shipped models by name (knob1 to knob5)."""
        name = str(path)
        if name in KNOBS:
            shipped = resources.files("knobcam.model.knobs").joinpath(f"{name}.toml")
            return cls.parse(shipped.read_text("utf-8"))
        try:
            text = read_text(path, "model file", _MOST_BYTES)
        except InputError as error:
            raise InputError(f"{error}: a model file, or one of {', '.join(KNOBS)}") from None
        try:
            return cls.parse(text)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    @staticmethod
    def is_named(path: str) -> bool:
        """Whether a path is meant as a model: a shipped name, a TOML file, or one that says so on top."""
        if path in KNOBS or path.lower().endswith(".toml"):
            return True
        try:
            with open_file(path) as file:
                return b"knobcam.model/" in file.read(_HEAD_BYTES)
        except (InputError, OSError):
            return False

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.text() == other.text()

    def __hash__(self) -> int:
        return hash(self.text())

    def __reduce__(self) -> tuple[Any, ...]:
        return Model.parse, (self.text(),)

    @classmethod
    @checked
    def parse(cls, text: str) -> Model:
        """Read a model from the text of its file."""
        load_plugins()
        return cls(_core.Model.parse(text))

    def text(self) -> str:
        """The text of the model file; `parse` gives the same model back, to the last bit."""
        return self.core.text()

    @checked
    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the model file; it appears whole or not at all."""
        return write(path, self.text())

    @property
    def name(self) -> str:
        """What a person calls it."""
        return self.core.name

    @property
    def coordinate(self) -> Coordinate:
        """Rotary or linear."""
        return self.core.axis

    @property
    def axis(self) -> Coordinate:
        """The older name of `coordinate`."""
        warnings.warn("Model.axis is now called coordinate", DeprecationWarning, stacklevel=2)
        return self.coordinate

    @property
    def torque_unit(self) -> str:
        """What its torques are in: N m (N on a linear axis), or of a motor A, V or duty."""
        return self.core.torque_unit

    @property
    def effects(self) -> tuple[str, ...]:
        """Ids of its effects, in the order of the catalogue."""
        return tuple(self.core.effects)

    @property
    def joint(self) -> str | None:
        """The effect that joins shaft and knob; None where they are one."""
        rows = self.catalogue()
        return next((one for one in self.effects if rows[one].place == "coupling"), None)

    def catalogue(self) -> dict[str, Effect]:
        """Return the catalogue by id, with the laws that the model carries itself in place of their names."""
        return effects(self.coordinate) | of_rows(self.core.own_rows())

    @property
    def laws(self) -> Mapping[str, str]:
        """The formulas that the model carries itself, by the name of the effect that each is."""
        return {name: row.law for name, row in of_rows(self.core.own_rows()).items()}

    @property
    def params(self) -> Mapping[str, Parameter]:
        """All parameters by `effect.parameter`."""
        return {row[0]: Parameter(*row) for row in self.core.rows()}

    @property
    def phases(self) -> frozenset[str]:
        """The parameters that are phases: angles of which zero is a value like any other."""
        rows = self.catalogue()
        split = {name: name.partition(".") for name in self.params}
        return frozenset(
            name for name, (effect, _, own) in split.items() if rows[effect].parameter(own).phase
        )

    @property
    def fitted_to(self) -> tuple[str, ...]:
        """The captures that its values come from, name and fingerprint each; none where nobody said."""
        return tuple(self.core.fitted_to)

    @property
    def reach(self) -> tuple[float, float] | None:
        """How far to both sides of zero and how fast it is turned, rad and rad/s (m, m/s); None: not said."""
        reach = self.core.reach
        return None if reach is None else (reach[0], reach[1])

    @property
    def period(self) -> float | None:
        """Period of its detents over 2 pi, rad or m; None without detents."""
        return self.core.period

    @checked
    def with_value(self, name: str, value: float) -> Model:
        """Return the model with one parameter set."""
        return Model(self.core.with_value(name, value))

    @checked
    def with_reach(self, angle: float, speed: float = 5.0) -> Model:
        """Return the model as one that is turned by up to `angle` to both sides of zero, rad (m if linear).

        `speed` is how fast at most, rad/s, m/s. Whether it may be rendered is asked over these; by default a
        turn and 5 rad/s (1 m and 1 m/s). InputError for more than 200 rad or 100 rad/s.
        """
        return Model(self.core.with_reach((angle, speed)))

    @checked
    def with_fixed(self, name: str, fixed: bool = True) -> Model:
        """Return the model with one parameter kept from being fitted, or freed."""
        return Model(self.core.with_fixed(name, fixed))

    def frozen(self) -> Model:
        """Return the model with every parameter kept as it is: fitting it only measures its error."""
        model = self
        for name in self.params:
            model = model.with_fixed(name)
        return model

    @checked
    def with_tie(self, name: str, to: str) -> Model:
        """Return the model with one parameter always equal to another."""
        return Model(self.core.with_tie(name, to))

    @property
    def at_shaft(self) -> tuple[str, ...]:
        """Ids of the effects that load the shaft, before the joint; the others act on the knob."""
        return tuple(self.core.at_shaft)

    @property
    def sides(self) -> tuple[str, ...]:
        """What stands at the shaft, a sentence; nothing where all loads act on the knob."""
        names = " and ".join(self.at_shaft)
        load = "loads" if len(self.at_shaft) == 1 else "load"
        return (f"{names} {load} the shaft, before the joint to the knob.",) if names else ()

    @checked
    def with_effect(self, effect: str) -> Model:
        """Return the model with one effect more, at its neutral values."""
        return Model(self.core.with_effect(effect))

    @checked
    def with_at_shaft(self, effect: str) -> Model:
        """Return the model with a load of it at the shaft, before the backlash or compliance of the model.

        Raises InputError for a model without a joint, and for what cannot be there: the base model's loads,
        sensors, what is an inertia, and functions of one's own.
        """
        return Model(self.core.with_at_shaft(effect))

    @checked
    def as_torque(self, *, kt: float | None, resistance_ohm: float | None = None) -> Model:
        """Return the model of a motor in A or V with its torques in N m, by its torque constant, N m/A.

        In V the resistance of the winding has to be known too: what is in proportion to the speed holds the
        back-EMF, which is taken off. On a linear axis N and N/A. InputError says what is missing or too much.
        """
        try:
            return Model(self.core.as_torque(*torque_per_unit(self.torque_unit, kt, resistance_ohm)))
        except InputError as error:
            raise InputError(f"model '{self.name}': {error}" if self.name else str(error)) from None

    def to(self, target: str, **options: Any) -> Left:
        """Return the model in another form: mujoco, c, fmu, cogging-table, urdf or modelica.

        What becomes of each effect there, the torque error, and the file, which `save(path)` writes. Options
        are `without` (effects to be left out, or "impossible"), `motion`, `rate_hz`, `kt`, `suffix`, `fmi`,
        as in `knobcam.render.convert.convert`. Raises InputError for an effect that is impossible there.
        """
        return leaving.convert(self, target, **options)

    @checked
    def renamed(self, name: str) -> Model:
        """Return the model under another name."""
        return Model(self.core.renamed(name))

    def plot(self) -> Figure:
        """Friction over velocity and torque over position, as in Figures 2 and 3 of the paper."""
        return showing.plot(self)

    def _table(self) -> list[tuple[str, ...]]:
        return [(p.name, f"{p.value:.6g}", p.unit, p.role) for p in self.params.values()]

    def __repr__(self) -> str:
        title = f"Model {self.name}".rstrip()
        return title + "\n" + text_table(("parameter", "value", "unit", "role"), self._table())

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(f"Model {self.name}", ("parameter", "value", "unit", "role"), self._table()),)
