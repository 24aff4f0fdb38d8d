"""Trials: missions of given scenarios, many at the same time, in which a decider chooses the options, drives, or both.

The result of a mission depends neither on the worlds beside it nor on their number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.frames import grouped
from clean_swarm_env.deciders.decided_goal import AskedGoal, DecidedGoal
from clean_swarm_env.deciders.decider import DeciderMaker
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission import MissionResult
from train.running.pulse import tell

MOST_WORLDS = 32
"""Default of the largest number of worlds in a batch."""


@dataclass(frozen=True)
class TrialSettings:
    """Settings of trials."""

    goal: AskedGoal = None
    """Goals that the decider chooses options for; see `DecidedGoal`."""
    worlds: int = MOST_WORLDS
    """Largest number of worlds side by side."""
    observation: ObservationConfig | None = None
    """Terms of the observation; the default ones unless given."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""
    record: RecordSettings | None = None
    """Where the missions are recorded; none is unless given."""
    action: ActionConfig = field(default_factory=ActionConfig)
    """What the decider gives: options, movement vectors or both."""


def run_trials(
    scenarios: Sequence[Scenario], maker: DeciderMaker, settings: TrialSettings | None = None
) -> list[MissionResult]:
    """Return the result of each scenario, in the order of the scenarios."""
    results = dict(each_trial(scenarios, maker, settings))
    return [results[number] for number in range(len(scenarios))]


def each_trial(
    scenarios: Sequence[Scenario], maker: DeciderMaker, settings: TrialSettings | None = None
) -> Iterator[tuple[int, MissionResult]]:
    """Yield the place in `scenarios` and the result of each mission when it is done."""
    for numbers in grouped([scenario.mission for scenario in scenarios]):
        trials = _trials([scenarios[number] for number in numbers], maker, settings or TrialSettings())
        for place, result in trials:
            yield numbers[place], result


def _trials(
    scenarios: Sequence[Scenario], maker: DeciderMaker, settings: TrialSettings
) -> Iterator[tuple[int, MissionResult]]:
    """Yield the place in `scenarios`, all of one frame, and the result of each mission as it finishes."""
    worlds = min(settings.worlds, len(scenarios))
    waiting = iter(enumerate(scenarios))
    doing, did = [-1] * worlds, [-1] * worlds
    begun: list[tuple[int, int]] = []

    def following(world: int) -> Scenario | None:
        place, scenario = next(waiting, (-1, None))
        did[world], doing[world] = doing[world], place
        if scenario is not None:
            begun.append((world, scenario.seed))
        return scenario

    batch = Batch(
        scenarios[0].mission,
        worlds,
        source=following,
        observation=settings.observation,
        directories=settings.directories,
        record=settings.record,
        action=settings.action,
    )
    decided = DecidedGoal(batch, settings.goal)
    decider = maker(decided.problem, np.repeat(np.arange(worlds), batch.robots))
    observations = batch.reset()
    while max(doing) >= 0:
        for world, seed in begun:
            decider.reset(batch.worlds.rows_of(world), seed)
        begun.clear()
        tell(batch.decision_period * sum(place >= 0 for place in doing))
        observations = batch.step(decided.decide(decider, observations)).observations
        for end in batch.finished:
            yield did[end.world], end.result
