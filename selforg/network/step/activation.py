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
from selforg.compiler.records import Words, Written
from selforg.network import state as st
from selforg.network.model.packed import (
    EITHER,
    NEGATIVE,
    POSITIVE,
    WISH_LESS,
    WISH_MORE,
    PackedModel,
    Scratch,
    open_model,
    open_scratch,
)
from selforg.network.state import RowStates, open_states


@inlined
def activate_row(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Compute the activations of `row`, every term from the old ones."""
    begin_terms(row, model, states, scratch)
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
def begin_terms(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
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
def weigh_goals(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
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
def flow_from_goals(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
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
def flow_between(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Add what behaviours of `row` give each other, where an effect of one meets a wish of another."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    total = s.row_values[row, st.TOTAL]
    for p in range(m.pair_effect.shape[0]):
        e, u = m.pair_effect[p], m.pair_wish[p]
        if not own.live_effect[e] or not own.live_wish[u]:
            continue
        effect, wish, sensor = m.effect_change[e], s.wishes[row, u], m.effect_sensor[e]
        b, q = m.effect_owner[e], m.wish_owner[u]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, m.uniform) / total
            if own.operational[q] and not s.marks[row, st.READY, q]:
                share = help_ * s.values[row, st.ACTIVATION, q] / helpers(effect, sensor, own.counts)
                s.values[row, st.SUCCESSORS, b] += m.successor_weight * share
            if own.operational[b] and s.marks[row, st.READY, b] and s.values[row, st.SATISFACTION, b] > 0.0:
                share = help_ * s.values[row, st.ACTIVATION, b] / wishers(wish, sensor, own.counts)
                s.values[row, st.PREDECESSORS, q] += m.predecessor_weight * share
        elif own.operational[q]:
            share = hindering(effect, wish, m.uniform) * s.values[row, st.ACTIVATION, q] / total
            s.values[row, st.CONFLICTORS, b] += m.conflictor_weight * share / opponents(wish, sensor, own.counts)


@inlined
def flow_from_plan(row: int, model: Words[PackedModel], states: Written[RowStates]) -> None:
    """Set the plan's term for the behaviours of its remaining steps: the sooner one is due, the more."""
    s, weight = open_states(states), open_model(model).plan_weight
    index, length = s.plan_marks[row, st.PLAN_INDEX], s.plan_marks[row, st.PLAN_LENGTH]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        s.values[row, st.PLAN, s.plan[row, k]] = weight / (k - index + 1)


@inlined
def sum_terms(row: int, model: Words[PackedModel], states: Written[RowStates]) -> None:
    """Multiply the old activations of `row` by the decay and add the terms; activation never falls below 0."""
    values, decay = open_states(states).values, open_model(model).activation_decay
    for b in range(values.shape[2]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[row, layer, b]
        values[row, st.ACTIVATION, b] = max(0.0, decay * values[row, st.ACTIVATION, b] + step)


@inlined
def share_row(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Find for `row` the operational behaviours, the live effects and wishes, and how many behaviours share each."""
    find_live(row, model, states, scratch)
    count_sharers(row, model, states, scratch)


@inlined
def is_operational(row: int, b: int, marks: Ints) -> bool:
    """Return whether behaviour `b` is part of the network and switched on."""
    return bool(marks[row, st.PRESENT, b] == 1 and marks[row, st.ENABLED, b] == 1)


@inlined
def find_live(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill `operational`, `live_effect` and `live_wish` for `row`."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    behaviours = s.marks.shape[2]
    for b in range(behaviours):
        own.operational[b] = 1 if is_operational(row, b, s.marks) else 0
    for e in range(own.live_effect.shape[0]):
        b = m.effect_owner[e]
        shown = m.effect_tag[e] < 0 or m.effect_tag[e] == s.marks[row, st.ALTERNATIVE, b]
        own.live_effect[e] = 1 if shown and m.effect_change[e] != 0.0 and s.marks[row, st.PRESENT, b] else 0
    for u in range(own.live_wish.shape[0]):  # the wishes of goals are always live
        b = m.wish_owner[u]
        own.live_wish[u] = 1 if b >= behaviours or (s.wish_kept[row, u] and s.marks[row, st.PRESENT, b]) else 0


@inlined
def count_sharers(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill `counts` for every sensor, from the effects of behaviours and the wishes of `row`."""
    m, own, wishes = open_model(model), open_scratch(scratch), open_states(states).wishes[row]
    live_effect, live_wish, operational = own.live_effect, own.live_wish, own.operational
    for sensor in range(own.counts.shape[1]):
        begin, end = m.sensor_effect_first[sensor], m.sensor_effect_first[sensor + 1]
        up, down, either = count_owners(
            m.sensor_effect, begin, end, m.effect_owner, m.effect_change, live_effect, operational
        )
        begin, end = m.sensor_wish_first[sensor], m.sensor_wish_first[sensor + 1]
        more, less, _ = count_owners(m.sensor_wish, begin, end, m.wish_owner, wishes, live_wish, operational)
        own.counts[POSITIVE, sensor], own.counts[NEGATIVE, sensor], own.counts[EITHER, sensor] = up, down, either
        own.counts[WISH_MORE, sensor], own.counts[WISH_LESS, sensor] = more, less


@inlined
def count_owners(
    entries: Ints, begin: int, end: int, owner: Ints, size: Floats, live: Ints, operational: Ints
) -> tuple[int, int, int]:
    """Count the operational behaviours with a live entry above 0, below 0, and of any size.

    The effects or wishes are entries[begin:end], those of one behaviour next to each other; `owner`, `size` and `live`
    have an element for each effect or wish.
    """
    above, below, either = 0, 0, 0
    last_above, last_below, last = -1, -1, -1
    for k in range(begin, end):
        entry = entries[k]
        b = owner[entry]
        if not live[entry] or not operational[b]:
            continue
        if size[entry] > 0.0 and b != last_above:
            above += 1
            last_above = b
        if size[entry] < 0.0 and b != last_below:
            below += 1
            last_below = b
        if b != last:
            either += 1
            last = b
    return above, below, either


@inlined
def helpers(effect: float, sensor: int, counts: Ints) -> int:
    """Return how many share what goes to effects of this sign, at least 1."""
    return int(max(counts[POSITIVE, sensor] if effect > 0.0 else counts[NEGATIVE, sensor], 1))


@inlined
def wishers(wish: float, sensor: int, counts: Ints) -> int:
    """Return how many share what goes to wishes of this sign, at least 1."""
    return int(max(counts[WISH_MORE, sensor] if wish > 0.0 else counts[WISH_LESS, sensor], 1))


@inlined
def opponents(wish: float, sensor: int, counts: Ints) -> int:
    """Return how many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    if wish == 0.0:
        return int(max(counts[EITHER, sensor], 1))
    return int(max(counts[NEGATIVE, sensor] if wish > 0.0 else counts[POSITIVE, sensor], 1))
