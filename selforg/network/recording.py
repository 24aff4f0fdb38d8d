"""Recording: what a network decided, step by step, with everything that an explanation needs.

Make a `Recorder` of a network that is `explained`, and call `record` after each of its steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.network.network import BehaviourNetwork


@dataclass(frozen=True)
class StepRecord:
    """One step of R rows; the layers are those of `state` and `plan_state`.

    Attributes:
        rows: (R,) rows of the network that these are.
        values: (VALUE_LAYERS, R, B) activation, satisfaction and the components of activation.
        marks: (MARK_LAYERS or EXPLAINED_LAYERS, R, B).
        row_values: (ROW_LAYERS, R) thresholds and total activation.
        goal_satisfaction: (R, G).
        goal_enabled: (R, G).
        wishes: (R, U).
        wish_kept: (R, U).
        readings: (R, S) what the sensors read.
        plan: (R, MAX_PLAN) behaviours.
        plan_marks: (PLAN_LAYERS, R).

    """

    rows: Ints
    values: Floats
    marks: Ints
    row_values: Floats
    goal_satisfaction: Floats
    goal_enabled: Ints
    wishes: Floats
    wish_kept: Ints
    readings: Floats
    plan: Ints
    plan_marks: Ints


class Recorder:
    """Copies what a network knows after a step, of all rows or `rows` (K,)."""

    def __init__(self, network: BehaviourNetwork, rows: Ints | None = None) -> None:
        self.network = network
        self.rows = np.arange(network.rows) if rows is None else rows
        self.steps: list[StepRecord] = []

    def record(self) -> StepRecord:
        """Record the last step."""
        state, plans, rows = self.network.state, self.network.plans, self.rows
        record = StepRecord(
            rows=rows,
            values=state.values[:, rows],
            marks=state.marks[:, rows],
            row_values=state.row_values[:, rows],
            goal_satisfaction=state.goal_satisfaction[rows],
            goal_enabled=state.goal_enabled[rows],
            wishes=state.wishes[rows],
            wish_kept=state.wish_kept[rows],
            readings=state.readings[rows],
            plan=plans.steps[rows],
            plan_marks=plans.marks[:, rows],
        )
        self.steps.append(record)
        return record
