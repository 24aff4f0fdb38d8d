"""Trials: missions of given scenarios under one way of choosing options, many worlds at once.

What a mission comes to does not depend on the worlds beside it nor on their number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.frames import frame_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.terms import ObservationConfig
from clean_swarm_env.world.mission import MissionResult
from selector.strategies.policy import Network
from selector.strategies.policy_file import TrainedPolicy
from selector.strategies.problem import Problem
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys

Ints = NDArray[np.int64]
Observations = NDArray[np.float32]
MOST_WORLDS = 32
"""Worlds of one batch, unless told otherwise."""


class Pilot(Protocol):
    """What chooses an option for each row."""

    def begin(self, rows: Ints, seed: int) -> None:
        """Take note that a mission of a `seed` begins in `rows` (N,)."""

    def choose(self, observations: Observations) -> Ints:
        """Return the option (R,) that each row holds in the coming decision period, from what it sees (R, F)."""


class PilotMaker(Protocol):
    """What makes a pilot for a batch of worlds."""

    def __call__(self, problem: Problem, teams: Ints) -> Pilot:
        """Return a pilot for rows of `teams` (R,), whose features are all components of the observation."""


class StrategyPilot:
    """A strategy that decides anew in every decision period, and learns no more."""

    def __init__(self, strategy: DecisionStrategy, columns: Ints) -> None:
        """`columns` (K,) of an observation are the context of the strategy."""
        self.strategy, self._columns = strategy, columns

    def begin(self, rows: Ints, seed: int) -> None:
        """Give rows new sources of randomness."""
        self.strategy.reseed(rows, row_keys(np.random.SeedSequence([seed, 1]), len(rows)))

    def choose(self, observations: Observations) -> Ints:
        """Return what the strategy selects."""
        return self.strategy.select(observations[:, self._columns].astype(np.float64))


class PolicyPilot:
    """A trained network: the likeliest option."""

    def __init__(self, policy: TrainedPolicy, problem: Problem) -> None:
        names = policy.spec.observations
        known = Problem(problem.goal, problem.options, problem.scores, names)
        self._columns = np.array([problem.features.index(name) for name in names])
        self._network = Network(policy.ordered_for(known, "policy"))

    def begin(self, rows: Ints, seed: int) -> None:
        """Nothing changes with a mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the likeliest option."""
        outputs = self._network.outputs(observations[:, self._columns].astype(np.float64))
        options: Ints = outputs.argmax(axis=1)
        return options


def problem_of(batch: Batch) -> Problem:
    """Return what is decided in a batch and what is seen; the first coordinated goal counts."""
    model = batch.worlds.coordinator.model
    return Problem(model.goal, model.options, model.scores, batch.observer.names)


def run_trials(
    scenarios: Sequence[Scenario],
    maker: PilotMaker,
    *,
    worlds: int = MOST_WORLDS,
    observation: ObservationConfig | None = None,
    directories: tuple[Path, ...] = (),
) -> list[MissionResult]:
    """Return what each scenario came to, in their order."""
    results: dict[int, MissionResult] = {}
    for numbers in by_frame(scenarios):
        some = [scenarios[number] for number in numbers]
        frame_worlds = min(worlds, len(some))
        for place, result in _trials(some, maker, frame_worlds, observation, directories):
            results[numbers[place]] = result
    return [results[number] for number in range(len(scenarios))]


def by_frame(scenarios: Sequence[Scenario]) -> list[list[int]]:
    """Return the numbers of scenarios that fit into one batch, batch by batch."""
    groups: list[tuple[object, list[int]]] = []
    for number, scenario in enumerate(scenarios):
        frame = frame_of(scenario.mission)
        own = next((members for known, members in groups if known == frame), None)
        if own is None:
            groups.append((frame, [number]))
        else:
            own.append(number)
    return [members for _, members in groups]


def _trials(
    scenarios: Sequence[Scenario],
    maker: PilotMaker,
    worlds: int,
    observation: ObservationConfig | None,
    directories: tuple[Path, ...],
) -> Iterator[tuple[int, MissionResult]]:
    """Yield the place of each scenario, of one frame, and what it came to, as they finish."""
    waiting = iter(enumerate(scenarios))
    doing, did = [-1] * worlds, [-1] * worlds
    begun: list[tuple[int, int]] = []

    def following(world: int) -> Scenario | None:
        place, scenario = next(waiting, (-1, None))
        did[world], doing[world] = doing[world], place
        if scenario is not None:
            begun.append((world, scenario.seed))
        return scenario

    frame = scenarios[0].mission
    batch = Batch(frame, worlds, source=following, observation=observation, directories=directories)
    teams = np.repeat(np.arange(worlds), batch.robots)
    pilot = maker(problem_of(batch), teams)
    observations = batch.reset()
    while max(doing) >= 0:
        for world, seed in begun:
            pilot.begin(batch.worlds.rows_of(world), seed)
        begun.clear()
        observations = batch.step(pilot.choose(observations)).observations
        for end in batch.finished:
            yield did[end.world], end.result
