"""The methods of a study, which propose values and are told what these brought.

Every method draws from one seed only and proposes a batch at a time: the order in which missions end has no effect.
"""

from __future__ import annotations

import warnings
import zlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution, IntDistribution
from optuna.samplers import BaseSampler, CmaEsSampler, NSGAIISampler, RandomSampler, TPESampler
from optuna.trial import TrialState
from ribs.archives import GridArchive
from ribs.emitters import IsoLineEmitter

from train.studies.config import MAP_ELITES, ArchiveConfig, Choices, Method, StudyConfig
from train.studies.space import Dimension, StudySpace, Varied


@dataclass(frozen=True)
class Feedback:
    """What values brought."""

    values: tuple[float, ...]
    """What is minimised; empty where the library refused the values."""
    events: float = 0.0
    """Mean number of collision events."""
    avoiding: float = 0.0
    """Mean share of time spent avoiding [-]."""


class Proposer(ABC):
    """A method at work; `ask` and `tell` take turns."""

    @abstractmethod
    def ask(self, count: int) -> list[tuple[Varied, ...]]:
        """Return values to try, in the order of the dimensions."""

    @abstractmethod
    def tell(self, feedback: Sequence[Feedback]) -> None:
        """Learn from what the values asked for last brought, in their order."""


class _OptunaProposer(Proposer):
    """A sampler of optuna on a study in memory."""

    def __init__(self, sampler: BaseSampler, space: StudySpace, objectives: int) -> None:
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self._space = space
        self._distributions = distributions(space)
        self._study = optuna.create_study(sampler=sampler, directions=["minimize"] * objectives)
        self._asked: list[optuna.Trial] = []

    def ask(self, count: int) -> list[tuple[Varied, ...]]:
        self._asked = [self._study.ask(self._distributions) for _ in range(count)]
        return [
            tuple(
                one.plain(trial.params[name])
                for name, one in zip(self._space.names, self._space.dimensions, strict=True)
            )
            for trial in self._asked
        ]

    def tell(self, feedback: Sequence[Feedback]) -> None:
        for trial, brought in zip(self._asked, feedback, strict=True):
            if brought.values:
                self._study.tell(trial, brought.values)
            else:
                self._study.tell(trial, state=TrialState.FAIL)


class _ElitesProposer(Proposer):
    """MAP-Elites (Mouret and Clune 2015, arXiv:1504.04909) by pyribs, on the unit cube of the dimensions.

    Elites vary along the lines between them (Vassiliades and Mouret 2018, doi:10.1145/3205455.3205602).
    """

    def __init__(self, space: StudySpace, study: StudyConfig, seed: int) -> None:
        self._dimensions, size = space.dimensions, len(space.dimensions)
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

    def ask(self, count: int) -> list[tuple[Varied, ...]]:
        self._asked = self._emitter.ask()[:count]
        return [tuple(one.at(x) for one, x in zip(self._dimensions, row, strict=True)) for row in self._asked.tolist()]

    def tell(self, feedback: Sequence[Feedback]) -> None:
        good = [k for k, brought in enumerate(feedback) if brought.values]
        if good:
            measures = [(feedback[k].events, feedback[k].avoiding) for k in good]
            self._archive.add(self._asked[good], [-feedback[k].values[0] for k in good], measures)


def proposer_of(method: Method, study: StudyConfig, space: StudySpace, seed: int) -> Proposer:
    """Return a method of a study at its beginning; methods of one seed draw different numbers."""
    sequence = np.random.SeedSequence([seed, zlib.crc32(method.encode())])
    seed = int(sequence.generate_state(1, np.uint32)[0])
    if method == MAP_ELITES:
        return _ElitesProposer(space, study, seed)
    with warnings.catch_warnings(action="ignore", category=optuna.exceptions.ExperimentalWarning):
        samplers: dict[Method, BaseSampler] = {
            "random": RandomSampler(seed),
            "TPE": TPESampler(seed=seed, multivariate=True),
            "CMA-ES": CmaEsSampler(seed=seed, popsize=study.batch, warn_independent_sampling=False),
            "NSGA-II": NSGAIISampler(seed=seed, population_size=study.batch),
        }
    return _OptunaProposer(samplers[method], space, study.figures)


def empty_archive(config: ArchiveConfig, size: int) -> GridArchive:
    """Return an archive of solutions of a `size`, with cells of collision events and share of time avoiding."""
    return GridArchive(
        solution_dim=size, dims=[config.cells] * 2, ranges=[(0.0, config.events), (0.0, 1.0)], dtype=np.float64, seed=0
    )


def distributions(space: StudySpace) -> dict[str, BaseDistribution]:
    """Return the dimensions as optuna describes them, by name."""
    return {name: _distribution(one) for name, one in zip(space.names, space.dimensions, strict=True)}


def _distribution(dimension: Dimension) -> BaseDistribution:
    given = dimension.values
    if isinstance(given, Choices):
        return CategoricalDistribution(given.choices)
    if given.whole:
        return IntDistribution(int(given.low), int(given.high), log=given.log)
    return FloatDistribution(given.low, given.high, log=given.log)
