"""FormationControl and CircleFormation: robots move as a flock, or stand in a circle."""

from typing import Annotated

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.tasks.measures.order import gap_spread, nearest_neighbours, polarisation, radial_spread
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState, Things, WorldStart
from clean_swarm_env.world.task import Task
from selforg.arrays import KEPT, Floats, Ints
from selforg.commands import Commands
from selforg.elementary import unit_vectors

SPACING = 1.5
"""Distance at which flocking robots want their neighbours [m]: the reach of their pose gradient."""
CIRCLE = 3.5
"""Goal radius of the beacon [m]; robots stand their own one farther away."""
SET_OUT = 0.4
"""Speed of the robots at the start [m/s]."""
LAST = 10.0
"""Seconds at the end over which the order of a flock is averaged."""


class Order(TaskState):
    """How robots set out, and sums of their order at the end of the mission."""

    outset: Annotated[Floats, "R 2", KEPT]  # direction, a unit vector
    order: Annotated[Floats, "W", KEPT]
    error: Annotated[Floats, "W", KEPT]
    looks: Annotated[Ints, "W", KEPT]


@TASKS.register
class FormationControl(Task[TaskSettings, Order]):
    """Robots that move in all directions form a flock, which keeps their mean momentum.

    Robots that start at rest would stay at rest: each sets out until its mechanism commands it.
    """

    story = "12 robots on 4 m x 4 m set out in any direction of one half and become a flock within 60 s"
    measures = (
        Measure("polarisation", "-", "higher", 0.9, "headings in one half give 0.66, all the same 1"),
        Measure("error of spacing", "m", "lower", 0.3, "a fifth of the wanted distance of 1.5 m to the nearest"),
    )
    baseline = "everybody goes straight on"
    mission = {
        "world": {"ground": "open", "width": 20.0, "height": 20.0},
        "robots": {"count": 12, "drive": "holonomic"},
        "time_limit": 60.0,
    }
    fewest = 2

    def place(self, start: WorldStart) -> None:
        """Put the robots close together, with headings in one half."""
        headings = start.rng.uniform(-0.5 * np.pi, 0.5 * np.pi, size=start.robots)
        start.put_robots(start.scattered(start.robots, 0.8, 4.0), headings)
        self.state.outset[start.rows] = np.stack(unit_vectors(start.poses[:, 2]), axis=1)

    def command(self, commands: Commands) -> None:
        """Let the robots set out."""
        commands.clear()
        self.command_baseline(commands)

    def command_baseline(self, commands: Commands) -> None:
        """Go straight on."""
        commands.vectors[:] = SET_OUT * self.state.outset
        commands.commanded[:] = True

    def after_moving(self) -> None:
        """Add the order of the flock, near the end."""
        world, state = self.world, self.state
        counts = (world.limits - world.ticks) * world.period < LAST
        if counts.any():
            order, error = self._present()
            state.order += np.where(counts, order, 0.0)
            state.error += np.where(counts, error, 0.0)
            state.looks += counts

    def _present(self) -> tuple[Floats, Floats]:
        """Return polarisation and error of spacing (W,) of this moment."""
        nearest = nearest_neighbours(self.world.positions, self.world.ground)
        return polarisation(self.world.headings), np.abs(nearest - SPACING).mean(axis=1)

    def result(self) -> dict[str, Floats]:
        """Return the mean order near the end, or that of now."""
        state, looks = self.state, np.maximum(self.state.looks, 1)
        order, error = self._present()
        return {
            "polarisation": np.where(state.looks > 0, state.order / looks, order),
            "error of spacing": np.where(state.looks > 0, state.error / looks, error),
        }


@TASKS.register
class CircleFormation(Task[TaskSettings, TaskState]):
    """Robots form a ring around a beacon."""

    story = "10 robots on 8 m x 8 m form a circle around a beacon in the middle within 90 s"
    measures = (
        Measure("spread of distances to the centre", "m", "lower", 0.25, "the radius of a robot"),
        Measure("spread of angles between neighbours", "rad", "lower", 0.31, "half of the even angle 2 pi / 10"),
    )
    baseline = "everybody stays where it is"
    mission = {
        "world": {"ground": "open", "width": 16.0, "height": 16.0},
        "robots": {"count": 10, "pose_diffusion": 1.5},
        "time_limit": 90.0,
    }
    fewest = 2
    start_side = 8.0

    def things(self) -> tuple[Things, ...]:
        """Return the beacon."""
        return (Things("centre", self.world.centres, diffusion=5.0, goal_radius=CIRCLE),)

    def command_baseline(self, commands: Commands) -> None:
        """Stand still."""

    def result(self) -> dict[str, Floats]:
        """Return how round and how even the ring is."""
        positions, ground = self.world.positions, self.world.ground
        return {
            "spread of distances to the centre": radial_spread(positions, ground.centre, ground),
            "spread of angles between neighbours": gap_spread(positions, ground.centre, ground),
        }
