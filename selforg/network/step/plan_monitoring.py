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

from selforg.arrays import Floats, Ints
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
    plan, marks = s.plan[row], s.marks[row]
    index, length = s.plan_marks[row, st.PLAN_INDEX], s.plan_marks[row, st.PLAN_LENGTH]
    due = plan[index] if index < length else -1
    realised = due >= 0 and ran(due, marks) and is_realised(due, model, marks, s.plan_readings[row])
    if realised:
        index += 1
    in_order = True
    for b in range(marks.shape[1]):
        if not marks[st.ENDED, b]:
            continue
        # as in the original, none is in a step in which the due one was realised
        meant = not realised and index < length and plan[index] == b
        if meant:
            while index < length and plan[index] == b:
                index += 1
            for k in range(index, length):
                meant = meant and plan[k] != b
        in_order = in_order and (meant or independent[b] == 1)
    s.plan_marks[row, st.PLAN_INDEX] = index
    return in_order


@inlined
def note_changes(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> bool:
    """Note what changed since the last step; return whether all of it was expected."""
    s = open_states(states)
    readings, seen, marks = s.readings[row], s.plan_readings[row], s.marks[row]
    idle = True
    for b in range(marks.shape[1]):
        idle = idle and not ran(b, marks)
    expected = True
    for sensor in range(readings.shape[0]):
        reading, last = six_decimals(readings[sensor]), seen[st.LAST_STEP, sensor]
        counts = reading != last and is_relevant(sensor, model, marks, s.goal_enabled[row])
        change = reading - last if counts else 0.0
        before = 0.0 if idle else seen[st.SINCE_IDLE, sensor]
        seen[st.TWO_STEPS, sensor] = seen[st.LAST_CHANGE, sensor] + change
        seen[st.LAST_STEP, sensor] = reading
        seen[st.LAST_CHANGE, sensor] = change
        seen[st.SINCE_IDLE, sensor] = six_decimals(before + change)
        expected = expected and (change == 0.0 or was_expected(sensor, change, model, marks))
    return expected


@inlined
def six_decimals(number: float) -> float:
    """Return `number` as the planner writes it. Differences are not rounded, as in the original (M3)."""
    return float(np.rint(number * UNITS) / UNITS)


@inlined
def ran(b: int, marks: Ints) -> bool:
    """Whether behaviour `b` was running until now; here and below marks are those (MARK, B) of a row."""
    return bool(marks[st.EXECUTING, b] == 1 or marks[st.ENDED, b] == 1)


@inlined
def is_relevant(sensor: int, model: Handle[PackedModel], marks: Ints, enabled: Ints) -> bool:
    """Whether a condition of a behaviour that is not optional, or of a goal that is `enabled` (G,), looks at it."""
    m = open_model(model)
    for k in range(m.sensor_wish_first[sensor], m.sensor_wish_first[sensor + 1]):
        wish = m.sensor_wish[k]
        b = m.wish_owner[wish]
        if m.wish_optional[wish]:
            continue
        if marks[st.PRESENT, b] and (m.wish_tag[wish] < 0 or m.wish_tag[wish] == marks[st.ALTERNATIVE, b]):
            return True
    behaviours = marks.shape[1]
    for k in range(m.sensor_goal_wish_first[sensor], m.sensor_goal_wish_first[sensor + 1]):
        if enabled[m.wish_owner[m.sensor_goal_wish[k]] - behaviours]:
            return True
    return False


@inlined
def was_expected(sensor: int, change: float, model: Handle[PackedModel], marks: Ints) -> bool:
    """Whether something that ran has an effect on `sensor` in the direction of `change`."""
    m = open_model(model)
    for k in range(m.sensor_effect_first[sensor], m.sensor_effect_first[sensor + 1]):
        e = m.sensor_effect[k]
        b = m.effect_owner[e]
        shown = m.effect_tag[e] < 0 or m.effect_tag[e] == marks[st.ALTERNATIVE, b]
        if shown and m.effect_change[e] * change > 0.0 and ran(b, marks):
            return True
    return False


@inlined
def is_realised(b: int, model: Handle[PackedModel], marks: Ints, seen: Floats) -> bool:
    """Whether all effects of behaviour `b` count as realised; seen (READING, S) are the changes of the row."""
    m = open_model(model)
    for e in range(m.effect_first[b], m.effect_first[b + 1]):
        if m.effect_tag[e] >= 0 and m.effect_tag[e] != marks[st.ALTERNATIVE, b]:
            continue
        wanted, recent = six_decimals(m.effect_change[e]), seen[st.TWO_STEPS, m.effect_sensor[e]]
        since_idle = seen[st.SINCE_IDLE, m.effect_sensor[e]]
        done = wanted * since_idle > 0.0 and abs(since_idle) >= 0.5 * abs(wanted)
        if not (done if m.strict_progress else wanted >= recent):
            return False
    return True
