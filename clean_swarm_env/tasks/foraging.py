"""Foraging: robots find food, bring it to the nest, and lay a trail by which others find it."""

from typing import Annotated

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.config.types import Index
from clean_swarm_env.world.by_hand import WORLD, by_hand, free_place
from clean_swarm_env.world.parts.measure import Achievement, Measure
from clean_swarm_env.world.parts.shown import ROBOT, Destination, Shown
from clean_swarm_env.world.parts.things import TaskState, Things, WorldStart
from clean_swarm_env.world.task import Task
from selector.documents.fields import Number
from selforg.arrays import KEPT, SCRATCH, Flags, Floats, Ints

PATCH_RADIUS, NEST_RADIUS = 0.5, 1.5  # [m]
AWAY = 9.0  # [m] least distance of food from the nest
AT_NEST = 1.0
"""Distance from the edge of the nest within which an item counts as brought [m]: a robot's goal radius and more."""


class Food(TaskState):
    """Two patches of food in each world, and what robots have brought."""

    patches: Annotated[Floats, "W 2 2", KEPT]  # [m]
    carried: Annotated[Flags, "R", KEPT]  # whether the robot carried something at the end of the period before
    puts: Annotated[Flags, "R", SCRATCH]  # whether it put that down at the nest in the last period
    brought: Annotated[Ints, "W", KEPT]


@TASKS.register
class Foraging(Task[TaskSettings, Food]):
    """Patches hold more than robots can bring. An item counts when a robot puts it down at the nest."""

    story = "12 robots bring food from 2 patches, 9 m and more away, to a nest on a torus of 900 m2 for 300 s"
    measures = (
        Measure(
            "items brought per minute",
            "1/min",
            "higher",
            10.0,
            "more than a quarter of the 36 that 12 robots could bring that know a way of 10 m",
        ),
    )
    baseline = "random search: the same robots, which never follow a trail"
    baseline_option = "RandomSearch"
    searching = {"Foraging": "explore"}
    sees = "food_seen"
    mission = {"world": {"width": 30.0, "height": 30.0}, "robots": {"count": 12}, "time_limit": 300.0}
    achievements = (
        Achievement(
            "brought", "Items that the robot brought in the period.", "Items that the team brought in the period."
        ),
    )
    phases = ("searching", "carrying")
    apart, start_side = 0.6, 5.0
    changes = True

    def place(self, start: WorldStart) -> None:
        """Put robots around the nest, and food away from it."""
        super().place(start)
        self.state.patches[start.world] = start.scattered(2, 6.0, 24.0, AWAY)

    def things(self) -> tuple[Things, ...]:
        """Return the food and the nest."""
        return (
            Things("food", self.state.patches, diffusion=0.0, goal_radius=PATCH_RADIUS),
            Things("nest", self.world.centres, diffusion=0.0, goal_radius=NEST_RADIUS),
        )

    def lose(self, rows: Ints) -> None:
        """Forget what robots in `rows` (K,) carried that are taken away or fail: nobody brings it."""
        self.state.carried[rows] = False

    def destinations(self) -> tuple[Destination, ...]:
        """Return the nest for a robot with an item, else the nearest food, if it sees any."""
        return (Destination("the nest", "nest", {"carrying": True}), Destination("food", "food", {self.sees: True}))

    def after_moving(self) -> None:
        """Count the items that robots have put down at the nest."""
        world, state = self.world, self.state
        carrying = world.carrying
        at_nest = world.ground.distances(world.floor.physics.positions, world.ground.centre) < NEST_RADIUS + AT_NEST
        state.puts[:] = state.carried & ~carrying & at_nest
        state.brought += world.by_world(state.puts).sum(axis=1)
        state.carried[:] = carrying

    def shown(self) -> tuple[Shown, ...]:
        """Return which robots have just put an item down at the nest: an event."""
        about = "1 where the robot has just put an item down at the nest"
        return (*super().shown(), Shown("brought", ROBOT, self.state.puts, about, event="item brought"))

    def achieved(self) -> dict[str, Flags]:
        """Return which robots put an item down at the nest."""
        return {"brought": self.state.puts}

    def totals(self) -> dict[str, Ints]:
        """Return the items that the team has brought."""
        return {"items_brought": self.state.brought}

    def phase(self) -> Ints:
        """Return which robots carry an item."""
        return self.world.carrying.astype(np.int64)

    def result(self) -> dict[str, Floats]:
        """Return the items that the team has brought, divided by the minutes of the whole mission."""
        minutes = self.world.limits * self.world.period / 60.0
        return {"items brought per minute": self.state.brought / minutes}


@by_hand
def put_food(task: Foraging, patch: Index, x: Number, y: Number) -> None:
    """Put a patch of food at another place [m]."""
    patches = task.state.patches[WORLD]
    if patch >= len(patches):
        raise ValueError(f"patch {patch}: expected a number below {len(patches)}")
    patches[patch] = free_place(task.world, x, y)
    task.show_around(WORLD)
    task.world.forget_ways(WORLD)
