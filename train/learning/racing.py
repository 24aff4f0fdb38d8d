"""The race: candidates do block after block of common scenarios, and those that are clearly worse stop.

Missions of one scenario under two options have hardly more in common than any two (docs/tuning.md), but where scenarios
differ in size, pairs do. The test is Student's of paired differences, one-sided, on the figures that count. It is not
corrected for the number of candidates: a race may lose candidates, as long as the best is rarely among them.
Other tests that were tried: docs/decisions/0172-fresh-scenarios.md.

Shapes: C candidates, J figures that count, n scenarios.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Annotated, TypeVar

import numpy as np
import scipy.stats
from pydantic import Field

from selector.documents.fields import Closed
from selforg.arrays import Flags, Floats, Ints

C = TypeVar("C")
Measuring = Callable[[Sequence[C], int], Floats]
"""Returns the figures that count (C, J, n) of candidates on the first n scenarios."""


class RaceConfig(Closed):
    """The race of new candidates, and the best ones before them, over blocks of common scenarios."""

    block: Annotated[int, Field(strict=True, ge=2, le=1000)] = 10
    """Scenarios after which candidates are compared."""
    blocks: Annotated[int, Field(strict=True, ge=1, le=1000)] = 5
    """Largest number of blocks."""
    level: Annotated[float, Field(strict=True, gt=0.0, lt=0.5)] = 0.05
    """A candidate is dropped if it is worse than the best one at this level of a paired one-sided t-test [-]."""


def race(candidates: Sequence[C], measure: Measuring[C], rules: RaceConfig) -> list[C]:
    """Return the candidates that no block showed to be worse than the best ones, in their order."""
    alive = list(candidates)
    for block in range(1, rules.blocks + 1):
        worse = worse_than_best(measure(alive, block * rules.block), rules.level)
        alive = [candidate for candidate, drop in zip(alive, worse, strict=True) if not drop]
        if len(alive) == 1:
            break
    return alive


def worse_than_best(figures: Floats, level: float) -> Flags:
    """Return which candidates (C,) are worse in every figure (C, J, n) than one that is not dominated, at a `level`."""
    worse = np.zeros(len(figures), dtype=np.bool_)
    for best in front(figures.mean(axis=-1)):
        with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # all differences are equal
            p = scipy.stats.ttest_rel(figures, figures[best][None], axis=-1, alternative="greater").pvalue
        worse |= (p < level).all(axis=-1)
    return worse


def front(means: Floats) -> Ints:
    """Return the candidates whose means (C, J) no other candidate's dominate, in the order of the first figure.

    >>> front(np.array([[3.0, 1.0], [1.0, 2.0], [3.0, 2.0]])).tolist()
    [1, 0]

    """
    others, own = means[None], means[:, None]
    dominated = np.all(others <= own, axis=-1) & np.any(others < own, axis=-1)  # (C, C)
    best = np.flatnonzero(~np.any(dominated, axis=1))
    order: Ints = best[np.argsort(means[best, 0], kind="stable")]
    return order
