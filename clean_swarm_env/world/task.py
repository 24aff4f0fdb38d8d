"""Tasks: the work in a world. A class in one file is a task of your own; see `Task`.

Why there is one world for all of them: docs/decisions/0223-one-world-any-task.md.

Shapes: W worlds of N robots, R = W * N rows (robots).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Generic, TypeVar, get_args, get_origin

import numpy as np

from clean_swarm_env.config.cleaning import PatrolConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import TaskSettings, find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.reception import Reception
from clean_swarm_env.world.task_parts import Measure, TaskState, Things, WorldStart
from clean_swarm_env.world.view import World
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_network import RobotNetwork
from selector.coordination.robots import network_of
from selforg.arrays import KEPT, Flags, Floats
from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MovementMechanism
from selforg.randomness import DirectionStream

AROUND: Final = BufferSettings(aggregation={"DEFAULT": "new"}, aggregation_distance=0.0)
"""Settings of the buffer of things: gradients at one place are one thing."""
WALK: Final = 2.0
"""Time for which a robot on a random walk keeps its direction [s]."""

S = TypeVar("S", bound=TaskSettings)
T = TypeVar("T", bound=TaskState)


class Task(ABC, Generic[S, T]):
    """What there is to do in W worlds at once. Register a subclass with `TASKS.register`; implement `result`.

    A mission names the task, and has its settings, under the key `task:`. `parallel_env`, `evaluate`, `run`, `play`,
    recordings, states, training and tuning then take it as they take cleaning. Everything else has a default: robots
    start anywhere, nothing else is there, and the mission ends with its time. You never need to loop over robots.

    Attributes:
        name: that of the class, unless given.
        story: one sentence: the robots, their place and their task.
        measures: figures of success; the first one that is no guard is the one that counts.
        baseline: what the mechanisms are compared with, in words; see `lead`. Empty: nothing.
        baseline_option: the option of the goal that is the baseline, where one is.
        goal: the goal in the knowledge whose options serve the task: the one of its own name unless given.
        mission: keys of a mission that names the task, unless they are given: the task's own mission.
        fewest: robots with which the measures have a meaning.
        start_side: side of the square in the middle in which robots start, 0: the whole ground [m].
        apart, away: least distance of robots from each other, and from the middle, at the start [m].
        thinks_when_driven: whether networks of robots go on deciding while a learner drives the robots.
        world, settings, state: the worlds, the settings, and the arrays of this task.
        around: the things, as `things` returned them.
        asked: (R, 2) [m/s] what the mechanisms asked for last; 0 for nothing.

    """

    name: ClassVar[str] = ""
    Settings: ClassVar[type[TaskSettings]] = TaskSettings
    State: ClassVar[type[TaskState]] = TaskState
    story: ClassVar[str] = ""
    measures: ClassVar[tuple[Measure, ...]] = ()
    baseline: ClassVar[str] = "random walk, a new direction every 2 s"
    baseline_option: ClassVar[str] = ""
    goal: ClassVar[str] = ""
    mission: ClassVar[Mapping[str, Any]] = {}
    fewest: ClassVar[int] = 1
    start_side: ClassVar[float] = 0.0
    apart: ClassVar[float] = 1.0
    away: ClassVar[float] = 0.0
    thinks_when_driven: ClassVar[bool] = True
    handling: ClassVar[tuple[str, ...]] = ()  # behaviours that the task carries out; see `records.MindsRecord`
    transport: ClassVar[tuple[str, ...]] = ()

    settings: S
    state: T
    asked: Annotated[Floats, "R 2", KEPT]
    _walk: Annotated[Floats, "R 2", KEPT]

    def __init_subclass__(cls) -> None:
        """Take the name from the class, and settings and state from the brackets of the base class."""
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

    def __init__(self, world: World) -> None:
        self.world = world
        mission = world.mission
        if mission.robots.count < self.fewest:
            expected = f"at least {self.fewest} with the task {mission.task.name}"
            raise ConfigurationError(f"robots.count: expected {expected}, got {mission.robots.count}")
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
            self._walk[rows] = self.world.max_speed * self.world.directions(rows)
        commands.vectors[:] = self._walk
        commands.commanded[:] = True

    # ---- what the worlds call

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
        space = poses.space
        trails = trail_settings(mission.patrol)
        return {
            "gradients": SoBuffer(AROUND, space, poses),
            "pheromones": SoBuffer(trails, space, poses, reception.delivery()),
            "own_pheromones": SoBuffer(trails, space, poses, Delivery(reach=0.0)),
        }

    @classmethod
    def movers(
        cls, mission: MissionConfig, buffers: Mapping[str, SoBuffer], directions: DirectionStream
    ) -> dict[str, MovementMechanism]:
        """Return the mechanisms that move robots by themselves, by the behaviours of the robots' network."""
        return {}

    def reset(self, world: int, rows: slice) -> None:
        """Show the things of a world that has just been placed."""
        self.asked[rows] = self._walk[rows] = 0.0
        for thing in self.around:
            thing.show(self.world.buffers["gradients"], world, self.world.now)

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

    def costs(self) -> Floats:
        """Return what the missions (W,) cost [s]: their time limits times their worst measures by the targets.

        A guard counts where it misses its target only. 1 time limit: the target is just met.
        """
        values = self.result()
        worst: Floats = np.max([measure.ratio(values[measure.name]) for measure in self.measures], axis=0)
        return worst * self.world.limits * self.world.period

    def met(self) -> Flags:
        """Return whether all measures (W,) meet their targets."""
        values, met = self.result(), np.ones(self.world.worlds, dtype=np.bool_)
        for measure in self.measures:
            met &= np.array([measure.met(value) for value in values[measure.name].tolist()])
        return met


def trail_settings(patrol: PatrolConfig) -> BufferSettings:
    """Return the settings of buffers of pheromones, of which the strongest at a place counts."""
    return BufferSettings(patrol.view_distance, {"DEFAULT": "max"}, patrol.aggregation_distance, patrol.min_diffusion)


def measures_of(mission: MissionConfig) -> tuple[Measure, ...]:
    """Return the measures that results of a mission have; none where the task is cleaning, which has other figures."""
    kind: Any = None if mission.cleans else find_task(mission.task.name)
    measures: tuple[Measure, ...] = () if kind is None else kind.measures
    return measures
