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

from selforg.compiled import kernel
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.tables import Floats, Ints, floats_of, ints_of

# plan_marks (PLAN_LAYERS, R)
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
        self.marks: NDArray[np.int64] = np.zeros((PLAN_LAYERS, rows), dtype=np.int64)
        self.readings: NDArray[np.float64] = np.zeros((2, rows, sensors))  # of the last step; change since last idle

    def reset(self, rows: NDArray[np.int64]) -> None:
        """Forget the plans of `rows` (K,)."""
        self.marks[:, rows] = 0
        self.readings[:, rows] = 0.0


@kernel
def is_relevant(row: int, sensor: int, ints: Ints, marks: Ints, goal_enabled: Ints) -> bool:
    """Whether a condition of a behaviour or of a goal that is on looks at `sensor`."""
    first, entry, tag = ints_of(ints, t.SENSOR_WISH_FIRST), ints_of(ints, t.SENSOR_WISH), ints_of(ints, t.WISH_TAG)
    owner = ints_of(ints, t.WISH_OWNER)
    for k in range(first[sensor], first[sensor + 1]):
        b = owner[entry[k]]
        if marks[st.PRESENT, row, b] and (tag[entry[k]] < 0 or tag[entry[k]] == marks[st.ALTERNATIVE, row, b]):
            return True
    first, entry = ints_of(ints, t.SENSOR_GOAL_WISH_FIRST), ints_of(ints, t.SENSOR_GOAL_WISH)
    behaviours = ints_of(ints, t.SIZES)[1]
    for k in range(first[sensor], first[sensor + 1]):  # noqa: SIM110  (compiled code knows no generators)
        if goal_enabled[row, owner[entry[k]] - behaviours]:
            return True
    return False


@kernel
def ran(row: int, b: int, marks: Ints) -> bool:
    """Whether behaviour `b` was running until now."""
    return bool(marks[st.EXECUTING, row, b] == 1 or marks[st.FINISHED, row, b] == 1)


@kernel
def was_expected(row: int, sensor: int, change: float, ints: Ints, floats: Floats, marks: Ints) -> bool:
    """Whether something that ran has an effect on `sensor` in the direction of `change`."""
    first, entry = ints_of(ints, t.SENSOR_EFFECT_FIRST), ints_of(ints, t.SENSOR_EFFECT)
    owner, tag, effect = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_TAG), floats_of(floats, t.EFFECT_CHANGE)
    for k in range(first[sensor], first[sensor + 1]):
        e = entry[k]
        held = tag[e] < 0 or tag[e] == marks[st.ALTERNATIVE, row, owner[e]]
        if held and effect[e] * change > 0.0 and ran(row, owner[e], marks):
            return True
    return False


@kernel
def is_realised(row: int, b: int, ints: Ints, floats: Floats, marks: Ints, change: Floats) -> bool:
    """Whether all effects of behaviour `b` count as realised by `change` (S,)."""
    first, sensor, tag = ints_of(ints, t.EFFECT_FIRST), ints_of(ints, t.EFFECT_SENSOR), ints_of(ints, t.EFFECT_TAG)
    effect, strict = floats_of(floats, t.EFFECT_CHANGE), ints_of(ints, t.OPTIONS)[3]
    for e in range(first[b], first[b + 1]):
        if tag[e] >= 0 and tag[e] != marks[st.ALTERNATIVE, row, b]:
            continue
        seen = change[sensor[e]]
        realised = effect[e] * seen > 0.0 and abs(seen) >= 0.5 * abs(effect[e]) if strict else effect[e] >= seen
        if not realised:
            return False
    return True


@kernel
def see_changes(
    row: int, ints: Ints, floats: Floats, readings: Floats, marks: Ints, goal_enabled: Ints, plan_readings: Floats
) -> bool:
    """Note what changed since the last step; returns whether all of it was expected."""
    idle = True
    for b in range(marks.shape[2]):
        idle = idle and not ran(row, b, marks)
    expected = True
    for sensor in range(readings.shape[1]):
        change = readings[row, sensor] - plan_readings[0, row, sensor]
        plan_readings[0, row, sensor] = readings[row, sensor]
        if idle:
            plan_readings[1, row, sensor] = 0.0
        if change == 0.0 or not is_relevant(row, sensor, ints, marks, goal_enabled):
            continue
        plan_readings[1, row, sensor] += change
        expected = expected and was_expected(row, sensor, change, ints, floats, marks)
    return expected


@kernel
def watch_plan(
    row: int, ints: Ints, floats: Floats, readings: Floats, marks: Ints, goal_enabled: Ints, plan: Ints,
    plan_marks: Ints, plan_readings: Floats,
) -> None:  # fmt: skip
    """Pass the due step of the plan of `row` if it is done, and note whether a new plan is needed.

    Call it before what ended itself is forgotten.
    """
    expected = see_changes(row, ints, floats, readings, marks, goal_enabled, plan_readings)
    index = plan_marks[INDEX, row]
    due = plan[row, index] if index < plan_marks[LENGTH, row] else -1
    alarm = plan_marks[ALARM, row] == 1
    for b in range(marks.shape[2]):
        alarm = alarm or (marks[st.FINISHED, row, b] == 1 and b != due)
    plan_marks[ALARM, row] = 0
    if alarm or not expected or not plan_marks[KNOWN, row]:
        plan_marks[NEEDED, row] = 1
        plan_readings[1, row, :] = 0.0
    elif due >= 0 and ran(row, due, marks):
        done = marks[st.FINISHED, row, due] == 1
        if done or is_realised(row, due, ints, floats, marks, plan_readings[1, row]):
            plan_marks[INDEX, row] = index + 1
