"""Satisfaction, the second stage of a step: conditions become satisfactions, readiness and wishes (compiled)."""

from __future__ import annotations

from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.network.model import packed
from selforg.network.model.activators import activate
from selforg.network.model.packed import PackedModel, Scratch, open_model, open_scratch
from selforg.network.state import RowStates, open_states


@inlined
def satisfy_row(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Compute satisfactions, readiness and wishes of `row`; satisfied goals that are not permanent switch off."""
    evaluate_leaves(row, model, open_states(states).readings, scratch)
    evaluate_nodes(model, scratch)
    evaluate_wishes(row, model, states, scratch)
    judge_behaviours(row, model, states, scratch)
    judge_goals(row, model, states, scratch)


@lean_kernel
def evaluate_conditions(readings: Floats, model: Handle[PackedModel], scratch: Handle[Scratch]) -> None:
    """Fill leaves and nodes of `scratch` from `readings` (1, S), for an explanation."""
    evaluate_leaves(0, model, readings, scratch)
    evaluate_nodes(model, scratch)


@inlined
def evaluate_leaves(row: int, model: Handle[PackedModel], readings: Floats, scratch: Handle[Scratch]) -> None:
    """Fill satisfaction and wish of every leaf from the `readings` (R, S) of `row`."""
    m, own, read = open_model(model), open_scratch(scratch), readings[row]
    for k in range(m.leaf_sensor.shape[0]):
        reading = read[m.leaf_sensor[k]]
        own.leaf_satisfaction[k], own.leaf_wish[k] = activate(
            m.leaf_kind[k], reading, m.leaf_a[k], m.leaf_b[k], m.leaf_low[k], m.leaf_high[k], m.leaf_direction[k]
        )


@inlined
def evaluate_nodes(model: Handle[PackedModel], scratch: Handle[Scratch]) -> None:
    """Fill the satisfaction of every node: product, maximum or 1 - s of its children."""
    m, own = open_model(model), open_scratch(scratch)
    for node in range(m.node_kind.shape[0]):
        kind, begin, end = m.node_kind[node], m.node_first[node], m.node_first[node + 1]
        if kind == packed.LEAF:
            own.node_satisfaction[node] = own.leaf_satisfaction[m.node_child[begin]]
        elif kind == packed.NEGATION:
            own.node_satisfaction[node] = 1.0 - own.node_satisfaction[m.node_child[begin]]
        elif kind == packed.CONJUNCTION:
            product = 1.0
            for k in range(begin, end):
                product *= own.node_satisfaction[m.node_child[k]]
            own.node_satisfaction[node] = product
        else:
            largest = own.node_satisfaction[m.node_child[begin]]
            for k in range(begin + 1, end):
                largest = max(largest, own.node_satisfaction[m.node_child[k]])
            own.node_satisfaction[node] = largest


@inlined
def turned(wish: float, direction: float) -> float:
    """Return the wish of a negation whose condition has `wish`; `direction` if the condition wishes nothing."""
    if wish > 0.0:
        return wish - 1.0
    if wish < 0.0:
        return 1.0 + wish
    return direction


@inlined
def evaluate_wishes(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill the wishes of `row`; a wish of an alternative that is not held is not kept."""
    m, s = open_model(model), open_states(states)
    wishes, kept, marks = s.wishes[row], s.wish_kept[row], s.marks[row]
    leaf_wish = open_scratch(scratch).leaf_wish
    for u in range(m.wish_leaf.shape[0]):
        wish = leaf_wish[m.wish_leaf[u]]
        for k in range(m.turn_first[u], m.turn_first[u + 1]):
            wish = turned(wish, m.turn_direction[k])
        wishes[u] = wish
        kept[u] = 1 if m.wish_tag[u] < 0 or marks[st.ALTERNATIVE, m.wish_owner[u]] == m.wish_tag[u] else 0


@inlined
def keep_smallest(row: int, behaviour: int, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Keep only the smallest of several wishes of one behaviour about one sensor."""
    m, wishes, kept = open_model(model), open_states(states).wishes[row], open_states(states).wish_kept[row]
    begin, end = m.wish_first[behaviour], m.wish_first[behaviour + 1]
    for u in range(begin, end):
        if not kept[u]:
            continue
        for other in range(begin, u):
            if kept[other] and m.wish_sensor[other] == m.wish_sensor[u]:
                weaker = u if abs(wishes[u]) >= abs(wishes[other]) else other
                kept[weaker] = 0
                if weaker == u:
                    break


@inlined
def judge_behaviours(
    row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]
) -> None:
    """Fill satisfaction and readiness of the behaviours of `row` from their nodes."""
    m, values, marks = open_model(model), open_states(states).values[row], open_states(states).marks[row]
    satisfaction = open_scratch(scratch).node_satisfaction
    for b in range(values.shape[1]):
        product = 1.0
        for k in range(m.precondition_first[b], m.precondition_first[b + 1]):
            if m.precondition_tag[k] < 0 or m.precondition_tag[k] == marks[st.ALTERNATIVE, b]:
                product *= satisfaction[m.precondition_node[k]]
        values[st.SATISFACTION, b] = product
        marks[st.READY, b] = 1 if product >= m.ready_threshold[b] else 0
        if product > m.ready_threshold[b]:
            keep_smallest(row, b, model, states)


@inlined
def judge_goals(row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill the satisfaction of the goals of `row`; those that are satisfied and not permanent switch off."""
    m, s = open_model(model), open_states(states)
    node_satisfaction = open_scratch(scratch).node_satisfaction
    for g in range(m.goal_permanent.shape[0]):
        product = 1.0
        for k in range(m.goal_first[g], m.goal_first[g + 1]):
            product *= node_satisfaction[m.goal_node[k]]
        s.goal_satisfaction[row, g] = product
        if product >= m.goal_threshold[g] and not m.goal_permanent[g]:
            s.goal_enabled[row, g] = 0
