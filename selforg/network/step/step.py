"""One decision of some rows, compiled as a whole: evaluate, follow the plan, activate, arbitrate."""

from collections.abc import Callable

import numpy as np

from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.network.model import packed as t
from selforg.network.model.packed import Floats, Ints, ints_of
from selforg.network.planning.memory import recall, write_key
from selforg.network.state import state as st
from selforg.network.step import plan_monitoring as pw
from selforg.network.step.activation import activate_row
from selforg.network.step.arbitration import arbitrate_row
from selforg.network.step.plan_monitoring import watch_plan
from selforg.network.step.readings import find_wrong
from selforg.network.step.satisfaction import evaluate_row
from selforg.network.step.sharing import COUNTS

SENSE_AND_DECIDE, DECIDE = range(2)


def scratch_of(ints: Ints) -> tuple[Floats, Ints, Floats, Ints]:
    """Return what the step of a model needs for its own use: leaves (2, L), counts (COUNTS, S), floats and ints."""
    sensors, behaviours, goals, nodes, wishes = ints_of(ints, t.SIZES).tolist()
    effects, leaves = len(ints_of(ints, t.EFFECT_OWNER)), len(ints_of(ints, t.LEAF_SENSOR))
    whole = np.empty(effects + wishes + 3 * behaviours, np.int64)
    return np.empty((2, leaves)), np.empty((COUNTS, sensors), np.int64), np.empty(nodes + goals), whole


# ints, floats of the model; readings (R, S); value, mark and row table, goal satisfaction and enabled, wishes and kept
# of the state; steps, mark table and readings of the plans; layout and entries of the plan memory, keys (R, K); what
# `scratch_of` returns
Tables = tuple[
    Ints, Floats, Floats, Floats, Ints, Floats, Floats, Ints, Floats, Ints, Ints, Ints, Floats, Ints, Ints, Ints,
    Floats, Ints, Floats, Ints,
]  # fmt: skip
STEP_TABLES = Layout(
    "i1", "f1", "f2", "f3", "i3", "f2", "f2", "i2", "f2", "i2", "i2", "i2", "f3", "i1", "i2", "i2", "f2", "i2", "f1",
    "i1",
)  # fmt: skip
tables_of: Callable[[Bundle], Tables] = STEP_TABLES.unbundle


@lean_kernel
def step_rows(rows: Ints, tables: Bundle, phase: int, planning: bool, guarantee: bool) -> int:
    """Step `rows` (K,); return how many of them need a plan that is not remembered and have not decided yet.

    For a wrong reading return -1 - (what `find_wrong` says), with nothing changed.
    """
    (
        ints, floats, readings, values, marks, row_values, goal_satisfaction, goal_enabled, wishes, kept, plan,
        plan_marks, plan_readings, key_layout, remembered, keys, leaves, counts, numbers, whole,
    ) = tables_of(tables)  # fmt: skip
    if phase == SENSE_AND_DECIDE:
        wrong = find_wrong(rows, ints, readings)
        if wrong >= 0:
            return -1 - wrong
    behaviours, nodes = values.shape[2], numbers[: t.size_of(ints, t.NODE_KIND)]
    goal_weight = numbers[t.size_of(ints, t.NODE_KIND) :]
    heard, counted, order = (
        whole[:behaviours],
        whole[behaviours : 2 * behaviours],
        whole[2 * behaviours : 3 * behaviours],
    )
    effects = t.size_of(ints, t.EFFECT_OWNER)
    live, live_wish = whole[3 * behaviours : 3 * behaviours + effects], whole[3 * behaviours + effects :]
    missing = 0
    for k in range(rows.shape[0]):
        row = rows[k]
        if phase == SENSE_AND_DECIDE:
            evaluate_row(
                row, ints, floats, readings, values, marks, goal_satisfaction, goal_enabled, wishes, kept, leaves, nodes
            )
            if planning:
                watch_plan(row, ints, floats, readings, marks, goal_enabled, plan, plan_marks, plan_readings)
            forget_finished(row, values, marks)
            if planning and plan_marks[row, pw.NEEDED]:
                write_key(row, key_layout, readings, marks, goal_enabled, keys)
                if not recall(row, keys, remembered, plan, plan_marks):
                    missing += 1
                    continue
                plan_marks[row, pw.NEEDED] = 0
        activate_row(
            row, ints, floats, values, marks, row_values, wishes, kept, goal_enabled, plan, plan_marks, goal_weight,
            heard, live, live_wish, counts,
        )  # fmt: skip
        timed_out = arbitrate_row(row, ints, floats, values, marks, row_values, guarantee, counted, order)
        if timed_out:
            plan_marks[row, pw.ALARM] = 1
    return missing


@inlined
def forget_finished(row: int, values: Floats, marks: Ints) -> None:
    """Take the activation from what ended itself; what was stopped keeps it (Q15)."""
    for b in range(values.shape[2]):
        if marks[row, st.FINISHED, b]:
            marks[row, st.FINISHED, b] = 0
            values[row, st.ACTIVATION, b] = 0.0
