"""The headroom of a family: what the best choice of an option for each situation saves beside the best single choice.

Both are searched on scenarios of the split "train" and judged on those of "test", so that luck in the search does not
count. The search begins with the best single option. It then tries every option in one situation after the other, and
keeps what lowers the mean excess cost, until a whole round changes nothing.

Shapes: S situations, O options, Q rules, T scenarios of the search, K scenarios of the test.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission import MissionResult
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.analysis.claims import Claim, claims_of
from train.evaluation.entrants import NEVER_AVOIDING, RANDOM, member_pilot
from train.learning.by_missions import TeamsPilot
from train.reports.text_table import Grid, flat
from train.running.decided_goal import DecidedGoal
from train.running.pilots import Pilot, columns_of
from train.running.trials import TrialSettings, run_trials

SINGLE, RULE_FOUND = "best single choice", "best choice for each situation"
MOST_ROUNDS = 5
"""Rounds over all situations after which a search ends."""


@dataclass(frozen=True)
class HeadroomRequest:
    """The request of the user."""

    family: FamilyConfig
    situations: tuple[str, ...]
    """Components of the observation, of which the largest tells the situation of a robot."""
    seed: int
    searched: int
    """T."""
    judged: int
    """K."""
    goal: str | None = None
    directories: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Headroom:
    """What the search found."""

    single: str
    """The best single option."""
    rule: dict[str, str]
    """Situation -> option."""
    missions: int
    """Missions of the search."""
    claims: tuple[Claim, ...]
    """The rule found, Off and Random beside the best single choice, on the scenarios of the test."""
    excesses: dict[str, float]
    """Mean excess of each on the scenarios of the test [s]."""


class RuleSearch:
    """Costs of rules on the same scenarios; each rule is run once."""

    def __init__(self, request: HeadroomRequest) -> None:
        batch = Batch(request.family.scenario(0, 0, "train").mission, directories=request.directories)
        self.problem = DecidedGoal(batch, request.goal).problem
        columns_of(self.problem, request.situations, "--situations")
        self._request = request
        self._settings = TrialSettings(request.goal, directories=request.directories)
        self._known: dict[tuple[int, ...], float] = {}

    @property
    def missions(self) -> int:
        """Missions run so far."""
        return len(self._known) * self._request.searched

    def best(self) -> tuple[int, Ints]:
        """Return the best single option and the best rule (S,)."""
        count, options = len(self._request.situations), len(self.problem.options)
        single = int(self._means(np.repeat(np.arange(options)[:, None], count, axis=1)).argmin())
        rule = np.full(count, single)
        for _ in range(MOST_ROUNDS):
            before = rule.copy()
            for situation in range(count):
                tried = np.tile(rule, (options, 1))
                tried[:, situation] = np.arange(options)
                rule = tried[self._means(tried).argmin()]
            if np.array_equal(rule, before):
                break
        return single, rule

    def excess(self, scenarios: Sequence[Scenario], rules: Ints) -> Floats:
        """Return the excess costs (Q, T) of teams that follow `rules` (Q, S) on scenarios (T,)."""
        missions = [scenario for _ in rules for scenario in scenarios]
        seeds, own = [scenario.seed for scenario in missions], np.repeat(rules, len(scenarios), axis=0)

        def pilot(problem: Problem, teams: Ints) -> Pilot:
            return TeamsPilot(problem, self._request.situations, len(teams), seeds, own)

        return _excess(run_trials(missions, pilot, self._settings)).reshape(len(rules), len(scenarios))

    def excess_of(self, scenarios: Sequence[Scenario], member: str) -> Floats:
        """Return the excess costs (T,) of an entrant."""

        def pilot(problem: Problem, teams: Ints) -> Pilot:
            return member_pilot(member, problem, teams, self._request.directories)

        return _excess(run_trials(scenarios, pilot, self._settings))

    def _means(self, rules: Ints) -> Floats:
        """Return the mean excess (Q,) of `rules` (Q, S)."""
        keys = [tuple(rule.tolist()) for rule in rules]
        new = list(dict.fromkeys(key for key in keys if key not in self._known))
        if new:
            request = self._request
            scenarios = [request.family.scenario(request.seed, k, "train") for k in range(request.searched)]
            means = self.excess(scenarios, np.array(new)).mean(axis=1)
            self._known |= dict(zip(new, means.tolist(), strict=True))
        return np.array([self._known[key] for key in keys])


def headroom_of(request: HeadroomRequest) -> Headroom:
    """Search for the best rule and the best single option of a family, and judge them on other scenarios."""
    search = RuleSearch(request)
    single, rule = search.best()
    scenarios = [request.family.scenario(request.seed, k, "test") for k in range(request.judged)]
    judged = search.excess(scenarios, np.stack([np.full(len(rule), single), rule]))
    excesses = {SINGLE: judged[0], RULE_FOUND: judged[1]}
    options = search.problem.options
    for member in (NEVER_AVOIDING, RANDOM):
        if member == RANDOM or NEVER_AVOIDING.partition(":")[2] in options:
            excesses[member] = search.excess_of(scenarios, member)
    tables = {label: own[None, :, None] for label, own in excesses.items()}
    others = [label for label in excesses if label != SINGLE]
    claims = claims_of({request.family.name: tables}, others, {request.family.name: SINGLE})
    named = {name: options[option] for name, option in zip(request.situations, rule.tolist(), strict=True)}
    means = {label: float(own.mean()) for label, own in excesses.items()}
    return Headroom(options[single], named, search.missions, tuple(claims), means)


def headroom_table(found: Headroom, family: str) -> Grid:
    """Return what was found as a table."""
    told = {claim.strategy: claim for claim in found.claims}
    rows = [(SINGLE, f"{found.excesses[SINGLE]:.1f}", "1.000", "")]
    for label, claim in told.items():
        rows.append(
            (label, f"{found.excesses[label]:.1f}", f"{claim.ratio:.3f}", f"[{claim.ci95[0]:.3f}, {claim.ci95[1]:.3f}]")
        )
    low, high = (1.0 - bound for bound in reversed(told[RULE_FOUND].ci95))
    notes = (
        f"headroom {1.0 - told[RULE_FOUND].ratio:.1%} [{low:.1%}, {high:.1%}] of the excess",
        f"{found.missions} missions of search",
        f"best single choice: {found.single}",
        "best choices: " + ", ".join(f"{name} {option}" for name, option in found.rule.items()),
    )
    grid = flat(f"{family}: headroom", "strategy", ("excess s", "ratio to the best single choice", "95 %"), rows)
    return Grid(grid.title, grid.corner, grid.columns, grid.rows, notes=notes)


def _excess(results: Sequence[MissionResult]) -> Floats:
    return np.array([result.cost_s - result.unavoidable_s for result in results])
