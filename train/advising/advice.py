"""The missions of an advice: a search for the best options of a mission, and a last round that judges them.

All missions are in one journal. Which of them come next follows from those that are done; see `train.advising.search`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.load import load_family, random_starts
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.deciders.named import FIXED, MACHINE, POLICY, decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.task import task_class
from selector.documents.errors import DocumentError, within
from selector.documents.fields import JOINT
from selector.documents.find import files_of
from selector.documents.writing import write_whole
from selector.knowledge import Option
from selforg.plugins import PluginError
from train.advising import perturbed
from train.advising.opening import document_of, open_mission, variants_of
from train.advising.rounds import BROKE, CPU, Lacking, broke_off, needed, seconds_of
from train.advising.search import JAMMED, AdviceSearch, SearchResult, arm_of, held_by, never_avoiding
from train.analysis.verdict import RANDOM
from train.evaluation.comparison import Comparison, Deciders
from train.evaluation.conditions import check_fit
from train.evaluation.evaluation import Done, Evaluation
from train.evaluation.pipeline import mission_score
from train.request import Request
from train.running.needs import check_needs, needs_of
from train.running.run_folder import fingerprints
from train.running.runs import RunRecord
from train.running.trial_task import TASK_SCENARIOS, TrialTask

OPTIONS_FILE, NUMBERS_FILE = "options.yaml", "numbers.yaml"
"""Files with all options that race, and with the variants of the best ones, too; there the best have the highest score,
so that a rule for one goal leaves them in place for the others."""
NO_RULES = ("random-held",)
"""Machines that ship as chance."""
USUAL_SHARE = 0.05
"""Share of its time limit that a mission lasts, coarsely, before one has run."""
KINDS_OF = 50
"""Scenarios of a family among which there have to be several kinds."""
LEAST_MISSIONS = 120
"""Missions without which nothing can be said."""


@dataclass(frozen=True)
class AdviceTask(TrialTask):
    """Starts under one arm; missions that a plug-in breaks off cost more than any other."""

    def each(self) -> Iterator[RunRecord]:
        """Run the missions."""
        done, before = set(), time.process_time()
        try:
            for record in super().each():
                done.add(record.key)
                before, began = time.process_time(), before
                yield replace(record, counts={CPU: round(1000.0 * (before - began))})
        except PluginError as error:
            for scenario in self.scenarios:
                if (scenario.id, self.condition) not in done:
                    mission, none = scenario.mission, (0.0,) * len(scenario.mission.counted_distances)
                    measures = {measure.name: 0.0 for measure in task_class(mission).measures}
                    lost = (0, mission.robots.count, 0, 0.0, 100.0 * mission.time_limit, 0.0, measures)
                    result = MissionResult(False, mission.time_limit, none, none, *lost)
                    yield self.finished(scenario, result, 0.0, counts={f"{BROKE}{error}": 1})


class Advising(Evaluation):
    """The missions of an advice for a mission, a family or a task.

    Args:
        request: the request, with the directory of the results.
        minutes: time of processors for all missions [min].
        missions: number of missions in place of that; then the same advice comes again on any machine.
        kinds: whether to find what is best for each kind of scenario, too.
        robust: whether to do what is judged in perturbed worlds, too; the time for it is not part of the budget.

    Attributes:
        budget: what all missions may take: time of processors [s], or their number.
        censors: whether the cost of a mission that is not finished is unknown, as `censored` has it.
        nothing_to_choose: whether each goal has one option only.
        varied: goal -> variants of the best option, once they are needed.

    """

    def __init__(
        self,
        request: Request,
        minutes: float,
        missions: int | None = None,
        *,
        kinds: bool = False,
        robust: bool = False,
    ) -> None:
        super().__init__(request)
        assert request.output is not None
        self.folder = request.output
        self.budget, self.missions, self.kinds = (
            60.0 * minutes if missions is None else float(missions),
            missions,
            kinds,
        )
        family = load_family(request.name, self.directories).with_knowledge(request.knowledge, self.directories)
        with within(family.name):
            self._check_time(family, minutes)
            check_needs(family.largest, TASK_SCENARIOS, request.machine, TASK_SCENARIOS)
            drawn = [family.scenario(request.seed, k, "train") for k in range(KINDS_OF if kinds else 0)]
            if len(found := {task_class(family.mission).kind_of(scenario.mission) for scenario in drawn}) == 1:
                raise DocumentError(f"--kinds: expected scenarios of several kinds, got one: {found.pop()}")
            self.opened = open_mission(family, self.directories)
            self.choosers_that_fit = self._fitting()
        self.family, self.mission = self.opened.family, self.opened.family.mission
        self.censors = not (task_class(self.mission).measures or items_keep_coming(self.mission))
        self.nothing_to_choose = self.opened.combinations == 1
        self.of_family = family.description != random_starts(family.mission).description
        self.goal = JOINT.join(self.opened.goals)
        self.robust = robust and not self.nothing_to_choose
        for number in self.worlds:
            perturbed.perturbed(self.family.scenario(request.seed, 0, "test").mission, request.seed, number)
        self.stem, self.scenarios, self.context = self.family.name, [], ""
        self.varied: dict[str, list[Option]] = {}
        options = {goal: [one.model_dump(mode="json") for one in own] for goal, own in self.opened.known.table.items()}
        asked = {
            "minutes": minutes,
            "missions": missions,
            "kinds": kinds,
            "robust": robust,
            "options": options,
            "learned": bool(self.opened.known.learned),
        }
        comparison = Comparison(
            document=self.family,
            seed=request.seed,
            goal=self.goal,
            conditions={},
            files=fingerprints(self.directories),
            directories=self.directories,
        )
        self.identify(comparison, advice=asked)

    def price(self, record: RunRecord) -> float:
        """Return what a mission took of the budget."""
        return 1.0 if self.missions else seconds_of(record)

    @cache  # noqa: B019  (an evaluation lives as long as its process)
    def kind(self, name: str) -> str:
        """Return the kind of a scenario; all are of one unless kinds are asked for."""
        if not self.kinds:
            return ""
        return task_class(self.mission).kind_of(self.family.scenario_named(self.request.seed, name).mission)

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the missions that the search needs next; once it is over, those of the last round."""
        self._write(OPTIONS_FILE, document_of(self.opened.known.table, self.directories))
        search = self.search(done)
        try:
            found = search.run()
            going, _ = self.judged(found, done)
            self.robustness(found.winner, going, done)
        except Lacking as lacking:
            self.so_far = f"; {search.leads}" if search.rounds else ""
            return [task for arm, own in lacking.missing.items() for task in self.tasks_of(arm, own)]
        return []

    def search(self, done: Done) -> AdviceSearch:
        """Return the search over missions that are done."""
        return AdviceSearch(
            self.opened,
            self.choosers_that_fit,
            self._vary,
            done,
            self.budget,
            self.price,
            lambda record: mission_score(self.mission, record.result.cost_s),
            counts=self.censors,
            entrants=lambda winner, finalists, choosers: (
                len(self.entrants(winner, finalists, choosers)) + (len(finalists) if len(finalists) > 1 else 0)
            ),
            kind=self.kind,
        )

    def entrants(self, winner: str, finalists: Sequence[str], choosers: Sequence[str]) -> list[str]:
        """Return the arms of the last round: the best, what it must beat, and what changes options on the way."""
        off = never_avoiding(self.opened, held_by(self.opened, winner))
        chance = [] if self.nothing_to_choose else [RANDOM]
        return list(dict.fromkeys([winner, *finalists, arm_of(self.opened.experts), *off, *chance, *choosers]))

    def judged(self, found: SearchResult, done: Done) -> tuple[list[str], dict[str, int]]:
        """Return the arms of the last round that did all starts, and how many starts each of the others lost.

        Lacking says which missions are missing, of the first starts only while those are not done.
        """
        arms = self.entrants(found.winner, found.finalists, found.choosers)
        first = {arm: [(scenario_name("test", k), arm) for k in range(min(found.starts, JAMMED))] for arm in arms}
        runs = needed(first, done)
        stopped = {arm: sum(map(bool, map(broke_off, own))) for arm, own in runs.items() if any(map(broke_off, own))}
        if self.censors:
            lost = {arm: sum(not one.result.completed for one in own) for arm, own in runs.items()}
            most = len(first[found.winner])
            if 2 * lost[found.winner] < most:
                stopped = {arm: many for arm, many in lost.items() if 2 * many >= most} | stopped
        stopped = {arm: many for arm, many in stopped.items() if arm not in {found.winner, *found.kinds.values()}}
        twice = found.finalists if len(found.finalists) > 1 else ()
        going = [arm for arm in arms if arm not in stopped]
        every = {
            arm: [(scenario_name("test", k, w), arm) for k in range(found.starts) for w in range(1 + (arm in twice))]
            for arm in going
        }
        needed(every, done)
        return going, stopped

    @property
    def worlds(self) -> range:
        """Numbers of the perturbed worlds; none unless they are asked for."""
        return range(1, perturbed.WORLDS + 1 if self.robust else 1)

    def robustness(self, winner: str, arms: Sequence[str], done: Done) -> perturbed.Robustness | None:
        """Return what arms cost in perturbed worlds, if they are asked for; Lacking if missions are missing."""
        if not self.robust:
            return None
        names = [scenario_name("test", k) for k in range(perturbed.STARTS)]
        labels = {arm: [f"{arm}{perturbed.IN_WORLD}{number}" for number in self.worlds] for arm in arms}
        runs = needed({one: [(name, one) for name in names] for own in labels.values() for one in own}, done)
        costs = {
            arm: np.array([[run.result.excess_s for run in runs[one]] for one in own]) for arm, own in labels.items()
        }
        usual = np.array([done[name, winner].result.excess_s for name in names])
        return perturbed.Robustness(winner, costs, usual)

    def expected(self, done: Done) -> int:
        """Return how many missions the budget lasts for, at the mean price of those so far, and those beside it."""
        spent = sum(map(self.price, done.values()))
        beside = len(self.worlds) * perturbed.STARTS * perturbed.ARMS
        return round(len(done) * self.budget / spent) + beside if spent > 0.0 else 0

    def leading(self, costs: Mapping[str, Sequence[float]]) -> str:
        """Return who leads, in words."""
        return self.so_far.removeprefix("; ")

    def _fitting(self) -> list[str]:
        """Return the rules and policies that decide a goal of the mission and fit it; DocumentError if none can."""
        wide = self.opened
        with TemporaryDirectory() as folder:
            file = Path(folder) / OPTIONS_FILE
            write_whole(file, document_of(wide.known.table, self.directories).encode())
            mission = wide.with_knowledge(file).scenario(0, 0, "test").mission
            batch = Batch(mission, directories=self.directories)
        names = [f"{MACHINE}:{name}" for name in files_of("machines", self.directories) if name not in NO_RULES]
        names += [f"{POLICY}:{name}" for name in files_of("policies", self.directories)]
        several, found = {goal for goal in wide.goals if len(wide.names(goal)) > 1}, []
        for name in names if several else ():
            try:
                if several & set(decider_named(name, self.directories).goals):
                    check_fit(name, Deciders(members=(name,)), batch, JOINT.join(wide.goals), self.directories)
                    found.append(name)
            except ValueError:  # it does not fit, or its file is damaged
                continue
        return found

    def _check_time(self, family: FamilyConfig, minutes: float) -> None:
        """Raise DocumentError if the fewest missions of which anything can be said take longer than there is time."""
        needed = USUAL_SHARE * needs_of(family.largest).time * LEAST_MISSIONS / 60.0
        if needed > minutes and self.missions is None and not self.request.machine.forced:
            expected = f"expected at least {math.ceil(needed)} for a mission of {family.largest.rows} robots"
            raise DocumentError(f"--minutes: {expected}, by a coarse estimate, got {minutes:g}; --force begins anyway")

    def _vary(self, held: Mapping[str, str]) -> Mapping[str, Sequence[Option]]:
        """Return the variants of options, and write them to their file; goal -> option."""
        table = self.opened.known.table
        chosen = {goal: next(one for one in table[goal] if one.name == name) for goal, name in held.items()}
        self.varied = variants_of(chosen, self.directories)
        better: dict[str, list[Option]] = {}
        for goal, own in table.items():
            options = [*own, *self.varied[goal]]
            most = {"score": max(one.score for one in options) + 1.0}
            better[goal] = [one.model_copy(update=most) if one.name == held[goal] else one for one in options]
        self._write(NUMBERS_FILE, document_of(better, self.directories))
        return self.varied

    @cache  # noqa: B019
    def _write(self, name: str, text: str) -> None:
        """Write a file with options, once: they follow from what was done before they are needed."""
        write_whole(self.folder / name, text.encode())

    def file_of(self, arm: str) -> Path:
        """Return the file with the knowledge of an arm."""
        names = {option.name for own in self.varied.values() for option in own}
        kind, _, options = arm.partition(":")
        varied = kind == FIXED and names & set(options.split(JOINT))
        return self.folder.resolve() / (NUMBERS_FILE if varied or kind in (MACHINE, POLICY) else OPTIONS_FILE)

    def tasks_of(self, arm: str, names: Sequence[str]) -> list[TrialTask]:
        """Return the tasks of scenarios of an arm, or of one in a perturbed world."""
        member, _, number = arm.partition(perturbed.IN_WORLD)
        family, seed = self.opened.with_knowledge(self.file_of(member)), self.request.seed
        drawn = tuple(family.scenario_named(seed, name) for name in names)
        if number:
            drawn = tuple(replace(one, mission=perturbed.perturbed(one.mission, seed, int(number))) for one in drawn)
        return AdviceTask(family.name, seed, drawn, arm, member, self.goal, directories=self.directories).parts()
