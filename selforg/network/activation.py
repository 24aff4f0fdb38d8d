"""Activation of one row's behaviours: who gets how much from whom (compiled).

The terms are those of Maes ("How to do the right thing", 1989, doi:10.1080/09540098908915643), extended by the paper.
Each is added to its own layer of the state, so that every step can be explained. Which effect meets which wish is known
when the model is built (`tables`, pairs); a step only walks those pairs.
"""

from __future__ import annotations

import math

from selforg.compiled import kernel
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.plan_watch import INDEX, LENGTH
from selforg.network.sharing import (
    COUNTS,
    count_effects,
    count_wishes,
    find_live,
    helpers,
    operational,
    opponents,
    wishers,
)
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
def weigh_goals(floats: Floats, by_priority: int, enabled: Ints, weight: Floats) -> None:
    """Fill `weight` (G,): 1, or the priorities of the goals that are on mapped linearly onto [1, 2]."""
    weight[:] = 1.0
    if not by_priority:
        return
    priority = floats_of(floats, t.GOAL_PRIORITY)
    least, most = math.inf, -math.inf
    for g in range(weight.shape[0]):
        if enabled[g]:
            least, most = min(least, priority[g]), max(most, priority[g])
    if most > least:
        for g in range(weight.shape[0]):
            weight[g] += (priority[g] - least) / (most - least)


@kernel
def flow_from_goals(
    ints: Ints, floats: Floats, wishes: Floats, live: Ints, counts: Ints, enabled: Ints, goal_weight: Floats,
    goals: Floats, inhibition: Floats,
) -> None:  # fmt: skip
    """Add what goals give to the behaviours whose effects meet their wishes; `live` (E,), `enabled` (G,)."""
    pair_effect, pair_wish = ints_of(ints, t.GOAL_PAIR_EFFECT), ints_of(ints, t.GOAL_PAIR_WISH)
    owner, sensors = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_SENSOR)
    wish_owner, uniform = ints_of(ints, t.WISH_OWNER), ints_of(ints, t.OPTIONS)[0]
    change, weight = floats_of(floats, t.EFFECT_CHANGE), floats_of(floats, t.WEIGHTS)
    for p in range(pair_effect.shape[0]):
        e, u = pair_effect[p], pair_wish[p]
        goal = wish_owner[u] - goals.shape[0]
        if not live[e] or not enabled[goal]:
            continue
        effect, wish, b, sensor = change[e], wishes[u], owner[e], sensors[e]
        if effect * wish > 0.0:
            share = helping(effect, wish, uniform) * goal_weight[goal] / helpers(effect, sensor, counts)
            goals[b] += weight[1] * share
        else:
            share = hindering(effect, wish, uniform) * goal_weight[goal]
            inhibition[b] += weight[2] * share / opponents(wish, sensor, counts)


@kernel
def flow_between(
    ints: Ints, floats: Floats, wishes: Floats, live: Ints, live_wish: Ints, counts: Ints, heard: Ints, ready: Ints,
    satisfaction: Floats, activation: Floats, total: float, predecessors: Floats, successors: Floats,
    conflictors: Floats,
) -> None:  # fmt: skip
    """Add what behaviours give each other, where an effect of one meets a wish of another."""
    pair_effect, pair_wish = ints_of(ints, t.PAIR_EFFECT), ints_of(ints, t.PAIR_WISH)
    owner, sensors = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_SENSOR)
    wish_owner, uniform = ints_of(ints, t.WISH_OWNER), ints_of(ints, t.OPTIONS)[0]
    change, weight = floats_of(floats, t.EFFECT_CHANGE), floats_of(floats, t.WEIGHTS)
    for p in range(pair_effect.shape[0]):
        e, u = pair_effect[p], pair_wish[p]
        if not live[e] or not live_wish[u]:
            continue
        effect, wish, b, q, sensor = change[e], wishes[u], owner[e], wish_owner[u], sensors[e]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, uniform) / total
            if heard[q] and not ready[q]:
                successors[b] += weight[4] * (help_ * activation[q] / helpers(effect, sensor, counts))
            if heard[b] and ready[b] and satisfaction[b] > 0.0:
                predecessors[q] += weight[3] * (help_ * activation[b] / wishers(wish, sensor, counts))
        elif heard[q]:
            share = hindering(effect, wish, uniform) * activation[q] / total
            conflictors[b] += weight[2] * share / opponents(wish, sensor, counts)


@kernel
def activate_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, wishes: Floats, kept: Ints,
    goal_enabled: Ints, goal_weight: Floats, plan: Ints, plan_marks: Ints, scratch: Ints,
) -> None:  # fmt: skip
    """Compute the activations of `row`, every term from the old ones.

    `goal_weight` (G,) and `scratch` (`scratch_size`,) are overwritten; `plan` (R, T) holds behaviours, `plan_marks`
    where in it the row stands.
    """
    sizes, weight = ints_of(ints, t.SIZES), floats_of(floats, t.WEIGHTS)
    behaviours, effects = sizes[1], ints_of(ints, t.EFFECT_OWNER).shape[0]
    heard, live = scratch[:behaviours], scratch[behaviours : behaviours + effects]
    live_wish = scratch[behaviours + effects : behaviours + effects + sizes[4]]
    counts = scratch[behaviours + effects + sizes[4] :].reshape(COUNTS, sizes[0])
    activation, satisfaction = values[st.ACTIVATION, row], values[st.SATISFACTION, row]
    total = begin_step(row, values, marks, weight[0], heard)
    row_values[st.TOTAL, row] = total
    find_live(ints, floats, marks[st.PRESENT, row], marks[st.ALTERNATIVE, row], kept[row], live, live_wish)
    count_effects(ints, floats, heard, live, counts)
    count_wishes(ints, heard, live_wish, wishes[row], counts)
    weigh_goals(floats, ints_of(ints, t.OPTIONS)[2], goal_enabled[row], goal_weight)
    flow_from_goals(
        ints, floats, wishes[row], live, counts, goal_enabled[row], goal_weight, values[st.GOALS, row],
        values[st.INHIBITION, row],
    )  # fmt: skip
    flow_between(
        ints, floats, wishes[row], live, live_wish, counts, heard, marks[st.READY, row], satisfaction, activation,
        total, values[st.PREDECESSORS, row], values[st.SUCCESSORS, row], values[st.CONFLICTORS, row],
    )  # fmt: skip
    index, length = plan_marks[INDEX, row], plan_marks[LENGTH, row]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        values[st.PLAN, row, plan[row, k]] = weight[5] / (k - index + 1)
    add_up(row, values, floats_of(floats, t.DYNAMICS)[0])


@kernel
def begin_step(row: int, values: Floats, marks: Ints, situation: float, heard: Ints) -> float:
    """Clear the terms and note in `heard` (B,) who is operational; returns their old activation, 1 if that is none."""
    activation, satisfaction = values[st.ACTIVATION, row], values[st.SATISFACTION, row]
    values[st.PRECONDITIONS : st.VALUE_LAYERS, row] = 0.0
    preconditions = values[st.PRECONDITIONS, row]
    total = 0.0
    for b in range(heard.shape[0]):
        heard[b] = 1 if operational(marks, row, b) else 0
        total += activation[b] if heard[b] else 0.0
        preconditions[b] = situation * satisfaction[b]
    return total if total != 0.0 else 1.0


@kernel
def add_up(row: int, values: Floats, decay: float) -> None:
    """Let the old activations decay and add the terms; activation never falls below 0."""
    for b in range(values.shape[2]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[layer, row, b]
        values[st.ACTIVATION, row, b] = max(0.0, decay * values[st.ACTIVATION, row, b] + step)


@kernel
def scratch_size(ints: Ints) -> int:
    """Length of the integers that `activate_row` needs for its own use."""
    sizes = ints_of(ints, t.SIZES)
    return int(sizes[1] + ints_of(ints, t.EFFECT_OWNER).shape[0] + sizes[4] + COUNTS * sizes[0])
