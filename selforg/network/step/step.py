"""One step of some rows, compiled as a whole: its stages, in the order of docs/network.md."""

from __future__ import annotations

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined, long_kernel
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.network.model.packed import SENSE_AND_DECIDE, PackedModel, Scratch, open_scratch
from selforg.network.planning.memory import KnownPlans, recall, write_key
from selforg.network.state import RowStates, open_states
from selforg.network.step.activation import activate_row, share_row
from selforg.network.step.arbitration import arbitrate_row
from selforg.network.step.plan_monitoring import monitor_plan
from selforg.network.step.readings import find_wrong
from selforg.network.step.satisfaction import satisfy_row


@long_kernel
def step_rows(
    now: float,
    rows: Ints,
    model: Handle[PackedModel],
    states: Written[RowStates],
    known: Handle[KnownPlans],
    scratch: Handle[Scratch],
) -> int:
    """Step `rows` (K,); return how many of them need a plan that is not known and have not decided yet.

    If a reading is wrong, nothing is changed, and the result is -1 - (what `find_wrong` returns). This is a step, see
    `selforg.program`.
    """
    phase, guarantee = open_scratch(scratch).phase, open_scratch(scratch).guarantee > 0
    if phase == SENSE_AND_DECIDE:
        wrong = find_wrong(rows, model, states)
        if wrong >= 0:
            return -1 - wrong
    missing = 0
    for k in range(rows.shape[0]):
        row = rows[k]
        if phase == SENSE_AND_DECIDE:
            satisfy_row(row, model, states, scratch)
            if not follow_plan(row, model, states, known):
                missing += 1
                continue
        share_row(row, model, states, scratch)
        activate_row(row, model, states, scratch)
        if arbitrate_row(row, model, states, scratch, guarantee):
            open_states(states).plan_marks[row, st.PLAN_ALARM] = 1
    return missing


@inlined
def follow_plan(row: int, model: Handle[PackedModel], states: Written[RowStates], known: Handle[KnownPlans]) -> bool:
    """Bring the plan of `row` up to date; return False if it needs one that is not known."""
    s = open_states(states)
    if s.planned:
        monitor_plan(row, model, states)
    clear_ended(row, states)
    if s.planned and s.plan_marks[row, st.PLAN_NEEDED]:
        write_key(row, states, known)
        if not recall(row, states, known):
            return False
        s.plan_marks[row, st.PLAN_NEEDED] = 0
    return True


@inlined
def clear_ended(row: int, states: Written[RowStates]) -> None:
    """Set the activation of behaviours that ended themselves to 0; stopped ones keep theirs (Q15)."""
    values, marks = open_states(states).values[row], open_states(states).marks[row]
    for b in range(marks.shape[1]):
        if marks[st.ENDED, b]:
            marks[st.ENDED, b] = 0
            values[st.ACTIVATION, b] = 0.0
