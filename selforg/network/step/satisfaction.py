"""Satisfaction, the second stage of a step: conditions become satisfactions, readiness and wishes (compiled)."""

from __future__ import annotations

from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Words, Written
from selforg.network import state as st
from selforg.network.model import packed
from selforg.network.model.activators import activate
from selforg.network.model.packed import PackedModel, Scratch, open_model, open_scratch
from selforg.network.state import RowStates, open_states


@inlined
def satisfy_row(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Compute satisfactions, readiness and wishes of `row`; satisfied goals that are not permanent switch off."""
    evaluate_leaves(row, model, open_states(states).readings, scratch)
    evaluate_nodes(model, scratch)
    evaluate_wishes(row, model, states, scratch)
    judge_behaviours(row, model, states, scratch)
    judge_goals(row, model, states, scratch)


@lean_kernel
def evaluate_conditions(readings: Floats, model: Words[PackedModel], scratch: Words[Scratch]) -> None:
    """Fill leaves and nodes of `scratch` from `readings` (1, S), for an explanation."""
    evaluate_leaves(0, model, readings, scratch)
    evaluate_nodes(model, scratch)


@inlined
def evaluate_leaves(row: int, model: Words[PackedModel], readings: Floats, scratch: Words[Scratch]) -> None:
    """Fill satisfaction and wish of every leaf from the `readings` (R, S) of `row`."""
    m, own = open_model(model), open_scratch(scratch)
    sensor, kind, direction = m.leaf_sensor, m.leaf_kind, m.leaf_direction
    a, b = m.leaf_a, m.leaf_b
    low, high = m.leaf_low, m.leaf_high
    satisfaction, wish = own.leaf_satisfaction, own.leaf_wish
    for k in range(sensor.shape[0]):
        reading = readings[row, sensor[k]]
        satisfaction[k], wish[k] = activate(kind[k], reading, a[k], b[k], low[k], high[k], direction[k])


@inlined
def evaluate_nodes(model: Words[PackedModel], scratch: Words[Scratch]) -> None:
    """Fill the satisfaction of every node: product, maximum or 1 - s of its children."""
    m, own = open_model(model), open_scratch(scratch)
    kinds, first, child = m.node_kind, m.node_first, m.node_child
    leaf, value = own.leaf_satisfaction, own.node_satisfaction
    for node in range(kinds.shape[0]):
        kind, begin, end = kinds[node], first[node], first[node + 1]
        if kind == packed.LEAF:
            value[node] = leaf[child[begin]]
        elif kind == packed.NEGATION:
            value[node] = 1.0 - value[child[begin]]
        elif kind == packed.CONJUNCTION:
            product = 1.0
            for k in range(begin, end):
                product *= value[child[k]]
            value[node] = product
        else:
            largest = value[child[begin]]
            for k in range(begin + 1, end):
                largest = max(largest, value[child[k]])
            value[node] = largest


@inlined
def turned(wish: float, direction: float) -> float:
    """Return the wish of a negation whose condition has `wish`; `direction` if the condition wishes nothing."""
    if wish > 0.0:
        return wish - 1.0
    if wish < 0.0:
        return 1.0 + wish
    return direction


@inlined
def evaluate_wishes(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Fill the wishes of `row`; a wish of an alternative that is not held is not kept."""
    m, s = open_model(model), open_states(states)
    leaf, owner, tag = m.wish_leaf, m.wish_owner, m.wish_tag
    first, direction, leaf_wish = m.turn_first, m.turn_direction, open_scratch(scratch).leaf_wish
    marks, wishes, kept = s.marks, s.wishes, s.wish_kept
    for u in range(leaf.shape[0]):
        wish = leaf_wish[leaf[u]]
        for k in range(first[u], first[u + 1]):
            wish = turned(wish, direction[k])
        wishes[row, u] = wish
        kept[row, u] = 1 if tag[u] < 0 or marks[row, st.ALTERNATIVE, owner[u]] == tag[u] else 0


@inlined
def keep_smallest(row: int, behaviour: int, model: Words[PackedModel], states: Written[RowStates]) -> None:
    """Keep only the smallest of several wishes of one behaviour about one sensor."""
    m, s = open_model(model), open_states(states)
    first, sensor = m.wish_first, m.wish_sensor
    wishes, kept = s.wishes, s.wish_kept
    begin, end = first[behaviour], first[behaviour + 1]
    for u in range(begin, end):
        if not kept[row, u]:
            continue
        for other in range(begin, u):
            if kept[row, other] and sensor[other] == sensor[u]:
                weaker = u if abs(wishes[row, u]) >= abs(wishes[row, other]) else other
                kept[row, weaker] = 0
                if weaker == u:
                    break


@inlined
def judge_behaviours(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Fill satisfaction and readiness of the behaviours of `row` from their nodes."""
    m, s = open_model(model), open_states(states)
    first, node, tag = m.precondition_first, m.precondition_node, m.precondition_tag
    threshold, satisfaction = m.ready_threshold, open_scratch(scratch).node_satisfaction
    values, marks = s.values, s.marks
    for b in range(values.shape[2]):
        product = 1.0
        for k in range(first[b], first[b + 1]):
            if tag[k] < 0 or tag[k] == marks[row, st.ALTERNATIVE, b]:
                product *= satisfaction[node[k]]
        values[row, st.SATISFACTION, b] = product
        marks[row, st.READY, b] = 1 if product >= threshold[b] else 0
        if product > threshold[b]:
            keep_smallest(row, b, model, states)


@inlined
def judge_goals(row: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> None:
    """Fill the satisfaction of the goals of `row`; those that are satisfied and not permanent switch off."""
    m, s = open_model(model), open_states(states)
    first, node, node_satisfaction = m.goal_first, m.goal_node, open_scratch(scratch).node_satisfaction
    permanent, threshold = m.goal_permanent, m.goal_threshold
    satisfaction, enabled = s.goal_satisfaction, s.goal_enabled
    for g in range(permanent.shape[0]):
        product = 1.0
        for k in range(first[g], first[g + 1]):
            product *= node_satisfaction[node[k]]
        satisfaction[row, g] = product
        if product >= threshold[g] and not permanent[g]:
            enabled[row, g] = 0
