"""The report of an evaluation on a family: the content of `summary.json` and the figures of the tables.

Shapes: S members of a strategy (one for each seed of its training), K scenarios, V world seeds of each.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

from clean_swarm_env.config.types import AVOIDANCE
from selector.documents.trust import BASELINE
from train.analysis.intervals import Ratio
from train.analysis.runs import COST, Report, Runs
from train.analysis.strategy_comparison import StrategyComparison, compare_strategies
from train.analysis.task_report import by_strategy
from train.analysis.verdict import RANDOM, Ranking, unfinished_sentence

NEVER_AVOIDS = "fixed:Off"
"""Label of the strategy that never avoids."""
EXCESS = "excess_s"


@dataclass(frozen=True)
class FamilyReport(Report):
    """All results of an evaluation on a family; the strategies are in the order of their excess."""

    summarised: ClassVar[tuple[str, ...]] = (
        *(COST, EXCESS, "duration_s", "events", "events_per_s", "contact_s", "items", "completed"),
    )

    @classmethod
    def of(cls, runs: Runs) -> Self:
        """Return the report on runs."""
        return cls(replace(runs, conditions={label: runs.conditions[label] for label in ranking_of(runs).labels}))

    @cached_property
    def comparison(self) -> StrategyComparison | None:
        """None without fixed options to compare with."""
        runs = self.runs
        return compare_strategies(runs.table(EXCESS), runs.fixed, runs.censored) if runs.fixed else None

    @cached_property
    def ranking(self) -> Ranking:
        """The strategies by their excess."""
        return ranking_of(self.runs)

    @property
    def compared(self) -> str:
        """What is compared: the excess, or the cost where they are the same."""
        return "cost" if all(own[EXCESS] == own[COST] for own in self.summaries.values()) else "excess"

    @property
    def verdict(self) -> list[str]:
        """What came out, in one to three sentences."""
        runs = self.runs
        tried = [label for label in runs.conditions if RANDOM in runs.conditions and label not in (*runs.fixed, RANDOM)]
        found = self.ranking.sentences((NEVER_AVOIDS, BASELINE, RANDOM), tried)
        return [*found, *filter(None, [unfinished_sentence(runs.unfinished, self.ranking, self.runs.task.missed[1])])]

    @property
    def content(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        runs, comparison = self.runs, self.comparison
        content: dict[str, Any] = {
            "family": runs.document.name,
            "goal": runs.goal,
            "scenarios": runs.scenarios,
            "worlds": len(runs.names[0]),
            "seed": runs.seed,
            "strategies": self.summary,
            **by_strategy(self.measured),
        }
        if comparison is not None:
            content["best_fixed"] = comparison.best_fixed.labels
            content["gap"] = None if comparison.gap is None else asdict(comparison.gap)
            content["comparison"] = [
                {**asdict(standing), "ratio": standing.ratio.content} for standing in comparison.standings
            ]
        return content


def ranking_of(runs: Runs) -> Ranking:
    """Return the strategies by their excess; the worlds of a scenario count as one."""
    off = "never avoiding" if AVOIDANCE in runs.goal else "Off"
    return Ranking.of(runs.table(EXCESS), left=runs.censored, spoken={NEVER_AVOIDS: off})


def ratio_of(runs: Runs, label: str, to: str) -> Ratio:
    """Return the ratio of the mean excess of a strategy to that of another."""
    return Ratio.between(label, to, runs.table(EXCESS), runs.censored)
