"""How a plan is followed: when its next step is due and when a new plan is needed (compiled).

A new plan is needed when there is none, when the world changed in a way that nothing running was expected to bring
about, when a behaviour timed out or one that the plan did not ask for ended itself, and when the network itself
changed.

The step that is due is passed when its behaviour ran and all its effects count as realised. As in the original (Q22),
an effect counts as realised when it is not below the change seen since the robot last stood idle: a positive effect at
once, a negative one only after the change. `strict_progress` asks for a change of the effect's own sign and at least
half its size instead.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.packed import Floats, Ints, begin_of, float_begin_of
from selforg.network.state import state as st

# marks (PLAN_LAYERS, R), mark_table (R, PLAN_LAYERS)
(
    INDEX,  # of the step that is due
    LENGTH,
    KNOWN,  # the last attempt found a plan
    ALARM,  # something happened that asks for a new plan
    NEEDED,  # this step needs a new plan
    PLAN_LAYERS,
) = range(6)

MAX_PLAN = 64


class PlanState:
    """What a network remembers about the plans of its R rows; S sensors."""

    def __init__(self, rows: int, sensors: int) -> None:
        self.steps: NDArray[np.int64] = np.zeros((rows, MAX_PLAN), dtype=np.int64)
        self.mark_table: NDArray[np.int64] = np.zeros((rows, PLAN_LAYERS), dtype=np.int64)
        self.marks: NDArray[np.int64] = self.mark_table.T
        self.readings: NDArray[np.float64] = np.zeros((rows, 2, sensors))  # of the last step; change since last idle


@inlined
def is_relevant(row: int, sensor: int, ints: Ints, marks: Ints, goal_enabled: Ints) -> bool:
    """Whether a condition of a behaviour or of a goal that is on looks at `sensor`."""
    owner, tag = begin_of(ints, t.WISH_OWNER), begin_of(ints, t.WISH_TAG)
    first, entry = begin_of(ints, t.SENSOR_WISH_FIRST) + sensor, begin_of(ints, t.SENSOR_WISH)
    for k in range(ints[first], ints[first + 1]):
        wish = ints[entry + k]
        b, held = ints[owner + wish], ints[tag + wish]
        if marks[row, st.PRESENT, b] and (held < 0 or held == marks[row, st.ALTERNATIVE, b]):
            return True
    first, entry = begin_of(ints, t.SENSOR_GOAL_WISH_FIRST) + sensor, begin_of(ints, t.SENSOR_GOAL_WISH)
    behaviours = marks.shape[2]
    for k in range(ints[first], ints[first + 1]):
        if goal_enabled[row, ints[owner + ints[entry + k]] - behaviours]:
            return True
    return False


@inlined
def ran(row: int, b: int, marks: Ints) -> bool:
    """Whether behaviour `b` was running until now."""
    return bool(marks[row, st.EXECUTING, b] == 1 or marks[row, st.FINISHED, b] == 1)


@inlined
def was_expected(row: int, sensor: int, change: float, ints: Ints, floats: Floats, marks: Ints) -> bool:
    """Whether something that ran has an effect on `sensor` in the direction of `change`."""
    first, entry = begin_of(ints, t.SENSOR_EFFECT_FIRST) + sensor, begin_of(ints, t.SENSOR_EFFECT)
    owner, tag = begin_of(ints, t.EFFECT_OWNER), begin_of(ints, t.EFFECT_TAG)
    effect = float_begin_of(floats, t.EFFECT_CHANGE)
    for k in range(ints[first], ints[first + 1]):
        e = ints[entry + k]
        b, held = ints[owner + e], ints[tag + e]
        shown = held < 0 or held == marks[row, st.ALTERNATIVE, b]
        if shown and floats[effect + e] * change > 0.0 and ran(row, b, marks):
            return True
    return False


@inlined
def is_realised(row: int, b: int, ints: Ints, floats: Floats, marks: Ints, plan_readings: Floats) -> bool:
    """Whether all effects of behaviour `b` count as realised by the change since the row last stood idle."""
    first, sensor, tag = begin_of(ints, t.EFFECT_FIRST), begin_of(ints, t.EFFECT_SENSOR), begin_of(ints, t.EFFECT_TAG)
    effect, strict = float_begin_of(floats, t.EFFECT_CHANGE), ints[begin_of(ints, t.OPTIONS) + 3]
    for e in range(ints[first + b], ints[first + b + 1]):
        if ints[tag + e] >= 0 and ints[tag + e] != marks[row, st.ALTERNATIVE, b]:
            continue
        seen, wanted = plan_readings[row, 1, ints[sensor + e]], floats[effect + e]
        realised = wanted * seen > 0.0 and abs(seen) >= 0.5 * abs(wanted) if strict else wanted >= seen
        if not realised:
            return False
    return True


@inlined
def see_changes(
    row: int, ints: Ints, floats: Floats, readings: Floats, marks: Ints, goal_enabled: Ints, plan_readings: Floats
) -> bool:
    """Note what changed since the last step; returns whether all of it was expected."""
    idle = True
    for b in range(marks.shape[2]):
        idle = idle and not ran(row, b, marks)
    expected = True
    for sensor in range(readings.shape[1]):
        change = readings[row, sensor] - plan_readings[row, 0, sensor]
        plan_readings[row, 0, sensor] = readings[row, sensor]
        if idle:
            plan_readings[row, 1, sensor] = 0.0
        if change == 0.0 or not is_relevant(row, sensor, ints, marks, goal_enabled):
            continue
        plan_readings[row, 1, sensor] += change
        expected = expected and was_expected(row, sensor, change, ints, floats, marks)
    return expected


@inlined
def watch_plan(
    row: int, ints: Ints, floats: Floats, readings: Floats, marks: Ints, goal_enabled: Ints, plan: Ints,
    plan_marks: Ints, plan_readings: Floats,
) -> None:  # fmt: skip
    """Pass the due step of the plan of `row` if it is done, and note whether a new plan is needed.

    Call it before what ended itself is forgotten.
    """
    expected = see_changes(row, ints, floats, readings, marks, goal_enabled, plan_readings)
    index = plan_marks[row, INDEX]
    due = plan[row, index] if index < plan_marks[row, LENGTH] else -1
    alarm = plan_marks[row, ALARM] == 1
    for b in range(marks.shape[2]):
        alarm = alarm or (marks[row, st.FINISHED, b] == 1 and b != due)
    plan_marks[row, ALARM] = 0
    if alarm or not expected or not plan_marks[row, KNOWN]:
        plan_marks[row, NEEDED] = 1
        for sensor in range(readings.shape[1]):
            plan_readings[row, 1, sensor] = 0.0
    elif due >= 0 and ran(row, due, marks):
        done = marks[row, st.FINISHED, due] == 1
        if done or is_realised(row, due, ints, floats, marks, plan_readings):
            plan_marks[row, INDEX] = index + 1
