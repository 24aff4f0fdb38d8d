"""One mission from start to end, and its result."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.world.explaining import RobotStep, explain_robot
from clean_swarm_env.world.mission_end import RUNNING, mission_state
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import library_of
from selector.coordination.selection import BY_SCORE, Selection
from selector.strategies.registry import StrategySpec
from selforg.arrays import Floats

Scores = Mapping[str, Mapping[str, float]]
PERIOD_ROUNDING = 1e-9
"""A time this little before the beginning of a control period belongs to that period [periods]."""


@dataclass(frozen=True)
class MissionResult:
    """The figures of a mission that is over, in the order of the columns of `runs.csv`."""

    completed: bool
    """Whether all garbage was dumped in time, or all measures of the task met their targets."""
    duration_s: float
    """Time at which the last item was dumped, or the task was done, or the time limit [s]."""
    collision_samples_per_s: tuple[float, ...]
    """For each collision distance, pairs closer than it, counted at every physics step [1/s]."""
    collision_events_per_s: tuple[float, ...]
    """For each collision distance, pairs that came closer than it [1/s]."""
    garbage_done: int
    """Items dumped."""
    robots: int
    """Robots that took part."""
    ticks: int
    """Control periods run."""
    items_per_min: float
    """Items dumped per minute [1/min]."""
    cost_s: float
    """See `Task.cost` [s]."""
    unavoidable_s: float
    """The part of the cost that nobody could avoid [s]."""
    measures: Mapping[str, float] = field(default_factory=dict)
    """The measures of the task by name; cleaning has none."""

    @property
    def excess_s(self) -> float:
        """The part of the cost that is compared [s]."""
        return self.cost_s - self.unavoidable_s

    def as_mapping(self) -> dict[str, Any]:
        """Return the figures as plain data; without `measures` where there are none."""
        figures = asdict(self)
        return figures if self.measures else {name: figures[name] for name in figures if name != "measures"}


@dataclass(frozen=True)
class MissionRun:
    """The arguments of one mission.

    Attributes:
        mission: the mission.
        start: places of robots and items at the start.
        seed: seed of everything random in it.
        scores: goal -> option -> score, laid over the expert knowledge.
        strategy: decides in every decision period which option each robot's coordinators hold.
        directories: the user's configurations, knowledge and robots, searched before the shipped ones.

    """

    mission: MissionConfig
    start: StartConfiguration
    seed: int
    scores: Scores
    strategy: StrategySpec = BY_SCORE
    directories: tuple[Path, ...] = ()

    def explain(self, robot: int, time: float) -> RobotStep:
        """Run the mission up to the control period in which `time` [s] lies; return what a robot decided then, and why.

        Raises:
            ValueError: no such robot, one that has not joined by then, or a time at which the mission does not run.

        """
        course = self._explained(robot)
        ticks = period_of(time, self.mission.world.control_rate) + 1
        while course.in_progress and course.worlds.ticks[0] < ticks:
            course.tick()
        if not 0 < ticks == course.worlds.ticks[0]:
            ended = result_of(course.worlds, 0).duration_s
            raise ValueError(f"time: expected seconds from 0 to the end of the mission at {ended:g}, got {time:g}")
        return explain_robot(course.worlds, robot)

    def explanations(self, robot: int) -> Iterator[RobotStep]:
        """Run the mission, and yield what a robot decides in each control period, and why, as soon as it has decided.

        The first control period is that in which the robot joins, if it is not in the team from the start on.

        Raises:
            ValueError: no such robot.

        """
        course = self._explained(robot)
        while course.in_progress:
            course.tick()
            if robot < course.worlds.team.joined[0]:
                yield explain_robot(course.worlds, robot)

    def _explained(self, robot: int) -> Course:
        """Return the mission at its beginning, to be explained."""
        course = Course(self, explained=True)
        if not 0 <= robot < course.worlds.robots:
            raise ValueError(f"robot: expected a number from 0 to {course.worlds.robots - 1}, got {robot}")
        return course


def period_of(time: float, control_rate: float) -> int:
    """Return the number of the control period in which `time` [s] lies; -1 for no time of a mission."""
    return math.floor(time * control_rate + PERIOD_ROUNDING) if math.isfinite(time) and time >= 0.0 else -1


def run_mission(
    mission: MissionConfig,
    start: StartConfiguration,
    seed: int,
    scores: Scores,
    strategy: StrategySpec = BY_SCORE,
    directories: tuple[Path, ...] = (),
) -> MissionResult:
    """Run one mission to its end; the arguments are those of `MissionRun`."""
    course = Course(MissionRun(mission, start, seed, scores, strategy, directories))
    while course.in_progress:
        course.tick()
    return result_of(course.worlds, 0)


class Course:
    """One mission in one world, control period by control period.

    With `explained` the networks note why each behaviour runs or does not; the course is the same.

    Attributes:
        worlds: the one world.

    """

    def __init__(self, run: MissionRun, *, explained: bool = False) -> None:
        mission, directories = run.mission, run.directories
        knowledge = knowledge_of(mission, directories).with_scores(run.scores)
        models = coordinators_of(mission, knowledge, library_of(directories), directories)
        self.worlds = Worlds(mission, models, directories=directories, explained=explained)
        self.worlds.reset(0, run.start, run.seed)
        self._selection = Selection(self.worlds.coordinators, run.seed, run.strategy)
        self._decision_ticks = round(mission.decision_period * mission.world.control_rate)
        self.worlds.hold(self._selection.decide())

    def opinions(self) -> dict[str, Floats]:
        """Return what each robot thinks of the options (R, O) of each coordinated goal."""
        thought = self._selection.opinions()
        return {c.model.goal: values for c, values in zip(self.worlds.coordinators, thought, strict=True)}

    @property
    def in_progress(self) -> bool:
        """Whether garbage and time are left."""
        worlds = self.worlds
        return mission_state(worlds.done[0], worlds.ticks[0], worlds.world.limits[0]) == RUNNING

    def tick(self) -> None:
        """Run one control period; at the first one of a decision period, choose the options first."""
        ticks = int(self.worlds.ticks[0])
        if ticks > 0 and ticks % self._decision_ticks == 0:
            self.worlds.hold(self._selection.decide())
        self.worlds.tick()


def result_of(worlds: Worlds, world: int) -> MissionResult:
    """Return the result of a world up to now."""
    task, values = worlds.task, worlds.task.result()
    ticks, totals = int(worlds.ticks[world]), task.totals()
    done = int(totals["garbage_done"][world]) if "garbage_done" in totals else 0
    time = max(ticks, 1) * worlds.period
    events, samples = worlds.collisions.events[world], worlds.collisions.samples[world]
    return MissionResult(
        completed=bool(task.completed(values)[world]),
        duration_s=round(float(task.duration(world)), 9),
        collision_samples_per_s=tuple((samples / time).tolist()),
        collision_events_per_s=tuple((events / time).tolist()),
        garbage_done=done,
        robots=int(worlds.team.joined[world]),
        ticks=ticks,
        items_per_min=60.0 * done / time,
        cost_s=float(task.cost(world, values)),
        unavoidable_s=float(task.unavoidable(world)),
        measures={name: float(own[world]) for name, own in values.items()},
    )
