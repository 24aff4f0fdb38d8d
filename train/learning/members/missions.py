"""Missions of members: each mission has one member of a population, which decides for all its robots.

The result of a mission does not depend on the missions beside it, nor on the process that runs it.

Shapes: R rows, F components of an observation.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.machine_file import StateMachine
from selector.strategies.policy_file import TrainedPolicy
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.deciders.decider import Decided, Decider
from train.deciders.machine import MachineDecider
from train.deciders.policy import PolicyDecider
from train.deciders.rules import RuleDecider
from train.running.runs import RunKey, RunRecord
from train.running.trials import TrialSettings, each_trial


class PopulationMember(Protocol):
    """What decides in a mission; plain data, which can be sent to a worker process."""

    def decider(self, problem: Problem, rows: int) -> Decider:
        """Return a decider for the rows of one mission."""


@dataclass(frozen=True)
class OptionMember:
    """Always the same option."""

    option: int

    def decider(self, problem: Problem, rows: int) -> Decider:
        """Return a decider that takes the option."""
        return RuleDecider(problem, (), np.full((rows, 1), self.option))


@dataclass(frozen=True)
class PolicyMember:
    """The likeliest option by a network."""

    policy: TrainedPolicy

    def decider(self, problem: Problem, rows: int) -> Decider:
        """Return a decider that follows the policy."""
        return PolicyDecider(self.policy, problem)


@dataclass(frozen=True)
class MachineMember:
    """The option of a machine's state."""

    machine: StateMachine

    def decider(self, problem: Problem, rows: int) -> Decider:
        """Return a decider that follows the machine."""
        return MachineDecider(self.machine, problem, rows)


@dataclass(frozen=True)
class MemberRun(RunRecord):
    """One finished mission of a member."""

    place: int = 0
    """Number of the mission among those that were asked for."""
    seen: Floats = field(default_factory=lambda: np.zeros((3, 0)))
    """(3, F) number, sum and sum of squares of all observations of the mission."""


@dataclass(frozen=True)
class MemberTask:
    """Some missions, each with its member; plain data, which can be sent to a worker process."""

    scenarios: tuple[Scenario, ...]
    members: tuple[PopulationMember, ...]
    """The member of each scenario."""
    places: tuple[int, ...]
    """Number of each mission among those that were asked for."""
    settings: TrialSettings

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and number of each mission."""
        return tuple((scenario.id, str(place)) for scenario, place in zip(self.scenarios, self.places, strict=True))

    def without(self, done: Collection[RunKey]) -> MemberTask:
        """Return the missions that are not `done`."""
        left = [number for number, key in enumerate(self.keys) if key not in done]
        return replace(
            self,
            scenarios=tuple(self.scenarios[number] for number in left),
            members=tuple(self.members[number] for number in left),
            places=tuple(self.places[number] for number in left),
        )

    def each(self) -> Iterator[MemberRun]:
        """Run the missions, and yield each when it is done."""
        seen: dict[int, Floats] = {}
        waiting: dict[int, deque[int]] = defaultdict(deque)
        for place, scenario in enumerate(self.scenarios):
            waiting[scenario.seed].append(place)

        def decider(problem: Problem, teams: Ints) -> MembersDecider:
            return MembersDecider(problem, self.members, waiting, seen)

        for place, result in each_trial(self.scenarios, decider, self.settings):
            scenario = self.scenarios[place]
            run = (type(self).__name__, scenario.id, scenario.seed, str(self.places[place]), result, 0.0)
            yield MemberRun(*run, self.places[place], seen[place].copy())  # worlds without a mission are seen on


class _Mission(NamedTuple):
    """A mission that goes on."""

    rows: Ints
    decider: Decider
    place: int


class MembersDecider(Decider):
    """The rows of each mission follow the decider of its member.

    Args:
        problem: see `Decider`.
        members: member of each mission.
        waiting: seed -> numbers of its missions, in the order in which they begin.
        seen: number of a mission -> (3, F) number, sum and sum of squares of its observations, which this notes.

    """

    def __init__(
        self,
        problem: Problem,
        members: Sequence[PopulationMember],
        waiting: Mapping[int, deque[int]],
        seen: dict[int, Floats],
    ) -> None:
        super().__init__(problem)
        self._members, self._waiting, self._seen = members, waiting, seen
        self._missions: dict[int, _Mission] = {}

    def reset(self, rows: Ints, seed: int) -> None:
        """Let `rows` (N,) follow the member of the next mission of a seed."""
        place = self._waiting[seed].popleft()
        decider = self._members[place].decider(self.problem, len(rows))
        decider.reset(np.arange(len(rows)), seed)
        self._missions[int(rows[0])] = _Mission(rows, decider, place)
        self._seen[place] = np.zeros((3, len(self.problem.features)))

    def _decide(self, observations: Observations) -> Decided:
        count = len(observations)
        decided = Decided(np.zeros(count, dtype=np.int64), np.zeros((count, 2)))
        for rows, decider, place in self._missions.values():
            own = observations[rows]
            decided.options[rows], decided.vectors[rows] = decider.decide(own)
            numbers = own.astype(np.float64)
            self._seen[place] += np.stack([np.full(numbers.shape[1], len(own)), numbers.sum(0), (numbers**2).sum(0)])
        return decided

    def opinions(self) -> Floats:
        """Return the opinions of the members (R, O)."""
        return np.concatenate([mission.decider.opinions() for _, mission in sorted(self._missions.items())])
