"""A task of your own in one file: robots close in around a flock, and drive it into a ring.

pip install .
python examples/own_task.py
clean-swarm evaluate Shepherding --import examples/own_task.py --scenarios 10 --record
"""

from typing import Annotated

import numpy as np
from pydantic import Field

from clean_swarm_env.tasks import TASKS, Measure, Shown, Task, TaskSettings, TaskState, Things, WorldStart
from selforg.arrays import KEPT, Flags, Floats, Ints

FENCE = 4.0  # [m] robots stand around the middle
SPEED = 0.4  # [m/s] of a sheep that flees


class Flocking(TaskSettings):
    """The key `task:` of a mission: `task: {name: Shepherding, sheep: 20}`."""

    sheep: Annotated[int, Field(strict=True, ge=1, le=1000)] = 12
    fear: float = 2.5  # [m] within which a sheep flees from a robot


class Flock(TaskState):
    """Arrays of W worlds and R robots; states, copies and recordings follow from this declaration."""

    sheep: Annotated[Floats, "W sheep 2", KEPT]  # [m]
    in_ring: Annotated[Ints, "W", KEPT]  # sheep in the ring
    paid: Annotated[Floats, "W", KEPT]  # share of the sheep in the ring when robots were last rewarded


@TASKS.register
class Shepherding(Task[Flocking, Flock]):
    """Sheep flee from the nearest robot. Robots that stand in a circle leave them one way: to the middle."""

    story = "12 robots, 7 m and more from the middle, drive a flock of 12 into a ring of 3 m within 60 s"
    measures = (Measure("sheep in the ring", "-", "higher", 0.8, "0.3 of them are there at the start"),)
    goal = "CircleFormation"  # whose options in the knowledge `library` serve this task
    mission = {"world": {"width": 20.0, "height": 20.0}, "robots": {"count": 12}, "time_limit": 60.0}
    doing = {"CircleFormation": "closes in around the flock"}  # what `explain` says of robots
    away, ring = 7.0, 3.0

    def place(self, start: WorldStart) -> None:
        """Put the robots outside, and the sheep inside."""
        super().place(start)
        self.state.sheep[start.world] = start.scattered(self.settings.sheep, 0.4, side=10.0)

    def things(self) -> tuple[Things, ...]:
        """Return what robots sense, by the channels that mechanisms read, and what recordings show."""
        sheep = Things("sheep", self.state.sheep, diffusion=self.settings.fear, moves=True)
        return (Things("centre", self.world.centres, diffusion=20.0, goal_radius=FENCE), sheep)

    def after_moving(self) -> None:
        """Let sheep flee from the nearest robot, in all worlds at once."""
        ground, sheep = self.world.ground, self.state.sheep
        away = ground.offsets(self.world.positions[:, None], sheep[:, :, None])  # (W, sheep, N, 2) [m]
        nearest = np.linalg.norm(away, axis=-1).argmin(axis=2)[:, :, None, None]
        way = np.take_along_axis(away, nearest, axis=2)[:, :, 0]
        length = np.linalg.norm(way, axis=-1, keepdims=True)
        flees = length < self.settings.fear
        sheep[:] = ground.space.wrap(sheep + flees * way * SPEED * self.world.period / np.maximum(length, 1e-9))
        self.state.in_ring[:] = self._inside().sum(axis=1)

    def _inside(self) -> Flags:
        """Return which sheep (W, sheep) are in the ring."""
        return self.world.ground.distances(self.state.sheep, self.world.ground.centre) < self.ring

    def shown(self) -> tuple[Shown, ...]:
        """Return how many sheep are in the ring; each time that one more is, the timeline of replays has an event."""
        rings = Shown("in_ring", "world", self.state.in_ring, "sheep in the ring", event="sheep comes into the ring")
        return (*super().shown(), rings)

    def result(self) -> dict[str, Floats]:
        """Return the share of the sheep that are in the ring."""
        return {"sheep in the ring": self._inside().mean(axis=1)}

    def done(self) -> Flags:
        """Return where the whole flock is in the ring."""
        return self.result()["sheep in the ring"] == 1.0

    def observe(self) -> dict[str, Floats]:
        """Return what each robot sees beside the usual terms."""
        return {"flock_in_ring": self.result()["sheep in the ring"][self.world.of_row]}

    def reward(self) -> Floats:
        """Pay the whole team for each part of the flock that has come into the ring since it was last paid."""
        now, before = self.result()["sheep in the ring"], self.state.paid.copy()
        self.state.paid[:] = now
        return (now - before)[self.world.of_row]


if __name__ == "__main__":
    from train import play

    play(Shepherding)
