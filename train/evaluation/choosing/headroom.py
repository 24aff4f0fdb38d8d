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
from functools import partial
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.world.mission import MissionResult
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.analysis.claims import Claim, claims_of
from train.evaluation.entrants import member_pilot, with_baselines
from train.learning.by_missions import TeamsPilot
from train.reports.text_table import Grid, flat
from train.running.decided_goal import DecidedGoal
from train.running.pilots import Pilot, columns_of
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


class RuleSearch:
    """Costs of rules on the same scenarios; each rule is run once."""

    def __init__(self, request: HeadroomRequest) -> None:
        observation = ObservationConfig.usual(request.family.terms)
        first = request.family.scenario(0, 0, "train").mission
        batch = Batch(first, observation=observation, directories=request.directories)
        self.problem = DecidedGoal(batch, request.goal).problem
        columns_of(self.problem, request.situations, "--situations")
        self._request = request
        self._scenarios = [request.family.scenario(request.seed, k, "train") for k in range(request.searched)]
        self._settings = TrialSettings(request.goal, observation=observation, directories=request.directories)
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

    def excess(self, scenarios: Sequence[Scenario], rules: Ints) -> Floats:
        """Return the excess costs (T,) of teams that follow `rules` (T, S) on scenarios (T,)."""
        seeds = [scenario.seed for scenario in scenarios]

        def pilot(problem: Problem, teams: Ints) -> Pilot:
            return TeamsPilot(problem, self._request.situations, len(teams), seeds, rules)

        return _excess(run_trials(scenarios, pilot, self._settings))

    def excess_of(self, scenarios: Sequence[Scenario], member: str) -> Floats:
        """Return the excess costs (T,) of an entrant."""
        maker = partial(member_pilot, member, directories=self._request.directories)
        return _excess(run_trials(scenarios, maker, self._settings))

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
            found = self.excess(self._scenarios * len(new), np.repeat(np.array(new), count, axis=0))
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
    excesses = {
        SINGLE: search.excess(scenarios, np.full_like(rules, single)),
        RULE_FOUND: search.excess(scenarios, rules),
    }
    for member in (entrant.label for entrant in with_baselines((), options)):
        excesses[member] = search.excess_of(scenarios, member)
    tables = {label: own[None, :, None] for label, own in excesses.items()}
    others = [label for label in excesses if label != SINGLE]
    claims = claims_of({request.family.name: tables}, others, {request.family.name: SINGLE})
    means = {label: float(own.mean()) for label, own in excesses.items()}
    named_options = {name: options[option] for name, option in named.items()}
    return Headroom(options[single], named_options, search.missions, tuple(claims), means)


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
    return replace(grid, notes=notes)


def scenario_kinds(scenarios: Sequence[Scenario]) -> list[str]:
    """Return the kind (T,) of each scenario."""
    return [
        f"spots {len(mission.garbage.spots)} stations {len(set(mission.stations.places))}"
        for mission in (scenario.mission for scenario in scenarios)
    ]


def _excess(results: Sequence[MissionResult]) -> Floats:
    return np.array([result.excess_s for result in results])
