"""Conditions evaluated for one row: satisfactions, readiness and wishes (compiled)."""

from __future__ import annotations

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.activators import activate
from selforg.network.model.packed import Floats, Ints, begin_of, float_begin_of, size_of
from selforg.network.state import state as st

SATISFACTION, WISH = range(2)  # of a leaf


@inlined
def evaluate_leaves(row: int, ints: Ints, floats: Floats, readings: Floats, leaves: Floats) -> None:
    """Activate every condition on the `readings` (R, S) of `row`; fills satisfaction and wish in `leaves` (2, L)."""
    sensor, kind = begin_of(ints, t.LEAF_SENSOR), begin_of(ints, t.LEAF_KIND)
    a, b = float_begin_of(floats, t.LEAF_A), float_begin_of(floats, t.LEAF_B)
    low, high = float_begin_of(floats, t.LEAF_LOW), float_begin_of(floats, t.LEAF_HIGH)
    direction = float_begin_of(floats, t.LEAF_DIRECTION)
    for k in range(size_of(ints, t.LEAF_SENSOR)):
        leaves[SATISFACTION, k], leaves[WISH, k] = activate(
            ints[kind + k], readings[row, ints[sensor + k]], floats[a + k], floats[b + k], floats[low + k],
            floats[high + k], floats[direction + k],
        )  # fmt: skip


@inlined
def evaluate_nodes(ints: Ints, leaves: Floats, value: Floats) -> None:
    """Satisfaction of every node (C,): product, maximum or 1 - s of its children; `leaves` (2, L)."""
    kinds, first, child = begin_of(ints, t.NODE_KIND), begin_of(ints, t.NODE_FIRST), begin_of(ints, t.NODE_CHILD)
    for node in range(size_of(ints, t.NODE_KIND)):
        kind, begin, end = ints[kinds + node], child + ints[first + node], child + ints[first + node + 1]
        if kind == t.LEAF:
            value[node] = leaves[SATISFACTION, ints[begin]]
        elif kind == t.NEGATION:
            value[node] = 1.0 - value[ints[begin]]
        elif kind == t.CONJUNCTION:
            product = 1.0
            for k in range(begin, end):
                product *= value[ints[k]]
            value[node] = product
        else:
            largest = value[ints[begin]]
            for k in range(begin + 1, end):
                largest = max(largest, value[ints[k]])
            value[node] = largest


@inlined
def turned(wish: float, direction: float) -> float:
    """Turn a wish round, as a negation does: what would have to be undone, or `direction` if nothing is wished."""
    if wish > 0.0:
        return wish - 1.0
    if wish < 0.0:
        return 1.0 + wish
    return direction


@inlined
def evaluate_wishes(
    row: int, ints: Ints, floats: Floats, leaves: Floats, marks: Ints, wishes: Floats, kept: Ints
) -> None:
    """All wishes (R, U) of `row`; those of alternatives that are not held are not `kept` (R, U)."""
    leaf, owner, tag = begin_of(ints, t.WISH_LEAF), begin_of(ints, t.WISH_OWNER), begin_of(ints, t.WISH_TAG)
    first, direction = begin_of(ints, t.TURN_FIRST), float_begin_of(floats, t.TURN_DIRECTION)
    for u in range(size_of(ints, t.WISH_LEAF)):
        wish = leaves[WISH, ints[leaf + u]]
        for k in range(ints[first + u], ints[first + u + 1]):
            wish = turned(wish, floats[direction + k])
        wishes[row, u] = wish
        held = ints[tag + u]
        kept[row, u] = 1 if held < 0 or marks[row, st.ALTERNATIVE, ints[owner + u]] == held else 0


@inlined
def keep_smallest(row: int, ints: Ints, behaviour: int, wishes: Floats, kept: Ints) -> None:
    """Of several wishes of one behaviour about one sensor keep the smallest one only."""
    first, sensor = begin_of(ints, t.WISH_FIRST), begin_of(ints, t.WISH_SENSOR)
    begin, end = ints[first + behaviour], ints[first + behaviour + 1]
    for u in range(begin, end):
        if not kept[row, u]:
            continue
        for other in range(begin, u):
            if kept[row, other] and ints[sensor + other] == ints[sensor + u]:
                weaker = u if abs(wishes[row, u]) >= abs(wishes[row, other]) else other
                kept[row, weaker] = 0
                if weaker == u:
                    break


@inlined
def judge_behaviours(
    row: int, ints: Ints, floats: Floats, node_value: Floats, values: Floats, marks: Ints, wishes: Floats, kept: Ints
) -> None:
    """Satisfaction and readiness of the behaviours of `row` from their nodes' values (C,)."""
    first, node = begin_of(ints, t.PRECONDITION_FIRST), begin_of(ints, t.PRECONDITION_NODE)
    tag, threshold = begin_of(ints, t.PRECONDITION_TAG), float_begin_of(floats, t.READY_THRESHOLD)
    for b in range(values.shape[2]):
        product = 1.0
        for k in range(ints[first + b], ints[first + b + 1]):
            if ints[tag + k] < 0 or ints[tag + k] == marks[row, st.ALTERNATIVE, b]:
                product *= node_value[ints[node + k]]
        values[row, st.SATISFACTION, b] = product
        marks[row, st.READY, b] = 1 if product >= floats[threshold + b] else 0
        if product > floats[threshold + b]:
            keep_smallest(row, ints, b, wishes, kept)


@inlined
def judge_goals(row: int, ints: Ints, floats: Floats, node_value: Floats, satisfaction: Floats, enabled: Ints) -> None:
    """Satisfaction (R, G) of the goals of `row`; those that are satisfied and not permanent switch off."""
    first, node = begin_of(ints, t.GOAL_FIRST), begin_of(ints, t.GOAL_NODE)
    permanent, threshold = begin_of(ints, t.PERMANENT), float_begin_of(floats, t.GOAL_THRESHOLD)
    for g in range(satisfaction.shape[1]):
        product = 1.0
        for k in range(ints[first + g], ints[first + g + 1]):
            product *= node_value[ints[node + k]]
        satisfaction[row, g] = product
        if product >= floats[threshold + g] and not ints[permanent + g]:
            enabled[row, g] = 0


@inlined
def evaluate_row(
    row: int, ints: Ints, floats: Floats, readings: Floats, values: Floats, marks: Ints,
    goal_satisfaction: Floats, goal_enabled: Ints, wishes: Floats, kept: Ints, leaves: Floats, nodes: Floats,
) -> None:  # fmt: skip
    """Satisfactions, readiness and wishes of `row`; satisfied goals that are not permanent switch off."""
    evaluate_leaves(row, ints, floats, readings, leaves)
    evaluate_nodes(ints, leaves, nodes)
    evaluate_wishes(row, ints, floats, leaves, marks, wishes, kept)
    judge_behaviours(row, ints, floats, nodes, values, marks, wishes, kept)
    judge_goals(row, ints, floats, nodes, goal_satisfaction, goal_enabled)
