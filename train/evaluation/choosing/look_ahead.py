"""A bound by looking ahead: at each decision of the team, copies of the world try every option before one is taken.

A copy holds an option for some seconds, then follows a base to the end or up to a horizon: an option, or a policy by
which each robot chooses for itself, and may correct its movement. Further copies follow a policy at once. The team
does what cost least on average over its copies: a rollout (Bertsekas et al. 1997, doi:10.1023/A:1009635226865).
Nobody can know in a mission what copies tell; so this is what choosing for the whole team could bring, not a strategy.

A copy has the random numbers of its world, and would know what is drawn. Therefore in each copy one robot drawn at
random holds an option drawn at random for the first period: a course that differs a little soon is another one.

Shapes: A alternatives, which are the options and a policy, K copies of each, N robots, T scenarios.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission import MissionResult
from selforg.arrays import Floats, Ints
from selforg.registry import unknown
from train.analysis.claims import claims_of
from train.analysis.family_report import unfinished
from train.analysis.spread import too_few
from train.analysis.statistics import share_cell
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import Decider
from train.deciders.named import FIXED, POLICY, NamedDecider, decider_named
from train.reports.text_table import Grid, flat, interval_cell
from train.running.trials import TrialSettings, run_trials

LOOKING = "look-ahead"


@dataclass(frozen=True)
class LookAheadRequest:
    """The request of the user."""

    family: FamilyConfig
    base: str
    """What copies follow after the option that they try: an option, or a policy as `--strategy` takes it."""
    seed: int
    scenarios: int
    """T."""
    copies: int
    """K."""
    hold: float
    """Time for which an option is held [s]."""
    horizon: float
    """Time for which copies run [s]."""
    goal: str | None = None
    directories: tuple[Path, ...] = ()


class LookingTeam:
    """One mission in which the team takes what copies of its world found cheapest.

    Attributes:
        taken: how often each alternative was taken.
        alternatives: (A,) names of the options; of the policy, too, if the base is one.

    """

    def __init__(self, request: LookAheadRequest, scenario: Scenario, number: int) -> None:
        waiting = iter([scenario])
        base = _named(as_member(request.base), request.directories)
        seen, action = base.observation(request.family.mission.terms), ActionConfig(mode=base.mode)
        batch = partial(Batch, scenario.mission, observation=seen, directories=request.directories, action=action)
        self._batch = batch(source=lambda _: next(waiting, None))
        self._decided = DecidedGoal(self._batch, request.goal)
        self._base = _Base(request.base, base, self._decided)
        self.alternatives = self._base.alternatives
        worlds = len(self.alternatives) * request.copies
        self._ahead = batch(worlds, begin_anew=False, reward={"cost": -1.0})
        self._copies, period = request.copies, self._batch.decision_period
        self._hold, self._horizon = (max(round(time / period), 1) for time in (request.hold, request.horizon))
        self._random = np.random.default_rng([request.seed, number])
        self.taken: Counter[str] = Counter()

    def result(self) -> MissionResult:
        """Do the mission."""
        batch = self._batch
        observations = batch.reset()
        while True:
            best = self._best(batch.get_state(), observations)
            self.taken[self.alternatives[best]] += 1
            for _ in range(self._hold):
                observations = batch.step(self._base.actions(np.full(batch.rows, best), observations)).observations
                if batch.finished:
                    return batch.finished[0].result

    def _best(self, state: bytes, observations: Observations) -> int:
        """Return the alternative whose copies cost least."""
        ahead, base, robots = self._ahead, self._base, self._batch.robots
        count = len(self.alternatives)
        ahead.set_state(state)
        tried: Ints = np.repeat(np.arange(count), self._copies * robots).reshape(count, self._copies, robots)
        first, copies = tried.copy(), np.arange(self._copies)
        who, what = self._random.integers(robots, size=self._copies), self._random.integers(count, size=self._copies)
        first[:, copies, who] = what
        seen = np.tile(observations, (ahead.count, 1))
        costs: Floats = np.zeros(ahead.count)
        for period in range(self._horizon):
            held = first if period == 0 else tried if period < self._hold else np.full_like(tried, base.number)
            step = ahead.step(base.actions(held.ravel(), seen))
            rewards, seen = step.rewards.reshape(ahead.count, robots), step.observations
            costs -= rewards.sum(axis=1) / np.maximum(ahead.took_part.reshape(ahead.count, robots).sum(axis=1), 1)
            if ahead.over.all():
                break
        return int(costs.reshape(count, self._copies).mean(axis=1).argmin())


class _Base:
    """What copies follow after the option that they try.

    Attributes:
        alternatives: see `LookingTeam`.
        number: that of the base among them.

    """

    def __init__(self, base: str, named: NamedDecider, decided: DecidedGoal) -> None:
        options, self._decided = decided.problem.options, decided
        self._policy: Decider | None = None
        self.alternatives: tuple[str, ...] = options
        if base.startswith(f"{POLICY}:"):
            self._policy = named.build(decided.problem, np.zeros(0, dtype=np.int64))
            self.alternatives = (*options, base)
        elif base not in options:
            raise ConfigurationError(f"--base: {unknown('option', base, options)}")
        self.number = self.alternatives.index(base)

    def actions(self, alternatives: Ints, observations: Observations) -> NDArray[Any]:
        """Return the actions (R, ...) of rows with alternatives (R,) that see `observations` (R, F).

        A policy that corrects the movement corrects that of all rows, whatever option they hold.
        """
        if self._policy is None:
            return self._decided.actions(alternatives)
        actions, held = self._decided.decide(self._policy, observations), alternatives != self.number
        actions[held, : self._decided.goals] = self._decided.actions(alternatives[held])
        return actions


@dataclass(frozen=True)
class Looked:
    """What came of looking ahead on all scenarios."""

    alternatives: tuple[str, ...]
    """(A,) as `--strategy` takes them."""
    results: tuple[MissionResult, ...]
    """(T,)."""
    taken: Counter[str]
    """How often each alternative was taken."""


def looked_ahead(request: LookAheadRequest) -> Looked:
    """Do the test scenarios by looking ahead."""
    results, taken = [], Counter[str]()
    for number, scenario in enumerate(_scenarios(request)):
        team = LookingTeam(request, scenario, number)
        results.append(team.result())
        taken += team.taken
    return Looked(tuple(map(as_member, team.alternatives)), tuple(results), taken)


def look_ahead_table(request: LookAheadRequest) -> Grid:
    """Do test scenarios by looking ahead, and by every option alone; return the table of their excess costs."""
    looked, scenarios = looked_ahead(request), _scenarios(request)
    results = {LOOKING: looked.results}
    settings = TrialSettings(request.goal, directories=request.directories)
    for member in looked.alternatives:
        named = _named(member, request.directories)
        seen = named.observation(request.family.mission.terms)
        given = replace(settings, observation=seen, action=ActionConfig(mode=named.mode))
        results[member] = tuple(run_trials(scenarios, named.build, given))
    base, family = as_member(request.base), request.family.name
    excesses = {label: np.array([[[result.excess_s] for result in own]]) for label, own in results.items()}
    claims = claims_of({family: excesses}, [label for label in excesses if label != base], {family: base})
    ratios = {claim.strategy: f"{claim.ratio:.2f} {interval_cell(claim.ci95, 2)}" for claim in claims}
    left = {label: unfinished(scenarios[0].mission, own) for label, own in results.items()}
    rows = [
        (label, share_cell(left[label]), f"{own.mean():.1f}", ratios.get(label, "1")) for label, own in excesses.items()
    ]
    title = f"{family}: look-ahead on {len(scenarios)} scenarios"
    grid = flat(title, "strategy", ("unfinished", "excess s", f"to {base} [95 %]"), rows)
    told = f"taken by the look-ahead: {shares_of(looked.taken)}"
    return replace(grid, notes=(told, *too_few([claim.of for claim in claims])))


def as_member(alternative: str) -> str:
    """Return an option or a policy as `--strategy` takes it."""
    return alternative if alternative.startswith(f"{POLICY}:") else f"{FIXED}:{alternative}"


def shares_of(taken: Counter[str], most: int | None = None) -> str:
    """Return the options taken most often, all unless `most` is given, with their shares."""
    return ", ".join(f"{option} {number / taken.total():.0%}" for option, number in taken.most_common(most))


def _named(member: str, directories: Sequence[Path]) -> NamedDecider:
    """Return a decider; ConfigurationError for one that drives."""
    named = decider_named(member, directories)
    if named.mode == "velocity":
        raise ConfigurationError(f"--base: expected an option or a policy that chooses options, got {member}")
    return named


def _scenarios(request: LookAheadRequest) -> list[Scenario]:
    return [request.family.scenario(request.seed, number, "test") for number in range(request.scenarios)]
