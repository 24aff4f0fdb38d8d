"""The headroom of a family: what the best choice of an option for each case saves beside the best single choice.

A case is the situation of a robot, or the kind of a scenario: its numbers of spots of garbage and of places of
stations. Both choices are searched on scenarios of the split "train" and judged on those of "test", so that luck in the
search does not count. The search begins with the best single option. For situations it then tries every option in one
after the other, and keeps what lowers the mean excess cost, until a whole round changes nothing. For kinds it takes the
best option of each.

Of many options the worse half drops out, again and again, while the number of scenarios doubles (Karnin et al. 2013,
Almost optimal exploration in multi-armed bandits); a few that are best for a kind stay. The finalists
are judged, too, so that the best in hindsight stands beside, chosen on one half of the scenarios and judged on the
other.

Shapes: S situations, 1 without any; O options, L that are left, Q rules, T scenarios of the search.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split, scenario_name
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.analysis.family_report import excess_ratios, excesses_of
from train.analysis.flips import ALPHA
from train.analysis.intervals import Ratio
from train.analysis.strategy_comparison import BestFixed
from train.deciders.decider import Decider, TeamsDecider, columns_of
from train.deciders.machines import RuleDecider
from train.deciders.named import FIXED
from train.evaluation.base import Done
from train.evaluation.family import FamilyEvaluation
from train.evaluation.trial_task import TASK_SCENARIOS, TrialTask
from train.reports.family_tables import excess_publication
from train.reports.text_table import Publication, interval_cell
from train.request import Request
from train.running.runs import RunRecord
from train.running.trials import TrialSettings

SINGLE, RULE_FOUND = "best single choice", "best choice for each case"
MOST_ROUNDS = 5
"""Rounds over all situations after which a search ends."""
FIRST_SCENARIOS = 4
"""Scenarios after which the first options drop out."""


@dataclass(frozen=True)
class RuleTask(TrialTask):
    """Scenarios on which each team follows one rule."""

    situations: tuple[str, ...] = ()
    """See `HeadroomEvaluation`."""
    rules: Mapping[str, Sequence[int]] = field(default_factory=dict)
    """Name of a scenario -> its rule (S,): the number of an option for each situation."""

    @property
    def settings(self) -> TrialSettings:
        """What robots see and give."""
        return TrialSettings(self.goal or None, TASK_SCENARIOS, directories=self.directories, record=self.record)

    def decider(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider by the rules."""
        seeds = [scenario.seed for scenario in self.scenarios]
        makers = [partial(RuleDecider, self.situations, self.rules[scenario.id]) for scenario in self.scenarios]
        return TeamsDecider(makers, seeds, problem, teams)


class Lacking(Exception):
    """A search needs runs that are not done."""

    def __init__(self, tasks: list[TrialTask]) -> None:
        super().__init__(f"{len(tasks)} tasks are not done")
        self.tasks = tasks


class HeadroomEvaluation(FamilyEvaluation):
    """The search for the best rule and the best single option of a family, and the runs that judge them.

    Args:
        request: the request; its scenarios judge what is found.
        situations: components of the observation, of which the largest tells the situation of a robot; none: kinds of
            scenarios.
        searched: number of scenarios of the search.
        family: the family, unless it is the one that the request names.
        finalists: number of options that the search ends with; 0: it compares all on all scenarios.
        told: terms of the observation beside those of the mission.

    """

    growing = ""

    def __init__(
        self,
        request: Request,
        situations: tuple[str, ...],
        searched: int,
        family: FamilyConfig | None = None,
        *,
        finalists: int = 0,
        told: tuple[str, ...] = (),
    ) -> None:
        asked = {"situations": list(situations), "scenarios": searched, "finalists": finalists}
        self.beside_baselines = not finalists
        super().__init__(request, family, terms=told, headroom=asked)
        self._situations, self._searched, self._finalists = situations, searched, finalists
        self._drawn = partial(self.scenario, self.family)
        columns_of(self.problem, situations, "--situations")
        self.stem += "-headroom"

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks that the search needs next; once it is over, those that judge what was found."""
        try:
            single, rules = self._single(done), self._judged(done)
        except Lacking as lacking:
            return lacking.tasks
        alone = np.full_like(rules, single)
        return [
            *self._rule_tasks(self.scenarios, SINGLE, alone, done),
            *self._rule_tasks(self.scenarios, RULE_FOUND, rules, done),
            *(
                task
                for option, label in self._others(done).items()
                for task in self._rule_tasks(self.scenarios, label, np.full_like(rules, option), done)
            ),
            *super().tasks(done),
        ]

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the costs of the rule found, Off and Random beside those of the best single choice."""
        done = {record.key: record for record in records}
        others = list(self._others(done).values())
        labels = [SINGLE, RULE_FOUND, *others, *(entrant.label for entrant in self.entrants)]
        runs, against = self.runs(records, {label: (label,) for label in labels}), dict.fromkeys(labels, SINGLE)
        ratio, excesses = excess_ratios(runs, against)[RULE_FOUND], excesses_of(runs)
        best = BestFixed.of(excesses, (SINGLE, *others))
        hindsight = Ratio.of(excesses[RULE_FOUND], best.judged(excesses))
        told = "" if hindsight.ratio is None else f"{hindsight.ratio:.3f} {interval_cell(hindsight.ci95)}"
        ends = "" if ratio.ci95 is None else " [{:.1%}, {:.1%}]".format(*(1.0 - end for end in reversed(ratio.ci95)))
        cases, saved = self._cases(done), 1.0 - (np.inf if ratio.ratio is None else ratio.ratio)
        single, many = self.options[self._single(done)], len(self.scenarios)
        named = f"Choosing for each case in place of always {single}"
        verdict = f"{named} is not shown to save anything on {many} scenarios: {saved:.0%}{ends} of the excess."
        if ratio.p is not None and ratio.p < ALPHA:
            verdict = f"{named} {'saves' if saved > 0.0 else 'loses'} {abs(saved):.0%}{ends} of the excess."
        notes = (
            f"headroom {saved:.1%}{ends} of the excess: what the best choice for each case saves",
            f"{sum(name.startswith('train') for name, _ in done)} missions of search",
            f"best single choice: {single}",
            *([f"ratio to the best in hindsight of {len(others) + 1}, {best.label}: {told}"] if others else []),
            "best choices: " + ", ".join(f"{case} {self.options[option]}" for case, option in cases.items()),
        )
        said, head = [verdict], "ratio to the best single choice"
        return excess_publication(runs, against, "headroom", head, notes=notes, verdict=said)

    @property
    def _singles(self) -> Ints:
        """The rules (O, S) of one option each."""
        return np.repeat(np.arange(len(self.options))[:, None], max(len(self._situations), 1), axis=1)

    def _single(self, done: Done) -> int:
        """Return the best single option."""
        return self._best(self._singles, done)

    def _best(self, rules: Ints, done: Done) -> int:
        """Return the number of the best of `rules` (Q, S)."""
        left = self._left(rules, done)
        return int(left[self._excesses(rules[left], done).mean(axis=1).argmin()])

    def _left(self, rules: Ints, done: Done) -> Ints:
        """Return numbers (L,) of the `rules` (Q, S) that no round has dropped: the best, and those of each kind."""
        left, count = np.arange(len(rules)), min(FIRST_SCENARIOS, self._searched)
        most = len(left) if self._finalists else 0
        while most > self._finalists:
            most = max(most // 2, self._finalists)
            excesses, kinds = self._excesses(rules[left], done, count), self._kinds("train")[:count]
            keep = [excesses.mean(axis=1).argsort(kind="stable")[:most]]
            for kind in () if self._situations else np.unique(kinds):
                keep.append(excesses[:, kinds == kind].mean(axis=1).argsort(kind="stable")[: max(most // 4, 1)])
            left, count = left[np.unique(np.concatenate(keep))], min(2 * count, self._searched)
        return left

    def _others(self, done: Done) -> dict[int, str]:
        """Return the finalists beside the best single option, each with its label."""
        single = self._single(done)
        labels = {
            int(option): f"{FIXED}:{self.options[option]}"
            for option in self._left(self._singles, done)
            if option != single
        }
        taken = [entrant.label for entrant in self.entrants]
        return {option: label for option, label in labels.items() if self._finalists and label not in taken}

    def _cases(self, done: Done) -> dict[str, int]:
        """Return the best option for each case."""
        situations = self._situations
        if situations:
            return dict(zip(situations, self._rule(done).tolist(), strict=True))
        left, kinds = self._left(self._singles, done), self._kinds("train")
        excesses = self._excesses(self._singles[left], done)
        return {kind: int(left[excesses[:, kinds == kind].mean(axis=1).argmin()]) for kind in np.unique(kinds).tolist()}

    def _rule(self, done: Done) -> Ints:
        """Return the best rule (S,) for situations."""
        rule = np.full(len(self._situations), self._single(done))
        for _ in range(MOST_ROUNDS):
            before = rule.copy()
            for situation in range(len(rule)):
                tried = np.tile(rule, (len(self.options), 1))
                tried[:, situation] = np.arange(len(self.options))
                rule = tried[self._best(tried, done)]
            if np.array_equal(rule, before):
                break
        return rule

    def _judged(self, done: Done) -> Ints:
        """Return the rules (K, S) that are judged, one for each test scenario."""
        cases = self._cases(done)
        if self._situations:
            return np.tile(np.array(list(cases.values())), (len(self.scenarios), 1))
        single = self._single(done)
        return np.array([[cases.get(kind, single)] for kind in self._kinds("test").tolist()])

    def _excesses(self, rules: Ints, done: Done, count: int = 0) -> Floats:
        """Return the excess costs (Q, T) of `rules` (Q, S) on all scenarios of the search, or the first `count`.

        Lacking says which runs are not done.
        """
        names = [scenario_name("train", k) for k in range(count or self._searched)]
        conditions = [" / ".join(self.options[option] for option in rule) for rule in rules]
        tasks = [
            task
            for condition, rule in dict(zip(conditions, rules, strict=True)).items()
            for task in self._rule_tasks(names, condition, np.tile(rule, (len(names), 1)), done)
        ]
        if tasks:
            raise Lacking(tasks)
        found = [[done[name, condition] for name in names] for condition in conditions]
        return np.array([[record.result.excess_s for record in row] for row in found])

    def _rule_tasks(self, names: Sequence[str], condition: str, rules: Ints, done: Done) -> list[TrialTask]:
        """Return the tasks of the scenarios `names` (K,) that are not done, on which teams follow `rules` (K, S)."""
        rule_of = {
            name: rule for name, rule in zip(names, rules.tolist(), strict=True) if (name, condition) not in done
        }
        left, found = list(rule_of), list[TrialTask]()
        for first in range(0, len(left), TASK_SCENARIOS):
            part = [self._drawn(name) for name in left[first : first + TASK_SCENARIOS]]
            settings = vars(self.task(part, condition, ""))
            found.append(RuleTask(**settings, situations=self._situations, rules=rule_of))
        return found

    @cache  # noqa: B019  (an evaluation lives as long as its process)
    def _kinds(self, split: Split) -> NDArray[np.str_]:
        """Return the kinds (T,) of the scenarios of the search, or of those that judge."""
        count = self._searched if split == "train" else len(self.scenarios)
        return np.array(scenario_kinds([self._drawn(scenario_name(split, k)) for k in range(count)]))


def scenario_kinds(scenarios: Sequence[Scenario]) -> list[str]:
    """Return the kind (T,) of each scenario."""
    tasks = [scenario.mission.task for scenario in scenarios]
    return [
        f"spots {len(task.garbage.spots)} stations {len(set(task.stations.places))}"
        + (" harmless" if task.consequences.harmless else "")
        if isinstance(task, CleaningSettings)
        else task.name
        for task in tasks
    ]
