"""The search of a study: batches of candidates are proposed, race on common training scenarios, and teach the method.

The methods are samplers of optuna, each on a study in memory that is asked and told. Each draws from one seed only and
proposes a batch at a time: the order in which missions end has no effect.

What a candidate brings is estimated for all scenarios of the search, though most candidates stop early: by regression
on what the unchanged options bring there (Cochran 1977, Sampling Techniques, chapter 7).

Shapes: F figures of a mission, n scenarios that a candidate did.
"""

from __future__ import annotations

import warnings
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import optuna
from optuna.samplers import BaseSampler, CmaEsSampler, RandomSampler, TPESampler
from optuna.trial import TrialState

from selector.documents.errors import DocumentError
from selforg.arrays import Floats
from train.learning.racing import race
from train.studies.config import Method, StudyConfig
from train.studies.missions import COST, LAST_RACE, SEARCH, Candidate, MissionField
from train.studies.space import StudySpace, Varied


@dataclass(frozen=True)
class StudyTrial:
    """A candidate, and its figures as the method got them."""

    candidate: Candidate
    means: tuple[float, ...] = ()
    """Estimated means of the figures, in the order of FIGURES; none where the library refused the values."""
    scenarios: int = 0
    """Number of scenarios on which the estimate rests."""


@dataclass(frozen=True)
class Arm:
    """What one method found."""

    method: Method
    trials: tuple[StudyTrial, ...]
    finalists: tuple[Candidate, ...]
    """Candidates that no race dropped, best first."""


def proposals_of(method: Method, study: StudyConfig, seed: int) -> optuna.Study:
    """Return what a method proposes, from its beginning; methods of one seed draw different numbers."""
    sequence = np.random.SeedSequence([seed, zlib.crc32(method.encode())])
    seed = int(sequence.generate_state(1, np.uint32)[0])
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings(action="ignore", category=optuna.exceptions.ExperimentalWarning):
        samplers: dict[Method, BaseSampler] = {
            "random": RandomSampler(seed),
            "TPE": TPESampler(seed=seed, multivariate=True),
            "CMA-ES": CmaEsSampler(seed=seed, popsize=study.batch, warn_independent_sampling=False),
        }
    return optuna.create_study(sampler=samplers[method])


class CandidateSearch:
    """The races of one study.

    Args:
        study: the study.
        space: its space.
        field: does the missions.
        unchanged: the candidate in which nothing of the space is applied.

    """

    def __init__(self, study: StudyConfig, space: StudySpace, field: MissionField, unchanged: Candidate) -> None:
        self._study, self._space, self._field, self._unchanged = study, space, field, unchanged

    def arm(self, method: Method, seed: int, on_batch: Callable[[Sequence[StudyTrial]], None]) -> Arm:
        """Search by a method; `on_batch` gets all trials so far after each batch."""
        study, proposals = self._study, proposals_of(method, self._study, seed)
        trials: list[StudyTrial] = []
        best: list[Candidate] = []
        while len(trials) < study.trials:
            asked = [
                proposals.ask(self._space.distributions) for _ in range(min(study.batch, study.trials - len(trials)))
            ]
            batch = [self._candidate(f"{method}-{proposal.number + 1}", proposal.params) for proposal in asked]
            able = [candidate for candidate in batch if not self._space.mistake(candidate.goals)]
            best = self._best(race([*best, *able], self._measure(SEARCH), study.race)) if able else best
            for proposal, candidate in zip(asked, batch, strict=True):
                trial = StudyTrial(candidate)
                if candidate in able:
                    means = tuple(self.means(candidate).tolist())
                    trial = StudyTrial(candidate, means, self._field.asked(SEARCH, candidate))
                told = (trial.means[COST], TrialState.COMPLETE) if trial.means else (None, TrialState.FAIL)
                proposals.tell(proposal, *told)
                trials.append(trial)
            on_batch(trials)
        if not best:
            raise DocumentError(f"{study.name}: {method}: the library refused all {len(trials)} candidates")
        return Arm(method, tuple(trials), tuple(best))

    def winner(self, arm: Arm) -> Candidate:
        """Return the winner of the last race, on fresh scenarios: the cheapest."""
        rules = self._study.race
        blocks = -(-self._study.last.scenarios // rules.block)
        measure = self._measure(LAST_RACE)
        left = race(arm.finalists, measure, rules.model_copy(update={"blocks": blocks}))
        count = min(self._field.asked(LAST_RACE, candidate) for candidate in left)
        return left[int(measure(left, count).mean(axis=-1).argmin())]

    def means(self, candidate: Candidate) -> Floats:
        """Return the estimated means (F,) of a candidate on all scenarios of the search."""
        count, rules = self._field.asked(SEARCH, candidate), self._study.race
        own = self._field.figures(SEARCH, [candidate], count)[0]
        reference = self._field.figures(SEARCH, [self._unchanged], rules.block * rules.blocks)[0]
        return estimated(own, reference)

    def _candidate(self, name: str, proposed: Mapping[str, Varied]) -> Candidate:
        dimensions = zip(self._space.names, self._space.dimensions, strict=True)
        values = tuple(dimension.plain(proposed[key]) for key, dimension in dimensions)
        return Candidate(name, self._space.goals_with(values), values)

    def _best(self, left: Iterable[Candidate]) -> list[Candidate]:
        """Return the best of the candidates that are left, at most as many as there are finalists."""
        return sorted(left, key=lambda candidate: float(self.means(candidate)[COST]))[: self._study.last.finalists]

    def _measure(self, stage: str) -> Callable[[Sequence[Candidate], int], Floats]:
        return lambda candidates, count: self._field.figures(stage, candidates, count)[:, COST]


def estimated(own: Floats, reference: Floats) -> Floats:
    """Return the means (F,) that `own` (F, n) would have on all scenarios of a `reference` (F, N).

    >>> estimated(np.array([[2.0, 4.0]]), np.array([[1.0, 2.0, 3.0]])).round(6).tolist()
    [4.0]

    """
    common = reference[:, : own.shape[1]]
    about = common - common.mean(axis=1, keepdims=True)
    spread = (about**2).sum(axis=1)
    slope = np.divide((about * own).sum(axis=1), spread, out=np.zeros(len(own)), where=spread > 0.0)
    means: Floats = own.mean(axis=1) + slope * (reference.mean(axis=1) - common.mean(axis=1))
    return means
