"""The global state of a world, for learners that see everything: bodies, cargo, items, stations, options, time.

Shapes: W worlds, N robots, M items, G components. Every component lies within [-1, 1].
"""

from __future__ import annotations

from math import prod

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.world.parts.shown import ROBOT, WORLD, AnyArray, in_span
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.elementary import unit_vectors

OWN = ("works", "x", "y", "heading_cos", "heading_sin")


class GlobalState:
    """The components of the global state of each world.

    `names` names them: `robot_K_NAME` (`OWN`, what the task says of robots, then `holds_OPTION` or with several
    goals `holds_GOAL_OPTION`), things as the task names them (`KIND_K_x`), `time`, and what the task says of worlds.
    Places go from -1 to 1 along each side of the torus or field; on open land they are offsets from the middle. `time`
    is the share of the time limit that has passed. The other components are flags, except cosine and sine. What is not
    there is 0.

    Cleaning has `carrying` and `recycled` of robots, `item_K_lying`, `carried`, `done`, `x` and `y` (where the item
    lies or was picked), `recycling_x`, `dump_y`, further stations as `recycling_2_x`, and `garbage_done`, the share of
    the items dumped of those that arrived.

    Args:
        worlds: the worlds.
        options: whether robots hold options; not if they are driven by vectors.

    Attributes:
        names: (G,) names of the components.
        final: (W, G) state at the end of the last mission of each world, zeros before.

    """

    def __init__(self, worlds: Worlds, *, options: bool) -> None:
        self._worlds = worlds
        coordinators = worlds.coordinators if options else ()
        self._holds = {
            f"holds_{c.model.goal}_{option}" if len(coordinators) > 1 else f"holds_{option}": (c, number)
            for c in coordinators
            for number, option in enumerate(c.model.options)
        }
        called = {one.axis: one.names for one in worlds.task.shown() if one.names}
        names: list[str] = []
        columns: list[Ints] = []  # (W, ...) where each component is among the values of all parts
        first = 0
        for axis, parts in self._parts().items():
            shape = len(parts), worlds.worlds, next(iter(parts.values())).size // worlds.worlds
            each = called.get(axis) or [f"{axis}_{number}" for number in range(shape[2])]
            names += parts if axis == WORLD else [f"{one}_{part}" for one in each for part in parts]
            columns.append(first + np.arange(prod(shape)).reshape(shape).transpose(1, 2, 0).reshape(shape[1], -1))
            first += prod(shape)
        self.names, self._columns = tuple(names), np.concatenate(columns, axis=1)
        self.final = np.zeros((worlds.worlds, len(names)), dtype=np.float32)

    def now(self) -> NDArray[np.float32]:
        """Return the state (W, G) of the worlds as they are."""
        found, present = self._parts(), self._worlds.physics.present
        values = np.concatenate([one for parts in found.values() for one in parts.values()], axis=None)
        robots = len(found[ROBOT])
        values[: robots * len(present)].reshape(robots, -1)[:, ~present] = 0.0
        return values.take(self._columns).astype(np.float32)

    def keep(self, ended: Ints) -> None:
        """Keep the state of the worlds (K,) whose missions have just ended as the final one."""
        self.final[ended] = self.now()[ended]

    def _parts(self) -> dict[str, dict[str, AnyArray]]:
        """Return axis -> name of a component -> its values (W * K,) or (W, K): robots, kinds of things, the world."""
        worlds, physics, shown = self._worlds, self._worlds.physics, self._worlds.task.shown()
        by_name = {one.name: one.values for one in shown}
        x, y = self._places(physics.positions).T
        own = (worlds.team.working, x, y, *unit_vectors(physics.headings))
        found: dict[str, dict[str, AnyArray]] = {ROBOT: dict(zip(OWN, own, strict=True))}
        course: dict[str, AnyArray] = {"time": np.minimum(worlds.ticks / worlds.world.limits, 1.0)}
        for one in shown:
            parts = course if one.axis == WORLD else found.setdefault(one.axis, {})
            for name, part in one.parts.items():
                parts[name] = part if isinstance(part, np.ndarray) else in_span(one.values, part)
            if one.values.ndim == 3:
                places = self._places(one.values)
                for name, span in one.where.items():
                    places[~in_span(by_name[name], span)] = 0.0
                parts["x"], parts["y"] = places[..., 0], places[..., 1]
        found[ROBOT] |= {name: c.held == number for name, (c, number) in self._holds.items()}
        return {axis: parts for axis, parts in found.items() if parts} | {WORLD: course}

    def _places(self, points: Floats) -> Floats:
        ground = self._worlds.floor.ground
        if ground.kind == "open":
            return np.clip((points - ground.centre) / ground.size, -1.0, 1.0)
        return 2.0 * points / ground.land - 1.0
