"""The report of strategies under disturbances: completion, duration and collisions, each with its interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from selforg.arrays import Floats
from train.analysis.family_report import NEVER_AVOIDS
from train.analysis.intervals import Estimate, share_interval
from train.analysis.runs import Runs
from train.analysis.verdict import RANDOM, Ranking, amount, interval_words

ROBUSTNESS_FIGURES = {"completed": "completed", "duration_s": "duration_s", "collision_events": "events"}
"""Share of missions completed, duration or time limit [s], and collision events of a mission at the first distance;
their names in `figures_of`."""


@dataclass(frozen=True)
class RobustnessReport:
    """All results of an evaluation under disturbances."""

    robustness: FamilyConfig
    seed: int
    scenarios: int
    """K."""
    estimates: Mapping[str, Mapping[str, Mapping[str, Estimate]]]
    """Disturbance -> label of a strategy -> figure of ROBUSTNESS_FIGURES -> its mean and interval."""

    def worst(self, label: str) -> str:
        """Return the disturbance under which a strategy completes fewest missions, then takes longest."""
        own = {name: by_label[label] for name, by_label in self.estimates.items()}
        return min(own, key=lambda name: (own[name]["completed"].value, -own[name]["duration_s"].value))

    def verdict(self, ranking: Ranking) -> list[str]:
        """Return what came out, in a few sentences; `ranking` as `durations_over` gives it."""
        best = ranking.labels[0]
        worst = self.worst(best)
        found = self.estimates[worst][best]
        share = f"{found['completed'].value:.0%}{interval_words(found['completed'].ci95, '{:.0%}'.format)}"
        return [
            *ranking.sentences((NEVER_AVOIDS, RANDOM)),
            f"{ranking.name(best)} is hit hardest by {worst}: {share} of its missions completed, "
            f"{amount(found['duration_s'].value)} s a mission.",
        ]

    @property
    def content(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        return {
            "experiment": self.robustness.name,
            "seed": self.seed,
            "scenarios": self.scenarios,
            "disturbances": {
                name: {
                    label: {figure: asdict(estimate) for figure, estimate in own.items()}
                    for label, own in by_label.items()
                }
                for name, by_label in self.estimates.items()
            },
        }

    @classmethod
    def of(cls, runs: Runs) -> RobustnessReport:
        """Compute everything from the runs; means over members and worlds count once a scenario."""
        family, estimates = runs.document, {}
        assert isinstance(family, FamilyConfig)
        for name in family.variants:
            tables = [runs.within(name).table(figure) for figure in ROBUSTNESS_FIGURES.values()]
            estimates[name] = {
                label: _estimates(*(table[label].mean(axis=2) for table in tables)) for label in runs.conditions
            }
        return cls(family, runs.seed, runs.scenarios, estimates)


def durations_over(runs: Runs) -> Ranking:
    """Rank strategies by their mean duration over all disturbances, and without any."""
    variants = [runs.within(name) for name in runs.document.variants]
    times, left = [own.table("duration_s") for own in variants], [own.censored for own in variants]
    values, lost = (
        {label: np.concatenate([table[label] for table in each], axis=2) for label in each[0]} for each in (times, left)
    )
    return Ranking.of(values, "takes", left=lost)


def _estimates(completed: Floats, durations: Floats, events: Floats) -> dict[str, Estimate]:
    """Return the figures of S members on K scenarios, each (S, K)."""
    share = float(completed.mean())
    found = (Estimate(share, share_interval(share, completed.shape[1])), Estimate.of(durations), Estimate.of(events))
    return dict(zip(ROBUSTNESS_FIGURES, found, strict=True))
