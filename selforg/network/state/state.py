"""What a network remembers of its rows: layers of arrays, each (R, B) or (R, G), so that kernels get few arguments.

`VALUES` layers are float64, `MARKS` layers int64. The names below are the layers' indices. In memory all layers of a
row lie together, as kernels go from row to row: they take the `_table`s, rows first; the views of the same memory
without `_table` have the layers first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.decorators import kernel
from selforg.network.model.packed import Floats, Ints

# values (VALUE_LAYERS, R, B), value_table (R, VALUE_LAYERS, B)
(
    ACTIVATION,
    SATISFACTION,
    PRECONDITIONS,  # from here on: the components of the last step's activation
    GOALS,
    INHIBITION,
    PREDECESSORS,
    SUCCESSORS,
    CONFLICTORS,
    PLAN,
    VALUE_LAYERS,
) = range(10)

COMPONENTS = {
    "preconditions": PRECONDITIONS,
    "goals": GOALS,
    "goal_inhibition": INHIBITION,
    "predecessors": PREDECESSORS,
    "successors": SUCCESSORS,
    "conflictors": CONFLICTORS,
    "plan": PLAN,
}

# marks (MARK_LAYERS, R, B), mark_table (R, MARK_LAYERS, B)
(
    PRESENT,  # part of the network at all
    ENABLED,
    EXECUTING,
    EXECUTION_TIME,  # steps since it started, -1: not running
    READY,
    STARTED,  # in the last step
    STOPPED,  # in the last step
    FINISHED,  # ended itself since the last step
    MANUAL,  # started by hand: skips the checks and is never stopped
    PRIORITY,
    ALTERNATIVE,  # which of its alternatives it holds, -1: none
    REASON,  # why it runs or does not, see `reasons`; this and the next layer exist only in an explained network
    BY,  # the behaviour that the reason is about, -1: none
    EXPLAINED_LAYERS,
) = range(14)
MARK_LAYERS = REASON

# row_values (ROW_LAYERS, R), row_table (R, ROW_LAYERS)
(
    THRESHOLD,
    TOTAL,  # activation of all operational behaviours before the last step
    DECIDING,  # the threshold by which the last step decided
    ROW_LAYERS,
) = range(4)


class NetworkState:
    """State arrays of R rows of a network with B behaviours, G goals and U wishes; `explained`: reasons are noted."""

    def __init__(self, rows: int, behaviours: int, goals: int, wishes: int, explained: bool = False) -> None:
        layers = EXPLAINED_LAYERS if explained else MARK_LAYERS
        self.value_table: NDArray[np.float64] = np.zeros((rows, VALUE_LAYERS, behaviours))
        self.mark_table: NDArray[np.int64] = np.zeros((rows, layers, behaviours), dtype=np.int64)
        self.row_table: NDArray[np.float64] = np.zeros((rows, ROW_LAYERS))
        self.values: NDArray[np.float64] = self.value_table.swapaxes(0, 1)
        self.marks: NDArray[np.int64] = self.mark_table.swapaxes(0, 1)
        self.row_values: NDArray[np.float64] = self.row_table.T
        self.goal_satisfaction: NDArray[np.float64] = np.zeros((rows, goals))
        self.goal_enabled: NDArray[np.int64] = np.ones((rows, goals), dtype=np.int64)
        self.wishes: NDArray[np.float64] = np.zeros((rows, wishes))
        self.wish_kept: NDArray[np.int64] = np.zeros((rows, wishes), dtype=np.int64)


@kernel
def reset_rows(
    rows: Ints, priorities: Ints, threshold: float, values: Floats, marks: Ints, row_values: Floats,
    goal_satisfaction: Floats, goal_enabled: Ints, wishes: Floats, kept: Ints, plan_marks: Ints, plan_readings: Floats,
) -> None:  # fmt: skip
    """Back to the first step for `rows` (K,): nothing runs, nothing is activated, known or planned, all goals are on.

    The arrays are those of `NetworkState` and `PlanState`, rows first.
    """
    for row in rows:
        values[row] = 0.0
        marks[row] = 0
        marks[row, PRESENT] = 1
        marks[row, ENABLED] = 1
        marks[row, EXECUTION_TIME] = -1
        for b in range(len(priorities)):  # one by one: a slice assigned to a slice takes two seconds to compile
            marks[row, PRIORITY, b] = priorities[b]
        row_values[row] = 0.0
        row_values[row, THRESHOLD] = row_values[row, DECIDING] = threshold
        goal_satisfaction[row] = 0.0
        goal_enabled[row] = 1
        wishes[row] = 0.0
        kept[row] = 0
        plan_marks[row] = 0
        plan_readings[row] = 0.0
