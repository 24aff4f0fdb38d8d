"""What an advice has found: what to hold, what it saves beside what one would do else, and what may be gained yet.

Only the last round makes claims, on starts that chose nothing. Its ratios are of mean excess costs. Whether something
gains is told by sign flips, corrected by Holm for all that might (`train.analysis`); that nothing does, by the best end
of every interval. Between them the verdict is that it is not known.

Shapes: K starts of the last round, V worlds of each.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from clean_swarm_env.config.families import scenario_name
from selforg.arrays import Floats
from train.advising import perturbed
from train.advising.advice import Advising
from train.advising.rounds import seconds_of
from train.advising.search import AdviceSearch, SearchResult, held_by
from train.analysis.family_report import EXCESS, ratio_of
from train.analysis.flips import ALPHA
from train.analysis.intervals import TOLD, Ratio, corrected_ps
from train.analysis.runs import Runs
from train.analysis.strategy_comparison import BestFixed, cross_fitted
from train.analysis.verdict import RANDOM
from train.evaluation.evaluation import Done
from train.running.runs import RunRecord

HINDSIGHTS = ("hindsight", "by_kind")
"""Properties of the findings: what would be gained by knowing what is best."""
TENTH = 1.0 - math.exp(-TOLD)
"""Gain below which it is not worth it to train a selector [-]: a difference of a tenth, as in `TOLD`."""
WORTH_LEARNING = 0.05
"""Gain of the best combination of each start, in hindsight, from which on training a selector may be worth it [-]."""


@dataclass(frozen=True)
class Findings:
    """What was found for a mission.

    Attributes:
        evaluation, search, found: what was asked, what was done, what came out.
        runs: the last round, of the arms that did all starts.
        stopped: arm that was stopped in the last round -> missions that it left unfinished.

    """

    evaluation: Advising
    search: AdviceSearch
    found: SearchResult
    runs: Runs
    stopped: Mapping[str, int]

    @classmethod
    def of(cls, evaluation: Advising, done: Done) -> Self:
        """Return what an evaluation has found whose missions are all done."""
        search = evaluation.search(done)
        found = search.run()
        going, stopped = evaluation.judged(found, done)
        names, arms = ((scenario_name("test", k),) for k in range(found.starts)), {arm: (arm,) for arm in going}
        seed, records = evaluation.request.seed, list(done.values())
        runs = Runs(evaluation.family, evaluation.goal, seed, tuple(names), arms, records)
        return cls(evaluation, search, found, runs, stopped)

    @property
    def held(self) -> dict[str, str]:
        """Goal -> the option to hold."""
        return held_by(self.evaluation.opened, self.found.winner)

    @cached_property
    def costs(self) -> dict[str, Floats]:
        """Arm -> excess (1, K, 1) of its missions [s]."""
        return self.runs.table(EXCESS)

    def ratio(self, arm: str) -> Ratio:
        """Return the ratio of an arm's mean excess to that of the best."""
        return ratio_of(self.runs, arm, self.found.winner)

    @cached_property
    def hindsight(self) -> Ratio | None:
        """The ratio of the best combination of each start to the best of all, of the same combinations.

        The former is chosen in one world of a start and judged in another, the latter on the other half of the starts.
        """
        finalists = [arm for arm in self.found.finalists if arm in self.costs]
        if len(finalists) < 2:
            return None
        names = [[scenario_name("test", k, world) for world in range(2)] for k in range(self.found.starts)]
        both = {
            arm: np.array([[[self.search.done[name, arm].result.excess_s for name in own] for own in names]])
            for arm in finalists
        }
        best = BestFixed.of(both, finalists).judged(both)
        return Ratio.of(cross_fitted(np.concatenate([*both.values()]))[None, :, None], best.mean(axis=2, keepdims=True))

    @cached_property
    def kinds(self) -> list[str]:
        """The kinds (K,) of the starts."""
        return [self.evaluation.kind(scenario_name("test", k)) for k in range(self.found.starts)]

    @cached_property
    def best_of_kinds(self) -> dict[str, str]:
        """Kind of start -> the arm that the search found for it; the best of all for a kind that it did not meet."""
        return {kind: self.found.kinds.get(kind, self.found.winner) for kind in sorted(set(self.kinds))}

    @cached_property
    def robustness(self) -> perturbed.Robustness | None:
        """What the arms of the last round cost in perturbed worlds, if asked."""
        return self.evaluation.robustness(self.found.winner, list(self.costs), self.search.done)

    @cached_property
    def by_kind(self) -> Ratio | None:
        """The ratio of the best of each kind to the best of all, where kinds are asked for."""
        if not self.evaluation.kinds:
            return None
        own = [self.costs[self.best_of_kinds[kind]][0, k, 0] for k, kind in enumerate(self.kinds)]
        return Ratio.of(np.array(own), self.costs[self.found.winner][0, :, 0])

    @cached_property
    def claims(self) -> dict[str, tuple[Ratio, float | None]]:
        """What might gain, and its p-value corrected for all of them: rules and policies that ship, and what is best.

        The latter two by the names of their properties: of each start, and of each kind.
        """
        found = {arm: self.ratio(arm) for arm in self.found.choosers if arm in self.costs}
        found |= {name: one for name in HINDSIGHTS if (one := getattr(self, name)) is not None}
        return dict(zip(found, zip(found.values(), corrected_ps(list(found.values())), strict=True), strict=True))

    @property
    def better(self) -> list[str]:
        """Rules and policies that are shown to beat the best combination, the best first."""
        shown = [arm for arm, told in self.claims.items() if arm not in HINDSIGHTS and shown_cheaper(*told)]
        return sorted(shown, key=lambda arm: self.claims[arm][0].ratio or 0.0)

    @property
    def gains(self) -> bool:
        """Whether the best combination of each start, or of each kind, is shown to gain something worth while."""
        told = [self.claims[name] for name in HINDSIGHTS if name in self.claims]
        return any(shown_cheaper(one, p) and (one.ratio or 1.0) <= 1.0 - WORTH_LEARNING for one, p in told)

    @property
    def most(self) -> float:
        """What may be gained at most, by the best ends of all intervals [-]; all where nothing was compared."""
        ends = [one.ci95[0] if one.ci95 else 0.0 for one, _ in self.claims.values()]
        return 1.0 - min(ends, default=0.0)

    @property
    def worth_it(self) -> bool | None:
        """Whether changing the choice on the way pays; None if that is not known."""
        if self.better or self.gains:
            return None if self.unjudged else True
        return False if self.most < TENTH else None

    @property
    def unjudged(self) -> str:
        """Why the best that is held is not what a selector must beat; empty where it is."""
        if self.search.left_out:
            return f"{len(self.search.left_out)} options were not tried"
        by_chance = self.ratio(RANDOM) if RANDOM in self.costs else None
        cheaper = by_chance is not None and shown_cheaper(by_chance, by_chance.p)
        return "a random choice costs less than what is held" if cheaper else ""

    @property
    def budgeted(self) -> list[RunRecord]:
        """The missions that the budget is for."""
        return [run for run in self.search.done.values() if perturbed.IN_WORLD not in run.condition]

    @property
    def content(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        return {
            "mission": self.evaluation.family.name,
            "held": self.held,
            "starts": self.found.starts,
            "excess_s": {arm: float(own.mean()) for arm, own in self.costs.items()},
            "ratios": {arm: self.ratio(arm).content for arm in self.costs if arm != self.found.winner},
            "hindsight": None if self.hindsight is None else self.hindsight.content,
            "kinds": self.best_of_kinds if self.evaluation.kinds else {},
            "by_kind": None if self.by_kind is None else self.by_kind.content,
            "robust": None if self.robustness is None else self.robustness.content,
            "stopped": dict(self.stopped),
            "better": self.better,
            "worth_it": self.worth_it,
            "missions": len(self.search.done),
            "cpu_s": round(sum(map(seconds_of, self.search.done.values())), 1),
        }


def shown_cheaper(ratio: Ratio, p: float | None) -> bool:
    """Return whether a ratio is shown to be below 1, by its corrected p-value and by its interval."""
    return p is not None and p < ALPHA and ratio.ci95 is not None and ratio.ci95[1] < 1.0
