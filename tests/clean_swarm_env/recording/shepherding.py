"""A task of a user's own, with things that move: robots drive sheep into a ring."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.tasks import Measure, Task, TaskSettings, TaskState, Things, WorldStart
from selforg.arrays import KEPT, Floats


class ShepherdingSettings(TaskSettings):
    """Settings of the task."""

    sheep: Annotated[int, Field(ge=1)] = 4
    """Number of sheep."""


class Flock(TaskState):
    """Where the sheep are."""

    places: Annotated[Floats, "W sheep 2", KEPT]  # [m]


class Shepherding(Task[ShepherdingSettings, Flock]):
    """Sheep flee from robots that are near."""

    story = "6 robots drive sheep into a ring"
    measures = (Measure("sheep in the ring", "-", "higher", 0.9, "nine of ten are a flock"),)
    goal = "CollectiveExploration"
    mission: ClassVar = {"world": {"width": 8.0, "height": 6.0}, "robots": {"count": 6}, "time_limit": 20.0}

    def place(self, start: WorldStart) -> None:
        """Put robots and sheep anywhere."""
        super().place(start)
        self.state.places[start.world] = start.scattered(self.settings.sheep, 0.3)

    def things(self) -> tuple[Things, ...]:
        """Return the ring, and the sheep, which move."""
        ring = np.broadcast_to(self.world.ground.centre, (self.world.worlds, 1, 2))
        return (Things("ring", ring, goal_radius=1.5), Things("sheep", self.state.places, -1, moves=True))

    def after_moving(self) -> None:
        """Move the sheep away from the nearest robots."""
        ground = self.world.ground
        offsets = ground.offsets(self.world.positions[:, None], self.state.places[:, :, None])
        distances = np.linalg.norm(offsets, axis=-1)  # (W, sheep, N)
        nearest = np.take_along_axis(offsets, distances.argmin(axis=2)[..., None, None], axis=2)[:, :, 0]
        least = distances.min(axis=2)[..., None]
        steps = np.where(least < 1.5, 0.4 * self.world.period * nearest / np.maximum(least, 1e-9), 0.0)
        self.state.places[:] = ground.space.wrap(self.state.places + steps)

    def result(self) -> dict[str, Floats]:
        """Return the share of sheep in the ring."""
        inside = self.world.ground.distances(self.state.places, self.world.ground.centre) < 1.5
        return {"sheep in the ring": inside.mean(axis=1)}


def with_shepherding(monkeypatch) -> None:
    """Register the task for one test."""
    TASKS.names()
    monkeypatch.setitem(TASKS._classes, "Shepherding", Shepherding)
