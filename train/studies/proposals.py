"""The methods of a study: samplers of optuna, each on a study in memory that is asked and told.

Every sampler draws from one seed only and proposes a batch at a time: the order in which missions end has no effect.
"""

from __future__ import annotations

import warnings
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution
from optuna.samplers import BaseSampler, CmaEsSampler, NSGAIISampler, RandomSampler, TPESampler
from optuna.trial import FrozenTrial, TrialState
from ribs.archives import GridArchive
from ribs.emitters import IsoLineEmitter

from selforg.arrays import Floats
from train.studies.config import ArchiveConfig, Method, StudyConfig
from train.studies.missions import AVOIDING, EVENT_COUNT
from train.studies.space import StudySpace

MEANS = "means"
"""Attribute of a trial: estimated means of the figures, in the order of FIGURES."""


class ElitesSampler(BaseSampler):  # type: ignore[misc]
    """MAP-Elites (Mouret and Clune 2015, arXiv:1504.04909) by pyribs, on the unit cube of the dimensions.

    Elites vary along the lines between them (Vassiliades and Mouret 2018, doi:10.1145/3205455.3205602).
    """

    def __init__(self, space: StudySpace, study: StudyConfig, seed: int) -> None:
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

    def infer_relative_search_space(self, study: optuna.Study, trial: FrozenTrial) -> dict[str, BaseDistribution]:
        """Return nothing: each parameter is read from the point of the trial."""
        return {}

    def sample_relative(
        self, study: optuna.Study, trial: FrozenTrial, search_space: dict[str, BaseDistribution]
    ) -> dict[str, Any]:
        """Return nothing; see above."""
        return {}

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
            "MAP-Elites": ElitesSampler(space, study, seed),
        }
    return optuna.create_study(sampler=samplers[method], directions=["minimize"] * study.figures)


def empty_archive(config: ArchiveConfig, size: int) -> GridArchive:
    """Return an archive of solutions of a `size`, with cells of collision events and share of time avoiding."""
    return GridArchive(
        solution_dim=size, dims=[config.cells] * 2, ranges=[(0.0, config.events), (0.0, 1.0)], dtype=np.float64, seed=0
    )
