"""The base class of learners that compare whole missions of members of a population.

A member is what decides for all robots of a mission. Each training begins with every option alone, so that a learner
knows the best one and the scale of what robots see. A mission counts as one decision: which member does it. The result
of a mission does not depend on the missions beside it, nor on the process that runs it.

Shapes: M members, N scenarios, F components of an observation, O options.
"""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice, product
from typing import Any, Generic, TypeVar

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.deciders.decider import DeciderMaker, TeamsDecider
from clean_swarm_env.deciders.machines import FixedDecider
from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, NonNegative, Number
from selector.documents.reading import read_json
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms
from train.learning.config import MembersConfig
from train.learning.training import Checkpoint, Training, judged
from train.running.runs import RunKey, RunRecord
from train.running.trials import TrialSettings, each_trial

TASKS_ELSEWHERE = 16
"""Tasks that missions of members are cut into if workers elsewhere do them."""


@dataclass(frozen=True)
class MemberRun(RunRecord):
    """One finished mission of a member; its condition is the number of the mission among those that were asked for."""

    seen: Floats = field(default_factory=lambda: np.zeros((3, 0)))
    """(3, F) number, sum and sum of squares of all observations of the mission."""


@dataclass(frozen=True)
class MemberTask:
    """Some missions, each with its member; plain data, which can be sent to a worker process."""

    missions: tuple[tuple[int, Scenario, DeciderMaker], ...]
    """Number of each mission among those that were asked for, its scenario, and what makes its decider: a `partial`,
    which can be sent, too."""
    settings: TrialSettings

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and number of each mission."""
        return tuple((scenario.id, str(place)) for place, scenario, _ in self.missions)

    def without(self, done: Collection[RunKey]) -> MemberTask:
        """Return the missions that are not `done`."""
        left = [mission for mission, key in zip(self.missions, self.keys, strict=True) if key not in done]
        return replace(self, missions=tuple(left))

    def each(self) -> Iterator[MemberRun]:
        """Run the missions, and yield each when it is done."""
        seen: dict[int, Floats] = {}
        places, scenarios, members = zip(*self.missions, strict=True)
        maker = partial(TeamsDecider, members, [scenario.seed for scenario in scenarios], seen=seen)
        for k, result in each_trial(scenarios, maker, self.settings):
            run = (type(self).__name__, scenarios[k].id, scenarios[k].seed, str(places[k]), result, 0.0)
            yield MemberRun(*run, seen[k].copy())  # worlds without a mission are seen on


Drawing = Callable[[int], list[Scenario]]
"""Returns the given number of new training scenarios of each family, the families in turn."""


class ObservationScale(Closed):
    """Mean and variance of each component of the observation, from the missions of the options alone."""

    mean: tuple[Number, ...]
    variance: tuple[NonNegative, ...]


class MembersCheckpoint(Checkpoint):
    """Everything that a training depends on."""

    scale: ObservationScale
    """The scale of robots' observations."""
    now: dict[str, Any]
    """The state."""
    kept: dict[str, Any]
    """The state at the best checkpoint."""


Learned = TypeVar("Learned", bound=Closed)
"""The state of a learner."""


class MembersTraining(Training, Generic[Learned]):
    """One training by missions of members.

    Attributes:
        settings: those of the learner.
        problem: goal and options; its features are the observation.
        scale: the scale of what robots see, from the first missions on.
        state: what was learned so far.

    """

    CHECKPOINT = "checkpoint.json"
    State: type[Learned]
    """Model of the state."""

    def _make(self) -> None:
        self.settings: MembersConfig = getattr(self.config, self.config.learner)
        self.problem = self.goal.problem
        self._settings = replace(self.trials, worlds=max(task.worlds for task in self.config.tasks))
        self.scale: ObservationScale
        self.state: Learned

    @abstractmethod
    def _first(self, order: Ints) -> Learned:
        """Return the first state, from the options in the order of their excess alone, the best first."""

    @abstractmethod
    def _next(self, draw: Drawing, random: np.random.Generator) -> Learned:
        """Return the next state, from missions of members on scenarios that `draw` returns."""

    @abstractmethod
    def _check(self, state: Learned, where: str) -> None:
        """Raise DocumentError unless a state that was read is one of this training."""

    def _learn(self) -> dict[str, Any]:
        series = self.curriculum.scenarios(self.checkpoint)
        random = np.random.default_rng([self.job.request.seed, self.checkpoint, 5])

        def draw(count: int) -> list[Scenario]:
            drawn = [list(islice(following, count)) for following in series]
            return [scenario for together in zip(*drawn, strict=True) for scenario in together]

        if not self.checkpoint:
            alone = [partial(FixedDecider, option) for option in range(len(self.problem.options))]
            costs, seen = self.costs(alone, draw(self.settings.opening))
            mean = seen[1] / seen[0]
            variance = np.maximum(seen[2] / seen[0] - mean**2, 0.0)
            self.scale = ObservationScale(mean=tuple(mean.tolist()), variance=tuple(variance.tolist()))
            self.state = self._best = self._first(logarithms(costs).mean(axis=0).argsort(kind="stable"))
        while self.decisions < (self.checkpoint + 1) * self.config.decisions:
            self.state = self._next(draw, random)
        return {"missions": len(self._costs)}

    def costs(self, members: Sequence[DeciderMaker], scenarios: Sequence[Scenario]) -> tuple[Floats, Floats]:
        """Let all members do all scenarios.

        Return their excess costs (N, M) [s], and number, sum and sum of squares (3, F) of all observations.
        """
        missions = [(place, *pair) for place, pair in enumerate(product(scenarios, members))]
        count, machine = len(missions), self.job.request.machine
        parts = TASKS_ELSEWHERE if machine.place else machine.workers
        tasks = [MemberTask(tuple(missions[first::parts]), self._settings) for first in range(min(parts, count))]
        costs, seen = np.zeros(count), np.zeros((count, 3, len(self.problem.features)))
        for run in self.job.done(tasks):
            assert isinstance(run, MemberRun)
            place = int(run.condition)
            costs[place], seen[place] = judged(run.result), run.seen
            self._note(self.decisions + 1)
        self._costs += costs.tolist()
        return costs.reshape(len(scenarios), len(members)), seen.sum(axis=0)

    def _learned(self) -> Learned:
        return self.state

    def _save(self) -> None:
        kept = {"scale": self.scale, "now": self.state, "kept": self._best}
        parts = {name: part.model_dump(mode="json") for name, part in kept.items()}
        self.job.folder.write(self.CHECKPOINT, json.dumps({"history": self.history, **parts}) + "\n")

    def _loaded(self) -> Mapping[str, Any]:
        where, content = shown(self.checkpoint_file), read_json(self.checkpoint_file)
        found = validated(MembersCheckpoint, content, where)
        self.state, self._best = (validated(self.State, part, where) for part in (found.now, found.kept))
        self.scale = found.scale
        check_lengths(len(self.problem.features), (self.scale.mean, self.scale.variance), where)
        for state in (self.state, self._best):
            self._check(state, where)
        return content


def check_lengths(length: int, parts: Sequence[Sequence[float]], where: str) -> None:
    """Raise DocumentError unless all parts of a state have a length."""
    for part in parts:
        if len(part) != length:
            raise DocumentError(f"{where}: expected {length} numbers of this training, got {len(part)}")
