"""Plan monitoring: when the next step of a plan is due and when a new plan is needed (compiled).

A new plan is needed when there is none, when the world changed in a way that nothing running was expected to bring
about, when a behaviour timed out or one that the plan did not ask for ended itself, and when the network itself
changed.

The step that is due is passed when its behaviour ran and all its effects count as realised. As in the original (Q22),
an effect counts as realised when it is not below the change seen since the robot last stood idle: a positive effect at
once, a negative one only after the change. `strict_progress` asks for a change of the effect's own sign and at least
half its size instead.
"""

from __future__ import annotations

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Words
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import plan_state as ps
from selforg.network.state import state as st
from selforg.network.state.plan_state import RowPlans, open_plans
from selforg.network.state.state import RowStates, open_states


@inlined
def monitor_plan(row: int, model: Words[PackedModel], states: Words[RowStates], plans: Words[RowPlans]) -> None:
    """Pass the due step of the plan of `row` if it is done, and note whether a new plan is needed.

    Call it before the marks of what ended itself are cleared.
    """
    expected = see_changes(row, model, states, plans)
    p, marks = open_plans(plans), open_states(states).marks
    steps, plan_marks, seen = p.steps, p.marks, p.readings
    index = plan_marks[row, ps.INDEX]
    due = steps[row, index] if index < plan_marks[row, ps.LENGTH] else -1
    alarm = plan_marks[row, ps.ALARM] == 1
    for b in range(marks.shape[2]):
        alarm = alarm or (marks[row, st.ENDED, b] == 1 and b != due)
    plan_marks[row, ps.ALARM] = 0
    if alarm or not expected or not plan_marks[row, ps.KNOWN]:
        plan_marks[row, ps.NEEDED] = 1
        for sensor in range(seen.shape[2]):
            seen[row, ps.SINCE_IDLE, sensor] = 0.0
    elif due >= 0 and ran(row, due, marks):
        done = marks[row, st.ENDED, due] == 1
        if done or is_realised(row, due, model, states, plans):
            plan_marks[row, ps.INDEX] = index + 1


@inlined
def see_changes(row: int, model: Words[PackedModel], states: Words[RowStates], plans: Words[RowPlans]) -> bool:
    """Note what changed since the last step; return whether all of it was expected."""
    s, seen = open_states(states), open_plans(plans).readings
    readings, marks = s.readings, s.marks
    idle = True
    for b in range(marks.shape[2]):
        idle = idle and not ran(row, b, marks)
    expected = True
    for sensor in range(readings.shape[1]):
        change = readings[row, sensor] - seen[row, ps.LAST_STEP, sensor]
        seen[row, ps.LAST_STEP, sensor] = readings[row, sensor]
        if idle:
            seen[row, ps.SINCE_IDLE, sensor] = 0.0
        if change == 0.0 or not is_relevant(row, sensor, model, states):
            continue
        seen[row, ps.SINCE_IDLE, sensor] += change
        expected = expected and was_expected(row, sensor, change, model, states)
    return expected


@inlined
def ran(row: int, b: int, marks: Ints) -> bool:
    """Whether behaviour `b` was running until now."""
    return bool(marks[row, st.EXECUTING, b] == 1 or marks[row, st.ENDED, b] == 1)


@inlined
def is_relevant(row: int, sensor: int, model: Words[PackedModel], states: Words[RowStates]) -> bool:
    """Whether a condition of a behaviour, or of a goal that is on, looks at `sensor`."""
    m, s = open_model(model), open_states(states)
    owner, tag, marks = m.wish_owner, m.wish_tag, s.marks
    first, about = m.sensor_wish_first, m.sensor_wish
    goal_first, about_goals, enabled = m.sensor_goal_wish_first, m.sensor_goal_wish, s.goal_enabled
    for k in range(first[sensor], first[sensor + 1]):
        wish = about[k]
        b = owner[wish]
        if marks[row, st.PRESENT, b] and (tag[wish] < 0 or tag[wish] == marks[row, st.ALTERNATIVE, b]):
            return True
    behaviours = marks.shape[2]
    for k in range(goal_first[sensor], goal_first[sensor + 1]):
        if enabled[row, owner[about_goals[k]] - behaviours]:
            return True
    return False


@inlined
def was_expected(row: int, sensor: int, change: float, model: Words[PackedModel], states: Words[RowStates]) -> bool:
    """Whether something that ran has an effect on `sensor` in the direction of `change`."""
    m, marks = open_model(model), open_states(states).marks
    first, effects = m.sensor_effect_first, m.sensor_effect
    owner, tag, effect = m.effect_owner, m.effect_tag, m.effect_change
    for k in range(first[sensor], first[sensor + 1]):
        e = effects[k]
        b = owner[e]
        shown = tag[e] < 0 or tag[e] == marks[row, st.ALTERNATIVE, b]
        if shown and effect[e] * change > 0.0 and ran(row, b, marks):
            return True
    return False


@inlined
def is_realised(row: int, b: int, model: Words[PackedModel], states: Words[RowStates], plans: Words[RowPlans]) -> bool:
    """Whether all effects of behaviour `b` count as realised by the change since the row last stood idle."""
    m, marks, readings = open_model(model), open_states(states).marks, open_plans(plans).readings
    first, sensor, tag = m.effect_first, m.effect_sensor, m.effect_tag
    effect, strict = m.effect_change, m.strict_progress
    for e in range(first[b], first[b + 1]):
        if tag[e] >= 0 and tag[e] != marks[row, st.ALTERNATIVE, b]:
            continue
        seen, wanted = readings[row, ps.SINCE_IDLE, sensor[e]], effect[e]
        realised = wanted * seen > 0.0 and abs(seen) >= 0.5 * abs(wanted) if strict else wanted >= seen
        if not realised:
            return False
    return True
