"""Activation, the fourth stage of a step: how much each behaviour gets from every other and from goals (compiled).

The terms are those of Maes ("How to do the right thing", 1989, doi:10.1080/09540098908915643), extended by the paper.
Each term has a layer of its own in the state, so that every step can be explained. Which effect and which wish are
about the same sensor is known when the model is built (`pair_effect`, `pair_wish`); a step visits only those pairs.
"""

from __future__ import annotations

import math

from selforg.compiler.decorators import inlined
from selforg.compiler.records import Words, Written
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import state as st
from selforg.network.state.plan_state import INDEX, LENGTH, RowPlans, open_plans
from selforg.network.state.state import RowStates, open_states
from selforg.network.step.scratch import Scratch, open_scratch
from selforg.network.step.sharing import helpers, opponents, wishers


@inlined
def activate_row(
    row: int, model: Words[PackedModel], states: Written[RowStates], plans: Words[RowPlans], scratch: Words[Scratch]
) -> None:
    """Compute the activations of `row`, every term from the old ones."""
    begin_terms(row, model, states, scratch)
    weigh_goals(row, model, states, scratch)
    flow_from_goals(row, model, states, scratch)
    flow_between(row, model, states, scratch)
    flow_from_plan(row, model, states, plans)
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
    values, row_values = s.values, s.row_values
    operational, weight = open_scratch(scratch).operational, open_model(model).situation_weight
    behaviours = values.shape[2]
    for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
        for b in range(behaviours):
            values[row, layer, b] = 0.0
    total = 0.0
    for b in range(behaviours):
        total += values[row, st.ACTIVATION, b] if operational[b] else 0.0
        values[row, st.PRECONDITIONS, b] = weight * values[row, st.SATISFACTION, b]
    row_values[row, st.TOTAL] = total if total != 0.0 else 1.0


@inlined
def weigh_goals(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill `goal_share`: 1, or the priorities of the goals that are on mapped linearly onto [1, 2]."""
    m, share = open_model(model), open_scratch(scratch).goal_share
    priority, by_priority = m.goal_priority, m.by_goal_priority
    enabled = open_states(states).goal_enabled
    for g in range(share.shape[0]):
        share[g] = 1.0
    if not by_priority:
        return
    least, most = math.inf, -math.inf
    for g in range(share.shape[0]):
        if enabled[row, g]:
            least, most = min(least, priority[g]), max(most, priority[g])
    if most > least:
        for g in range(share.shape[0]):
            share[g] += (priority[g] - least) / (most - least)


@inlined
def flow_from_goals(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Add what goals give to the behaviours of `row` whose effects meet their wishes."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    pair_effect, pair_wish, wish_owner = m.goal_pair_effect, m.goal_pair_wish, m.wish_owner
    owner, sensors, change = m.effect_owner, m.effect_sensor, m.effect_change
    uniform, goal_weight, conflictor_weight = m.uniform, m.goal_weight, m.conflictor_weight
    values, wishes, enabled = s.values, s.wishes, s.goal_enabled
    live, counts, goal_share = own.live_effect, own.counts, own.goal_share
    behaviours = values.shape[2]
    for p in range(pair_effect.shape[0]):
        e, u = pair_effect[p], pair_wish[p]
        goal = wish_owner[u] - behaviours
        if not live[e] or not enabled[row, goal]:
            continue
        b, sensor = owner[e], sensors[e]
        effect, wish = change[e], wishes[row, u]
        if effect * wish > 0.0:
            share = helping(effect, wish, uniform) * goal_share[goal] / helpers(effect, sensor, counts)
            values[row, st.GOALS, b] += goal_weight * share
        else:
            share = hindering(effect, wish, uniform) * goal_share[goal]
            values[row, st.INHIBITION, b] += conflictor_weight * share / opponents(wish, sensor, counts)


@inlined
def flow_between(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Add what behaviours of `row` give each other, where an effect of one meets a wish of another."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    pair_effect, pair_wish, wish_owner = m.pair_effect, m.pair_wish, m.wish_owner
    owner, sensors, change = m.effect_owner, m.effect_sensor, m.effect_change
    uniform, conflictor_weight = m.uniform, m.conflictor_weight
    predecessor_weight, successor_weight = m.predecessor_weight, m.successor_weight
    values, marks, wishes = s.values, s.marks, s.wishes
    live, live_wish = own.live_effect, own.live_wish
    operational, counts, total = own.operational, own.counts, s.row_values[row, st.TOTAL]
    for p in range(pair_effect.shape[0]):
        e, u = pair_effect[p], pair_wish[p]
        if not live[e] or not live_wish[u]:
            continue
        effect, wish, sensor = change[e], wishes[row, u], sensors[e]
        b, q = owner[e], wish_owner[u]
        if effect * wish > 0.0:
            help_ = helping(effect, wish, uniform) / total
            if operational[q] and not marks[row, st.READY, q]:
                share = help_ * values[row, st.ACTIVATION, q] / helpers(effect, sensor, counts)
                values[row, st.SUCCESSORS, b] += successor_weight * share
            if operational[b] and marks[row, st.READY, b] and values[row, st.SATISFACTION, b] > 0.0:
                share = help_ * values[row, st.ACTIVATION, b] / wishers(wish, sensor, counts)
                values[row, st.PREDECESSORS, q] += predecessor_weight * share
        elif operational[q]:
            share = hindering(effect, wish, uniform) * values[row, st.ACTIVATION, q] / total
            values[row, st.CONFLICTORS, b] += conflictor_weight * share / opponents(wish, sensor, counts)


@inlined
def flow_from_plan(row: int, model: Words[PackedModel], states: Written[RowStates], plans: Words[RowPlans]) -> None:
    """Set what the plan adds to the behaviours of its remaining steps: the sooner one is due, the more."""
    p, values, weight = open_plans(plans), open_states(states).values, open_model(model).plan_weight
    steps, index, length = p.steps, p.marks[row, INDEX], p.marks[row, LENGTH]
    for k in range(length - 1, index - 1, -1):  # backwards: the first occurrence is written last
        values[row, st.PLAN, steps[row, k]] = weight / (k - index + 1)


@inlined
def sum_terms(row: int, model: Words[PackedModel], states: Written[RowStates]) -> None:
    """Multiply the old activations of `row` by the decay and add the terms; activation never falls below 0."""
    values, decay = open_states(states).values, open_model(model).activation_decay
    for b in range(values.shape[2]):
        step = 0.0
        for layer in range(st.PRECONDITIONS, st.VALUE_LAYERS):
            step += values[row, layer, b]
        values[row, st.ACTIVATION, b] = max(0.0, decay * values[row, st.ACTIVATION, b] + step)
