"""Activation of one row's behaviours: who gets how much from whom (compiled).

The terms are those of Maes ("How to do the right thing", 1989, doi:10.1080/09540098908915643), extended by the paper.
Each is added to its own layer of the state, so that every step can be explained. Which effect meets which wish is known
when the model is built (`tables`, pairs); a step only walks those pairs.
"""

from __future__ import annotations

import math

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.packed import Floats, Ints, begin_of, float_begin_of, size_of
from selforg.network.state import state as st
from selforg.network.step.plan_monitoring import INDEX, LENGTH
from selforg.network.step.sharing import (
    count_effects,
    count_wishes,
    find_live,
    helpers,
    operational,
    opponents,
    wishers,
)


@inlined
def helping(effect: float, wish: float, uniform: int) -> float:
    """How much an effect helps a wish of its own direction."""
    return math.sqrt(effect * effect + wish * wish) if uniform else effect * wish


@inlined
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


@inlined
def weigh_goals(row: int, ints: Ints, floats: Floats, enabled: Ints, weight: Floats) -> None:
    """Fill `weight` (G,): 1, or the priorities of the goals that are on mapped linearly onto [1, 2]."""
    for g in range(weight.shape[0]):
        weight[g] = 1.0
    if not ints[begin_of(ints, t.OPTIONS) + 2]:
        return
    priority = float_begin_of(floats, t.GOAL_PRIORITY)
    least, most = math.inf, -math.inf
    for g in range(weight.shape[0]):
        if enabled[row, g]:
            least, most = min(least, floats[priority + g]), max(most, floats[priority + g])
    if most > least:
        for g in range(weight.shape[0]):
            weight[g] += (floats[priority + g] - least) / (most - least)


@inlined
def flow_from_goals(
    row: int, ints: Ints, floats: Floats, values: Floats, wishes: Floats, live: Ints, counts: Ints, enabled: Ints,
    goal_weight: Floats,
) -> None:  # fmt: skip
    """Add what goals give to the behaviours of `row` whose effects meet their wishes; `live` (E,), `enabled` (R, G)."""
    pair_effect, pair_wish = begin_of(ints, t.GOAL_PAIR_EFFECT), begin_of(ints, t.GOAL_PAIR_WISH)
    owner, sensors = begin_of(ints, t.EFFECT_OWNER), begin_of(ints, t.EFFECT_SENSOR)
    wish_owner, uniform = begin_of(ints, t.WISH_OWNER), ints[begin_of(ints, t.OPTIONS)]
    change, weight = float_begin_of(floats, t.EFFECT_CHANGE), float_begin_of(floats, t.WEIGHTS)
    behaviours = values.shape[2]
    for p in range(size_of(ints, t.GOAL_PAIR_EFFECT)):
        e, u = ints[pair_effect + p], ints[pair_wish + p]
        goal = ints[wish_owner + u] - behaviours
        if not live[e] or not enabled[row, goal]:
            continue
        effect, wish, b, sensor = floats[change + e], wishes[row, u], ints[owner + e], ints[sensors + e]
        if effect * wish > 0.0:
            share = helping(effect, wish, uniform) * goal_weight[goal] / helpers(effect, sensor, counts)
            values[row, st.GOALS, b] += floats[weight + 1] * share
        else:
            share = hindering(effect, wish, uniform) * goal_weight[goal]
            values[row, st.INHIBITION, b] += floats[weight + 2] * share / opponents(wish, sensor, counts)


@inlined
def flow_between(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, wishes: Floats, live: Ints, live_wish: Ints,
    counts: Ints, heard: Ints, total: float,
) -> None:  # fmt: skip
    """Add what behaviours of `row` give each other, where an effect of one meets a wish of another."""
    pair_effect, pair_wish = begin_of(ints, t.PAIR_EFFECT), begin_of(ints, t.PAIR_WISH)
    owner, sensors = begin_of(ints, t.EFFECT_OWNER), begin_of(ints, t.EFFECT_SENSOR)
    wish_owner, uniform = begin_of(ints, t.WISH_OWNER), ints[begin_of(ints, t.OPTIONS)]
    change, weight = float_begin_of(floats, t.EFFECT_CHANGE), float_begin_of(floats, t.WEIGHTS)
    for p in range(size_of(ints, t.PAIR_EFFECT)):
        e, u = ints[pair_effect + p], ints[pair_wish + p]
        if not live[e] or not live_wish[u]:
            continue
        effect, wish, sensor = floats[change + e], wishes[row, u], ints[sensors + e]
        b, q = ints[owner + e], ints[wish_owner + u]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, uniform) / total
            if heard[q] and not marks[row, st.READY, q]:
                share = help_ * values[row, st.ACTIVATION, q] / helpers(effect, sensor, counts)
                values[row, st.SUCCESSORS, b] += floats[weight + 4] * share
            if heard[b] and marks[row, st.READY, b] and values[row, st.SATISFACTION, b] > 0.0:
                share = help_ * values[row, st.ACTIVATION, b] / wishers(wish, sensor, counts)
                values[row, st.PREDECESSORS, q] += floats[weight + 3] * share
        elif heard[q]:
            share = hindering(effect, wish, uniform) * values[row, st.ACTIVATION, q] / total
            values[row, st.CONFLICTORS, b] += floats[weight + 2] * share / opponents(wish, sensor, counts)


@inlined
def activate_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, wishes: Floats, kept: Ints,
    goal_enabled: Ints, plan: Ints, plan_marks: Ints, goal_weight: Floats, heard: Ints, live: Ints, live_wish: Ints,
    counts: Ints,
) -> None:  # fmt: skip
    """Compute the activations of `row`, every term from the old ones.

    `plan` (R, T) holds behaviours, `plan_marks` where in it the row stands. Overwritten: `goal_weight` (G,), `heard`
    (B,), `live` (E,), `live_wish` (U,) and `counts` (COUNTS, S).
    """
    weight = float_begin_of(floats, t.WEIGHTS)
    total = begin_step(row, values, marks, floats[weight], heard)
    row_values[row, st.TOTAL] = total
    find_live(row, ints, floats, marks, kept, live, live_wish)
    count_effects(ints, floats, heard, live, counts)
    count_wishes(row, ints, heard, live_wish, wishes, counts)
    weigh_goals(row, ints, floats, goal_enabled, goal_weight)
    flow_from_goals(row, ints, floats, values, wishes, live, counts, goal_enabled, goal_weight)
    flow_between(row, ints, floats, values, marks, wishes, live, live_wish, counts, heard, total)
    index, length = plan_marks[row, INDEX], plan_marks[row, LENGTH]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        values[row, st.PLAN, plan[row, k]] = floats[weight + 5] / (k - index + 1)
    add_up(row, values, floats[float_begin_of(floats, t.DYNAMICS)])


@inlined
def begin_step(row: int, values: Floats, marks: Ints, situation: float, heard: Ints) -> float:
    """Clear the terms and note in `heard` (B,) who is operational; returns their old activation, 1 if that is none."""
    behaviours = values.shape[2]
    for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
        for b in range(behaviours):
            values[row, layer, b] = 0.0
    total = 0.0
    for b in range(behaviours):
        heard[b] = 1 if operational(row, b, marks) else 0
        total += values[row, st.ACTIVATION, b] if heard[b] else 0.0
        values[row, st.PRECONDITIONS, b] = situation * values[row, st.SATISFACTION, b]
    return total if total != 0.0 else 1.0


@inlined
def add_up(row: int, values: Floats, decay: float) -> None:
    """Let the old activations decay and add the terms; activation never falls below 0."""
    for b in range(values.shape[2]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[row, layer, b]
        values[row, st.ACTIVATION, b] = max(0.0, decay * values[row, st.ACTIVATION, b] + step)
