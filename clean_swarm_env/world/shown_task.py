"""What pictures, recordings, the global state and learners show of a task.

Shapes: W worlds of N robots, R = W * N rows (robots).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from clean_swarm_env.config.tasks import TaskKind
from clean_swarm_env.physics.rays import Bodies
from clean_swarm_env.world.task_parts import ItemArrays, Recorded, Things, kinds_of
from clean_swarm_env.world.view import CARRYING, World
from selforg.arrays import Floats, Ints


class ShownTask(TaskKind):
    """A task as others show it. You need to override nothing: robots, `around` and what robots carry are shown.

    Attributes:
        world: the worlds.
        around: the things, as `Task.things` returned them.

    """

    world: World
    around: tuple[Things, ...]

    def hindered(self, row: int) -> float:
        """Return how long a collision still stops the robot of a row [s]."""
        return 0.0

    def bodies(self) -> Sequence[Bodies]:
        """Return the things that rays meet beside robots and walls: those in `around`, with their goal radii."""
        return [Bodies(thing.places, thing.goal_radius) for thing in self.around]

    def item_arrays(self) -> ItemArrays:
        """Return items, cargo and stations, the same arrays all the time; none unless robots carry items."""
        return ItemArrays.none(self.world.worlds, self.world.rows)

    def cargo(self) -> Ints:
        """Return the thing that each robot (R,) carries, -1 for none; 0 where all that is known is that it carries."""
        return np.where(self.world.carrying, 0, -1)

    def recorded(self) -> tuple[Recorded, ...]:
        """Return arrays that recordings keep beside poses, contacts and options; the same ones all the time."""
        if CARRYING not in self.world.memory.kinds:
            return ()
        cargo = self.cargo()

        def note() -> None:
            cargo[:] = self.cargo()

        return (Recorded("cargo", "robot", cargo, "the item that the robot carries, -1 for none", note),)

    def drawn(self, world: int, rows: Ints) -> Mapping[str, Any]:
        """Return what pictures show beside robots, `around` and trails: fields of `drawing.canvas.Canvas`."""
        return {"cargo": np.where(self.cargo()[rows] >= 0, 1, 0)}

    def facts_of_robots(self) -> Mapping[str, Floats]:
        """Return what the global state has of each robot beside its pose: name -> (R,), within [-1, 1]."""
        memory = self.world.memory
        return {name: memory[name].values for name in memory.facts}

    def facts_of_worlds(self) -> Mapping[str, Floats]:
        """Return what the global state has of each world beside its time: name -> (W,), within [-1, 1]."""
        return {}

    def thing_names(self) -> list[str]:
        """Return the names (K,) of what `thing_values` returns."""
        kinds = zip(kinds_of(self.around), self.around, strict=True)
        return [f"{kind}_{k}_{axis}" for kind, thing in kinds for k in range(thing.count) for axis in ("x", "y")]

    def thing_values(self, scaled: Callable[[Floats], Floats]) -> Floats:
        """Return what the global state has of things (W, K), within [-1, 1]; `scaled` makes this of places [m]."""
        worlds = self.world.worlds
        places = [scaled(thing.places).reshape(worlds, -1) for thing in self.around]
        return np.concatenate((np.zeros((worlds, 0)), *places), axis=1)
