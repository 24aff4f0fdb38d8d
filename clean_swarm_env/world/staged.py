"""What worlds, pictures and recordings ask of a task, with answers that suit tasks whose robots only move.

Override these for robots that carry stages of their own through a tick, as those of cleaning do. Shapes: W worlds of N
robots, R = W * N rows (robots).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final

import numpy as np

from clean_swarm_env.config.events import Event
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import TaskKind
from clean_swarm_env.physics.rays import Bodies
from clean_swarm_env.world.mission_end import NO_TICK
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.promises import TASK_PROMISES
from clean_swarm_env.world.parts.shown import NO_END, ROBOT, WORLD, Drawn, Shown
from clean_swarm_env.world.parts.things import Things, kinds_of
from clean_swarm_env.world.reception import Reception
from clean_swarm_env.world.view import CARRYING, TaskView
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_network import RobotNetwork
from selector.coordination.robots import network_of
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.commands import Commands
from selforg.components.facts import FactRule
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.plugins import Promises

AROUND: Final = BufferSettings(aggregation={"DEFAULT": "new"}, aggregation_distance=0.0)
"""Settings of the buffer of things: gradients at one place are one thing."""
TRAILS: Final = BufferSettings(view_distance=4.0, aggregation_distance=0.1, min_diffusion=0.3)
"""Settings of buffers of pheromones, of which the strongest at a place counts, for robots of 1 m/s."""


class StagedTask(TaskKind, ABC):
    """The stages of a tick, the network, the buffers, the cost and the looks of a task.

    Attributes:
        priced: whether the cost of a mission is counted in each tick, so that learners can be paid for it.
        Counts: class that counts achievements and costs in place of `achieved` and `cost`, see `learning.progress`.
        best_score: score of a mission that costs nothing, from which its cost by the time limit is taken [-].
        thinks_when_driven: whether networks of robots go on deciding while a learner drives the robots.
        always_acts: whether networks select again until some behaviour runs.
        notices: facts that robots notice by themselves, see `noticed`: how each is told and kept, by name.
        around: the things, as `Task.things` returned them.
        asked: (R, 2) [m/s] what the mechanisms asked for last; 0 for nothing.
        standing: (R,) ticks for which a collision stops the robot, that of the collision included; 0 unless you say so.

    """

    promises: ClassVar[Promises] = TASK_PROMISES
    measures: ClassVar[tuple[Measure, ...]] = ()
    goal: ClassVar[str] = ""
    priced: ClassVar[bool] = False
    Counts: ClassVar[Any] = None
    best_score: ClassVar[float] = 2.0  # 1 where the measure that is worst by its target just meets it
    thinks_when_driven: ClassVar[bool] = True
    always_acts: ClassVar[bool] = True
    notices: ClassVar[Mapping[str, FactRule]] = {}

    world: TaskView
    around: tuple[Things, ...]
    asked: Annotated[Floats, "R 2", KEPT]
    standing: Annotated[Ints, "R", READ]
    _walk: Annotated[Floats, "R 2", KEPT]

    @abstractmethod
    def result(self) -> Mapping[str, Floats]:
        """Return the value (W,) of each measure by its name: finite at any time, at the end the result."""

    def done(self) -> Flags:
        """Return which worlds (W,) are done before their time; none unless you say so."""
        return np.zeros(self.world.worlds, dtype=np.bool_)

    def bend(self, commands: Commands) -> None:
        """Change the commands of behaviours, once all are known."""

    @classmethod
    def goals(cls, mission: MissionConfig, directories: Sequence[Path]) -> tuple[str, ...]:
        """Return the goals that robots coordinate."""
        return (cls.goal or cls.name,)

    @classmethod
    def opened(cls, mission: MissionConfig) -> MissionConfig:
        """Return the mission whose robots coordinate all goals that they could."""
        return mission

    @classmethod
    def robot(
        cls, mission: MissionConfig, models: Sequence[CoordinatorModel], directories: Sequence[Path]
    ) -> RobotNetwork:
        """Return the network of a robot: coordinators only, all of which run that are ready."""
        return RobotNetwork(network_of(models))

    @classmethod
    def buffers(cls, mission: MissionConfig, poses: OwnPoses, reception: Reception) -> dict[str, SoBuffer]:
        """Return the buffers, by the names that configurations use.

        In `own_pheromones` each robot finds only its own pheromones.
        """
        space, merged = poses.space, TRAILS.aggregation_distance * mission.slowest
        trails = replace(TRAILS, aggregation_distance=merged, hidden=mission.world.blocks("pheromones"))
        return {
            "gradients": SoBuffer(AROUND, space, poses),
            "pheromones": SoBuffer(trails, space, poses, reception.delivery()),
            "own_pheromones": SoBuffer(trails, space, poses, Delivery(reach=0.0)),
        }

    def reset(self, world: int, rows: slice) -> None:
        """Show the things of a world that has just been placed."""
        self.asked[rows] = self._walk[rows] = 0.0
        self.show_around(world)

    def show_around(self, world: int) -> None:
        """Show the things of a world where they are now, and nowhere else."""
        buffer = self.world.buffers["gradients"]
        buffer.clear(world)
        for thing in self.around:
            thing.show(buffer, world, self.world.now)

    def come(self, world: int, tick: int) -> int:
        """Let come to a world what comes by itself up to a tick; return the tick at which more comes."""
        return NO_TICK

    def happen(self, world: int, event: Event) -> None:
        """Let an event of the task itself happen in a world."""

    def lose(self, rows: Ints) -> None:
        """Let go of robots in `rows` (K,) that are about to be taken away or to fail."""

    def renew(self, rows: Ints) -> None:
        """Forget what happened to the robots in `rows` (K,), which begin anew."""

    def sense(self) -> None:
        """Show things that move where they are now, before robots sense."""
        if any(thing.moves for thing in self.around):
            for world in range(self.world.worlds):
                self.show_around(world)

    def follow(self, vectors: Floats, working: Flags) -> None:
        """Act for robots that are driven by vectors (R, 2) [m/s]; working (R,): those that are at work."""

    def after_acting(self, commands: Commands) -> None:
        """Change the commands, and note them."""
        self.bend(commands)
        self.asked[:] = np.where(commands.commanded[:, None], commands.vectors, 0.0)

    def noticed(self) -> Mapping[str, Flags]:
        """Return which robots (R,) have noticed something in this period that they tell, by the names in `notices`.

        It is asked only where robots tell facts: because their documents declare some, or somebody sees `heard`.
        """
        return {}

    def completed(self, values: Mapping[str, Floats]) -> Flags:
        """Return whether the missions (W,) are completed: all measures, whose `values` are (W,), meet their targets."""
        met = np.ones(self.world.worlds, dtype=np.bool_)
        for measure in self.measures:
            met &= np.array([measure.met(value) for value in values[measure.name].tolist()])
        return met

    def cost(self, world: int, values: Mapping[str, Floats]) -> float:
        """Return what the mission of a world costs [s]: its time limit times its worst measure by the targets.

        A guard counts where it misses its target only. 1 time limit: the target is just met. `values`: of `result`.
        """
        worst = max(measure.ratio(float(values[measure.name][world])) for measure in self.measures)
        return worst * int(self.world.limits[world]) * self.world.period

    def unavoidable(self, world: int) -> float:
        """Return the part of the cost of a world that no team could avoid [s]."""
        return 0.0

    def duration(self, world: int) -> float:
        """Return how long the mission of a world has lasted if it is done, else its time limit [s]."""
        if not self.done()[world]:
            return self.world.missions[world].time_limit
        # The last thing was done at the beginning of its period.
        return max(int(self.world.ticks[world]) - 1, 0) * self.world.period

    # ---- what others show

    def shown(self) -> tuple[Shown, ...]:
        """Return the arrays that recordings, pictures, the global state and rays have beside poses, contacts, options.

        Those of robots come first, then those of things: their knowledge, and the things in `around`.
        """
        memory = self.world.memory
        about = "what the robot knows"
        known = [Shown(f, ROBOT, memory[f].values, about, {f: memory[f].values}, recorded=False) for f in memory.facts]
        if CARRYING in memory.kinds:
            cargo = np.where(self.world.carrying, 0, -1)

            def note() -> None:
                cargo[:] = np.where(self.world.carrying, 0, -1)

            known.append(Shown("cargo", ROBOT, cargo, "the item that the robot carries, -1 for none", note=note))
        things = zip(kinds_of(self.around), self.around, strict=True)
        return (
            *known,
            *(
                Shown(kind, kind, one.places, "where it is", met=Bodies(one.places, one.goal_radius), recorded=False)
                for kind, one in things
            ),
        )

    def drawn(self) -> tuple[Drawn, ...]:
        """Return the signs that pictures draw beside robots, `around` and trails."""
        return (Drawn(ROBOT, "item", {"cargo": (0, NO_END)}),) if CARRYING in self.world.memory.kinds else ()

    def headline(self, world: int) -> str:
        """Return what there is to say of a world in one line: its measures, and the numbers that it shows of worlds."""
        measures = (f"{name} {values[world]:.3g}" for name, values in self.result().items())
        return ", ".join(
            (*measures, *(f"{one.values[world]} {one.about}" for one in self.shown() if one.axis == WORLD))
        )
