"""The global state of a world, for learners that see everything: bodies, cargo, items, stations, options, time.

Shapes: W worlds, N robots, M items, G components. Every component lies within [-1, 1].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.world.parts.shown import ROBOT, WORLD, AnyArray, Shown
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
        self._coordinators = worlds.coordinators if options else ()
        several = len(self._coordinators) > 1
        holds = [
            f"holds_{c.model.goal}_{option}" if several else f"holds_{option}"
            for c in self._coordinators
            for option in c.model.options
        ]
        shown = worlds.task.shown()
        own = (*OWN, *_parts(shown, ROBOT), *holds)
        robots = [f"robot_{k}_{name}" for k in range(worlds.robots) for name in own]
        called = {one.axis: one.names for one in shown if one.names}
        things = [
            f"{thing}_{part}"
            for axis, parts in self._things(shown).items()
            for thing in called.get(axis) or [f"{axis}_{k}" for k in range(len(next(iter(parts.values()))[0]))]
            for part in parts
        ]
        self.names = (*robots, *things, "time", *_parts(shown, WORLD))
        self.final = np.zeros((worlds.worlds, len(self.names)), dtype=np.float32)

    def now(self) -> NDArray[np.float32]:
        """Return the state (W, G) of the worlds as they are."""
        worlds, shown = self._worlds, self._worlds.task.shown()
        time = np.minimum(worlds.ticks / worlds.world.limits, 1.0)
        course = np.stack([time, *_parts(shown, WORLD).values()], axis=1)
        robots = self._robots(shown).reshape(worlds.worlds, -1)
        kinds = self._things(shown).values()
        things = [np.stack([*parts.values()], axis=2).reshape(worlds.worlds, -1) for parts in kinds]
        return np.concatenate((robots, *things, course), axis=1).astype(np.float32)

    def _things(self, shown: Sequence[Shown]) -> dict[str, dict[str, AnyArray]]:
        """Return what the things are called -> name of a component -> its values (W, M)."""
        found: dict[str, dict[str, AnyArray]] = {}
        for one in shown:
            if one.axis in (ROBOT, WORLD):
                continue
            parts = found.setdefault(one.axis, {})
            parts |= one.parts
            if one.values.ndim == 3:
                places = self._places(one.values)
                if one.there is not None:
                    places[~one.there] = 0.0
                parts["x"], parts["y"] = places[..., 0], places[..., 1]
        return {axis: parts for axis, parts in found.items() if parts}

    def keep(self, ended: Ints) -> None:
        """Keep the state of the worlds (K,) whose missions have just ended as the final one."""
        self.final[ended] = self.now()[ended]

    def _places(self, points: Floats) -> Floats:
        ground = self._worlds.floor.ground
        if ground.kind == "open":
            return np.clip((points - ground.centre) / ground.size, -1.0, 1.0)
        return 2.0 * points / ground.land - 1.0

    def _robots(self, shown: Sequence[Shown]) -> Floats:
        """Return the components (R, ...) of the robots."""
        worlds, physics = self._worlds, self._worlds.physics
        own = np.column_stack(
            (
                worlds.team.working,
                self._places(physics.positions),
                *unit_vectors(physics.headings),
                *_parts(shown, ROBOT).values(),
                *(np.eye(len(c.model.options))[c.held] for c in self._coordinators),
            )
        )
        own[~physics.present] = 0.0
        return np.asarray(own, dtype=np.float64)


def _parts(shown: Sequence[Shown], axis: str) -> dict[str, AnyArray]:
    """Return what the global state has of robots or worlds."""
    return {name: values for one in shown if one.axis == axis for name, values in one.parts.items()}
