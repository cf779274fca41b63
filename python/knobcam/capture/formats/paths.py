"""Columns that are named by their place in a message, as PlotJuggler exports `sensor_msgs/JointState`.

`/joint_states/joint1/position` where it knew the joints' names, `/joint_states/position[0]` where it did not.
"""

from __future__ import annotations

import re
from dataclasses import replace

from .table import Table, choose

_PLACE = re.compile(r"/(?:.*/)?([^/]+)/(?:position|velocity|effort)(?:\[(\d{1,3})\])?")


def of_joint(table: Table, joint: str) -> Table | None:
    """Return a table without the columns of the other joints; None where none is named by joints."""
    found = {name: place for name in table.columns if (place := _PLACE.fullmatch(name))}
    joints = {name: place[2] or place[1] for name, place in found.items()}
    if not joints:
        return None
    own = choose(table.source, joint, set(joints.values()))
    return replace(
        table, columns={name: c for name, c in table.columns.items() if joints.get(name, own) == own}
    )
