"""C: a header with the model as a constant, for the render step as a library. No physics is written in C."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...model import Model
from . import library
from .conversion import Form
from .target import Options, Target, judged_by_the_step, rendered

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from .terms import Term

_HEADER = """\
/* {about}

   The render step of knobcam: compile as C or C++ and link the library knobstep, which needs no operating
   system and no heap:

       {link}

   Only knob_new takes memory, of what it sets aside; a step takes none, and never locks, waits or prints. */
#ifndef KNOBCAM_KNOB_H
#define KNOBCAM_KNOB_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {{
#endif

typedef struct knobcam_knob knobcam_knob;

/* Memory that knobs are made in, no longer yours; several are shared out together. The shared library takes
   its own. knobcam_needs: how many bytes it takes at most to make a knob of a model. */
void knobcam_memory(void *memory, size_t bytes);
size_t knobcam_needs(const char *model);
/* NULL where the model cannot be rendered; `why` (of `room` bytes, or NULL) then says so. `held`: 0 on a
   handle that a hand turns or that a simulation moves by the torque, 1 where the motion is imposed. */
knobcam_knob *knobcam_new(const char *model, double rate_hz, int held, char *why, size_t room);
/* The torque that a hand has to apply, {torque}; the motor applies its negative. {motion}.
   Call it once a sample. */
double knobcam_step(knobcam_knob *knob, double theta, double omega, double alpha);
/* The same where the torque of the hand is measured, {torque}. */
double knobcam_step_beside(knobcam_knob *knob, double theta, double omega, double alpha, double tau_other);
/* 0: it renders. Else it has let go until it is reset: 1 not finite, 2 a jump, 3 its torque, 4 energy. */
int knobcam_fault(const knobcam_knob *knob);
void knobcam_reset(knobcam_knob *knob);
void knobcam_free(knobcam_knob *knob);

#define KNOB_RATE_HZ {rate!r}
#define KNOB_MEMORY {needs} /* bytes */

static const char KNOB_MODEL[] =
{model};

/* For one knob; for more of them give more by knobcam_memory first. */
static inline knobcam_knob *knob_new(int held, char *why, size_t room) {{
    static double memory[KNOB_MEMORY / sizeof(double)];
    static int given = 0;
    if (!given) {{ knobcam_memory(memory, sizeof memory); }}
    given = 1;
    return knobcam_new(KNOB_MODEL, KNOB_RATE_HZ, held, why, room);
}}

#ifdef __cplusplus
}}
#endif

#endif
"""


def checked_text(model: Model, rate_hz: float) -> str:
    """Return the text of a model that the render step takes. InputError says why it does not."""
    rendered(model, rate_hz)
    return model.text()


def in_few_words(model: Model) -> Model:
    """Return a model whose file is shorter: what a fit may do with a parameter is nothing to a renderer."""
    for name, param in model.params.items():
        if param.role in ("free", "fixed"):
            other = model.with_fixed(name, param.role == "free")
            model = min(model, other, key=lambda one: len(one.text()))
    return model


def literal(text: str) -> str:
    """Return a text as a constant of C, line by line; JSON escapes alike, but for what is not ASCII."""
    plain = "".join(one if one.isascii() else "?" for one in text)
    return "\n".join(f"    {json.dumps(line)}" for line in plain.splitlines(keepends=True))


def units(model: Model) -> tuple[str, str]:
    """Return the unit of the torque, and what the motion is in."""
    if model.coordinate == "linear":
        return "N", "Position m, speed m/s, acceleration m/s^2"
    return "N m", "Angle rad, speed rad/s, acceleration rad/s^2"


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write the header; the library comes with the package."""
    static, shared = library.static(), library.shared()
    link = f"gcc -O2 main.c {static or shared}"
    if static is None:
        link += f" -Wl,-rpath,{shared.parent}"
    constant = checked_text(in_few_words(model), options.rate_hz)
    torque, motion = units(model)
    text = _HEADER.format(
        about=" ".join(options.header).replace("*/", "* /"),
        link="gcc -O2 main.c libknobstep.a",
        torque=torque,
        motion=motion,
        rate=options.rate_hz,
        model=literal(constant),
        needs=-8 * (-library.needs(constant) // 8),
    )
    return Form((), text, remarks=(f"To link a program with it: {link}",))


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that the library renders of the constant in the header along the motion, N m."""
    constant = str(form.content).partition("KNOB_MODEL[] =\n")[2].partition(";\n")[0]
    return library.torque_along("".join(map(json.loads, re.findall(r'(?m)^    (".*")$', constant))), options)


TARGET = Target(judged_by_the_step, write, measure)
