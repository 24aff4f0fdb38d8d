"""Missions in one process and in lock step over processes of robots, tick by tick."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import mission_from
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.world.worlds import Worlds
from examples.robots.bodies import ServedBodies, tick_together


@dataclass
class Both:
    """One mission, in one process and by processes of robots, which begin alike."""

    mission: object
    strategy: str
    seed: int
    watch: Callable[[Worlds], np.ndarray] | None = None
    """Returns what is kept of a control period, `poses_of` if not given."""
    course: list = field(default_factory=list)
    """Poses (N, 3) after each control period in one process."""

    def __post_init__(self):
        self.mission = mission_from(self.mission)
        self.start = random_start(self.mission, self.seed, 0)
        named, scenario = decider_named(self.strategy), Scenario("x", self.seed, self.mission, self.start)
        seen, action = named.observation(usual_terms(self.mission)), ActionConfig(mode=named.mode)
        batch = Batch(self.mission, source=lambda world: scenario, begin_anew=False, observation=seen, action=action)
        decided = DecidedGoal(batch, named.decides(None))
        decider = named.build(decided.problem, np.zeros(batch.rows, dtype=np.int64))
        observations = batch.reset()
        decider.reset(batch.worlds.rows_of(0), self.seed)
        watch = self.watch or poses_of
        batch.watch = lambda: self.course.append(watch(batch.worlds))
        while not batch.over[0]:
            observations = batch.step(decided.decide(decider, observations)).observations
        self.result = batch.finished[0].result

    def bodies(self):
        return ServedBodies(self.mission, self.start, self.seed)

    def robots(self, **settings):
        numbers = range(self.mission.rows)
        return [
            RobotProcess(self.mission, k, self.strategy, start=self.start, seed=self.seed, **settings) for k in numbers
        ]


def poses_of(worlds):
    """Return the poses (N, 3) of all robots, as a new array."""
    return np.column_stack([worlds.physics.positions, worlds.physics.headings])


def same_course(mission, strategy, seed):
    """Fail at the first tick at which robots as processes are not, bit for bit, where they are in one process."""
    both = Both(mission, strategy, seed)
    bodies, robots, tick = both.bodies(), both.robots(), 0
    while bodies.running:
        tick_together(bodies, robots)
        np.testing.assert_array_equal(poses_of(bodies.worlds), both.course[tick], f"tick {tick}")
        tick += 1
    assert tick == len(both.course)
    if bodies.worlds.task.name == "Cleaning":  # measures of others may count what robots know, which bodies do not
        assert bodies.result == both.result
    assert [robot.ear.refused.total() for robot in robots] == [0] * len(robots)
