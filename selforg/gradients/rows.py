"""Gradients as rows of tables: `Gradient` objects written into messages, and stored rows read back as objects."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.gradients.gradient import Gradient, padded
from selforg.gradients.names import Codes
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Store
from selforg.space import Space


def write_gradient(gradient: Gradient, space: Space, keys: Codes, messages: Floats, tags: Ints) -> None:
    """Fill all `messages` (M, MESSAGE_COLUMNS) and `tags` (M, TAG_COLUMNS) with one checked gradient."""
    g, dim, far = gradient, space.dim, messages[:, c.MESSAGE_FAR :]
    place = padded(g.position, dim, "position")
    messages[:, c.X : c.X + dim] = space.wrap(place[:dim])
    far[:, c.FAR_HEADING : c.FAR_HEADING + 3] = padded(g.heading, dim, "heading")
    messages[:, c.DIFFUSION], messages[:, c.GOAL_RADIUS] = g.diffusion, g.goal_radius
    far[:, c.FAR_FACTOR], far[:, c.FAR_PERIOD] = g.evaporation_factor, g.evaporation_period
    far[:, c.FAR_STAMP], far[:, c.FAR_CLOCK] = g.stamp, g.stamp if g.clock is None else g.clock
    tags[:, c.TAG_SIGN], tags[:, c.TAG_MOVING] = g.attraction, g.moving
    for key, value in g.payload.items():
        if type(value) in (int, float) and abs(value) < float("inf"):
            # the first number travels in the table, where compiled code sees it
            far[:, c.FAR_VALUE], tags[:, c.TAG_KEY] = value, keys.code(str(key))
            break


def set_times(messages: Floats, now: float) -> None:
    """Set when `messages` (M, MESSAGE_COLUMNS) are spread, which is when their evaporation begins, to `now` [s]."""
    far = messages[:, c.MESSAGE_FAR :]
    far[:, c.FAR_STAMP] = far[:, c.FAR_CLOCK] = now


def read_gradient(
    store: Store, slot: int, dim: int, channel: str, source: int | str, payload: Mapping[str, Any]
) -> Gradient:
    """Return the gradient in a slot of a store; `clock` is when it last evaporated."""
    near, link, far = store.near[slot], store.links[slot], store.far[slot]
    clock = near[c.NEAR_DUE] - far[c.FAR_PERIOD] if np.isfinite(near[c.NEAR_DUE]) else far[c.FAR_CLOCK]
    return Gradient(
        channel=channel,
        position=tuple(near[c.X : c.X + dim].tolist()),
        source=source,
        heading=tuple(far[c.FAR_HEADING : c.FAR_HEADING + dim].tolist()),
        attraction=int(link[c.LINK_SIGN]),
        diffusion=float(near[c.DIFFUSION]),
        goal_radius=float(near[c.GOAL_RADIUS]),
        evaporation_factor=float(far[c.FAR_FACTOR]),
        evaporation_period=float(far[c.FAR_PERIOD]),
        stamp=float(far[c.FAR_STAMP]),
        clock=float(clock),
        moving=int(link[c.LINK_LAYER]) % c.LEVELS == c.MOVING,
        payload=payload,
    )
