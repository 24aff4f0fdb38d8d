"""Resetting rows to the state before their first step (compiled)."""

from __future__ import annotations

from selforg.arrays import Ints
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Words, Written
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import state as st
from selforg.network.state.plan_state import RowPlans, open_plans
from selforg.network.state.state import RowStates, open_states


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
