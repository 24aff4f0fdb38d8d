"""The headroom of a family: what the best choice of an option for each case saves beside the best single choice.

A case is the situation of a robot, or the kind of a scenario: its numbers of spots of garbage and of places of
stations. Both choices are searched on scenarios of the split "train" and judged on those of "test", so that luck in the
search does not count. The search begins with the best single option. For situations it then tries every option in one
after the other, and keeps what lowers the mean excess cost, until a whole round changes nothing. For kinds it takes the
best option of each.

Shapes: S situations, 1 without any; O options, Q rules, T scenarios of the search, K scenarios of the test.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission import MissionResult
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.analysis.claims import Claim, claims_of
from train.analysis.family_report import unfinished
from train.analysis.spread import too_few
from train.analysis.statistics import share_cell
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import columns_of
from train.deciders.named import decider_named
from train.deciders.rules import TeamRuleDecider
from train.evaluation.entrants import with_baselines
from train.reports.text_table import Grid, flat, interval_cell
from train.running.trials import TrialSettings, run_trials

SINGLE, RULE_FOUND = "best single choice", "best choice for each case"
MOST_ROUNDS = 5
"""Rounds over all situations after which a search ends."""


@dataclass(frozen=True)
class HeadroomRequest:
    """The request of the user."""

    family: FamilyConfig
    situations: tuple[str, ...]
    """Components of the observation, of which the largest tells the situation of a robot; empty: kinds of scenarios."""
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
    """Situation or kind -> option."""
    missions: int
    """Missions of the search."""
    claims: tuple[Claim, ...]
    """The rule found, Off and Random beside the best single choice, on the scenarios of the test."""
    excesses: dict[str, float]
    """Mean excess of each on the scenarios of the test [s]."""
    unfinished: dict[str, float | None]
    """Share of the missions of each that were not completed."""


class RuleSearch:
    """Costs of rules on the same scenarios; each rule is run once."""

    def __init__(self, request: HeadroomRequest) -> None:
        first = request.family.scenario(0, 0, "train").mission
        batch = Batch(first, directories=request.directories)
        self.problem = DecidedGoal(batch, request.goal).problem
        columns_of(self.problem, request.situations, "--situations")
        self._request = request
        self._scenarios = [request.family.scenario(request.seed, k, "train") for k in range(request.searched)]
        self._settings = TrialSettings(request.goal, directories=request.directories)
        self._known: dict[tuple[int, ...], Floats] = {}

    @property
    def missions(self) -> int:
        """Missions run so far."""
        return len(self._known) * self._request.searched

    def single(self) -> int:
        """Return the best single option."""
        return int(self._means(self._singles).argmin())

    def of_kinds(self) -> dict[str, int]:
        """Return the best single option for each kind of scenario."""
        excesses, kinds = self._excesses(self._singles), np.array(scenario_kinds(self._scenarios))
        return {kind: int(excesses[:, kinds == kind].mean(axis=1).argmin()) for kind in np.unique(kinds).tolist()}

    def rule(self) -> Ints:
        """Return the best rule (S,)."""
        count, options = len(self._request.situations), len(self.problem.options)
        rule = np.full(count, self.single())
        for _ in range(MOST_ROUNDS):
            before = rule.copy()
            for situation in range(count):
                tried = np.tile(rule, (options, 1))
                tried[:, situation] = np.arange(options)
                rule = tried[self._means(tried).argmin()]
            if np.array_equal(rule, before):
                break
        return rule

    def results(self, scenarios: Sequence[Scenario], rules: Ints) -> list[MissionResult]:
        """Return the results (T,) of teams that follow `rules` (T, S) on scenarios (T,)."""
        seeds = [scenario.seed for scenario in scenarios]

        def decider(problem: Problem, teams: Ints) -> TeamRuleDecider:
            return TeamRuleDecider(problem, self._request.situations, len(teams), seeds, rules)

        return run_trials(scenarios, decider, self._settings)

    def results_of(self, scenarios: Sequence[Scenario], member: str) -> list[MissionResult]:
        """Return the results (T,) of an entrant."""
        return run_trials(scenarios, decider_named(member, self._request.directories).build, self._settings)

    @property
    def _singles(self) -> Ints:
        """The rules (O, S) of one option each."""
        return np.repeat(np.arange(len(self.problem.options))[:, None], max(len(self._request.situations), 1), axis=1)

    def _means(self, rules: Ints) -> Floats:
        """Return the mean excess (Q,) of `rules` (Q, S)."""
        means: Floats = self._excesses(rules).mean(axis=1)
        return means

    def _excesses(self, rules: Ints) -> Floats:
        """Return the excess costs (Q, T) of `rules` (Q, S) on the scenarios of the search."""
        keys = [tuple(rule.tolist()) for rule in rules]
        new = list(dict.fromkeys(key for key in keys if key not in self._known))
        if new:
            count = self._request.searched
            found = _excess(self.results(self._scenarios * len(new), np.repeat(np.array(new), count, axis=0)))
            self._known |= dict(zip(new, found.reshape(-1, count), strict=True))
        return np.stack([self._known[key] for key in keys])


def headroom_of(request: HeadroomRequest) -> Headroom:
    """Search for the best rule and the best single option of a family, and judge them on other scenarios."""
    search = RuleSearch(request)
    scenarios = [request.family.scenario(request.seed, k, "test") for k in range(request.judged)]
    single, options = search.single(), search.problem.options
    if request.situations:
        rule = search.rule()
        rules, named = np.tile(rule, (len(scenarios), 1)), dict(zip(request.situations, rule.tolist(), strict=True))
    else:
        named = search.of_kinds()
        rules = np.array([[named.get(kind, single)] for kind in scenario_kinds(scenarios)])
    results = {
        SINGLE: search.results(scenarios, np.full_like(rules, single)),
        RULE_FOUND: search.results(scenarios, rules),
    }
    for member in (entrant.label for entrant in with_baselines((), options, request.family.mission)):
        results[member] = search.results_of(scenarios, member)
    tables = {label: _excess(own)[None, :, None] for label, own in results.items()}
    others = [label for label in results if label != SINGLE]
    claims = claims_of({request.family.name: tables}, others, {request.family.name: SINGLE})
    means = {label: float(own.mean()) for label, own in tables.items()}
    left = {label: unfinished(scenarios[0].mission, own) for label, own in results.items()}
    named_options = {name: options[option] for name, option in named.items()}
    return Headroom(options[single], named_options, search.missions, tuple(claims), means, left)


def headroom_table(found: Headroom, family: str) -> Grid:
    """Return what was found as a table."""
    told = {claim.strategy: claim for claim in found.claims}
    rows = []
    for label, excess in found.excesses.items():
        ratio = (f"{told[label].ratio:.3f}", interval_cell(told[label].ci95)) if label in told else ("1.000", "")
        rows.append((label, share_cell(found.unfinished[label]), f"{excess:.1f}", *ratio))
    low, high = (1.0 - bound for bound in reversed(told[RULE_FOUND].ci95))
    notes = (
        f"headroom {1.0 - told[RULE_FOUND].ratio:.1%} [{low:.1%}, {high:.1%}] of the excess",
        f"{found.missions} missions of search",
        f"best single choice: {found.single}",
        "best choices: " + ", ".join(f"{name} {option}" for name, option in found.rule.items()),
        *too_few([claim.of for claim in found.claims]),
    )
    grid = flat(
        f"{family}: headroom", "strategy", ("unfinished", "excess s", "ratio to the best single choice", "95 %"), rows
    )
    return replace(grid, notes=notes)


def scenario_kinds(scenarios: Sequence[Scenario]) -> list[str]:
    """Return the kind (T,) of each scenario."""
    return [
        f"spots {len(mission.garbage.spots)} stations {len(set(mission.stations.places))}"
        for mission in (scenario.mission for scenario in scenarios)
    ]


def _excess(results: Sequence[MissionResult]) -> Floats:
    return np.array([result.excess_s for result in results])
