"""The conclusion of a study: what its results cost on scenarios that decided nothing, beside what they must beat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from selforg.arrays import Floats
from train.analysis.spread import Ratio
from train.analysis.statistics import Summary, summarise
from train.studies.config import RANDOM, StudyConfig
from train.studies.missions import COST, FIGURES, LAST_RACE, STATEMENT, Candidate, MissionField
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
        return Ratio.of(self.figures[COST], other.figures[COST])

    def beats(self, other: Stated) -> bool:
        """Return whether the interval of the ratio says that this one is cheaper; it does not for few scenarios."""
        ratio = self.ratio_to(other)
        return ratio.p is not None and ratio.ci95 is not None and ratio.ci95[1] < 1.0


@dataclass(frozen=True)
class Conclusion:
    """The results of a study and its yardsticks, all on the same scenarios."""

    results: tuple[Stated, ...]
    yardsticks: tuple[Stated, ...]

    def marks(self, result: Stated) -> list[str]:
        """Return the labels of what a result had to beat but did not."""
        return [one.label for one in self.yardsticks if one.label in TO_BEAT and not result.beats(one)]


def conclude(
    study: StudyConfig, space: StudySpace, search: CandidateSearch, arms: Sequence[Arm], field: MissionField
) -> Conclusion:
    """Run the last race of each method and state what came out; random search counts with its cheapest."""
    winners = {arm.method: search.winners(arm) for arm in arms}
    found = winners[study.method]
    single = len(found) == 1
    results = {study.name if single else f"{study.name}-{k + 1}": winner for k, winner in enumerate(found)}
    yardsticks = {UNCHANGED: Candidate(UNCHANGED, space.unchanged())}
    if off := space.null():
        yardsticks[NULL_OPTION] = Candidate(NULL_OPTION, off)
    if study.method != RANDOM:
        yardsticks[BEST_RANDOM] = min(winners[RANDOM], key=lambda one: _cost(field, one))
    everyone = {**results, **yardsticks}
    figures = field.figures(STATEMENT, list(everyone.values()), study.last.scenarios)
    stated = [Stated(label, candidate, own) for (label, candidate), own in zip(everyone.items(), figures, strict=True)]
    return Conclusion(tuple(stated[: len(results)]), tuple(stated[len(results) :]))


def _cost(field: MissionField, candidate: Candidate) -> float:
    """Return the mean cost of a candidate in the last race [s]."""
    return float(field.figures(LAST_RACE, [candidate], field.asked(LAST_RACE, candidate))[0, COST].mean())
