"""FMU: the render step as a slave of FMI co-simulation, 2.0 or 3.0, around the library of this platform."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple
from xml.sax.saxutils import escape, quoteattr

from ...model import Model
from . import library
from .c import checked_text, units
from .conversion import Form
from .target import Options, Target, judged_by_the_step

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from .terms import Term

_NAME = "knobcam"
_RESOURCE = "resources/knob.txt"
_WRITTEN = (1980, 1, 1, 0, 0, 0)  # the same model gives the same file
_DESCRIPTION = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- {header} -->
<fmiModelDescription fmiVersion="{version}.0" modelName={name} {token}="{digest}" generationTool="knobcam"
  variableNamingConvention="flat"{more}>
  <CoSimulation modelIdentifier="{identifier}" canHandleVariableCommunicationStepSize="true"{offers}/>
  <DefaultExperiment startTime="0.0" stopTime="1.0" stepSize="{step!r}"/>
  <ModelVariables>
{variables}
  </ModelVariables>
  <ModelStructure>
{structure}
  </ModelStructure>
</fmiModelDescription>
"""
_INPUTS = ("theta", "omega", "alpha", "tau_other")
_CHOICES = {
    "tau_other_measured": "whether tau_other, the torque of the hand, is given",
    "held": "whether the motion is imposed, and not moved by the torque",
}


class _Variable(NamedTuple):
    """A variable of the unit: a number, or a choice; `start` where it is set from outside."""

    name: str
    what: str
    attributes: str
    start: str | None = None

    @property
    def choice(self) -> bool:
        return self.start == "false"


def _variables(model: Model) -> list[_Variable]:
    torque, motion = units(model)
    about = (*motion.split(", "), f"torque of the hand, {torque}")
    given = 'causality="input" variability="continuous"'
    tuned = 'causality="parameter" variability="tunable"'
    made = 'causality="output" variability="continuous" initial="calculated"'
    return [
        *(_Variable(name, what, given, "0.0") for name, what in zip(_INPUTS, about, strict=True)),
        _Variable("tau", f"torque that a hand has to apply, {torque}", made),
        *(_Variable(name, what, tuned, "false") for name, what in _CHOICES.items()),
    ]


def _second(every: Sequence[_Variable]) -> dict[str, str]:
    """What a description of FMI 2.0 has otherwise than one of 3.0: numbers and choices are counted apart."""
    lines = []
    for at, one in enumerate(every):
        start = "" if one.start is None else f' start="{one.start}"'
        lines.append(
            f'    <ScalarVariable name="{one.name}" valueReference="{at - one.choice * _COUNT}" '
            f"description={quoteattr(one.what)} {one.attributes}>"
            f"<{'Boolean' if one.choice else 'Real'}{start}/></ScalarVariable>"
        )
    unknown = f'<Unknown index="{_COUNT}" dependencies=""/>'
    return {
        "token": "guid",
        "more": ' numberOfEventIndicators="0"',
        "offers": ' canNotUseMemoryManagementFunctions="true"',
        "variables": "\n".join(lines),
        "structure": f"    <Outputs>{unknown}</Outputs>\n    <InitialUnknowns>{unknown}</InitialUnknowns>",
    }


def _third(every: Sequence[_Variable]) -> dict[str, str]:
    """What a description of FMI 3.0 has otherwise: all are counted in one row, and time is one of them."""
    time = _Variable("time", "s", 'causality="independent" variability="continuous"')
    lines = []
    for at, one in enumerate([*every[:_COUNT], time, *every[_COUNT:]]):
        start = "" if one.start is None else f' start="{one.start}"'
        lines.append(
            f'    <{"Boolean" if one.choice else "Float64"} name="{one.name}" valueReference="{at}" '
            f"description={quoteattr(one.what)} {one.attributes}{start}/>"
        )
    unknown = f'valueReference="{_COUNT - 1}" dependencies=""/>'
    return {
        "token": "instantiationToken",
        "more": "",
        "offers": "",
        "variables": "\n".join(lines),
        "structure": f"    <Output {unknown}\n    <InitialUnknown {unknown}",
    }


_COUNT = len(_INPUTS) + 1  # of numbers, the torque last
_VERSIONS = {2: _second, 3: _third}


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write the unit: its description, the library, and rate and model as a resource."""
    resource = f"{options.rate_hz!r}\n{checked_text(model, options.rate_hz)}"
    shared = library.shared()
    description = _DESCRIPTION.format(
        header=escape(" ".join(options.header)).replace("--", "- -"),
        version=options.fmi,
        name=quoteattr(model.name or "knob"),
        digest=hashlib.sha256(resource.encode()).hexdigest()[:32],
        identifier=_NAME,
        step=1.0 / options.rate_hz,
        **_VERSIONS[options.fmi](_variables(model)),
    )
    binary = f"binaries/{library.fmi_platform(options.fmi)}/{_NAME}{shared.suffix}"
    unit = io.BytesIO()
    with zipfile.ZipFile(unit, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in (
            ("modelDescription.xml", description.encode()),
            (binary, shared.read_bytes()),
            (_RESOURCE, resource.encode()),
        ):
            archive.writestr(zipfile.ZipInfo(name, _WRITTEN), content, zipfile.ZIP_DEFLATED)
    step = f"A communication step is {1.0 / options.rate_hz:g} s, or a whole number of them."
    return Form((), unit.getvalue(), remarks=(step,))


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that the library renders of the unit's resource along the motion, N m."""
    assert isinstance(form.content, bytes)
    with zipfile.ZipFile(io.BytesIO(form.content)) as archive:
        text = archive.read(_RESOURCE).decode()
    return library.torque_along(text.partition("\n")[2], options)


TARGET = Target(judged_by_the_step, write, measure)
