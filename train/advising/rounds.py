"""Rounds of a search: what arms cost on the same starts, and which missions of them are not done.

Shapes: A arms, n starts of a round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats
from train.running.runs import RunKey, RunRecord

CPU = "cpu_ms"
"""Count of a mission: the time of its processor [ms]."""
BROKE = "broke: "
"""Begins the count of missions that a plug-in broke off, before its error."""


def seconds_of(record: RunRecord) -> float:
    """Return the time of a processor that a mission took [s]."""
    return record.counts.get(CPU, 0) / 1000.0


def broke_off(record: RunRecord) -> str:
    """Return why a plug-in broke off a mission; empty if none did."""
    return next((name.removeprefix(BROKE) for name in record.counts if name.startswith(BROKE)), "")


@dataclass(frozen=True)
class Round:
    """What a round measured."""

    title: str
    arms: tuple[str, ...]
    costs: Floats
    """(A, n) excess costs [s]; what a stopped arm did not do is its mean."""
    rewards: Floats
    """(A, n) rewards, likewise."""
    kinds: tuple[str, ...]
    """(n,) kinds of the starts."""

    @property
    def means(self) -> Floats:
        """Mean excess (A,) [s]."""
        return np.asarray(self.costs.mean(axis=1))

    @property
    def order(self) -> list[str]:
        """The arms, the cheapest first."""
        return [self.arms[place] for place in self.means.argsort(kind="stable")]

    @property
    def best_of_kinds(self) -> dict[str, str]:
        """Kind of start -> the cheapest arm on those of the kind."""
        kinds = np.array(self.kinds)
        return {
            kind: self.arms[int(self.costs[:, kinds == kind].mean(axis=1).argmin())]
            for kind in dict.fromkeys(self.kinds)
        }


class Lacking(Exception):
    """Missions are not done: arm -> names of scenarios."""

    def __init__(self, missing: Mapping[str, Sequence[str]]) -> None:
        super().__init__("missions are not done")
        self.missing = missing


def needed(keys: Mapping[str, Sequence[RunKey]], done: Mapping[RunKey, RunRecord]) -> dict[str, list[RunRecord]]:
    """Return arm -> its runs; Lacking if some are not done."""
    missing = {arm: [scenario for scenario, name in own if (scenario, name) not in done] for arm, own in keys.items()}
    if any(missing.values()):
        raise Lacking({arm: own for arm, own in missing.items() if own})
    return {arm: [done[key] for key in own] for arm, own in keys.items()}


def portfolio(done: Round, first: str) -> list[str]:
    """Return arms in the order in which each adds most to the earlier ones, if the best of them is taken at a start."""
    left = [place for place, arm in enumerate(done.arms) if arm != first]
    best = done.costs[done.arms.index(first)] if first in done.arms else np.full(done.costs.shape[1], np.inf)
    order = [first] if first in done.arms else []
    while left:
        place = min(left, key=lambda one: float(np.minimum(best, done.costs[one]).mean()))
        best = np.minimum(best, done.costs[place])
        left.remove(place)
        order.append(done.arms[place])
    return order


def filled_up(values: Sequence[float], count: int) -> list[float]:
    """Return values, and their mean for each that is missing of `count`."""
    return [*values, *[float(np.mean(values))] * (count - len(values))]
