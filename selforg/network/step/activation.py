"""Activation, the third stage of a step: how much each behaviour gets from every other and from goals (compiled).

The terms are those of Maes ("How to do the right thing", 1989, doi:10.1080/09540098908915643), extended by the paper.
Each term has a layer of its own in the state, so that every step can be explained. Which effect and which wish are
about the same sensor is known when the model is built (`pair_effect`, `pair_wish`); a step visits only those pairs.

Flows are shared among behaviours, which are counted first. A behaviour is *operational* when it is part of the network
and switched on: only then do the others count it. An effect or a wish is *live* when its behaviour is part of the
network and it belongs to no alternative that the row does not hold. A live effect counts for others only while its
behaviour is operational; so does a live wish.
"""

from __future__ import annotations

import math

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.network.model.packed import (
    EITHER,
    NEGATIVE,
    POSITIVE,
    PackedModel,
    Scratch,
    open_model,
    open_scratch,
)
from selforg.network.state import RowStates, open_states


@inlined
def activate_row(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Compute the activations of `row`, every term from the old ones."""
    reset_terms(row, model, states, scratch)
    weigh_goals(row, model, states, scratch)
    flow_from_goals(row, model, states, scratch)
    flow_between(row, model, states, scratch)
    flow_from_plan(row, model, states)
    sum_terms(row, model, states)


@inlined
def helping(effect: float, wish: float, uniform: int) -> float:
    """Return how much an effect helps a wish of its own direction."""
    return math.sqrt(effect * effect + wish * wish) if uniform else effect * wish


@inlined
def hindering(effect: float, wish: float, uniform: int) -> float:
    """Return how much (negative) an effect hurts a wish against it, or with wish 0 something that should stay.

    The jump to -0.1 at |effect * wish| = 1 is the original's (Q18), as is the sign beyond 1 (Q17).
    """
    if uniform:
        return -math.sqrt(effect * effect + wish * wish)
    if wish == 0.0:
        return -abs(effect)
    product = abs(effect * wish)
    return -0.1 if product == 1.0 else product - 1.0


@inlined
def reset_terms(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Set the term of the situation, clear the others, and sum the old activations of operational behaviours.

    A sum of 0 counts as 1.
    """
    s = open_states(states)
    operational, weight = open_scratch(scratch).operational, open_model(model).situation_weight
    behaviours = s.values.shape[2]
    for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
        for b in range(behaviours):
            s.values[row, layer, b] = 0.0
    total = 0.0
    for b in range(behaviours):
        total += s.values[row, st.ACTIVATION, b] if operational[b] else 0.0
        s.values[row, st.PRECONDITIONS, b] = weight * s.values[row, st.SATISFACTION, b]
    s.row_values[row, st.TOTAL] = total if total != 0.0 else 1.0


@inlined
def weigh_goals(row: int, model: Handle[PackedModel], states: Handle[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill `goal_share`: 1, or the priorities of the goals that are on mapped linearly onto [1, 2]."""
    m, share = open_model(model), open_scratch(scratch).goal_share
    enabled = open_states(states).goal_enabled
    for g in range(share.shape[0]):
        share[g] = 1.0
    if not m.by_goal_priority:
        return
    least, most = math.inf, -math.inf
    for g in range(share.shape[0]):
        if enabled[row, g]:
            least, most = min(least, m.goal_priority[g]), max(most, m.goal_priority[g])
    if most > least:
        for g in range(share.shape[0]):
            share[g] += (m.goal_priority[g] - least) / (most - least)


@inlined
def flow_from_goals(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Add what goals give to the behaviours of `row` whose effects meet their wishes."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    behaviours = s.values.shape[2]
    for p in range(m.goal_pair_effect.shape[0]):
        e, u = m.goal_pair_effect[p], m.goal_pair_wish[p]
        goal = m.wish_owner[u] - behaviours
        if not own.live_effect[e] or not s.goal_enabled[row, goal]:
            continue
        b, sensor = m.effect_owner[e], m.effect_sensor[e]
        effect, wish = m.effect_change[e], s.wishes[row, u]
        if effect * wish > 0.0:
            share = helping(effect, wish, m.uniform) * own.goal_share[goal] / helpers(effect, sensor, own.counts)
            s.values[row, st.GOALS, b] += m.goal_weight * share
        else:
            share = hindering(effect, wish, m.uniform) * own.goal_share[goal]
            s.values[row, st.INHIBITION, b] += m.conflictor_weight * share / opponents(wish, sensor, own.counts)


@inlined
def flow_between(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Add what behaviours of `row` give each other, where an effect of one meets a wish of another."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    total = s.row_values[row, st.TOTAL]
    for p in range(m.pair_effect.shape[0]):
        e, u = m.pair_effect[p], m.pair_wish[p]
        b, q = m.effect_owner[e], m.wish_owner[u]
        if not own.live_effect[e] or not is_live(row, u, q, states):
            continue
        effect, wish, sensor = m.effect_change[e], s.wishes[row, u], m.effect_sensor[e]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, m.uniform) / total
            if own.operational[q] and not s.marks[row, st.READY, q]:
                share = help_ * s.values[row, st.ACTIVATION, q] / helpers(effect, sensor, own.counts)
                s.values[row, st.SUCCESSORS, b] += m.successor_weight * share
            if own.operational[b] and s.marks[row, st.READY, b] and s.values[row, st.SATISFACTION, b] > 0.0:
                share = help_ * s.values[row, st.ACTIVATION, b]
                share /= wishers(row, wish, sensor, model, states, own.operational)
                s.values[row, st.PREDECESSORS, q] += m.predecessor_weight * share
        elif own.operational[q]:
            share = hindering(effect, wish, m.uniform) * s.values[row, st.ACTIVATION, q] / total
            s.values[row, st.CONFLICTORS, b] += m.conflictor_weight * share / opponents(wish, sensor, own.counts)


@inlined
def flow_from_plan(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Set the plan's term for the behaviours of its remaining steps: the sooner one is due, the more."""
    s, weight = open_states(states), open_model(model).plan_weight
    index, length = s.plan_marks[row, st.PLAN_INDEX], s.plan_marks[row, st.PLAN_LENGTH]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        s.values[row, st.PLAN, s.plan[row, k]] = weight / (k - index + 1)


@inlined
def sum_terms(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Multiply the old activations of `row` by the decay and add the terms; activation never falls below 0."""
    values, decay = open_states(states).values, open_model(model).activation_decay
    for b in range(values.shape[2]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[row, layer, b]
        values[row, st.ACTIVATION, b] = max(0.0, decay * values[row, st.ACTIVATION, b] + step)


@inlined
def share_row(row: int, model: Handle[PackedModel], states: Handle[RowStates], scratch: Handle[Scratch]) -> None:
    """Find for `row` the operational behaviours, the live effects, and how many behaviours share those of a sensor.

    All this follows from three marks of each behaviour. Most rows have those of the row before: its results stay.
    """
    if note_shown(row, states, scratch):
        find_live(row, model, states, scratch)
        count_sharers(model, scratch)


@inlined
def note_shown(row: int, states: Handle[RowStates], scratch: Handle[Scratch]) -> bool:
    """Note in `shown` which behaviours `row` has, on or off, with which alternatives; return whether that is new."""
    marks, shown = open_states(states).marks, open_scratch(scratch).shown
    new = False
    for b in range(shown.shape[0]):
        switches = 2 * marks[row, st.PRESENT, b] + marks[row, st.ENABLED, b]
        here = 4 * (marks[row, st.ALTERNATIVE, b] + 1) + switches
        new = new or shown[b] != here
        shown[b] = here
    return new


@inlined
def is_operational(row: int, b: int, marks: Ints) -> bool:
    """Return whether behaviour `b` is part of the network and switched on."""
    return bool(marks[row, st.PRESENT, b] == 1 and marks[row, st.ENABLED, b] == 1)


@inlined
def find_live(row: int, model: Handle[PackedModel], states: Handle[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill `operational` and `live_effect` for `row`."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    for b in range(s.marks.shape[2]):
        own.operational[b] = 1 if is_operational(row, b, s.marks) else 0
    for e in range(own.live_effect.shape[0]):
        b = m.effect_owner[e]
        shown = m.effect_tag[e] < 0 or m.effect_tag[e] == s.marks[row, st.ALTERNATIVE, b]
        own.live_effect[e] = 1 if shown and m.effect_change[e] != 0.0 and s.marks[row, st.PRESENT, b] else 0


@inlined
def is_live(row: int, wish: int, owner: int, states: Handle[RowStates]) -> bool:
    """Return whether a wish of `row` counts; those of goals always do."""
    s = open_states(states)
    return bool(owner >= s.marks.shape[2] or (s.wish_kept[row, wish] and s.marks[row, st.PRESENT, owner]))


@inlined
def count_sharers(model: Handle[PackedModel], scratch: Handle[Scratch]) -> None:
    """Fill `counts` for every sensor, from the live effects of operational behaviours, those of one side by side."""
    m, own = open_model(model), open_scratch(scratch)
    for sensor in range(own.counts.shape[1]):
        up, down, either = 0, 0, 0
        last_up, last_down, last = -1, -1, -1
        for k in range(m.sensor_effect_first[sensor], m.sensor_effect_first[sensor + 1]):
            effect = m.sensor_effect[k]
            b = m.effect_owner[effect]
            if not own.live_effect[effect] or not own.operational[b]:
                continue
            if m.effect_change[effect] > 0.0 and b != last_up:
                up += 1
                last_up = b
            if m.effect_change[effect] < 0.0 and b != last_down:
                down += 1
                last_down = b
            if b != last:
                either += 1
                last = b
        own.counts[POSITIVE, sensor], own.counts[NEGATIVE, sensor], own.counts[EITHER, sensor] = up, down, either


@inlined
def helpers(effect: float, sensor: int, counts: Ints) -> int:
    """Return how many share what goes to effects of this sign, at least 1."""
    return int(max(counts[POSITIVE, sensor] if effect > 0.0 else counts[NEGATIVE, sensor], 1))


@inlined
def wishers(
    row: int, wish: float, sensor: int, model: Handle[PackedModel], states: Handle[RowStates], operational: Ints
) -> int:
    """Return how many operational behaviours of `row` share what goes to wishes of this sign, at least 1."""
    m, wishes = open_model(model), open_states(states).wishes
    found, last = 0, -1
    for k in range(m.sensor_wish_first[sensor], m.sensor_wish_first[sensor + 1]):
        u = m.sensor_wish[k]
        b = m.wish_owner[u]
        alike = wishes[row, u] > 0.0 if wish > 0.0 else wishes[row, u] < 0.0
        if alike and b != last and operational[b] and is_live(row, u, b, states):
            found += 1
            last = b
    return max(found, 1)


@inlined
def opponents(wish: float, sensor: int, counts: Ints) -> int:
    """Return how many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    if wish == 0.0:
        return int(max(counts[EITHER, sensor], 1))
    return int(max(counts[NEGATIVE, sensor] if wish > 0.0 else counts[POSITIVE, sensor], 1))
