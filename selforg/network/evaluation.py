"""Conditions evaluated for one row: satisfactions, readiness and wishes (compiled)."""

from __future__ import annotations

from selforg.compiled import kernel
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.activators import activate
from selforg.network.tables import Floats, Ints, floats_of, ints_of


@kernel
def evaluate_leaves(ints: Ints, floats: Floats, readings: Floats, satisfaction: Floats, wish: Floats) -> None:
    """Activate every condition on one row's `readings` (S,); fills `satisfaction` and `wish` (L,)."""
    sensor, kind = ints_of(ints, t.LEAF_SENSOR), ints_of(ints, t.LEAF_KIND)
    a, b = floats_of(floats, t.LEAF_A), floats_of(floats, t.LEAF_B)
    low, high = floats_of(floats, t.LEAF_LOW), floats_of(floats, t.LEAF_HIGH)
    direction = floats_of(floats, t.LEAF_DIRECTION)
    for k in range(sensor.shape[0]):
        satisfaction[k], wish[k] = activate(kind[k], readings[sensor[k]], a[k], b[k], low[k], high[k], direction[k])


@kernel
def evaluate_nodes(ints: Ints, leaf_satisfaction: Floats, value: Floats) -> None:
    """Satisfaction of every node (C,): product, maximum or 1 - s of its children."""
    kind, first, child = ints_of(ints, t.NODE_KIND), ints_of(ints, t.NODE_FIRST), ints_of(ints, t.NODE_CHILD)
    for node in range(kind.shape[0]):
        begin, end = first[node], first[node + 1]
        if kind[node] == t.LEAF:
            value[node] = leaf_satisfaction[child[begin]]
        elif kind[node] == t.NEGATION:
            value[node] = 1.0 - value[child[begin]]
        elif kind[node] == t.CONJUNCTION:
            value[node] = 1.0
            for k in range(begin, end):
                value[node] *= value[child[k]]
        else:
            value[node] = value[child[begin]]
            for k in range(begin + 1, end):
                value[node] = max(value[node], value[child[k]])


@kernel
def turned(wish: float, direction: float) -> float:
    """Turn a wish round, as a negation does: what would have to be undone, or `direction` if nothing is wished."""
    if wish > 0.0:
        return wish - 1.0
    if wish < 0.0:
        return 1.0 + wish
    return direction


@kernel
def evaluate_wishes(
    ints: Ints, floats: Floats, leaf_wish: Floats, alternative: Ints, wishes: Floats, kept: Ints
) -> None:
    """All wishes of one row (U,); those of alternatives that are not held are not `kept`."""
    leaf, owner, tag = ints_of(ints, t.WISH_LEAF), ints_of(ints, t.WISH_OWNER), ints_of(ints, t.WISH_TAG)
    first, direction = ints_of(ints, t.TURN_FIRST), floats_of(floats, t.TURN_DIRECTION)
    for u in range(leaf.shape[0]):
        wish = leaf_wish[leaf[u]]
        for k in range(first[u], first[u + 1]):
            wish = turned(wish, direction[k])
        wishes[u] = wish
        kept[u] = 1 if tag[u] < 0 or alternative[owner[u]] == tag[u] else 0


@kernel
def keep_smallest(ints: Ints, behaviour: int, wishes: Floats, kept: Ints) -> None:
    """Of several wishes of one behaviour about one sensor keep the smallest one only."""
    first, sensor = ints_of(ints, t.WISH_FIRST), ints_of(ints, t.WISH_SENSOR)
    begin, end = first[behaviour], first[behaviour + 1]
    for u in range(begin, end):
        if not kept[u]:
            continue
        for other in range(begin, u):
            if kept[other] and sensor[other] == sensor[u]:
                weaker = u if abs(wishes[u]) >= abs(wishes[other]) else other
                kept[weaker] = 0
                if weaker == u:
                    break


@kernel
def evaluate_row(
    row: int, ints: Ints, floats: Floats, readings: Floats, values: Floats, marks: Ints,
    goal_satisfaction: Floats, goal_enabled: Ints, wishes: Floats, kept: Ints, leaf_scratch: Floats,
    node_scratch: Floats,
) -> None:  # fmt: skip
    """Satisfactions, readiness and wishes of `row`; satisfied goals that are not permanent switch off."""
    evaluate_leaves(ints, floats, readings[row], leaf_scratch[0], leaf_scratch[1])
    evaluate_nodes(ints, leaf_scratch[0], node_scratch)
    alternative = marks[st.ALTERNATIVE, row]
    evaluate_wishes(ints, floats, leaf_scratch[1], alternative, wishes[row], kept[row])
    judge_behaviours(
        ints, floats, node_scratch, alternative, values[st.SATISFACTION, row], marks[st.READY, row], wishes[row],
        kept[row],
    )  # fmt: skip
    judge_goals(ints, floats, node_scratch, goal_satisfaction[row], goal_enabled[row])


@kernel
def judge_behaviours(
    ints: Ints, floats: Floats, node_value: Floats, alternative: Ints, satisfaction: Floats, ready: Ints,
    wishes: Floats, kept: Ints,
) -> None:  # fmt: skip
    """Satisfaction and readiness (B,) of behaviours from their nodes' values (C,)."""
    first, node = ints_of(ints, t.PRECONDITION_FIRST), ints_of(ints, t.PRECONDITION_NODE)
    tag, ready_threshold = ints_of(ints, t.PRECONDITION_TAG), floats_of(floats, t.READY_THRESHOLD)
    for b in range(satisfaction.shape[0]):
        product = 1.0
        for k in range(first[b], first[b + 1]):
            if tag[k] < 0 or tag[k] == alternative[b]:
                product *= node_value[node[k]]
        satisfaction[b] = product
        ready[b] = 1 if product >= ready_threshold[b] else 0
        if product > ready_threshold[b]:
            keep_smallest(ints, b, wishes, kept)


@kernel
def judge_goals(ints: Ints, floats: Floats, node_value: Floats, satisfaction: Floats, enabled: Ints) -> None:
    """Satisfaction (G,) of goals; those that are satisfied and not permanent switch off."""
    first, node = ints_of(ints, t.GOAL_FIRST), ints_of(ints, t.GOAL_NODE)
    permanent, threshold = ints_of(ints, t.PERMANENT), floats_of(floats, t.GOAL_THRESHOLD)
    for g in range(satisfaction.shape[0]):
        product = 1.0
        for k in range(first[g], first[g + 1]):
            product *= node_value[node[k]]
        satisfaction[g] = product
        if product >= threshold[g] and not permanent[g]:
            enabled[g] = 0
