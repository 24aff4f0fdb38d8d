"""One mission from start to end, and what is reported of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.config import MissionConfig, StartConfiguration
from clean_swarm_env.robot_model import coordinators_of
from clean_swarm_env.worlds import Worlds
from selector.decisions import Problem
from selector.knowledge import load_knowledge
from selector.library import Library
from selector.strategies.max_score import MaxScore

Scores = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class MissionResult:
    """What a mission came to.

    Attributes:
        completed: whether all garbage was dumped in time.
        duration_s: time at which the last item was dumped, or the time limit [s].
        collision_samples_per_s: for each collision distance, pairs closer than it, counted at every physics step [1/s].
        collision_events_per_s: for each collision distance, pairs that came closer than it [1/s].
        garbage_done: items dumped.
        robots: number of robots.
        ticks: control periods run.

    """

    completed: bool
    duration_s: float
    collision_samples_per_s: tuple[float, ...]
    collision_events_per_s: tuple[float, ...]
    garbage_done: int
    robots: int
    ticks: int


def run_mission(mission: MissionConfig, start: StartConfiguration, seed: int, scores: Scores) -> MissionResult:
    """Run one mission with the options of the highest scores; `scores` are laid over the expert knowledge."""
    worlds = at_start(mission, start, seed, scores)
    while in_progress(worlds):
        worlds.tick()
    return result_of(worlds, 0)


def at_start(
    mission: MissionConfig, start: StartConfiguration, seed: int, scores: Scores, *, explained: bool = False
) -> Worlds:
    """Return the one world of a mission, ready for its first tick."""
    knowledge = load_knowledge(mission.knowledge).with_scores(scores)
    library = Library()
    library.check(knowledge)
    worlds = Worlds(mission, coordinators_of(mission.network, knowledge, library), explained=explained)
    worlds.reset(0, start, seed)
    choose(worlds)
    return worlds


def in_progress(worlds: Worlds) -> bool:
    """Whether the mission of the first world still has garbage and time left."""
    mission = worlds.mission
    limit = round(mission.time_limit / worlds.period)
    return bool(worlds.garbage.done[0] < mission.garbage.count and worlds.ticks[0] < limit)


def choose(worlds: Worlds) -> None:
    """Let every robot hold the options of the highest scores."""
    keys = np.zeros(worlds.rows, dtype=np.uint64)  # max-score draws nothing
    models = [coordinator.model for coordinator in worlds.coordinators]
    strategies = [MaxScore(Problem(model.goal, model.options, model.scores), keys) for model in models]
    worlds.hold(np.stack([strategy.select(np.zeros((worlds.rows, 0))) for strategy in strategies], axis=1))


def result_of(worlds: Worlds, world: int) -> MissionResult:
    """Return the result of a world as it stands."""
    mission = worlds.mission
    ticks, done = int(worlds.ticks[world]), int(worlds.garbage.done[world])
    completed = done == mission.garbage.count
    time = max(ticks, 1) * worlds.period
    # the last item is dumped at the beginning of its control period
    duration = max(ticks - 1, 0) * worlds.period if completed else mission.time_limit
    return MissionResult(
        completed=completed,
        duration_s=round(duration, 9),
        collision_samples_per_s=tuple((worlds.collisions.samples[world] / time).tolist()),
        collision_events_per_s=tuple((worlds.collisions.events[world] / time).tolist()),
        garbage_done=done,
        robots=worlds.robots,
        ticks=ticks,
    )
