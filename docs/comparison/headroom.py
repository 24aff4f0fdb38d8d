"""The headroom of a family: what the best options for each kind of scenario save beside the best single choice.

The kind of a scenario is its numbers of spots of garbage and of places of stations. Both choices are searched on
scenarios of the split "train" and judged on those of "test", so that luck in the search does not count.

Of many options the worse half drops out, again and again, while the number of scenarios doubles (Karnin et al. 2013,
Almost optimal exploration in multi-armed bandits); a few that are best for a kind stay. The finalists
are judged, too, so that the best in hindsight stands beside, chosen on one half of the scenarios and judged on the
other. `python -m docs.comparison.headroom FAMILY GOAL --output DIRECTORY [--searched 16] [--judged 50] [--finalists 0]
[--seed 0]` does one search, and goes on with what the directory holds.

Shapes: O options, L that are left, T scenarios of the search, K scenarios.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split, scenario_name
from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.decider import Decider, TeamsDecider
from clean_swarm_env.deciders.machines import FixedDecider
from clean_swarm_env.deciders.named import FIXED
from clean_swarm_env.learning.warm_up import usable_cpus
from clean_swarm_env.tasks import Cleaning
from clean_swarm_env.world.task import task_class
from docs.comparison.claims import too_few
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.analysis.family_report import EXCESS, ranking_of
from train.analysis.flips import ALPHA
from train.analysis.intervals import Ratio
from train.analysis.runs import Runs
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import BestFixed
from train.analysis.verdict import unfinished_sentence
from train.evaluation.comparing import Comparing
from train.evaluation.evaluation import Done
from train.evaluation.pipeline import evaluate
from train.reports.text_table import EMPTY_CELL, Grid, Publication, interval_cell
from train.request import Request
from train.running.needs import Machine
from train.running.runs import RunRecord
from train.running.trial_task import TASK_SCENARIOS, TrialTask
from train.running.trials import TrialSettings

SINGLE, RULE_FOUND = "best single choice", "best choice for each case"
FIRST_SCENARIOS = 4
"""Scenarios after which the first options drop out."""
MOST_SENTENCES = 3
"""Most sentences of a verdict."""


@dataclass(frozen=True)
class ChosenTask(TrialTask):
    """Scenarios on each of which one option is held."""

    chosen: Mapping[str, int] = field(default_factory=dict)
    """Name of a scenario -> number of its option."""

    @property
    def settings(self) -> TrialSettings:
        """What robots see and give."""
        return TrialSettings(self.goal or None, TASK_SCENARIOS, directories=self.directories, record=self.record)

    def decider(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider by the options."""
        seeds = [scenario.seed for scenario in self.scenarios]
        makers = [partial(FixedDecider, self.chosen[scenario.id]) for scenario in self.scenarios]
        return TeamsDecider(makers, seeds, problem, teams)


class Lacking(Exception):
    """A search needs runs that are not done."""

    def __init__(self, tasks: list[TrialTask]) -> None:
        super().__init__(f"{len(tasks)} tasks are not done")
        self.tasks = tasks


class HeadroomEvaluation(Comparing):
    """The search for the best options of each kind and the best single option, and the runs that judge them.

    Args:
        request: the request; its scenarios judge what is found.
        searched: number of scenarios of the search.
        family: the family, unless it is the one that the request names.
        finalists: number of options that the search ends with; 0: it compares all on all scenarios.

    """

    usual = ()

    def __init__(
        self, request: Request, searched: int, family: FamilyConfig | None = None, *, finalists: int = 0
    ) -> None:
        self.beside_baselines = not finalists
        asked = family or load_family(request.name).with_knowledge(request.knowledge)
        super().__init__(request, asked, headroom={"scenarios": searched, "finalists": finalists})
        self._searched, self._finalists = searched, finalists
        self.stem += "-headroom"

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks that the search needs next; once it is over, those that judge what was found."""
        try:
            single, cases = self._single(done), self._cases(done)
        except Lacking as lacking:
            return lacking.tasks
        best = [cases.get(kind, single) for kind in self._kinds("test").tolist()]
        alone = np.full(len(self.scenarios), single)
        return [
            *self._chosen_tasks(self.scenarios, SINGLE, alone, done),
            *self._chosen_tasks(self.scenarios, RULE_FOUND, np.array(best), done),
            *(
                task
                for option, label in self._others(done).items()
                for task in self._chosen_tasks(self.scenarios, label, np.full_like(alone, option), done)
            ),
            *super().tasks(done),
        ]

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the costs of the rule found, Off and Random beside those of the best single choice."""
        done = {record.key: record for record in records}
        others = list(self._others(done).values())
        labels = [SINGLE, RULE_FOUND, *others, *self.labels]
        runs, against = self.runs(records, {label: (label,) for label in labels}), dict.fromkeys(labels, SINGLE)
        ratio, excesses = excess_ratios(runs, against)[RULE_FOUND], runs.table(EXCESS)
        best = BestFixed.of(excesses, (SINGLE, *others))
        hindsight = Ratio.of(excesses[RULE_FOUND], best.judged(excesses))
        told = "" if hindsight.ratio is None else f"{hindsight.ratio:.3f} {interval_cell(hindsight.ci95)}"
        ends = "" if ratio.ci95 is None else " [{:.1%}, {:.1%}]".format(*(1.0 - end for end in reversed(ratio.ci95)))
        cases, saved = self._cases(done), 1.0 - (np.inf if ratio.ratio is None else ratio.ratio)
        single, many = self.problem.options[self._single(done)], len(self.scenarios)
        named = f"Choosing for each case in place of always {single}"
        verdict = f"{named} is not shown to save anything on {many} scenarios: {saved:.0%}{ends} of the excess."
        if ratio.p is not None and ratio.p < ALPHA:
            verdict = f"{named} {'saves' if saved > 0.0 else 'loses'} {abs(saved):.0%}{ends} of the excess."
        notes = (
            f"headroom {saved:.1%}{ends} of the excess: what the best choice for each case saves",
            f"{sum(name.startswith('train') for name, _ in done)} missions of search",
            f"best single choice: {single}",
            *([f"ratio to the best in hindsight of {len(others) + 1}, {best.label}: {told}"] if others else []),
            "best choices: " + ", ".join(f"{case} {self.problem.options[option]}" for case, option in cases.items()),
        )
        said, head = [verdict], "ratio to the best single choice"
        return excess_publication(runs, against, "headroom", head, notes=notes, verdict=said)

    def _single(self, done: Done) -> int:
        """Return the number of the best single option."""
        left = self._left(done)
        return int(left[self._excesses(left, done).mean(axis=1).argmin()])

    def _left(self, done: Done) -> Ints:
        """Return numbers (L,) of the options that no round has dropped: the best, and those of each kind."""
        left, count = np.arange(len(self.problem.options)), min(FIRST_SCENARIOS, self._searched)
        most = len(left) if self._finalists else 0
        while most > self._finalists:
            most = max(most // 2, self._finalists)
            excesses, kinds = self._excesses(left, done, count), self._kinds("train")[:count]
            keep = [excesses.mean(axis=1).argsort(kind="stable")[:most]]
            for kind in np.unique(kinds):
                keep.append(excesses[:, kinds == kind].mean(axis=1).argsort(kind="stable")[: max(most // 4, 1)])
            left, count = left[np.unique(np.concatenate(keep))], min(2 * count, self._searched)
        return left

    def _others(self, done: Done) -> dict[int, str]:
        """Return the finalists beside the best single option, each with its label."""
        single = self._single(done)
        labels = {
            int(option): f"{FIXED}:{self.problem.options[option]}" for option in self._left(done) if option != single
        }
        return {option: label for option, label in labels.items() if self._finalists and label not in self.labels}

    def _cases(self, done: Done) -> dict[str, int]:
        """Return the best option for each kind."""
        left, kinds = self._left(done), self._kinds("train")
        excesses = self._excesses(left, done)
        return {kind: int(left[excesses[:, kinds == kind].mean(axis=1).argmin()]) for kind in np.unique(kinds).tolist()}

    def _excesses(self, options: Ints, done: Done, count: int = 0) -> Floats:
        """Return the excess costs (L, T) of `options` (L,) on all scenarios of the search, or the first `count`.

        Lacking says which runs are not done.
        """
        names = [scenario_name("train", k) for k in range(count or self._searched)]
        tasks = [
            task
            for option in options
            for task in self._chosen_tasks(names, self.problem.options[option], np.full(len(names), option), done)
        ]
        if tasks:
            raise Lacking(tasks)
        found = [[done[name, self.problem.options[option]] for name in names] for option in options]
        return np.array([[record.result.excess_s for record in row] for row in found])

    def _chosen_tasks(self, names: Sequence[str], condition: str, options: Ints, done: Done) -> list[TrialTask]:
        """Return the tasks of the scenarios `names` (K,) that are not done, on which teams hold `options` (K,)."""
        chosen = {
            name: option for name, option in zip(names, options.tolist(), strict=True) if (name, condition) not in done
        }
        drawn = tuple(self._scenario(name) for name in chosen)
        own = (self.document.name, self.request.seed, drawn, condition, "", self.problem.goal)
        return ChosenTask(*own, directories=self.directories, chosen=chosen).parts()

    def _scenario(self, name: str) -> Scenario:
        return self.document.scenario_named(self.request.seed, name)

    @cache  # noqa: B019  (an evaluation lives as long as its process)
    def _kinds(self, split: Split) -> NDArray[np.str_]:
        """Return the kinds (T,) of the scenarios of the search, or of those that judge."""
        count = self._searched if split == "train" else len(self.scenarios)
        return np.array(scenario_kinds([self._scenario(scenario_name(split, k)) for k in range(count)]))


def excess_ratios(runs: Runs, against: Mapping[str, str]) -> dict[str, Ratio]:
    """Return label -> ratio of the mean excess to that of what it is compared with; nothing for the latter."""
    excesses, left = runs.table(EXCESS), runs.censored
    return {label: Ratio.between(label, other, excesses, left) for label, other in against.items() if label != other}


def excess_publication(
    runs: Runs,
    against: Mapping[str, str],
    title: str,
    head: str,
    *,
    notes: Sequence[str] = (),
    verdict: Sequence[str] = (),
) -> Publication:
    """Return the table of the excess of each strategy, beside that of what it is compared with, and the figures.

    Args:
        runs: the runs.
        against: label -> label of what it is compared with; itself for what others are compared with.
        title: what is compared.
        head: title of the column of ratios.
        notes: lines below the table.
        verdict: sentences that come before those on the order of strategies.

    """
    left, ratios, ranking = runs.unfinished, excess_ratios(runs, against), ranking_of(runs)
    rows, summary = [], dict[str, dict[str, object]]()
    for label, excess in ranking.means.items():
        share = float(left[label].mean()) if left else None
        summary[label] = {"excess_s": excess.value, "unfinished": share}
        cells = ("1", "")
        if label in ratios:
            ratio = ratios[label]
            summary[label] |= {"against": against[label], **ratio.content}
            cells = (EMPTY_CELL if ratio.ratio is None else f"{ratio.ratio:.3f}", interval_cell(ratio.ci95))
        rows.append((label, share_cell(share), f"{excess.value:.1f}", *cells))
    heads = ("strategy", "unfinished", "excess s", head, "95 %")
    few = too_few(runs.scenarios, len(ratios))
    grid = Grid(f"{runs.document.name}: {title}", heads, rows, notes=(*notes, f"excess: {Cleaning.excess}", *few))
    content = {"family": runs.document.name, "strategies": summary, "notes": list(notes)}
    said = [*verdict, *ranking.sentences(), *filter(None, [unfinished_sentence(left, ranking)])][:MOST_SENTENCES]
    return Publication(runs.document.name, runs.document.description, said, [grid], content)


def race(
    family: str,
    goal: str,
    output: Path,
    *,
    searched: int,
    judged: int,
    seed: int,
    finalists: int = 0,
) -> None:
    """Do a search of options of a goal that is missing in its directory, in processes of all CPUs."""
    request = Request(family, seed=seed, scenarios=judged, goal=goal, output=output, resume=True)
    machine = Machine(usable_cpus())
    evaluation = HeadroomEvaluation(replace(request, machine=machine), searched, finalists=finalists)
    evaluate(evaluation, Console(quiet=True))


def scenario_kinds(scenarios: Sequence[Scenario]) -> list[str]:
    """Return the kind (T,) of each scenario, with the price of a collision where that differs."""
    missions = [scenario.mission for scenario in scenarios]
    kinds = [task_class(mission).kind_of(mission) for mission in missions]
    if len({mission.collision_cost for mission in missions}) == 1:
        return kinds
    return [f"{kind} price {mission.collision_cost:g}" for kind, mission in zip(kinds, missions, strict=True)]


def main(arguments: list[str]) -> None:
    """Do the search that the words of a command ask for."""
    parser = argparse.ArgumentParser(prog="python -m docs.comparison.headroom")
    parser.add_argument("family")
    parser.add_argument("goal")
    parser.add_argument("--output", type=Path, required=True)
    for name, usual in (("searched", 16), ("judged", 50), ("finalists", 0), ("seed", 0)):
        parser.add_argument(f"--{name}", type=int, default=usual)
    race(**vars(parser.parse_args(arguments)))


if __name__ == "__main__":
    main(sys.argv[1:])
