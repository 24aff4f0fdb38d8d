"""The state of plans: which plan each row follows, how far, and its readings since."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, Floats, Ints
from selforg.compiler.records import Recording

# layers of marks
(
    INDEX,  # of the step that is due
    LENGTH,
    KNOWN,  # the last attempt found a plan
    ALARM,  # something happened that asks for a new plan
    NEEDED,  # this step needs a new plan
    PLAN_LAYERS,
) = range(6)

LAST_STEP, LAST_CHANGE, TWO_STEPS, SINCE_IDLE, READING_LAYERS = range(5)
"""Layers of readings, with six decimals: those of the last step; what changed in the last step, in the last two, and
since nothing ran or a plan was asked for."""

UNITS = 1e6
"""The planner compares numbers with six decimals."""

MAX_PLAN = 64


class RowPlans(NamedTuple):
    """What compiled code reads and writes of the plans of R rows; S sensors."""

    planned: int  # 1 if a planner answers
    steps: Annotated[Ints, "R MAX_PLAN", KEPT]  # behaviours in their order
    marks: Annotated[Ints, "R PLAN", KEPT]
    readings: Annotated[Floats, "R READING S", KEPT]
    keys: Annotated[Ints, "R KEY", KEPT]  # what the plan of a row depends on, see `planning.memory`


ROW_PLANS = Recording(RowPlans)
open_plans = ROW_PLANS.open


class PlanState:
    """The plans of R rows; `RowPlans` names the arrays."""

    def __init__(self, rows: int, sensors: int, planned: bool = False, key_words: int = 0) -> None:
        self.steps: Ints = np.zeros((rows, MAX_PLAN), dtype=np.int64)
        self.mark_table: Ints = np.zeros((rows, PLAN_LAYERS), dtype=np.int64)
        self.readings: Floats = np.zeros((rows, READING_LAYERS, sensors))
        self.keys: Ints = np.zeros((rows, key_words), dtype=np.int64)
        self.packed = ROW_PLANS.pack(RowPlans(int(planned), self.steps, self.mark_table, self.readings, self.keys))

    @property
    def marks(self) -> Ints:
        """(PLAN_LAYERS, R) view of `mark_table`."""
        return self.mark_table.T

    def set(self, row: int, behaviours: Sequence[int] | None, index: int) -> None:
        """Give `row` a plan (None: there is none) of which step `index` is due.

        Raises:
            ValueError: a plan of more than MAX_PLAN steps.

        """
        steps = behaviours or ()
        if len(steps) > MAX_PLAN:
            raise ValueError(f"a plan holds at most {MAX_PLAN} steps, got {len(steps)}")
        self.steps[row, : len(steps)] = steps
        self.mark_table[row, INDEX] = index
        self.mark_table[row, LENGTH] = len(steps)
        self.mark_table[row, KNOWN] = int(behaviours is not None)
