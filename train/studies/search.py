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
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution
from optuna.samplers import BaseSampler, CmaEsSampler, NSGAIISampler, RandomSampler, TPESampler
from optuna.trial import FrozenTrial, TrialState
from ribs.archives import GridArchive
from ribs.emitters import IsoLineEmitter

from selector.documents.errors import DocumentError
from selforg.arrays import Floats
from train.learning.racing import front, race
from train.studies.config import ArchiveConfig, Method, StudyConfig
from train.studies.missions import AVOIDING, COST, DURATION, EVENT_COUNT, LAST_RACE, SEARCH, Candidate, MissionField
from train.studies.space import StudySpace, Varied

MEANS = "means"
"""Attribute of a trial of optuna: estimated means of the figures, in the order of FIGURES."""


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


class ElitesSampler(RandomSampler):  # type: ignore[misc]
    """MAP-Elites (Mouret and Clune 2015, arXiv:1504.04909) by pyribs, on the unit cube of the dimensions.

    Elites vary along the lines between them (Vassiliades and Mouret 2018, doi:10.1145/3205455.3205602).
    """

    def __init__(self, space: StudySpace, study: StudyConfig, seed: int) -> None:
        super().__init__(seed)
        self._dimensions, size = dict(zip(space.names, space.dimensions, strict=True)), len(space.dimensions)
        self._archive = empty_archive(study.archive, size)
        self._emitter = IsoLineEmitter(
            self._archive,
            iso_sigma=0.05,
            line_sigma=0.2,
            initial_solutions=np.random.default_rng(seed).random((study.batch, size)),
            bounds=[(0.0, 1.0)] * size,
            batch_size=study.batch,
            seed=seed,
        )
        self._asked: list[Floats] = []

    def sample_independent(
        self, study: optuna.Study, trial: FrozenTrial, param_name: str, param_distribution: BaseDistribution
    ) -> Any:  # noqa: ANN401  (a value of any dimension)
        """Return one parameter of a trial; the first trial of a batch has the whole batch proposed."""
        if trial.number == len(self._asked):
            self._asked.extend(self._emitter.ask())
        share = self._asked[trial.number][list(self._dimensions).index(param_name)]
        return self._dimensions[param_name].at(float(share))

    def after_trial(
        self, study: optuna.Study, trial: FrozenTrial, state: TrialState, values: Sequence[float] | None
    ) -> None:
        """Add a trial to the archive, unless the library refused it."""
        if values:
            means = trial.user_attrs[MEANS]
            self._archive.add_single(self._asked[trial.number], -values[0], (means[EVENT_COUNT], means[AVOIDING]))


def proposals_of(method: Method, study: StudyConfig, space: StudySpace, seed: int) -> optuna.Study:
    """Return what a method proposes, from its beginning; methods of one seed draw different numbers."""
    sequence = np.random.SeedSequence([seed, zlib.crc32(method.encode())])
    seed = int(sequence.generate_state(1, np.uint32)[0])
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings(action="ignore", category=optuna.exceptions.ExperimentalWarning):
        samplers: dict[Method, BaseSampler] = {
            "random": RandomSampler(seed),
            "TPE": TPESampler(seed=seed, multivariate=True),
            "CMA-ES": CmaEsSampler(seed=seed, popsize=study.batch, warn_independent_sampling=False),
            "NSGA-II": NSGAIISampler(seed=seed, population_size=study.batch),
        }
    sampler = samplers.get(method) or ElitesSampler(space, study, seed)
    return optuna.create_study(sampler=sampler, directions=["minimize"] * study.figures)


def empty_archive(config: ArchiveConfig, size: int) -> GridArchive:
    """Return an archive of solutions of a `size`, with cells of collision events and share of time avoiding."""
    return GridArchive(
        solution_dim=size, dims=[config.cells] * 2, ranges=[(0.0, config.events), (0.0, 1.0)], dtype=np.float64, seed=0
    )


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
        self._counting = [DURATION, EVENT_COUNT] if study.objective == "front" else [COST]

    def arm(self, method: Method, seed: int, on_batch: Callable[[Sequence[StudyTrial]], None]) -> Arm:
        """Search by a method; `on_batch` gets all trials so far after each batch."""
        study, proposals = self._study, proposals_of(method, self._study, self._space, seed)
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
                proposal.set_user_attr(MEANS, trial.means)
                values = [trial.means[k] for k in self._counting] if trial.means else None
                proposals.tell(proposal, values, TrialState.COMPLETE if values else TrialState.FAIL)
                trials.append(trial)
            on_batch(trials)
        if not best:
            raise DocumentError(f"{study.name}: {method}: the library refused all {len(trials)} candidates")
        return Arm(method, tuple(trials), tuple(best))

    def winners(self, arm: Arm) -> list[Candidate]:
        """Return the winners of the last race, on fresh scenarios: the cheapest, or those on the front."""
        rules = self._study.race
        blocks = -(-self._study.last.scenarios // rules.block)
        measure = self._measure(LAST_RACE)
        left = race(arm.finalists, measure, rules.model_copy(update={"blocks": blocks}))
        count = min(self._field.asked(LAST_RACE, candidate) for candidate in left)
        order = front(measure(left, count).mean(axis=-1))
        return [left[k] for k in (order if len(self._counting) > 1 else order[:1])]

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
        candidates, most = list(left), self._study.last.finalists
        means = np.array([self.means(candidate)[self._counting] for candidate in candidates])
        if len(self._counting) == 1:
            return [candidates[k] for k in means[:, 0].argsort(kind="stable")[:most]]
        order = front(means)
        spread = np.unique(np.linspace(0, len(order) - 1, most).round().astype(np.int64))
        return [candidates[k] for k in order[spread]]

    def _measure(self, stage: str) -> Callable[[Sequence[Candidate], int], Floats]:
        return lambda candidates, count: self._field.figures(stage, candidates, count)[:, self._counting]


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
