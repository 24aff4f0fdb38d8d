"""A network model as flat arrays, in the form that the kernels read.

Handing an array to compiled code costs about 0.2 us, so all integers of a model lie in one array and all floats in
another. Both start with the offsets of their sections: kernels add what they look for to `begin_of` or `float_begin_of`
(a view would cost more than what is read from it), Python cuts a section out by `ints_of`. Letters:
S sensors, B behaviours, G goals, L leaves (conditions), C nodes (conditions and what is composed of them), E effects,
U wishes (a behaviour's or a goal's view of one leaf).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.decorators import inlined

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

(
    SIZES,  # S, B, G, C, U
    OPTIONS,  # uniform algorithm, max_parallel (0: any), goal_priority, strict_progress
    SENSOR_IS_FACT,  # (S,)
    LEAF_SENSOR,  # (L,)
    LEAF_KIND,  # (L,) activator kind
    NODE_KIND,  # (C,) LEAF, NEGATION, CONJUNCTION, DISJUNCTION; children come before parents
    NODE_FIRST,  # (C + 1,) into NODE_CHILD
    NODE_CHILD,  # nodes (or the leaf, of a LEAF node)
    PRECONDITION_FIRST,  # (B + 1,)
    PRECONDITION_NODE,
    PRECONDITION_TAG,  # alternative that it belongs to, -1: always
    GOAL_FIRST,  # (G + 1,)
    GOAL_NODE,
    WISH_FIRST,  # (B + G + 1,) behaviours, then goals
    WISH_OWNER,  # (U,)
    WISH_SENSOR,  # (U,)
    WISH_LEAF,  # (U,)
    WISH_TAG,  # (U,)
    TURN_FIRST,  # (U + 1,) into TURN_DIRECTION
    EFFECT_FIRST,  # (B + 1,)
    EFFECT_OWNER,  # (E,)
    EFFECT_SENSOR,  # (E,)
    EFFECT_TAG,  # (E,)
    SENSOR_EFFECT_FIRST,  # (S + 1,)
    SENSOR_EFFECT,
    SENSOR_WISH_FIRST,  # (S + 1,) wishes of behaviours
    SENSOR_WISH,
    SENSOR_GOAL_WISH_FIRST,  # (S + 1,)
    SENSOR_GOAL_WISH,
    PAIR_EFFECT,  # pairs of an effect and a wish of another behaviour about one sensor, by sensor
    PAIR_WISH,
    GOAL_PAIR_EFFECT,  # pairs of an effect and a goal's wish about one sensor, by sensor
    GOAL_PAIR_WISH,
    INTERRUPTABLE,  # (B,)
    TIMEOUT,  # (B,) steps, -1: never
    PERMANENT,  # (G,)
    INT_SECTIONS,
) = range(37)

(
    WEIGHTS,  # situation, goal, conflictor, predecessor, successor, plan
    DYNAMICS,  # activation decay, threshold decay
    LEAF_A,  # (L,)
    LEAF_B,  # (L,)
    LEAF_LOW,  # (L,)
    LEAF_HIGH,  # (L,)
    LEAF_DIRECTION,  # (L,)
    TURN_DIRECTION,  # wish of a satisfied leaf after each negation above it
    EFFECT_CHANGE,  # (E,)
    READY_THRESHOLD,  # (B,)
    GOAL_THRESHOLD,  # (G,)
    GOAL_PRIORITY,  # (G,)
    FLOAT_SECTIONS,
) = range(13)

LEAF, NEGATION, CONJUNCTION, DISJUNCTION = range(4)


def pack_ints(sections: Mapping[int, list[int]]) -> Ints:
    """One int64 array: the INT_SECTIONS + 1 offsets, then the sections in their order."""
    return np.asarray(_with_offsets([sections[k] for k in range(INT_SECTIONS)]), dtype=np.int64)


def pack_floats(sections: Mapping[int, list[float]]) -> Floats:
    """One float64 array: the FLOAT_SECTIONS + 1 offsets, then the sections in their order."""
    return np.asarray(_with_offsets([sections[k] for k in range(FLOAT_SECTIONS)]), dtype=np.float64)


def _with_offsets(sections: list[list[int]] | list[list[float]]) -> list[float]:
    offsets: list[float] = np.cumsum([len(sections) + 1, *map(len, sections)]).tolist()
    return offsets + [number for section in sections for number in section]


@inlined
def begin_of(table: Ints, section: int) -> int:
    """Where a section of the packed integers begins."""
    return int(table[section])


@inlined
def size_of(table: Ints, section: int) -> int:
    """Length of a section of the packed integers."""
    return int(table[section + 1] - table[section])


@inlined
def float_begin_of(table: Floats, section: int) -> int:
    """Where a section of the packed floats begins."""
    return int(table[section])


def ints_of(table: Ints, section: int) -> Ints:
    """One section of the packed integers, as a view."""
    return table[table[section] : table[section + 1]]
