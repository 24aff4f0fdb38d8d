"""Plan monitoring: when the next step of a plan is due and when a new plan is needed (compiled).

The rules are those of the original (`M1` to `M6`, found from its recorded traces;
docs/decisions/0054-plan-monitoring.md). A new plan is needed when

- there is none, or the network itself changed;
- a sensor changed in a way that nothing running was expected to bring about. Sensors that only optional conditions read
  do not count (M1), nor do changes that six decimals do not show (M2);
- a behaviour was stopped because its time was up (M6);
- a behaviour ended itself that was not due, or ends while the plan holds it again later; planner-independent ones never
  ask for a plan (M5).

The step that is due is passed when its behaviour ended itself, with all equal steps that follow (several that end in
one step pass theirs one after the other, M5), or when it ran and all its effects count as realised: an effect that is
not below the change of this step and the one before (M3). A positive effect is therefore realised at once, a negative
one only after the change (Q22). `strict_progress` asks for a change of the effect's own sign and at least half its size
instead, summed up since the robot last stood idle.
"""

from __future__ import annotations

import numpy as np

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import RowStates, open_states

UNITS = 1e6
"""The planner compares numbers with six decimals."""


@inlined
def monitor_plan(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Pass the due step of the plan of `row` if it is done, and note whether a new plan is needed.

    Call it before the marks of behaviours that ended themselves are cleared.
    """
    expected = note_changes(row, model, states)
    s = open_states(states)
    in_order = pass_steps(row, model, states)
    if s.plan_marks[row, st.PLAN_ALARM] == 1 or not expected or not in_order or not s.plan_marks[row, st.PLAN_KNOWN]:
        s.plan_marks[row, st.PLAN_NEEDED] = 1
        for sensor in range(s.plan_readings.shape[2]):
            s.plan_readings[row, st.SINCE_IDLE, sensor] = 0.0
    s.plan_marks[row, st.PLAN_ALARM] = 0


@inlined
def pass_steps(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> bool:
    """Pass what is done of the plan of `row`; return whether all that ended itself was meant to."""
    s, independent = open_states(states), open_model(model).independent
    index, length = s.plan_marks[row, st.PLAN_INDEX], s.plan_marks[row, st.PLAN_LENGTH]
    due = s.plan[row, index] if index < length else -1
    realised = due >= 0 and ran(row, due, s.marks) and is_realised(row, due, model, states)
    if realised:
        index += 1
    in_order = True
    for b in range(s.marks.shape[2]):
        if not s.marks[row, st.ENDED, b]:
            continue
        # as in the original, none is in a step in which the due one was realised
        meant = not realised and index < length and s.plan[row, index] == b
        if meant:
            while index < length and s.plan[row, index] == b:
                index += 1
            for k in range(index, length):
                meant = meant and s.plan[row, k] != b
        in_order = in_order and (meant or independent[b] == 1)
    s.plan_marks[row, st.PLAN_INDEX] = index
    return in_order


@inlined
def note_changes(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> bool:
    """Note what changed since the last step; return whether all of it was expected."""
    s = open_states(states)
    seen = s.plan_readings
    idle = True
    for b in range(s.marks.shape[2]):
        idle = idle and not ran(row, b, s.marks)
    expected = True
    for sensor in range(s.readings.shape[1]):
        reading, last = six_decimals(s.readings[row, sensor]), seen[row, st.LAST_STEP, sensor]
        counts = reading != last and is_relevant(row, sensor, model, states)
        change = reading - last if counts else 0.0
        before = 0.0 if idle else seen[row, st.SINCE_IDLE, sensor]
        seen[row, st.TWO_STEPS, sensor] = seen[row, st.LAST_CHANGE, sensor] + change
        seen[row, st.LAST_STEP, sensor] = reading
        seen[row, st.LAST_CHANGE, sensor] = change
        seen[row, st.SINCE_IDLE, sensor] = six_decimals(before + change)
        expected = expected and (change == 0.0 or was_expected(row, sensor, change, model, states))
    return expected


@inlined
def six_decimals(number: float) -> float:
    """Return `number` as the planner writes it. Differences are not rounded, as in the original (M3)."""
    return float(np.rint(number * UNITS) / UNITS)


@inlined
def ran(row: int, b: int, marks: Ints) -> bool:
    """Whether behaviour `b` was running until now."""
    return bool(marks[row, st.EXECUTING, b] == 1 or marks[row, st.ENDED, b] == 1)


@inlined
def is_relevant(row: int, sensor: int, model: Handle[PackedModel], states: Handle[RowStates]) -> bool:
    """Whether a condition of a behaviour that is not optional, or of a goal that is on, looks at `sensor`."""
    m, s = open_model(model), open_states(states)
    for k in range(m.sensor_wish_first[sensor], m.sensor_wish_first[sensor + 1]):
        wish = m.sensor_wish[k]
        b = m.wish_owner[wish]
        if m.wish_optional[wish]:
            continue
        if s.marks[row, st.PRESENT, b] and (
            m.wish_tag[wish] < 0 or m.wish_tag[wish] == s.marks[row, st.ALTERNATIVE, b]
        ):
            return True
    behaviours = s.marks.shape[2]
    for k in range(m.sensor_goal_wish_first[sensor], m.sensor_goal_wish_first[sensor + 1]):
        if s.goal_enabled[row, m.wish_owner[m.sensor_goal_wish[k]] - behaviours]:
            return True
    return False


@inlined
def was_expected(row: int, sensor: int, change: float, model: Handle[PackedModel], states: Handle[RowStates]) -> bool:
    """Whether something that ran has an effect on `sensor` in the direction of `change`."""
    m, marks = open_model(model), open_states(states).marks
    for k in range(m.sensor_effect_first[sensor], m.sensor_effect_first[sensor + 1]):
        e = m.sensor_effect[k]
        b = m.effect_owner[e]
        shown = m.effect_tag[e] < 0 or m.effect_tag[e] == marks[row, st.ALTERNATIVE, b]
        if shown and m.effect_change[e] * change > 0.0 and ran(row, b, marks):
            return True
    return False


@inlined
def is_realised(row: int, b: int, model: Handle[PackedModel], states: Handle[RowStates]) -> bool:
    """Whether all effects of behaviour `b` count as realised."""
    m, s = open_model(model), open_states(states)
    for e in range(m.effect_first[b], m.effect_first[b + 1]):
        if m.effect_tag[e] >= 0 and m.effect_tag[e] != s.marks[row, st.ALTERNATIVE, b]:
            continue
        wanted, recent = six_decimals(m.effect_change[e]), s.plan_readings[row, st.TWO_STEPS, m.effect_sensor[e]]
        since_idle = s.plan_readings[row, st.SINCE_IDLE, m.effect_sensor[e]]
        seen = wanted * since_idle > 0.0 and abs(since_idle) >= 0.5 * abs(wanted)
        if not (seen if m.strict_progress else wanted >= recent):
            return False
    return True
