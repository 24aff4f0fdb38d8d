"""Tasks: the work in W worlds of N robots, R = W * N rows. A class in one file is a task of your own; see `Task`.

Why there is one world for all of them: docs/decisions/0223-one-world-any-task.md.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Final, Generic, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import BaseModel, ConfigDict, create_model

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import StartsFile
from clean_swarm_env.config.tasks import TaskSettings, find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.parts.measure import Achievement
from clean_swarm_env.world.parts.shown import Destination, chosen_of
from clean_swarm_env.world.parts.things import TaskState, Things, WorldStart
from clean_swarm_env.world.staged import StagedTask
from clean_swarm_env.world.view import TaskView
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel, coordinator_models
from selector.documents.errors import validated
from selector.knowledge import Knowledge
from selforg.arrays import Flags, Floats, Ints
from selforg.commands import Commands
from selforg.plugins import is_own
from selforg.program import AFTER_ACTING, AFTER_MOVING, COMMANDING, LEAD, SENSE, TELLING, Rows, Step

WALK: Final = 2.0
"""Time for which a robot on a random walk keeps its direction [s]."""

S = TypeVar("S", bound=TaskSettings)
T = TypeVar("T", bound=TaskState)


class Task(StagedTask, ABC, Generic[S, T]):
    """What there is to do in W worlds at once. Register a subclass with `TASKS.register`.

    You write `measures` and `result`.

    You may write what there is (`State`, `sizes`, `place`, `things`, `known`), how it goes on (`after_moving`, `done`,
    `bend`, `command`, `command_baseline`), what learners see and get (`observe`, `reward`, `terms`, `achievements` with
    `achieved`, `totals`, `phases` with `phase`), how the task looks (`shown`, `drawn`, `headline`), and what is said of
    it (`doing`, `searching`, `sees`, `destinations`, `cost_so_far`, `cost_words`, `kind_of`, `missed`, `excess`). You
    never need to loop over robots, and will not need the rest: robots start anywhere, nothing else is there, and the
    mission ends with its time.

    A mission names the task, and has its settings, under the key `task:`. `parallel_env`, `evaluate`, `play`,
    recordings, states and training then take it as they take cleaning.

    Attributes:
        name, story, mission, changes: see `TaskKind`.
        priced, Counts, best_score, thinks_when_driven, always_acts, asked, standing: see `StagedTask`.
        measures: figures of success; the first one that is no guard is the one that counts.
        baseline: what the mechanisms are compared with, in words; see `command_baseline`. Empty: nothing.
        baseline_option: the option of the goal that is the baseline, where one is.
        goal: the goal in the knowledge whose options serve the task: the one of its own name unless given.
        fewest: robots with which the measures have a meaning.
        start_side: side of the square in the middle in which robots start, 0: the whole ground [m].
        apart, away: least distance of robots from each other, and from the middle, at the start [m].
        terms: terms of an observation unless others are chosen.
        achievements: what robots are counted for, told and paid, see `achieved`.
        phases: names of the phases of a robot's work, by which options may be limited, see `phase`.
        yardsticks: strategies that every comparison has beside those chosen; the baseline unless given.
        doing, searching: behaviour -> what a robot does while it runs, such as "picks an item"; what a robot does that
            looks for something, as a verb, such as "explore".
        sees: the sensor of robots that see what they look for.
        missed: head of the column, and words, of missions that were not completed.
        excess: what a cost is beyond the part that nobody can avoid.
        Starts: what files of start configurations say.
        world, settings, state: the worlds, the settings, and the arrays of this task.

    """

    State: ClassVar[type[TaskState]] = TaskState
    baseline: ClassVar[str] = "random walk, a new direction every 2 s"
    baseline_option: ClassVar[str] = ""
    fewest: ClassVar[int] = 1
    start_side: ClassVar[float] = 0.0
    apart: ClassVar[float] = 1.0
    away: ClassVar[float] = 0.0
    terms: ClassVar[tuple[str, ...]] = (
        "command", "things", "neighbour", "crowd", "movement", "facts", "task", "time", "holds",
    )  # fmt: skip
    achievements: ClassVar[tuple[Achievement, ...]] = ()
    phases: ClassVar[tuple[str, ...]] = ()
    Starts: ClassVar[type[StartsFile]] = StartsFile
    doing: ClassVar[Mapping[str, str]] = {}
    searching: ClassVar[Mapping[str, str]] = {}
    sees: ClassVar[str] = ""
    missed: ClassVar[tuple[str, str]] = ("missed", "left short of a target")
    excess: ClassVar[str] = "the cost less the part that no strategy can avoid"
    yardsticks: ClassVar[tuple[str, ...]] = ()

    settings: S
    state: T

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

    def __init__(self, world: TaskView) -> None:
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
        self.standing = np.zeros(world.rows, dtype=np.int64)
        self.around = self.things()

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

    def observe(self) -> Mapping[str, Floats]:
        """Return what each robot sees of the task beside the usual terms: name -> (R,), within [-1, 1]."""
        return {}

    def reward(self) -> Floats | None:
        """Return the rewards (R,) of the last decision period; None: what the measures have gained (`rewards`)."""
        return None

    def target(self, row: int, read: Mapping[str, float]) -> tuple[str, float] | None:
        """Return the place that a robot is going to: a word for it, and the distance [m]; `read`: sensor -> reading.

        It is the first of the `destinations` that the readings fit. The distance is -1 if it is not known.
        """
        world = row // self.world.robots
        values = {one.name: one.values[world] for one in self.shown() if one.values.ndim > 1}
        for one in self.destinations():
            if all((read.get(sensor, 0.0) > 0.0) == wanted for sensor, wanted in one.when.items()):
                places = values[one.at][chosen_of(one, values, len(values[one.at]))]
                away = self.world.nearest(row, places) if one.certain and len(places) else -1.0
                return (one.word, away) if len(places) else None
        return None

    def destinations(self) -> tuple[Destination, ...]:
        """Return the places that robots go to: what `explain` and pages say of a robot, and draw."""
        return ()

    def achieved(self) -> Mapping[str, Ints | Flags]:
        """Return how often each robot achieved something in the last control period: name -> (R,), all of them."""
        return {}

    def totals(self) -> Mapping[str, Ints]:
        """Return numbers of each mission so far, which infos have beside the measures: name -> (W,)."""
        return {}

    def cost_so_far(self, world: int, values: Mapping[str, Floats]) -> float:
        """Return what the mission of a world has cost so far [s]: what it costs if it ends now; `values`: of `result`.

        What options bring about in the next seconds is compared by it.
        """
        return self.cost(world, values)

    @classmethod
    def kind_of(cls, mission: MissionConfig) -> str:
        """Return the kind of a mission among the scenarios of a family; missions that differ by luck are of one."""
        return cls.name

    @classmethod
    def prices(cls, mission: MissionConfig) -> Mapping[str, float]:
        """Return the prices of a mission, which the page of recordings adds up by the names that cleaning has."""
        return {}

    @classmethod
    def cost_words(cls, mission: MissionConfig) -> str:
        """Return what the cost of a mission is made of."""
        return f"{mission.time_limit:g} s times the measure that is worst by its target"

    def phase(self) -> Ints:
        """Return the phase in which each robot (R,) is, a number of `phases`; 0 without any."""
        return np.zeros(self.world.rows, dtype=np.int64)

    def steps(self, commands: Commands) -> list[Step]:
        """Return the steps of a tick that are the task's, by their stages; see ARCHITECTURE.md."""
        everyone, minds = Rows.of(self.world.every_row), self.world.minds
        telling = [Step(TELLING, lambda now, _: minds.tell(self.noticed(), now), everyone)] if minds.facts else []
        return [
            Step(SENSE, lambda now, _: self.sense(), everyone),
            Step(COMMANDING, lambda now, _: self.command(commands), everyone),
            Step(AFTER_ACTING, lambda now, _: self.after_acting(commands), everyone),
            Step(LEAD, lambda now, _: self.command_baseline(commands), everyone),
            Step(AFTER_MOVING, lambda now, _: self.after_moving(), everyone),
            *telling,
        ]

    def command(self, commands: Commands) -> None:
        """Write the commands with which a control period begins, before behaviours write theirs; none unless you do."""
        commands.clear()

    def command_baseline(self, commands: Commands) -> None:
        """Write the commands of the baseline in place of those of behaviours: a random walk unless you do."""
        rows = np.flatnonzero(self.world.ticks[self.world.of_row] % round(WALK / self.world.period) == 0)
        if len(rows):
            self._walk[rows] = self.world.max_speed[rows] * self.world.directions(rows)
        commands.vectors[:] = self._walk
        commands.commanded[:] = True


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
