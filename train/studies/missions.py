"""The missions of candidates: tasks for workers, and the figures of each mission.

A candidate is expert knowledge in a file of its own. The option of the highest score serves each goal in its missions.
Finished missions are kept as those of evaluations are: the stage of the study stands before the name of the candidate.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario, scenario_name
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.parameters import Content
from selector.documents.reading import as_yaml
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.deciders.decider import Decided, Decider, columns_of
from train.evaluation.trial_task import TASK_SCENARIOS, TrialTask
from train.running.engine import Round
from train.running.finished_runs import Results
from train.running.run_folder import RunFolder
from train.running.runs import Job, RunKey, RunRecord, under
from train.running.trials import TrialSettings
from train.studies.space import Varied

FIGURES = ("cost_s", "duration_s", "events", "avoiding", "unfinished")
"""Figures of a mission: cost [s]; time [s] and collision events at the first distance, for each item done where garbage
keeps coming; share of robots and decisions in which a robot avoided others [-]; 1 if items were left or
another task missed a target, else 0."""
COST, UNFINISHED = FIGURES.index("cost_s"), FIGURES.index("unfinished")
STAGES = ("search", "last", "statement")
"""Stages of a study; no two have a scenario in common."""
SEARCH, LAST_RACE, STATEMENT = STAGES
DECISIONS, AVOIDED = "decisions", "avoiding"
"""Counts of a mission: decisions of all robots, and those at which a robot avoided others just then."""
SEEN = ObservationConfig(terms=("avoidance",))  # type: ignore[arg-type]
"""The observation from which this is counted; the options do not depend on it."""
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
class CandidateTask(TrialTask):
    """Some training scenarios under one candidate."""

    @property
    def settings(self) -> TrialSettings:
        """Those of the base class, with the observations of avoidance."""
        return replace(super().settings, observation=SEEN)

    def decider(self, problem: Problem, teams: Ints) -> AvoidanceWatch:
        """Return the decider of the candidate, watched."""
        return AvoidanceWatch(super().decider(problem, teams), problem, self._counted)

    def counts(self, scenario: Scenario) -> dict[str, int]:
        """Return the counts of a mission up to now."""
        return dict(self._counted[scenario.seed])

    @cached_property
    def _counted(self) -> dict[int, Counter[str]]:
        """Seed of a mission -> counts."""
        return {}


class AvoidanceWatch(Decider):
    """A decider that also counts, at each decision, which robots avoid others just then.

    Args:
        decider: the decider that is watched.
        problem: see `Decider`.
        counted: gets the counts of each mission by its seed.

    """

    def __init__(self, decider: Decider, problem: Problem, counted: dict[int, Counter[str]]) -> None:
        super().__init__(problem, decider.teams)
        self._decider, self._column = decider, columns_of(problem, ("avoiding",), "study")[0]
        self._counted = counted
        self._missions: dict[int, tuple[Ints, Counter[str]]] = {}

    def reset(self, rows: Ints, seed: int) -> None:
        """Prepare `rows` (N,) for the mission of a seed."""
        self._decider.reset(rows, seed)
        counts = self._counted[seed] = Counter()
        self._missions[int(rows[0])] = rows, counts

    def _decide(self, observations: Observations) -> Decided:
        for rows, counts in self._missions.values():
            counts[DECISIONS] += len(rows)
            counts[AVOIDED] += int(np.count_nonzero(observations[rows, self._column]))
        return self._decider.decide(observations)

    def opinions(self) -> Floats:
        """Return the opinions of the decider (R, O)."""
        return self._decider.opinions()


def stage_seeds(seed: int) -> dict[str, int]:
    """Return stage -> seed of its scenarios, for a study of a seed (docs/decisions/0172-fresh-scenarios.md).

    The seeds of scenarios are odd, as in trainings; the even ones validate trainings.
    """
    words = np.random.SeedSequence(seed).generate_state(len(STAGES), np.uint32)
    return {stage: int(word) * 2 + 1 for stage, word in zip(STAGES, words, strict=True)}


TaskMaker = Callable[[str, Candidate, tuple[int, ...]], Job]
"""Makes the task of some scenarios of a stage for a candidate."""


@dataclass(frozen=True)
class CandidateTasks:
    """Makes tasks of the training scenarios of a family, other ones in each stage."""

    family: FamilyConfig
    seed: int
    """Seed of the study."""
    goal: str
    """The goal whose option is asked for."""
    folder: RunFolder
    """Directory in which each candidate gets a file with its knowledge."""
    directories: tuple[Path, ...]
    """The user's own directories of configurations."""

    def __call__(self, stage: str, candidate: Candidate, numbers: tuple[int, ...]) -> CandidateTask:
        """Write the knowledge of the candidate, and return its task."""
        file = f"candidates/{candidate.name}.yaml"
        if not (self.folder.path / file).exists():
            self.folder.write(file, as_yaml({"goals": candidate.goals}))
        changes = {"knowledge": str((self.folder.path / file).resolve()), "store": ""}
        family = self.family.model_copy(update={"mission": self.family.mission.model_copy(update=changes)})
        seed = stage_seeds(self.seed)[stage]
        scenarios = tuple(family.scenario(seed, number, "train") for number in numbers)
        named = (under(stage, candidate.name), BY_SCORE_MEMBER, self.goal)
        return CandidateTask(family.name, seed, scenarios, *named, directories=self.directories)

    def mistake(self, record: RunRecord) -> str:
        """Return why a mission that is kept is none of this study; empty if it is."""
        seed = stage_seeds(self.seed).get(record.condition.partition(" - ")[0])
        decisions = record.counts.get(DECISIONS, 0)
        if seed is None or not decisions or not 0 <= record.counts.get(AVOIDED, -1) <= decisions:
            return f"expected a mission of a stage, {', '.join(STAGES)}, with the counts {DECISIONS} and {AVOIDED}"
        return record.mistake(self.family.name, seed, self.family.largest)


class MissionField:
    """The missions of candidates on the common scenarios of a stage; those that are kept are not run again.

    Args:
        make: makes tasks.
        results: keeps finished missions.
        done: does tasks.
        mission: the mission of the family.

    """

    def __init__(self, make: TaskMaker, results: Results, done: Round, mission: MissionConfig) -> None:
        self.results, self._make, self._done, self._mission = results, make, done, mission
        self._asked: dict[tuple[str, str], int] = {}

    def asked(self, stage: str, candidate: Candidate) -> int:
        """Return the number of scenarios whose figures were asked for; a resumed study may have kept more."""
        return self._asked[stage, candidate.name]

    def figures(self, stage: str, candidates: Sequence[Candidate], count: int) -> Floats:
        """Return the figures (C, F, count) of C candidates on the first scenarios of a stage."""
        tasks, kept = [], self.results.runs
        keys = [[_key(stage, candidate, number) for number in range(count)] for candidate in candidates]
        for candidate, own in zip(candidates, keys, strict=True):
            self._asked[stage, candidate.name] = max(count, self._asked.get((stage, candidate.name), 0))
            missing = [number for number, key in enumerate(own) if key not in kept]
            for first in range(0, len(missing), TASK_SCENARIOS):
                tasks.append(self._make(stage, candidate, tuple(missing[first : first + TASK_SCENARIOS])))
        for run in self._done(tasks):
            self.results.add(run)
        return np.array([[figures_of(kept[key], self._mission) for key in own] for own in keys]).swapaxes(1, 2)


def _key(stage: str, candidate: Candidate, number: int) -> RunKey:
    return scenario_name("train", number), under(stage, candidate.name)


def figures_of(run: RunRecord, mission: MissionConfig) -> tuple[float, ...]:
    """Return the figures (F,) of a mission of a family, in the order of FIGURES."""
    result = run.result
    items = max(result.garbage_done, 1) if mission.items.keep_coming else 1
    events = round(result.collision_events_per_s[0] * result.ticks / mission.world.control_rate)
    avoiding = run.counts[AVOIDED] / run.counts[DECISIONS]
    unfinished = not (mission.items.keep_coming or result.completed)
    return result.cost_s, result.duration_s / items, events / items, avoiding, float(unfinished)
