"""Gradients as rows of tables: `Gradient` objects written into messages, and stored rows read back as objects.

`Codes` are the numbers that stand for names in these tables.
"""

from typing import Any

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.gradients.gradient import Gradient
from selforg.gradients.store import columns as c
from selforg.space import Space


class Codes:
    """Numbers names in the order of their first use, from `first` on; names known from the start are 0, 1, ..."""

    def __init__(self, first: int = 0, known: tuple[str, ...] = ()) -> None:
        self._first = first
        self._codes = {name: code for code, name in enumerate(known)}
        self._names: list[str] = []

    def __len__(self) -> int:
        """Return how many names were used, without those known from the start."""
        return len(self._names)

    def __contains__(self, name: str) -> bool:
        """Return whether a name has a number."""
        return name in self._codes

    def code(self, name: str) -> int:
        """Return the number of `name`, a new one if it was never used."""
        if name not in self._codes:
            self._codes[name] = self._first + len(self._names)
            self._names.append(name)
        return self._codes[name]

    def name(self, code: int) -> str:
        """Return the name with a number from `first` on."""
        return self._names[code - self._first]

    def numbered(self) -> tuple[str, ...]:
        """Return the names that were used, by their numbers from `first` on."""
        return tuple(self._names)

    def names(self) -> list[str]:
        """Return the names that were used, sorted."""
        return sorted(self._names)


def write_gradient(gradient: Gradient, space: Space, keys: Codes, messages: Floats, tags: Ints) -> None:
    """Write one checked gradient into all `messages` (M, MESSAGE_COLUMNS) and `tags` (M, TAG_COLUMNS), both blank."""
    g, dim, far = gradient, space.dim, messages[:, c.MESSAGE_FAR :]
    messages[:, c.X : c.X + dim] = space.wrap(np.asarray(g.position, dtype=np.float64))
    far[:, c.FAR_HEADING : c.FAR_HEADING + len(g.heading)] = g.heading
    messages[:, c.DIFFUSION], messages[:, c.GOAL_RADIUS] = g.diffusion, g.goal_radius
    far[:, c.FAR_FACTOR], far[:, c.FAR_PERIOD] = g.evaporation_factor, g.evaporation_period
    far[:, c.FAR_STAMP], far[:, c.FAR_CLOCK] = g.stamp, g.stamp if g.clock is None else g.clock
    tags[:, c.TAG_SIGN], tags[:, c.TAG_MOVING] = g.attraction, g.moving
    for key, value in g.payload.items():
        if type(value) in (int, float) and abs(value) < float("inf"):
            # the first number lies in the table, because compiled code sees no payloads
            far[:, c.FAR_VALUE], tags[:, c.TAG_KEY] = value, keys.code(str(key))
            break


def set_times(messages: Floats, now: float) -> None:
    """Set when `messages` (M, MESSAGE_COLUMNS) are spread, which is when their evaporation begins, to `now` [s]."""
    far = messages[:, c.MESSAGE_FAR :]
    far[:, c.FAR_STAMP] = far[:, c.FAR_CLOCK] = now


def read_gradient(near: Floats, far: Floats, dim: int, **names: Any) -> Gradient:  # noqa: ANN401  (other fields)
    """Return the gradient of columns as stores and messages have them: NEAR_ and FAR_; `names` are its other fields."""
    return Gradient(
        position=tuple(near[c.X : c.X + dim].tolist()),
        heading=tuple(far[c.FAR_HEADING : c.FAR_HEADING + dim].tolist()),
        diffusion=float(near[c.DIFFUSION]),
        goal_radius=float(near[c.GOAL_RADIUS]),
        evaporation_factor=float(far[c.FAR_FACTOR]),
        evaporation_period=float(far[c.FAR_PERIOD]),
        stamp=float(far[c.FAR_STAMP]),
        **names,
    )
