"""The race: candidates do block after block of common scenarios, and those that are clearly worse stop.

Missions of one scenario under two options have hardly more in common than any two, but where scenarios differ in size,
pairs do. The test is Student's of paired differences, one-sided, on costs. It is not
corrected for the number of candidates: a race may lose candidates, as long as the best is rarely among them.
Other tests that were tried: docs/decisions/0172-paired-races.md.

Shapes: C candidates, n scenarios.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np
import scipy.stats
from pydantic import Field

from selector.documents.fields import Closed
from selforg.arrays import Flags, Floats


class RaceConfig(Closed):
    """The race of new candidates, and the best ones before them, over blocks of common scenarios."""

    block: Annotated[int, Field(strict=True, ge=2, le=1000)] = 10
    """Scenarios after which candidates are compared."""
    blocks: Annotated[int, Field(strict=True, ge=1, le=1000)] = 5
    """Largest number of blocks."""
    level: Annotated[float, Field(strict=True, gt=0.0, lt=0.5)] = 0.05
    """A candidate is dropped if it is worse than the best one at this level of a paired one-sided t-test [-]."""


def race(count: int, measure: Callable[[Sequence[int], int], Floats], rules: RaceConfig) -> list[int]:
    """Return the numbers of the candidates that no block showed to be worse than the best one, in their order.

    `measure` returns the costs (C, n) of some candidates on the first n scenarios.
    """
    alive = list(range(count))
    for block in range(1, rules.blocks + 1):
        worse = worse_than_best(measure(alive, block * rules.block), rules.level)
        alive = [candidate for candidate, drop in zip(alive, worse, strict=True) if not drop]
        if len(alive) == 1:
            break
    return alive


def worse_than_best(costs: Floats, level: float) -> Flags:
    """Return which candidates (C,) with costs (C, n) are worse than the one with the lowest mean, at a `level`."""
    best = costs[costs.mean(axis=-1).argmin()]
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # all differences are equal
        p = scipy.stats.ttest_rel(costs, best[None], axis=-1, alternative="greater").pvalue
    return np.asarray(p < level)
