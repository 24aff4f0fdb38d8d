"""Activation of one row's behaviours: who gets how much from whom (compiled).

The terms are those of Maes ("How to do the right thing", 1989, doi:10.1080/09540098908915643), extended by the paper.
Each is added to its own layer of the state, so that every step can be explained.
"""

from __future__ import annotations

import math

from selforg.compiled import kernel
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.plan_watch import INDEX, LENGTH
from selforg.network.tables import Floats, Ints, floats_of, ints_of


@kernel
def helping(effect: float, wish: float, uniform: int) -> float:
    """How much an effect helps a wish of its own direction."""
    return math.sqrt(effect * effect + wish * wish) if uniform else effect * wish


@kernel
def hindering(effect: float, wish: float, uniform: int) -> float:
    """How much (negative) an effect hurts a wish against it, or, with wish 0, something that should stay as it is.

    The jump to -0.1 at |effect * wish| = 1 is the original's (Q18), as is the sign beyond 1 (Q17).
    """
    if uniform:
        return -math.sqrt(effect * effect + wish * wish)
    if wish == 0.0:
        return -abs(effect)
    product = abs(effect * wish)
    return -0.1 if product == 1.0 else product - 1.0


@kernel
def operational(marks: Ints, row: int, b: int) -> bool:
    """Whether the other behaviours take notice of behaviour `b`."""
    return bool(marks[st.PRESENT, row, b] == 1 and marks[st.ENABLED, row, b] == 1)


@kernel
def total_activation(values: Floats, marks: Ints, row: int) -> float:
    """Activation of all operational behaviours, 1 if there is none."""
    total = 0.0
    for b in range(values.shape[2]):
        if operational(marks, row, b):
            total += values[st.ACTIVATION, row, b]
    return total if total != 0.0 else 1.0


@kernel
def count_effects(ints: Ints, floats: Floats, marks: Ints, row: int, sensor: int) -> tuple[int, int, int]:
    """Operational behaviours with a positive, a negative and any effect on `sensor`."""
    first, entry = ints_of(ints, t.SENSOR_EFFECT_FIRST), ints_of(ints, t.SENSOR_EFFECT)
    owner, tag = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_TAG)
    change = floats_of(floats, t.EFFECT_CHANGE)
    positive, negative, either = 0, 0, 0
    last_positive, last_negative, last = -1, -1, -1  # a behaviour's effects on one sensor follow each other
    for k in range(first[sensor], first[sensor + 1]):
        e = entry[k]
        b = owner[e]
        if change[e] == 0.0 or not operational(marks, row, b):
            continue
        if tag[e] >= 0 and tag[e] != marks[st.ALTERNATIVE, row, b]:
            continue
        if change[e] > 0.0 and b != last_positive:
            positive += 1
            last_positive = b
        if change[e] < 0.0 and b != last_negative:
            negative += 1
            last_negative = b
        if b != last:
            either += 1
            last = b
    return positive, negative, either


@kernel
def count_wishes(ints: Ints, marks: Ints, wishes: Floats, kept: Ints, row: int, sensor: int) -> tuple[int, int]:
    """Operational behaviours that wish more and that wish less of `sensor`."""
    first, entry = ints_of(ints, t.SENSOR_WISH_FIRST), ints_of(ints, t.SENSOR_WISH)
    owner = ints_of(ints, t.WISH_OWNER)
    positive, negative = 0, 0
    last_positive, last_negative = -1, -1
    for k in range(first[sensor], first[sensor + 1]):
        u = entry[k]
        b = owner[u]
        if not kept[row, u] or not operational(marks, row, b):
            continue
        if wishes[row, u] > 0.0 and b != last_positive:
            positive += 1
            last_positive = b
        if wishes[row, u] < 0.0 and b != last_negative:
            negative += 1
            last_negative = b
    return positive, negative


@kernel
def opposing(wish: float, positive: int, negative: int, either: int) -> int:
    """How many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    count = either if wish == 0.0 else (negative if wish > 0.0 else positive)
    return max(count, 1)


@kernel
def weigh_goals(row: int, ints: Ints, floats: Floats, goal_enabled: Ints, weight: Floats) -> None:
    """Fill `weight` (G,): 1, or the priorities of the goals that are on mapped linearly onto [1, 2]."""
    priority = floats_of(floats, t.GOAL_PRIORITY)
    weight[:] = 1.0
    if not ints_of(ints, t.OPTIONS)[2]:
        return
    least, most = math.inf, -math.inf
    for g in range(weight.shape[0]):
        if goal_enabled[row, g]:
            least, most = min(least, priority[g]), max(most, priority[g])
    if most > least:
        for g in range(weight.shape[0]):
            weight[g] += (priority[g] - least) / (most - least)


@kernel
def spread_of_sensor(
    row: int, sensor: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, wishes: Floats, kept: Ints,
    goal_enabled: Ints, goal_weight: Floats, total: float,
) -> None:  # fmt: skip
    """Add what flows over one sensor: from goals to behaviours and between behaviours."""
    first = ints_of(ints, t.SENSOR_EFFECT_FIRST)
    if first[sensor] == first[sensor + 1]:
        return
    entry = ints_of(ints, t.SENSOR_EFFECT)
    owner, tag, change = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_TAG), floats_of(floats, t.EFFECT_CHANGE)
    wish_first, wish_entry = ints_of(ints, t.SENSOR_WISH_FIRST), ints_of(ints, t.SENSOR_WISH)
    goal_first, goal_entry = ints_of(ints, t.SENSOR_GOAL_WISH_FIRST), ints_of(ints, t.SENSOR_GOAL_WISH)
    wish_owner, behaviours = ints_of(ints, t.WISH_OWNER), ints_of(ints, t.SIZES)[1]
    weight = floats_of(floats, t.WEIGHTS)
    uniform = ints_of(ints, t.OPTIONS)[0]
    positive, negative, either = count_effects(ints, floats, marks, row, sensor)
    wish_more, wish_less = count_wishes(ints, marks, wishes, kept, row, sensor)
    for k in range(first[sensor], first[sensor + 1]):
        e = entry[k]
        b = owner[e]
        effect = change[e]
        if not marks[st.PRESENT, row, b] or (tag[e] >= 0 and tag[e] != marks[st.ALTERNATIVE, row, b]):
            continue
        same_effects = max(positive if effect > 0.0 else negative, 1)
        for j in range(goal_first[sensor], goal_first[sensor + 1]):
            u = goal_entry[j]
            goal = wish_owner[u] - behaviours
            wish = wishes[row, u]
            if not goal_enabled[row, goal]:
                continue
            if effect * wish > 0.0:
                share = helping(effect, wish, uniform) * goal_weight[goal] / same_effects
                values[st.GOALS, row, b] += weight[1] * share
            elif effect != 0.0:
                share = hindering(effect, wish, uniform) * goal_weight[goal]
                values[st.INHIBITION, row, b] += weight[2] * share / opposing(wish, positive, negative, either)
        for j in range(wish_first[sensor], wish_first[sensor + 1]):
            u = wish_entry[j]
            q = wish_owner[u]
            wish = wishes[row, u]
            if q == b or not kept[row, u] or not marks[st.PRESENT, row, q]:
                continue
            if effect * wish > 0.0:
                help_ = helping(effect, wish, uniform) / total
                if operational(marks, row, q) and not marks[st.READY, row, q]:
                    share = help_ * values[st.ACTIVATION, row, q] / same_effects
                    values[st.SUCCESSORS, row, b] += weight[4] * share
                if operational(marks, row, b) and marks[st.READY, row, b] and values[st.SATISFACTION, row, b] > 0.0:
                    share = help_ * values[st.ACTIVATION, row, b] / max(wish_more if wish > 0.0 else wish_less, 1)
                    values[st.PREDECESSORS, row, q] += weight[3] * share
            elif effect != 0.0 and operational(marks, row, q):
                share = hindering(effect, wish, uniform) * values[st.ACTIVATION, row, q] / total
                values[st.CONFLICTORS, row, b] += weight[2] * share / opposing(wish, positive, negative, either)


@kernel
def activate_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, wishes: Floats, kept: Ints,
    goal_enabled: Ints, goal_weight: Floats, plan: Ints, plan_marks: Ints,
) -> None:  # fmt: skip
    """Compute the activations of `row`, every term from the old ones.

    `goal_weight` (G,) is scratch; `plan` (R, T) holds behaviours, `plan_marks` where in it the row stands.
    """
    sensors, behaviours = ints_of(ints, t.SIZES)[0], ints_of(ints, t.SIZES)[1]
    weight, dynamics = floats_of(floats, t.WEIGHTS), floats_of(floats, t.DYNAMICS)
    total = total_activation(values, marks, row)
    row_values[st.TOTAL, row] = total
    for b in range(behaviours):
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            values[layer, row, b] = 0.0
        values[st.PRECONDITIONS, row, b] = weight[0] * values[st.SATISFACTION, row, b]
    weigh_goals(row, ints, floats, goal_enabled, goal_weight)
    for sensor in range(sensors):
        spread_of_sensor(row, sensor, ints, floats, values, marks, wishes, kept, goal_enabled, goal_weight, total)
    index, length = plan_marks[INDEX, row], plan_marks[LENGTH, row]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        values[st.PLAN, row, plan[row, k]] = weight[5] / (k - index + 1)
    for b in range(behaviours):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[layer, row, b]
        values[st.ACTIVATION, row, b] = max(0.0, dynamics[0] * values[st.ACTIVATION, row, b] + step)
