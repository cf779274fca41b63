"""FMU: the render step as a slave of FMI 2.0 co-simulation, around the library of this platform."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping
from typing import TYPE_CHECKING
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
<fmiModelDescription fmiVersion="2.0" modelName={name} guid="{guid}" generationTool="knobcam"
  variableNamingConvention="flat" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="{identifier}" canHandleVariableCommunicationStepSize="true"
    canNotUseMemoryManagementFunctions="true"/>
  <DefaultExperiment startTime="0.0" stopTime="1.0" stepSize="{step!r}"/>
  <ModelVariables>
{variables}
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="{last}" dependencies=""/></Outputs>
  </ModelStructure>
</fmiModelDescription>
"""
_INPUTS = ("theta", "omega", "alpha", "tau_other")
_CHOICES = {
    "tau_other_measured": "whether tau_other, the torque of the hand, is given",
    "held": "whether the motion is imposed, and not moved by the torque",
}


def _variables(model: Model) -> str:
    torque, motion = units(model)
    about = (*motion.split(", "), f"torque of the hand, {torque}")
    lines = []
    for at, (name, what) in enumerate(zip(_INPUTS, about, strict=True)):
        lines.append((name, at, what, 'causality="input" variability="continuous"', '<Real start="0.0"/>'))
    for at, (name, what) in enumerate(_CHOICES.items()):
        attributes = 'causality="parameter" variability="tunable"'
        lines.append((name, at, what, attributes, '<Boolean start="false"/>'))
    what = f"torque that a hand has to apply, {torque}"
    attributes = 'causality="output" variability="continuous" initial="calculated"'
    lines.append(("tau", len(_INPUTS), what, attributes, "<Real/>"))
    return "\n".join(
        f'    <ScalarVariable name="{name}" valueReference="{at}" description={quoteattr(what)} {attributes}>'
        f"{kind}</ScalarVariable>"
        for name, at, what, attributes, kind in lines
    )


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write the unit: its description, the library, and rate and model as a resource."""
    resource = f"{options.rate_hz!r}\n{checked_text(model, options.rate_hz)}"
    shared = library.shared()
    description = _DESCRIPTION.format(
        header=escape(" ".join(options.header)).replace("--", "- -"),
        name=quoteattr(model.name or "knob"),
        guid=hashlib.sha256(resource.encode()).hexdigest()[:32],
        identifier=_NAME,
        step=1.0 / options.rate_hz,
        variables=_variables(model),
        last=len(_INPUTS) + len(_CHOICES) + 1,
    )
    binary = f"binaries/{library.fmi_platform()}/{_NAME}{shared.suffix}"
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
