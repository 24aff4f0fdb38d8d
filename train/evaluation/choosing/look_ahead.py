"""A bound by looking ahead: at each decision of the team, copies of the world try every option before one is taken.

A copy holds an option for some seconds, then a base option to the end or up to a horizon. The option whose copies cost
least in the mean is taken: a rollout (Bertsekas, Tsitsiklis & Wu 1997, doi:10.1023/A:1009635226865). Nobody can know in
a mission what copies tell; so this is what choosing for the whole team could bring, not a strategy.

A copy has the random numbers of its world, and would know what is drawn. Therefore in each copy one robot drawn at
random holds an option drawn at random for the first period: a course that differs a little soon is another one.

Shapes: O options, K copies of each, N robots, T scenarios.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission import MissionResult
from selforg.arrays import Floats, Ints
from selforg.registry import unknown
from train.analysis.claims import claims_of
from train.evaluation.entrants import FIXED, member_pilot
from train.reports.text_table import Grid, flat
from train.running.decided_goal import DecidedGoal
from train.running.trials import TrialSettings, run_trials

LOOKING = "look-ahead"


@dataclass(frozen=True)
class LookAheadRequest:
    """The request of the user."""

    family: FamilyConfig
    base: str
    """Option that copies hold after the one that they try."""
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
        options: (O,) names of the options.
        taken: how often each option was taken.

    """

    def __init__(self, request: LookAheadRequest, scenario: Scenario, number: int) -> None:
        waiting = iter([scenario])
        self._batch = Batch(scenario.mission, source=lambda _: next(waiting, None), directories=request.directories)
        self._decided = DecidedGoal(self._batch, request.goal)
        self.options = options = self._decided.problem.options
        if request.base not in options:
            raise ConfigurationError(f"--base: {unknown('option', request.base, options)}")
        worlds = len(options) * request.copies
        self._ahead = Batch(
            scenario.mission, worlds, begin_anew=False, reward={"cost": -1.0}, directories=request.directories
        )
        self._base, self._copies, period = options.index(request.base), request.copies, self._batch.decision_period
        self._hold, self._horizon = (max(round(time / period), 1) for time in (request.hold, request.horizon))
        self._random = np.random.default_rng([request.seed, number])
        self.taken: Counter[str] = Counter()

    def result(self) -> MissionResult:
        """Do the mission."""
        batch = self._batch
        batch.reset()
        while True:
            best = self._best(batch.get_state())
            self.taken[self.options[best]] += 1
            for _ in range(self._hold):
                batch.step(self._decided.actions(np.full(batch.rows, best)))
                if batch.finished:
                    return batch.finished[0].result

    def _best(self, state: bytes) -> int:
        """Return the option whose copies cost least."""
        ahead, count, robots = self._ahead, len(self.options), self._batch.robots
        ahead.set_state(state)
        tried: Ints = np.repeat(np.arange(count), self._copies * robots).reshape(count, self._copies, robots)
        first, copies = tried.copy(), np.arange(self._copies)
        who, what = self._random.integers(robots, size=self._copies), self._random.integers(count, size=self._copies)
        first[:, copies, who] = what
        costs: Floats = np.zeros(ahead.count)
        for period in range(self._horizon):
            held = first if period == 0 else tried if period < self._hold else np.full_like(tried, self._base)
            rewards = ahead.step(self._decided.actions(held.ravel())).rewards.reshape(ahead.count, robots)
            costs -= rewards.sum(axis=1) / np.maximum(ahead.took_part.reshape(ahead.count, robots).sum(axis=1), 1)
            if ahead.over.all():
                break
        return int(costs.reshape(count, self._copies).mean(axis=1).argmin())


@dataclass(frozen=True)
class Looked:
    """What came of looking ahead on all scenarios."""

    options: tuple[str, ...]
    """(O,) names."""
    results: tuple[MissionResult, ...]
    """(T,)."""
    taken: Counter[str]
    """How often each option was taken."""


def looked_ahead(request: LookAheadRequest) -> Looked:
    """Do the test scenarios by looking ahead."""
    results, taken = [], Counter[str]()
    for number, scenario in enumerate(_scenarios(request)):
        team = LookingTeam(request, scenario, number)
        results.append(team.result())
        taken += team.taken
    return Looked(team.options, tuple(results), taken)


def look_ahead_table(request: LookAheadRequest) -> Grid:
    """Do test scenarios by looking ahead, and by every option alone; return the table of their excess costs."""
    looked, scenarios = looked_ahead(request), _scenarios(request)
    excesses = {LOOKING: _excess(looked.results)}
    settings = TrialSettings(request.goal, directories=request.directories)
    for option in looked.options:
        maker = partial(member_pilot, f"{FIXED}:{option}", directories=request.directories)
        excesses[f"{FIXED}:{option}"] = _excess(run_trials(scenarios, maker, settings))
    base, family = f"{FIXED}:{request.base}", request.family.name
    claims = claims_of({family: excesses}, [label for label in excesses if label != base], {family: base})
    ratios = {claim.strategy: f"{claim.ratio:.2f} [{claim.ci95[0]:.2f}, {claim.ci95[1]:.2f}]" for claim in claims}
    rows = [(label, f"{own.mean():.1f}", ratios.get(label, "1")) for label, own in excesses.items()]
    title = f"{family}: look-ahead on {len(scenarios)} scenarios"
    grid = flat(title, "strategy", ("excess s", f"to {base} [95 %]"), rows)
    return replace(grid, notes=(f"taken by the look-ahead: {shares_of(looked.taken)}",))


def shares_of(taken: Counter[str], most: int | None = None) -> str:
    """Return the options taken most often, all unless `most` is given, with their shares."""
    return ", ".join(f"{option} {number / taken.total():.0%}" for option, number in taken.most_common(most))


def _scenarios(request: LookAheadRequest) -> list[Scenario]:
    return [request.family.scenario(request.seed, number, "test") for number in range(request.scenarios)]


def _excess(results: Sequence[MissionResult]) -> Floats:
    """Return excess costs (1, T, 1), as `claims_of` takes them."""
    return np.array([[[result.excess_s] for result in results]])
