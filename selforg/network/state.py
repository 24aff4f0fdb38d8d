"""The state of a network: what its rows (robots) know between two steps, and the numbers of the last step.

Values and marks of a row have layers, one for each quantity below. All layers of a row lie together in memory, because
compiled code goes from row to row: it takes the tables, with the rows first. Python code takes `values`, `marks` and
`row_values`, views of the same memory with the layers first: `state.marks[EXECUTING]` is (R, B).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, Floats, Ints
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Recording, Words, Written
from selforg.network import state as st
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.plan_state import RowPlans, open_plans

# layers of values
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

# layers of marks
(
    PRESENT,  # part of the network at all
    ENABLED,
    EXECUTING,
    EXECUTION_TIME,  # steps since it started, -1: not running
    READY,
    STARTED,  # in the last step
    STOPPED,  # in the last step
    ENDED,  # ended itself since the last step
    MANUAL,  # started by hand: nothing is checked and nothing stops it
    PRIORITY,
    ALTERNATIVE,  # which of its alternatives it holds, -1: none
    REASON,  # why it runs or does not, see `reasons`; this and the next layer exist only in an explained network
    BY,  # the behaviour that the reason is about, -1: none
    EXPLAINED_LAYERS,
) = range(14)
MARK_LAYERS = REASON

# layers of row_values
(
    THRESHOLD,
    TOTAL,  # activation of all operational behaviours before the last step
    DECIDING,  # the threshold by which the last step decided
    ROW_LAYERS,
) = range(4)


class RowStates(NamedTuple):
    """What compiled code reads and writes of R rows; S sensors, B behaviours, G goals, U wishes."""

    readings: Annotated[Floats, "R S", KEPT]  # what the sensors read now; facts 0 or 1
    values: Annotated[Floats, "R VALUE B", KEPT]  # activation, satisfaction and the terms of activation
    marks: Annotated[Ints, "R MARK B", KEPT]
    row_values: Annotated[Floats, "R ROW", KEPT]  # thresholds and total activation
    goal_satisfaction: Annotated[Floats, "R G", KEPT]
    goal_enabled: Annotated[Ints, "R G", KEPT]  # 1 while a goal is on
    wishes: Annotated[Floats, "R U", KEPT]  # signed change that is wanted
    wish_kept: Annotated[Ints, "R U", KEPT]  # 0: of another alternative, or a smaller wish about the same sensor counts


ROW_STATES = Recording(RowStates)
open_states = ROW_STATES.open


class NetworkState:
    """The state of R rows; in an `explained` network with the reasons of arbitration. `RowStates` names the arrays."""

    def __init__(self, rows: int, model: PackedModel, explained: bool = False) -> None:
        sensors, behaviours = len(model.is_fact), len(model.priority)
        goals, wishes = len(model.goal_permanent), len(model.wish_owner)
        layers = EXPLAINED_LAYERS if explained else MARK_LAYERS
        self.readings: Floats = np.zeros((rows, sensors))
        self.value_table: Floats = np.zeros((rows, VALUE_LAYERS, behaviours))
        self.mark_table: Ints = np.zeros((rows, layers, behaviours), dtype=np.int64)
        self.row_table: Floats = np.zeros((rows, ROW_LAYERS))
        self.goal_satisfaction: Floats = np.zeros((rows, goals))
        self.goal_enabled: Ints = np.ones((rows, goals), dtype=np.int64)
        self.wishes: Floats = np.zeros((rows, wishes))
        self.wish_kept: Ints = np.zeros((rows, wishes), dtype=np.int64)
        self.packed = ROW_STATES.pack(
            RowStates(
                readings=self.readings,
                values=self.value_table,
                marks=self.mark_table,
                row_values=self.row_table,
                goal_satisfaction=self.goal_satisfaction,
                goal_enabled=self.goal_enabled,
                wishes=self.wishes,
                wish_kept=self.wish_kept,
            )
        )

    @property
    def values(self) -> Floats:
        """(VALUE_LAYERS, R, B) view of `value_table`."""
        return self.value_table.swapaxes(0, 1)

    @property
    def explained(self) -> bool:
        """Whether there is room for the reasons of arbitration."""
        return bool(self.mark_table.shape[1] == EXPLAINED_LAYERS)

    @property
    def marks(self) -> Ints:
        """(MARK_LAYERS or EXPLAINED_LAYERS, R, B) view of `mark_table`."""
        return self.mark_table.swapaxes(0, 1)

    @property
    def row_values(self) -> Floats:
        """(ROW_LAYERS, R) view of `row_table`."""
        return self.row_table.T


@kernel
def reset_rows(rows: Ints, model: Words[PackedModel], states: Written[RowStates], plans: Written[RowPlans]) -> None:
    """Clear `rows` (K,): nothing runs, nothing is activated, known or planned, all goals are on; readings stay."""
    m, s, p = open_model(model), open_states(states), open_plans(plans)
    for row in rows:
        s.values[row] = 0.0
        s.marks[row] = 0
        s.marks[row, st.PRESENT] = 1
        s.marks[row, st.ENABLED] = 1
        s.marks[row, st.EXECUTION_TIME] = -1
        for b in range(len(m.priority)):  # one by one, because a slice assigned to a slice takes two seconds to compile
            s.marks[row, st.PRIORITY, b] = m.priority[b]
        s.row_values[row] = 0.0
        s.row_values[row, st.THRESHOLD] = s.row_values[row, st.DECIDING] = m.activation_threshold
        s.goal_satisfaction[row] = 0.0
        s.goal_enabled[row] = 1
        s.wishes[row] = 0.0
        s.wish_kept[row] = 0
        p.marks[row] = 0
        p.readings[row] = 0.0
