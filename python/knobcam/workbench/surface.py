"""What is left over two variables, beside what each law makes of it there: both as means around places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..learn.around import MAGNITUDE, Around

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..base.pages_left import Surface
    from ..learn.proposals import Proposals


def document(found: Proposals | None) -> Surface | None:
    """Return what is left as a map with those of the laws; None where no law is of two variables."""
    mapped = None if found is None else found.map
    if found is None or mapped is None:
        return None
    names = {"omega" if one == MAGNITUDE else one for one in mapped.over}
    both = [names <= {*one.variables} for one in found.laws]
    if not any(both):
        return None
    left = found.beside.residual
    around = Around(found.beside.prepared, mapped)
    laws = [
        around.mean(left - one.fit.residual) if of_both else None
        for one, of_both in zip(found.laws, both, strict=True)
    ]
    return {
        "over": mapped.over,
        "times": mapped.times,
        "x": mapped.x.tolist(),
        "y": mapped.y.tolist(),
        "value": _told(mapped.value),
        "laws": [None if law is None else _told(law) for law in laws],
    }


def _told(value: FloatArray) -> list[list[float | None]]:
    return [[float(one) if np.isfinite(one) else None for one in row] for row in value]
