"""The conclusion of a study: what its result costs on scenarios that decided nothing, beside what they must beat.

The result becomes expert knowledge, in a file and in a knowledge store.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import mission_context
from selector.documents.parameters import Content
from selector.documents.reading import as_yaml
from selector.knowledge import knowledge_from
from selforg.arrays import Floats
from train.analysis.flips import ALPHA
from train.analysis.intervals import Ratio, corrected_ps
from train.analysis.statistics import Summary, summarise
from train.evaluation.pipeline import mission_score
from train.memory import StoreRequest
from train.studies.config import RANDOM, StudyConfig
from train.studies.missions import COST, FIGURES, STATEMENT, UNFINISHED, Candidate, MissionField
from train.studies.search import Arm, CandidateSearch
from train.studies.space import NULL_OPTION, StudySpace

UNCHANGED = "unchanged"
BEST_RANDOM = "random search"
TO_BEAT = (NULL_OPTION, BEST_RANDOM)
"""Yardsticks that a result has to beat; else it is marked."""


@dataclass(frozen=True)
class Stated:
    """Options and their figures on the scenarios of the statement."""

    label: str
    """Name of the result, or of the yardstick."""
    candidate: Candidate
    figures: Floats
    """(F, K) in the order of FIGURES."""

    @property
    def summaries(self) -> dict[str, Summary]:
        """Mean and interval of each figure."""
        return {name: summarise(values) for name, values in zip(FIGURES, self.figures, strict=True)}

    def ratio_to(self, other: Stated) -> Ratio:
        """Return the ratio of the mean cost to that of another."""
        return Ratio.of(self.figures[COST], other.figures[COST], (self.figures[UNFINISHED], other.figures[UNFINISHED]))


@dataclass(frozen=True)
class Conclusion:
    """The result of a study and its yardsticks, all on the same scenarios."""

    result: Stated
    yardsticks: tuple[Stated, ...]

    @property
    def marks(self) -> list[str]:
        """Labels of the yardsticks that the result did not beat, after a correction for their number."""
        rivals = [one.label for one in self.yardsticks if one.label in TO_BEAT]
        ratios = [self.result.ratio_to(one) for one in self.yardsticks if one.label in TO_BEAT]
        found = zip(rivals, ratios, corrected_ps(ratios), strict=True)
        return [label for label, ratio, p in found if p is None or p >= ALPHA or ratio.sign > 0.0]

    @property
    def everyone(self) -> tuple[Stated, ...]:
        """The result and its yardsticks."""
        return (self.result, *self.yardsticks)


def conclude(
    study: StudyConfig, space: StudySpace, search: CandidateSearch, arms: Sequence[Arm], field: MissionField
) -> Conclusion:
    """Run the last race of each method and state what it found."""
    winners = {arm.method: search.winner(arm) for arm in arms}
    yardsticks = {UNCHANGED: Candidate(UNCHANGED, space.unchanged())}
    if off := space.null():
        yardsticks[NULL_OPTION] = Candidate(NULL_OPTION, off)
    if study.method != RANDOM:
        yardsticks[BEST_RANDOM] = winners[RANDOM]
    everyone = {study.name: winners[study.method], **yardsticks}
    figures = field.figures(STATEMENT, list(everyone.values()), study.last.scenarios)
    stated = [Stated(label, candidate, own) for (label, candidate), own in zip(everyone.items(), figures, strict=True)]
    return Conclusion(stated[0], tuple(stated[1:]))


class FoundKnowledge:
    """The knowledge that a study found: its result, the unchanged options and Off, with the scores of all.

    Args:
        study: the study.
        seed: its seed.
        family: the family whose missions gave the scores.
        space: the space of the study.
        conclusion: what came out.

    """

    def __init__(
        self, study: StudyConfig, seed: int, family: FamilyConfig, space: StudySpace, conclusion: Conclusion
    ) -> None:
        self._study, self._seed, self._family, self._conclusion = study, seed, family, conclusion
        self._scores: dict[tuple[str, str], Floats] = {}
        self._goals = dict(conclusion.result.candidate.goals)
        others = [one for one in conclusion.yardsticks if one.label != BEST_RANDOM]
        for goal in space.goals:
            options: dict[str, Content] = {}
            for stated in (conclusion.result, *others):
                option = space.served(stated.candidate.goals)[goal]
                name = stated.label if stated is conclusion.result else str(option["name"])
                scores = np.array([mission_score(family.mission, cost) for cost in stated.figures[COST].tolist()])
                self._scores.setdefault((goal, name), scores)
                options.setdefault(name, {**option, "name": name, "score": round(float(scores.mean()), 6)})
            self._goals[goal] = list(options.values())

    def text(self) -> str:
        """Return the file `knowledge/NAME.yaml`."""
        learned: dict[str, dict[str, Content]] = {}
        for (goal, name), scores in self._scores.items():
            figures = {"count": len(scores), "mean": float(scores.mean()), "variance": float(scores.var())}
            learned.setdefault(goal, {})[name] = figures
        return as_yaml({"description": self._description(), "goals": self._goals, "learned": learned})

    def give(self, request: StoreRequest) -> None:
        """Give the options and their scores to a store, with the study as their source, once."""
        knowledge = knowledge_from({"goals": self._goals}, self._study.name)
        source = f"study {self._study.name}, seed {self._seed}"
        memory = request.memory(knowledge, mission_context(self._family.name), source)
        if memory is not None and not memory.held():
            memory.give((goal, name, float(x)) for (goal, name), scores in self._scores.items() for x in scores)

    def _description(self) -> str:
        study, stated, marks = self._study, self._conclusion.result, self._conclusion.marks
        cost, count = stated.summaries["cost_s"], stated.figures.shape[1]
        interval = "" if cost.ci95 is None else f" [{cost.ci95[0]:.1f}, {cost.ci95[1]:.1f}]"
        mark = f", NOT SHOWN TO BEAT {' AND '.join(marks)}" if marks else ""
        told = f"{stated.label} costs {cost.mean:.1f} s{interval} on {count} fresh scenarios{mark}"
        about = f"{study.method} on training scenarios of {self._family.name}, seed {self._seed}"
        return f"{study.description} {about}: {told}.".strip()
