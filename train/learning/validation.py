"""Validation: what missions cost on scenarios that no training uses, the best checkpoint, and how both are kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.types import Count
from clean_swarm_env.world.mission import MissionResult
from selector.documents.fields import Closed, Number
from train.deciders.decider import DeciderMaker
from train.running.trials import TrialSettings, run_trials

LEAST_EXCESS = 0.01
"""Excess [s] that counts for less: it has to have a logarithm."""


def judged(result: MissionResult) -> float:
    """Return what learners learn from [s]: the excess, by which tables compare."""
    return max(result.excess_s, LEAST_EXCESS)


def measured(
    scenarios: Mapping[str, Sequence[Scenario]], maker: DeciderMaker, settings: TrialSettings
) -> dict[str, float]:
    """Return means for each family: cost, excess, share of completed missions, duration [s], collision events [1/s]."""
    figures = {}
    for family, some in scenarios.items():
        record = settings.record and replace(settings.record, directory=settings.record.directory / family)
        results = run_trials(some, maker, replace(settings, record=record))
        figures[f"{family}/cost_s"] = float(np.mean([result.cost_s for result in results]))
        figures[f"{family}/excess_s"] = float(np.mean([judged(result) for result in results]))
        figures[f"{family}/completed"] = float(np.mean([result.completed for result in results]))
        figures[f"{family}/duration_s"] = float(np.mean([result.duration_s for result in results]))
        figures[f"{family}/events_per_s"] = float(np.mean([r.collision_events_per_s[0] for r in results]))
    return figures


@dataclass
class CheckpointHistory:
    """Figures of all checkpoints so far, and the best score."""

    entries: list[dict[str, Any]] = field(default_factory=list)
    """One entry for each checkpoint."""
    best: float = float("inf")
    """Lowest score so far."""
    since: int = 0
    """Number of measurements since the best one."""

    def note(self, entry: dict[str, Any], figures: Mapping[str, float]) -> bool:
        """Add a checkpoint's entry and its figures; return whether it is the best so far.

        The score is the mean over families of the logarithm of the excess: families of high costs count no more.
        """
        costs = [value for name, value in figures.items() if name.endswith("/excess_s")]
        score = float(np.mean(np.log(costs))) if costs else float("nan")
        better = bool(costs) and score < self.best
        if costs:
            self.best, self.since = (score, 0) if better else (self.best, self.since + 1)
        self.entries.append({**entry, **figures, "score": score if costs else None, "best": better})
        return better


class CheckpointDescription(Closed):
    """The entries of a checkpoint beside the learned state."""

    checkpoint: Count
    """Number of checkpoints done."""
    decisions: Annotated[int, Field(strict=True, ge=0)]
    """Decisions made so far."""
    history: tuple[dict[str, Any], ...]
    """Figures of the checkpoints."""
    best: Number | None
    """Lowest score so far; None: none."""
    since: Annotated[int, Field(strict=True, ge=0)]
    """Measurements since the best one."""
