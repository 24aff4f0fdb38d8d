"""Reading: stored rows of tables back as `Gradient` objects."""

import numpy as np

from selforg.arrays import Floats
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.store.columns import (
    ATTRACTION,
    CLOCK,
    DIFFUSION,
    DUE,
    FACTOR,
    GOAL,
    HX,
    KEY,
    LAYER,
    LEVELS,
    MOVING,
    PERIOD,
    SERIAL,
    SLOT,
    SOURCE,
    STAMP,
    VALUE,
    X,
)


def gradient_of(buffer: SoBuffer, pair: Floats) -> Gradient:
    """Return the gradient of one pair (PAIR_COLUMNS,) as it was seen; `clock` is when it last evaporated."""
    slot, dim = int(pair[SLOT]), buffer.space.dim
    if slot < 0:
        age, row = divmod(-1 - slot, buffer.poses.rows)
        return buffer.poses.gradient(row, age)
    table = buffer.table
    fields, link, more, mark = table.near[slot], table.links[slot], table.far[slot], table.marks[slot]
    clock = fields[DUE] - more[PERIOD] if np.isfinite(fields[DUE]) else more[CLOCK]
    payload = buffer.payloads.get(int(mark[SERIAL]), {})
    if not payload and mark[KEY] >= 0:
        payload = {buffer.keys.name(int(mark[KEY])): float(more[VALUE])}
    return Gradient(
        channel=buffer.channels.name(int(link[LAYER]) // (LEVELS * buffer.table.spaces)),
        position=tuple(fields[X : X + dim].tolist()),
        source=buffer.source_name(int(mark[SOURCE])),
        heading=tuple(more[HX : HX + dim].tolist()),
        attraction=int(link[ATTRACTION]),
        diffusion=float(fields[DIFFUSION]),
        goal_radius=float(fields[GOAL]),
        evaporation_factor=float(more[FACTOR]),
        evaporation_period=float(more[PERIOD]),
        stamp=float(more[STAMP]),
        clock=float(clock),
        moving=int(link[LAYER]) % LEVELS == MOVING,
        payload=payload,
    )
