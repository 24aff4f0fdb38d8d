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

from selforg.arrays import Floats, Ints
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
    s, operational = open_states(states), open_scratch(scratch).operational
    values, weight = s.values[row], open_model(model).situation_weight
    behaviours = values.shape[1]
    for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
        for b in range(behaviours):
            values[layer, b] = 0.0
    total = 0.0
    for b in range(behaviours):
        total += values[st.ACTIVATION, b] if operational[b] else 0.0
        values[st.PRECONDITIONS, b] = weight * values[st.SATISFACTION, b]
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
    values, wishes, enabled = s.values[row], s.wishes[row], s.goal_enabled[row]
    behaviours = values.shape[1]
    for p in range(m.goal_pair_effect.shape[0]):
        e, u = m.goal_pair_effect[p], m.goal_pair_wish[p]
        goal = m.wish_owner[u] - behaviours
        if not own.live_effect[e] or not enabled[goal]:
            continue
        b, sensor = m.effect_owner[e], m.effect_sensor[e]
        effect, wish = m.effect_change[e], wishes[u]
        if effect * wish > 0.0:
            share = helping(effect, wish, m.uniform) * own.goal_share[goal] / helpers(effect, sensor, own.counts)
            values[st.GOALS, b] += m.goal_weight * share
        else:
            share = hindering(effect, wish, m.uniform) * own.goal_share[goal]
            values[st.INHIBITION, b] += m.conflictor_weight * share / opponents(wish, sensor, own.counts)


@inlined
def flow_between(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Add what behaviours of `row` give each other, where an effect of one meets a wish of another."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    values, marks, wishes, kept = s.values[row], s.marks[row], s.wishes[row], s.wish_kept[row]
    total = s.row_values[row, st.TOTAL]
    for p in range(m.pairs.shape[0]):
        e, u, b, q, sensor = m.pairs[p, 0], m.pairs[p, 1], m.pairs[p, 2], m.pairs[p, 3], m.pairs[p, 4]
        if not own.live_effect[e] or not kept[u] or not marks[st.PRESENT, q]:
            continue
        effect, wish = m.effect_change[e], wishes[u]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, m.uniform) / total
            if own.operational[q] and not marks[st.READY, q]:
                share = help_ * values[st.ACTIVATION, q] / helpers(effect, sensor, own.counts)
                values[st.SUCCESSORS, b] += m.successor_weight * share
            if own.operational[b] and marks[st.READY, b] and values[st.SATISFACTION, b] > 0.0:
                share = help_ * values[st.ACTIVATION, b]
                share /= wishers(wish, sensor, model, wishes, kept, own.operational)
                values[st.PREDECESSORS, q] += m.predecessor_weight * share
        elif own.operational[q]:
            share = hindering(effect, wish, m.uniform) * values[st.ACTIVATION, q] / total
            values[st.CONFLICTORS, b] += m.conflictor_weight * share / opponents(wish, sensor, own.counts)


@inlined
def flow_from_plan(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Set the plan's term for the behaviours of its remaining steps: the sooner one is due, the more."""
    s, weight = open_states(states), open_model(model).plan_weight
    values, plan = s.values[row], s.plan[row]
    index, length = s.plan_marks[row, st.PLAN_INDEX], s.plan_marks[row, st.PLAN_LENGTH]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        values[st.PLAN, plan[k]] = weight / (k - index + 1)


@inlined
def sum_terms(row: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Multiply the old activations of `row` by the decay and add the terms; activation never falls below 0."""
    values, decay = open_states(states).values[row], open_model(model).activation_decay
    for b in range(values.shape[1]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[layer, b]
        values[st.ACTIVATION, b] = max(0.0, decay * values[st.ACTIVATION, b] + step)


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
    marks, shown = open_states(states).marks[row], open_scratch(scratch).shown
    new = False
    for b in range(shown.shape[0]):
        switches = 2 * marks[st.PRESENT, b] + marks[st.ENABLED, b]
        here = 4 * (marks[st.ALTERNATIVE, b] + 1) + switches
        new = new or shown[b] != here
        shown[b] = here
    return new


@inlined
def is_operational(b: int, marks: Ints) -> bool:
    """Return whether behaviour `b` is part of the network and switched on; marks (MARK, B) of a row."""
    return bool(marks[st.PRESENT, b] == 1 and marks[st.ENABLED, b] == 1)


@inlined
def find_live(row: int, model: Handle[PackedModel], states: Handle[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill `operational` and `live_effect` for `row`."""
    m, marks, own = open_model(model), open_states(states).marks[row], open_scratch(scratch)
    for b in range(marks.shape[1]):
        own.operational[b] = 1 if is_operational(b, marks) else 0
    for e in range(own.live_effect.shape[0]):
        b = m.effect_owner[e]
        shown = m.effect_tag[e] < 0 or m.effect_tag[e] == marks[st.ALTERNATIVE, b]
        own.live_effect[e] = 1 if shown and m.effect_change[e] != 0.0 and marks[st.PRESENT, b] else 0


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
def wishers(wish: float, sensor: int, model: Handle[PackedModel], wishes: Floats, kept: Ints, operational: Ints) -> int:
    """Return how many operational behaviours share what goes to wishes of this sign, at least 1.

    wishes (U,) and which of them are `kept` (U,) of a row.
    """
    m = open_model(model)
    found, last = 0, -1
    for k in range(m.sensor_wish_first[sensor], m.sensor_wish_first[sensor + 1]):
        u = m.sensor_wish[k]
        b = m.wish_owner[u]
        alike = wishes[u] > 0.0 if wish > 0.0 else wishes[u] < 0.0
        if alike and b != last and operational[b] and kept[u]:
            found += 1
            last = b
    return max(found, 1)


@inlined
def opponents(wish: float, sensor: int, counts: Ints) -> int:
    """Return how many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    if wish == 0.0:
        return int(max(counts[EITHER, sensor], 1))
    return int(max(counts[NEGATIVE, sensor] if wish > 0.0 else counts[POSITIVE, sensor], 1))
