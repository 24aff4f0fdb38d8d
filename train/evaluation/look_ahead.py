"""A bound by looking ahead: at each decision of the team, copies of the world try every option before one is taken.

A copy holds an option for some seconds, then follows a base to the end or up to a horizon: an option, or a policy by
which each robot chooses for itself, and may correct its movement. Further copies follow a policy at once. The team
does what cost least on average over its copies: a rollout (Bertsekas et al. 1997, doi:10.1023/A:1009635226865).
Nobody can know in a mission what copies tell; so this is what choosing for the whole team could bring, not a strategy.

A copy has the random numbers of its world, and would know what is drawn. Therefore in each copy one robot drawn at
random holds an option drawn at random for the first period: a course that differs a little soon is another one
(docs/decisions/0191-look-ahead.md).

Shapes: A alternatives, which are the options and a policy, K copies of each, N robots, T scenarios.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from clean_swarm_env.config.families import FamilyConfig, place_of
from clean_swarm_env.config.types import ConfigurationError, Seconds
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.task import task_class
from selector.documents.fields import Closed
from selforg.arrays import Floats, Ints
from selforg.registry import unknown
from train.deciders.named import FIXED, POLICY
from train.evaluation.base import Done
from train.evaluation.family import FamilyEvaluation
from train.evaluation.trial_task import TrialTask
from train.reports.family_tables import excess_publication
from train.reports.text_table import Publication
from train.request import Request
from train.running.pulse import tell
from train.running.runs import RunRecord

LOOKING = "look-ahead"


class LookingAhead(Closed):
    """How teams look ahead."""

    base: str
    """What copies follow after the option that they try: an option, or a policy as `--strategy` takes it."""
    copies: Annotated[int, Field(ge=1, le=1000)] = 4
    """K."""
    hold: Seconds = 5.0
    """Time for which an option is held [s]."""
    horizon: Seconds = 120.0
    """Time for which copies run [s]."""


@dataclass(frozen=True)
class LookAheadTask(TrialTask):
    """Scenarios on which teams look ahead."""

    looking: LookingAhead = field(kw_only=True)

    def each(self) -> Iterator[RunRecord]:
        """Do the missions, and yield each run when it is done."""
        for scenario in self.scenarios:
            began, team = time.perf_counter(), LookingTeam(replace(self, scenarios=(scenario,)))
            result, taken = team.result(), dict(team.taken.most_common())
            yield self.finished(scenario, result, time.perf_counter() - began, counts=taken)


class LookingTeam:
    """One mission in which the team takes what copies of its world found cheapest.

    Attributes:
        taken: how often each alternative was taken.
        alternatives: (A,) names of the options; of the policy, too, if the base is one.

    """

    def __init__(self, task: LookAheadTask) -> None:
        waiting, looking = iter(task.scenarios), task.looking
        self._batch, self._decided, decider = task.team(source=lambda _: next(waiting, None))
        options, follows = self._decided.problem.options, task.member == looking.base
        self.alternatives = (*options, looking.base) if follows else options
        self._base = self.alternatives.index(looking.base)
        worlds = len(self.alternatives) * looking.copies
        costs = {"cost": -1.0} if task_class(task.first.mission).priced else None  # else: what the measures gain
        self._ahead, _, foreseen = task.team(worlds=worlds, begin_anew=False, reward=costs)
        self._policies = (decider, foreseen) if follows else None
        self._copies, period = looking.copies, self._batch.decision_period
        self._hold, self._horizon = (max(round(length / period), 1) for length in (looking.hold, looking.horizon))
        self._random = np.random.default_rng([task.seed, place_of(task.first.id)[0]])
        self.taken: Counter[str] = Counter()

    def result(self) -> MissionResult:
        """Do the mission."""
        batch = self._batch
        observations = batch.reset()
        while True:
            best = self._best(batch.get_state(), observations)
            self.taken[self.alternatives[best]] += 1
            for _ in range(self._hold):
                observations = batch.step(self._actions(0, np.full(batch.rows, best), observations)).observations
                tell(batch.decision_period)
                if batch.finished:
                    return batch.finished[0].result

    def _best(self, state: bytes, observations: Observations) -> int:
        """Return the alternative whose copies cost least."""
        ahead, robots = self._ahead, self._batch.robots
        count = len(self.alternatives)
        ahead.set_state(state)
        if self._policies is not None:
            self._policies[1].reset(np.arange(ahead.rows), 0)
        tried: Ints = np.repeat(np.arange(count), self._copies * robots).reshape(count, self._copies, robots)
        first, copies = tried.copy(), np.arange(self._copies)
        who, what = self._random.integers(robots, size=self._copies), self._random.integers(count, size=self._copies)
        first[:, copies, who] = what
        seen = np.tile(observations, (ahead.count, 1))
        costs: Floats = np.zeros(ahead.count)
        for period in range(self._horizon):
            held = first if period == 0 else tried if period < self._hold else np.full_like(tried, self._base)
            step = ahead.step(self._actions(1, held.ravel(), seen))
            rewards, seen = step.rewards.reshape(ahead.count, robots), step.observations
            costs -= rewards.sum(axis=1) / np.maximum(ahead.took_part.reshape(ahead.count, robots).sum(axis=1), 1)
            if ahead.over.all():
                break
        return int(costs.reshape(count, self._copies).mean(axis=1).argmin())

    def _actions(self, ahead: int, alternatives: Ints, observations: Observations) -> NDArray[Any]:
        """Return the actions (R, ...) of rows with alternatives (R,) that see `observations` (R, F).

        `ahead` is 1 for copies, whose policy begins anew whenever they do, 0 for the mission itself.

        A policy that corrects the movement corrects that of all rows, whatever option they hold.
        """
        if self._policies is None:
            return self._decided.actions(alternatives)
        actions, held = self._decided.decide(self._policies[ahead], observations), alternatives != self._base
        actions[held, : self._decided.goals] = self._decided.actions(alternatives[held])
        return actions


class LookAheadEvaluation(FamilyEvaluation):
    """Teams that look ahead on test scenarios, and every option alone; what copies follow may be a policy.

    Args:
        request: the request; its strategies are not read.
        looking: how teams look ahead.
        family: the family, unless it is the one that the request names.

    """

    growing, beside_baselines = "", False

    def __init__(self, request: Request, looking: LookingAhead, family: FamilyConfig | None = None) -> None:
        self._looking = looking
        policy = (looking.base,) if looking.base.startswith(f"{POLICY}:") else ()
        strategies = replace(request, strategies=(FIXED, *policy))
        super().__init__(strategies, family, look_ahead=looking.model_dump())
        self.stem += "-look-ahead"
        if not policy and looking.base not in self.options:
            raise ConfigurationError(f"--base: {unknown('option', looking.base, self.options)}")
        first = self._looking_task(self.scenarios[0])
        if first.named.mode == "velocity":
            expected = "an option or a policy that chooses options"
            raise ConfigurationError(f"--base: expected {expected}, got {looking.base}")
        first.team()  # a base that does not fit is an error

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks for all missing runs; those that look ahead come first, each with one scenario."""
        missing = [name for name in self.scenarios if (name, LOOKING) not in done]
        return [*(self._looking_task(name) for name in missing), *super().tasks(done)]

    def _looking_task(self, name: str) -> LookAheadTask:
        task = self.task([self.scenario(self.family, name)], LOOKING, as_member(self._looking.base))
        return LookAheadTask(**vars(task), looking=self._looking)

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return what looking ahead and every option cost, beside the base, and what was taken."""
        done, taken = {record.key: record for record in records}, Counter[str]()
        labels, base = [LOOKING, *(entrant.label for entrant in self.entrants)], as_member(self._looking.base)
        for name in self.scenarios:
            taken += Counter(done[name, LOOKING].counts)
        runs, against = self.runs(records, {label: (label,) for label in labels}), dict.fromkeys(labels, base)
        notes = (f"taken by the look-ahead: {shares_of(taken)}",)
        title = f"look-ahead on {len(self.scenarios)} scenarios"
        return excess_publication(runs, against, title, f"ratio to {base}", notes=notes)


def as_member(alternative: str) -> str:
    """Return an option or a policy as `--strategy` takes it."""
    return alternative if alternative.startswith(f"{POLICY}:") else f"{FIXED}:{alternative}"


def shares_of(taken: Counter[str], most: int | None = None) -> str:
    """Return the options taken most often, all unless `most` is given, with their shares."""
    return ", ".join(f"{option} {number / taken.total():.0%}" for option, number in taken.most_common(most))
