"""Tasks: the work in W worlds of N robots, R = W * N rows. A class in one file is a task of your own; see `Task`.

Why there is one world for all of them: docs/decisions/0223-one-world-any-task.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Generic, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import BaseModel, ConfigDict, create_model

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import TaskSettings, find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.measure import Measure
from clean_swarm_env.world.reception import Reception
from clean_swarm_env.world.shown_task import ShownTask
from clean_swarm_env.world.task_parts import TaskState, Things, WorldStart
from clean_swarm_env.world.view import World
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel, coordinator_models
from selector.coordination.robot_network import RobotNetwork
from selector.coordination.robots import network_of
from selector.documents.errors import validated
from selector.knowledge import Knowledge
from selforg.arrays import KEPT, Flags, Floats, Ints
from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.plugins import is_own

AROUND: Final = BufferSettings(aggregation={"DEFAULT": "new"}, aggregation_distance=0.0)
"""Settings of the buffer of things: gradients at one place are one thing."""
TRAILS: Final = BufferSettings(view_distance=4.0, aggregation_distance=0.1, min_diffusion=0.3)
"""Settings of buffers of pheromones, of which the strongest at a place counts, for robots of 1 m/s."""
WALK: Final = 2.0
"""Time for which a robot on a random walk keeps its direction [s]."""

S = TypeVar("S", bound=TaskSettings)
T = TypeVar("T", bound=TaskState)


class Task(ShownTask, ABC, Generic[S, T]):
    """What there is to do in W worlds at once. Register a subclass with `TASKS.register`; give `measures` and `result`.

    A mission names the task, and has its settings, under the key `task:`. `parallel_env`, `evaluate`, `run`, `play`,
    recordings, states, training and tuning then take it as they take cleaning. Everything else has a default: robots
    start anywhere, nothing else is there, and the mission ends with its time. You never need to loop over robots.

    Attributes:
        name, story, mission, begins_as_given: see `TaskKind`.
        measures: figures of success; the first one that is no guard is the one that counts.
        baseline: what the mechanisms are compared with, in words; see `lead`. Empty: nothing.
        baseline_option: the option of the goal that is the baseline, where one is.
        goal: the goal in the knowledge whose options serve the task: the one of its own name unless given.
        fewest: robots with which the measures have a meaning.
        start_side: side of the square in the middle in which robots start, 0: the whole ground [m].
        apart, away: least distance of robots from each other, and from the middle, at the start [m].
        changes: whether robots and things may come and go during a mission; not where measures are of all robots.
        priced: whether the cost of a mission is counted in each tick, so that learners can be paid for it.
        best_score: score of a mission that costs nothing, from which its cost by the time limit is taken [-].
        terms: terms of an observation unless others are chosen.
        counted: infos of learners beside times, collisions and the measures; see `borders.infos`.
        beside: strategies that every comparison has beside those chosen; the baseline unless given.
        thinks_when_driven: whether networks of robots go on deciding while a learner drives the robots.
        world, settings, state: the worlds, the settings, and the arrays of this task.
        asked: (R, 2) [m/s] what the mechanisms asked for last; 0 for nothing.

    """

    State: ClassVar[type[TaskState]] = TaskState
    measures: ClassVar[tuple[Measure, ...]] = ()
    baseline: ClassVar[str] = "random walk, a new direction every 2 s"
    baseline_option: ClassVar[str] = ""
    goal: ClassVar[str] = ""
    fewest: ClassVar[int] = 1
    start_side: ClassVar[float] = 0.0
    apart: ClassVar[float] = 1.0
    away: ClassVar[float] = 0.0
    changes: ClassVar[bool] = False
    priced: ClassVar[bool] = False
    best_score: ClassVar[float] = 2.0  # 1 where the measure that is worst by its target just meets it
    terms: ClassVar[tuple[str, ...]] = (
        "command", "things", "neighbour", "crowd", "movement", "facts", "task", "time", "holds",
    )  # fmt: skip
    counted: ClassVar[tuple[str, ...]] = ("own_collisions", "own_contact_s")
    beside: ClassVar[tuple[str, ...]] = ()
    thinks_when_driven: ClassVar[bool] = True
    always_acts: ClassVar[bool] = True  # whether networks select again until some behaviour runs

    settings: S
    state: T
    asked: Annotated[Floats, "R 2", KEPT]
    _walk: Annotated[Floats, "R 2", KEPT]

    def __init_subclass__(cls) -> None:
        """Take the name from the class, settings and state from the brackets of the base class."""
        super().__init_subclass__()
        if "name" not in vars(cls):
            cls.name = cls.__name__
        for base in getattr(cls, "__orig_bases__", ()):
            if get_origin(base) is not None and issubclass(get_origin(base), Task):
                for given in get_args(base):
                    if isinstance(given, type) and issubclass(given, TaskSettings):
                        cls.Settings = given
                    elif isinstance(given, type) and issubclass(given, TaskState):
                        cls.State = given
        if is_own(cls):
            given = {name: getattr(cls, name) for name in attributes_of_tasks().model_fields}
            validated(attributes_of_tasks(), given, f"task {cls.name}")

    def __init__(self, world: World) -> None:
        self.world = world
        mission = world.mission
        if mission.robots.count < self.fewest:
            expected = f"at least {self.fewest} with the task {mission.task.name}"
            raise ConfigurationError(f"robots.count: expected {expected}, got {mission.robots.count}")
        if not (self.measures or self.priced):
            raise ConfigurationError(f"task {self.name}: measures: expected one or more, got none")
        self.settings = mission.task  # type: ignore[assignment]  # of the model `Settings`, which read it
        numbers = {name: value for name, value in mission.task if isinstance(value, int)}
        sizes = {"W": world.worlds, "N": world.robots, "R": world.rows, **numbers, **self.sizes()}
        self.state = self.State(sizes)  # type: ignore[assignment]
        self.asked, self._walk = np.zeros((world.rows, 2)), np.zeros((world.rows, 2))
        self.around = self.things()

    # ---- what a task says; only `result` is required

    def sizes(self) -> Mapping[str, int]:
        """Return lengths of axes of the state that no setting has."""
        return {}

    def place(self, start: WorldStart) -> None:
        """Put robots, and things, of one world at their start; robots are anywhere unless you put them."""
        start.put_robots(start.scattered(start.robots, self.apart, self.start_side, self.away))

    def things(self) -> tuple[Things, ...]:
        """Return what robots can sense beside each other; called once, before any world is reset."""
        return ()

    def known(self) -> Mapping[str, Floats]:
        """Return what robots know from the start on: name -> (R,); only names that options expect are used."""
        return {}

    def after_moving(self) -> None:
        """Go on by a control period in all worlds at once, once all robots have moved."""

    def done(self) -> Flags:
        """Return which worlds (W,) are done before their time; none unless you say so."""
        return np.zeros(self.world.worlds, dtype=np.bool_)

    @abstractmethod
    def result(self) -> Mapping[str, Floats]:
        """Return the value (W,) of each measure by its name: finite at any time, at the end the result."""

    def observe(self) -> Mapping[str, Floats]:
        """Return what each robot sees of the task beside the usual terms: name -> (R,), within [-1, 1]."""
        return {}

    def reward(self) -> Floats | None:
        """Return the rewards (R,) of the last decision period; None: what the measures have gained (`rewards`)."""
        return None

    def command(self, commands: Commands) -> None:
        """Write the commands with which a control period begins, before behaviours write theirs; none unless you do."""
        commands.clear()

    def bend(self, commands: Commands) -> None:
        """Change the commands of behaviours, once all are known."""

    def lead(self, commands: Commands) -> None:
        """Write the commands of the baseline in place of those of behaviours: a random walk unless you do."""
        rows = np.flatnonzero(self.world.ticks[self.world.of_row] % round(WALK / self.world.period) == 0)
        if len(rows):
            self._walk[rows] = self.world.max_speed[rows] * self.world.directions(rows)
        commands.vectors[:] = self._walk
        commands.commanded[:] = True

    # ---- what the worlds call

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
        for thing in self.around:
            thing.show(self.world.buffers["gradients"], world, self.world.now)

    def lose(self, rows: Ints) -> None:
        """Let go of robots in `rows` (K,) that are about to be taken away or to fail."""

    def renew(self, rows: Ints) -> None:
        """Forget what happened to the robots in `rows` (K,), which begin anew."""

    def start_tick(self) -> Ints | None:
        """Start a control period; return the rows (K,) that decide in it, None for all."""
        return self.world.team.at_work

    def sense(self) -> None:
        """Show things that move where they are now, before robots sense."""
        moving = [thing for thing in self.around if thing.moves]
        if moving:
            buffer = self.world.buffers["gradients"]
            for world in range(self.world.worlds):
                buffer.clear(world)
                for thing in self.around:
                    thing.show(buffer, world, self.world.now)

    def follow(self, vectors: Floats, working: Flags) -> None:
        """Act for robots that are driven by vectors (R, 2) [m/s]; working (R,): those that are at work."""

    def after_deciding(self) -> None:
        """Carry out behaviours that have just started."""

    def after_acting(self, commands: Commands) -> None:
        """Change the commands, and note them."""
        self.bend(commands)
        self.asked[:] = np.where(commands.commanded[:, None], commands.vectors, 0.0)

    def after_leaving(self) -> None:
        """Carry out the requests of robots while they acted."""

    def before_moving(self, commands: Commands) -> None:
        """Change the commands of all robots, also of driven ones, just before they move."""

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
        ticks = max(int(self.world.ticks[world]) - 1, 0)  # the last thing was done at the beginning of its period
        return ticks * self.world.period

    def headline(self, world: int) -> str:
        """Return what there is to say of a world in one line: its measures."""
        return ", ".join(f"{name} {values[world]:.3g}" for name, values in self.result().items())


@cache
def attributes_of_tasks() -> type[BaseModel]:
    """Return a model of what a task says in attributes of its class."""
    hints = {name: hint for name, hint in get_type_hints(Task).items() if get_origin(hint) is ClassVar}
    fields: dict[str, Any] = {name: (*get_args(hint), ...) for name, hint in hints.items() if name != "promises"}
    strict = ConfigDict(strict=True, allow_inf_nan=False, arbitrary_types_allowed=True, revalidate_instances="always")
    return create_model("Attributes", __config__=strict, **fields)


def task_class(mission: MissionConfig) -> type[Task[Any, Any]]:
    """Return the class of the task of a mission."""
    return find_task(mission.task.name)  # type: ignore[return-value]  # all that are registered are tasks


def coordinators_of(
    mission: MissionConfig, knowledge: Knowledge, library: Library, directories: Sequence[Path] = ()
) -> tuple[CoordinatorModel, ...]:
    """Return the models of the goals that robots coordinate, in their order."""
    return coordinator_models(task_class(mission).goals(mission, directories), knowledge, library)
