"""Modelica: a block whose equation is one call of the render step in C; no physics is written in Modelica."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...model import Model
from . import library
from .c import checked_text, literal, units
from .conversion import Form
from .target import Options, Target, judged_by_the_step

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from .terms import Term

_INCLUDE = """\
#include <stddef.h>
#include "ModelicaUtilities.h"
void *knobcam_new(const char *model, double rate_hz, int held, char *why, size_t room);
double knobcam_step(void *knob, double theta, double omega, double alpha);
void knobcam_free(void *knob);
static void *knobcam_modelica_new(const char *model, double rate_hz, int held) {
  char why[400];
  void *knob = knobcam_new(model, rate_hz, held, why, sizeof why);
  if (knob == NULL) ModelicaFormatError("%s", why);
  return knob;
}
"""
_BLOCK = """\
block Knob {about}
  parameter Boolean held = false "whether the motion is imposed, and not moved by the torque";
  Modelica.Blocks.Interfaces.RealInput theta "{motion}";
  Modelica.Blocks.Interfaces.RealInput omega;
  Modelica.Blocks.Interfaces.RealInput alpha;
  Modelica.Blocks.Interfaces.RealOutput tau(start = 0.0, fixed = true) "torque of a hand, {torque}";
protected
  constant Real rate_hz = {rate!r};
  constant String model_text =
{model};
  Step knob = Step(model_text, rate_hz, if held then 1 else 0);

  class Step "the render step of knobcam"
    extends ExternalObject;
    function constructor
      input String model_text;
      input Real rate_hz;
      input Integer held;
      output Step knob;
      external "C" knob = knobcam_modelica_new(model_text, rate_hz, held)
        annotation(Library = "knobstep", Include =
{include});
    end constructor;
    function destructor
      input Step knob;
      external "C" knobcam_free(knob) annotation(Library = "knobstep");
    end destructor;
  end Step;

  impure function torque
    input Step knob;
    input Real theta;
    input Real omega;
    input Real alpha;
    output Real tau;
    external "C" tau = knobcam_step(knob, theta, omega, alpha) annotation(Library = "knobstep");
  end torque;
equation
  when sample(0.0, 1.0 / rate_hz) then
    tau = torque(knob, theta, omega, alpha);
  end when;
end Knob;
"""


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write the block; the library comes with the package."""
    torque, motion = units(model)
    text = _BLOCK.format(
        about=json.dumps(" ".join(options.header), ensure_ascii=False),
        motion=motion,
        torque=torque,
        rate=options.rate_hz,
        model=_lines(literal(checked_text(model, options.rate_hz))),
        include=json.dumps(_INCLUDE),  # not every compiler works out a sum of texts here
    )
    return Form((), text, remarks=(f"Its library knobstep is in {library.shared().parent}.",))


def _lines(constant: str) -> str:
    """Join the lines of a constant as Modelica does, which knows no texts side by side."""
    return constant.replace("\n", " +\n")


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that the library renders of the model along the motion, N m."""
    return library.torque_along(model.text(), options)


TARGET = Target(judged_by_the_step, write, measure)
