"""The missions of candidates: tasks for workers, and the figures of each mission.

A candidate is expert knowledge in a file of its own. The option of the highest score serves each goal in its missions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission_end import left_cost
from selector.documents.parameters import Content
from selector.documents.reading import as_yaml
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.deciders.decider import Decided, Decider, columns_of
from train.evaluation.trial_task import TASK_SCENARIOS, TrialTask
from train.running.engine import Round
from train.running.run_folder import RunFolder
from train.running.runs import Job, RunRecord
from train.running.trials import TrialSettings, each_trial
from train.studies.journal import MissionJournal
from train.studies.space import Varied

FIGURES = ("cost_s", "duration_s", "events", "avoiding", "unfinished")
"""Figures of a mission: cost [s]; time [s] and collision events at the first distance, for each item done where garbage
keeps coming; share of robots and seconds in which a robot avoided others [-]; 1 if items were left, else 0."""
COST, DURATION, EVENT_COUNT, AVOIDING, UNFINISHED = range(5)
STAGES = ("search", "last", "statement")
"""Stages of a study; no two have a scenario in common."""
SEARCH, LAST_RACE, STATEMENT = STAGES
SEEN = ObservationConfig(terms=("avoidance",))  # type: ignore[arg-type]
"""The observation of the watch; the options do not depend on it."""
BY_SCORE_MEMBER = "MaxScore"
"""The strategy of all missions of a study."""


@dataclass(frozen=True)
class Candidate:
    """Values that are tried, and the options that follow from them."""

    name: str
    """Name, unique in the study: method and number, or what it is."""
    goals: dict[str, list[Content]]
    """Options of all goals."""
    values: tuple[Varied, ...] = ()
    """In the order of the dimensions; none for what candidates are compared with."""


@dataclass(frozen=True)
class CandidateRun(RunRecord):
    """One finished mission of a candidate."""

    number: int = 0
    """Number of the scenario, from 0 on."""
    figures: tuple[float, ...] = ()
    """In the order of FIGURES."""


@dataclass(frozen=True)
class CandidateTask(TrialTask):
    """Some training scenarios under one candidate."""

    def each(self) -> Iterator[CandidateRun]:
        """Run the scenarios in one batch, and yield each run when it is done."""
        scenarios = [self.scenario_of(place) for place in self.places]
        watches: list[AvoidanceWatch] = []

        def decider(problem: Problem, teams: Ints) -> AvoidanceWatch:
            watches.append(AvoidanceWatch(self.decider(problem, teams), problem))
            return watches[-1]

        settings = TrialSettings(self.goal, TASK_SCENARIOS, SEEN, self.directories)
        for place, result in each_trial(scenarios, decider, settings):
            scenario = scenarios[place]
            items = max(result.garbage_done, 1) if scenario.mission.continuous else 1
            time = result.ticks / scenario.mission.world.control_rate
            events = round(result.collision_events_per_s[0] * time)
            avoiding = watches[-1].share(scenario.seed)
            left = float(left_cost(scenario.mission, result.garbage_done) > 0.0)
            figures = (result.cost_s, result.duration_s / items, events / items, avoiding, left)
            run = (self.experiment, scenario.id, self.seed, self.condition, result, 0.0)
            yield CandidateRun(*run, self.places[place][0], figures)


class AvoidanceWatch(Decider):
    """A decider that also notes, at each decision, which robots avoid others just then."""

    def __init__(self, decider: Decider, problem: Problem) -> None:
        super().__init__(problem)
        self._decider, self._column = decider, columns_of(problem, ("avoiding",), "study")[0]
        self._rows: dict[int, Ints] = {}
        self._counts: dict[int, list[float]] = {}

    def reset(self, rows: Ints, seed: int) -> None:
        """Prepare `rows` (N,) for the mission of a seed."""
        self._decider.reset(rows, seed)
        self._rows = {other: kept for other, kept in self._rows.items() if kept[0] != rows[0]}
        self._rows[seed], self._counts[seed] = rows, [0.0, 0.0]

    def _decide(self, observations: Observations) -> Decided:
        for seed, rows in self._rows.items():
            self._counts[seed][0] += float(observations[rows, self._column].mean())
            self._counts[seed][1] += 1.0
        return self._decider.decide(observations)

    def opinions(self) -> Floats:
        """Return what the decider thought (R, O)."""
        return self._decider.opinions()

    def share(self, seed: int) -> float:
        """Return the share of robots and decisions of a mission up to now in which a robot avoided others [-]."""
        avoided, decisions = self._counts[seed]
        return avoided / decisions


TaskMaker = Callable[[str, Candidate, tuple[int, ...]], Job]
"""Makes the task of some scenarios of a stage for a candidate."""


class CandidateTasks:
    """Makes tasks of the training scenarios of a family, other ones in each stage.

    The seeds of scenarios are odd, as in trainings; the even ones validate trainings.
    Each stage has its own (docs/decisions/0172-fresh-scenarios.md).

    Args:
        family: the family.
        seed: of the study.
        goal: the goal whose option is asked for.
        folder: directory in which each candidate gets a file with its knowledge.
        directories: the user's own directories of configurations.

    """

    def __init__(
        self, family: FamilyConfig, seed: int, goal: str, folder: RunFolder, directories: tuple[Path, ...]
    ) -> None:
        self._family, self._goal, self._folder, self._directories = family, goal, folder, directories
        words = np.random.SeedSequence(seed).generate_state(len(STAGES), np.uint32)
        self._seeds = {stage: int(word) * 2 + 1 for stage, word in zip(STAGES, words, strict=True)}

    def __call__(self, stage: str, candidate: Candidate, numbers: tuple[int, ...]) -> CandidateTask:
        """Write the knowledge of the candidate, and return its task."""
        file = f"candidates/{candidate.name}.yaml"
        if not (self._folder.path / file).exists():
            self._folder.write(file, as_yaml({"goals": candidate.goals}))
        mission = self._family.mission.model_copy(
            update={"knowledge": str((self._folder.path / file).resolve()), "store": ""}
        )
        family = self._family.model_copy(update={"mission": mission})
        named = (candidate.name, BY_SCORE_MEMBER, self._goal, self._directories)
        places = tuple((number, 0) for number in numbers)
        return CandidateTask(family, self._seeds[stage], places, *named, split="train")


class MissionField:
    """The missions of candidates on the common scenarios of a stage; those that the journal has are not run again."""

    def __init__(self, make: TaskMaker, journal: MissionJournal, done: Round) -> None:
        """Keep what makes tasks, what keeps figures, and what does tasks."""
        self.journal, self._make, self._done = journal, make, done
        self._asked: dict[tuple[str, str], int] = {}

    def asked(self, stage: str, candidate: Candidate) -> int:
        """Return the number of scenarios whose figures were asked for; the journal of a resumed study may have more."""
        return self._asked[stage, candidate.name]

    def figures(self, stage: str, candidates: Sequence[Candidate], count: int) -> Floats:
        """Return the figures (C, figures, count) of C candidates on the first scenarios of a stage."""
        tasks = []
        for candidate in candidates:
            self._asked[stage, candidate.name] = max(count, self._asked.get((stage, candidate.name), 0))
            missing = self.journal.missing(stage, candidate.name, count)
            for first in range(0, len(missing), TASK_SCENARIOS):
                tasks.append(self._make(stage, candidate, missing[first : first + TASK_SCENARIOS]))
        for run in self._done(tasks) if tasks else ():
            assert isinstance(run, CandidateRun)
            self.journal.add(stage, run.condition, run.number, run.figures)
        if tasks:
            self.journal.sync()
        return np.array([self.journal.figures(stage, candidate.name, count) for candidate in candidates])
