"""The base class of deciders, which say in each decision period what robots do: options, movement vectors, or both.

Shapes: R rows, F components of an observation, O options, M missions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from typing import ClassVar, NamedTuple, final

import numpy as np

from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.problem import Problem, must_know_component
from selforg.arrays import Floats, Ints


class Decided(NamedTuple):
    """What rows do until the next decision."""

    options: Ints
    """(R,) option that serves the goal; 0 where the decider only drives."""
    vectors: Floats
    """(R, 2) movement, see `LearnerActions`; 0 where the decider only chooses options."""


class Decider(ABC):
    """Base class: decides for R rows at a time.

    `reset` is called when rows begin a mission, `decide` once in each decision period, `update` when rewards of earlier
    decisions are known. A new decider is a class that implements `_decide`, or `_choose` of an `OptionDecider`, and, if
    it learns, `update`:

    >>> class Nearest(OptionDecider):
    ...     def _choose(self, observations):
    ...         return observations.argmin(axis=1)
    >>> problem = Problem("Goal", ("left", "right"), np.zeros(2), ("on_the_left", "on_the_right"))
    >>> nearest = Nearest(problem, teams=np.zeros(2, dtype=np.int64))
    >>> nearest.decide(np.array([[3.0, 1.0], [0.5, 1.0]])).options
    array([1, 0])

    Args:
        problem: goal and options; its features are all components of the observation.
        teams: (R,) number of the team of each row.

    Attributes:
        is_baseline: whether the baseline of the task commands the robots, in place of the decider.

    """

    is_baseline: ClassVar[bool] = False

    def __init__(self, problem: Problem, teams: Ints) -> None:
        self.problem, self.teams = problem, teams

    def reset(self, rows: Ints, seed: int) -> None:  # noqa: B027  (decisions of many depend on no mission)
        """Prepare `rows` (N,) for a new mission with `seed`."""

    @final
    def decide(self, observations: Observations) -> Decided:
        """Return what each row does until the next decision, from its observations (R, F)."""
        self._last = self._decide(observations)
        return self._last

    def opinions(self) -> Floats:
        """Return what each row thought of each option (R, O) when it last decided: 1 for the one that it took."""
        return np.eye(len(self.problem.options))[self._last.options]

    def update(self, options: Ints, rewards: Floats, observations: Observations) -> None:  # noqa: B027  (many learn nothing)
        """Learn from the rewards (R,) of the options (R,) that rows took with what they saw (R, F)."""

    @abstractmethod
    def _decide(self, observations: Observations) -> Decided:
        """Return what each row does."""


class OptionDecider(Decider):
    """Base class of deciders that only choose options."""

    def _decide(self, observations: Observations) -> Decided:
        return Decided(self._choose(observations), np.zeros((len(observations), 2)))

    @abstractmethod
    def _choose(self, observations: Observations) -> Ints:
        """Return the option (R,) of each row."""


class BaselineDecider(OptionDecider):
    """Lets the baseline of the task command the robots: `DecidedGoal` carries it out."""

    is_baseline = True

    def _choose(self, observations: Observations) -> Ints:
        return np.zeros(len(observations), dtype=np.int64)


DeciderMaker = Callable[[Problem, Ints], Decider]
"""Makes a decider for a problem and teams (R,); a class of deciders, or a `partial` of one, which can be pickled."""


class TeamsDecider(Decider):
    """Each team follows a decider of its own during its mission.

    Args:
        makers: (M,) what makes the decider of each mission.
        seeds: (M,) seed of each mission; missions of one seed begin in this order.
        problem, teams: see `Decider`.
        seen: number of a mission -> (3, F) number, sum and sum of squares of its observations, which this notes.

    """

    def __init__(
        self,
        makers: Sequence[DeciderMaker],
        seeds: Sequence[int],
        problem: Problem,
        teams: Ints,
        seen: dict[int, Floats] | None = None,
    ) -> None:
        super().__init__(problem, teams)
        self._makers, self._seen = makers, {} if seen is None else seen
        self._waiting: dict[int, deque[int]] = defaultdict(deque)
        for number, seed in enumerate(seeds):
            self._waiting[seed].append(number)
        self._missions: dict[int, tuple[Ints, Decider, int]] = {}

    def reset(self, rows: Ints, seed: int) -> None:
        """Let `rows` (N,) follow the decider of the next mission of a seed."""
        number = self._waiting[seed].popleft()
        own = np.arange(len(rows))
        decider = self._makers[number](self.problem, np.zeros_like(own))
        decider.reset(own, seed)
        self._missions[int(rows[0])] = rows, decider, number
        self._seen[number] = np.zeros((3, len(self.problem.features)))

    def _decide(self, observations: Observations) -> Decided:
        count = len(observations)
        decided = Decided(np.zeros(count, dtype=np.int64), np.zeros((count, 2)))
        for rows, decider, number in self._missions.values():
            own = observations[rows]
            decided.options[rows], decided.vectors[rows] = decider.decide(own)
            numbers = own.astype(np.float64)
            self._seen[number] += np.stack([np.full(numbers.shape[1], len(own)), numbers.sum(0), (numbers**2).sum(0)])
        return decided


def mode_of(*, options: bool, vector: bool) -> Mode:
    """Return what an action is that has options, a movement vector, or both."""
    return "option" if not vector else "both" if options else "velocity"


def columns_of(problem: Problem, names: tuple[str, ...], what: str) -> Ints:
    """Return the indices of components of an observation; DocumentError for an unknown name."""
    for name in names:
        must_know_component(name, problem.features, what)
    return np.array([problem.features.index(name) for name in names], dtype=np.int64)
