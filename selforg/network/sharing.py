"""Among how many behaviours a flow of activation is shared, and which effects and wishes take part (compiled).

All arrays belong to one row. An effect or wish is *live* when its behaviour is part of the network and it is not one of
an alternative that the row does not hold; it counts for others only while its behaviour is operational.
"""

from __future__ import annotations

from selforg.compiled import kernel
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.tables import Floats, Ints, floats_of, ints_of

# counts (COUNTS, S): operational behaviours that have, on a sensor,
POSITIVE, NEGATIVE, EITHER, WISH_MORE, WISH_LESS, COUNTS = range(6)  # an effect up, down, any; a wish up, down


@kernel
def operational(marks: Ints, row: int, b: int) -> bool:
    """Whether the other behaviours take notice of behaviour `b`."""
    return bool(marks[st.PRESENT, row, b] == 1 and marks[st.ENABLED, row, b] == 1)


@kernel
def find_live(
    ints: Ints, floats: Floats, present: Ints, alternative: Ints, kept: Ints, live_effect: Ints, live_wish: Ints
) -> None:
    """Fill `live_effect` (E,) and `live_wish` (U,) from `present`, `alternative` (B,) and `kept` (U,)."""
    owner, tag, change = ints_of(ints, t.EFFECT_OWNER), ints_of(ints, t.EFFECT_TAG), floats_of(floats, t.EFFECT_CHANGE)
    for e in range(owner.shape[0]):
        held = tag[e] < 0 or tag[e] == alternative[owner[e]]
        live_effect[e] = 1 if held and change[e] != 0.0 and present[owner[e]] else 0
    wish_owner = ints_of(ints, t.WISH_OWNER)
    for u in range(wish_owner.shape[0]):  # a goal's wishes are always live
        goal = wish_owner[u] >= present.shape[0]
        live_wish[u] = 1 if goal or (kept[u] and present[wish_owner[u]]) else 0


@kernel
def count_effects(ints: Ints, floats: Floats, heard: Ints, live: Ints, counts: Ints) -> None:
    """Fill POSITIVE, NEGATIVE and EITHER of `counts`; `heard` (B,) says which behaviours are operational."""
    first, entry = ints_of(ints, t.SENSOR_EFFECT_FIRST), ints_of(ints, t.SENSOR_EFFECT)
    owner, change = ints_of(ints, t.EFFECT_OWNER), floats_of(floats, t.EFFECT_CHANGE)
    for sensor in range(counts.shape[1]):
        positive, negative, either = 0, 0, 0
        last_positive, last_negative, last = -1, -1, -1  # a behaviour's effects on one sensor follow each other
        for k in range(first[sensor], first[sensor + 1]):
            e = entry[k]
            b = owner[e]
            if not live[e] or not heard[b]:
                continue
            if change[e] > 0.0 and b != last_positive:
                positive += 1
                last_positive = b
            if change[e] < 0.0 and b != last_negative:
                negative += 1
                last_negative = b
            if b != last:
                either += 1
                last = b
        counts[POSITIVE, sensor], counts[NEGATIVE, sensor], counts[EITHER, sensor] = positive, negative, either


@kernel
def count_wishes(ints: Ints, heard: Ints, live: Ints, wishes: Floats, counts: Ints) -> None:
    """Fill WISH_MORE and WISH_LESS of `counts`."""
    first, entry = ints_of(ints, t.SENSOR_WISH_FIRST), ints_of(ints, t.SENSOR_WISH)
    owner = ints_of(ints, t.WISH_OWNER)
    for sensor in range(counts.shape[1]):
        more, less = 0, 0
        last_more, last_less = -1, -1
        for k in range(first[sensor], first[sensor + 1]):
            u = entry[k]
            b = owner[u]
            if not live[u] or not heard[b]:
                continue
            if wishes[u] > 0.0 and b != last_more:
                more += 1
                last_more = b
            if wishes[u] < 0.0 and b != last_less:
                less += 1
                last_less = b
        counts[WISH_MORE, sensor], counts[WISH_LESS, sensor] = more, less


@kernel
def helpers(effect: float, sensor: int, counts: Ints) -> int:
    """How many share what goes to effects of this sign, at least 1."""
    return int(max(counts[POSITIVE, sensor] if effect > 0.0 else counts[NEGATIVE, sensor], 1))


@kernel
def wishers(wish: float, sensor: int, counts: Ints) -> int:
    """How many share what goes to wishes of this sign, at least 1."""
    return int(max(counts[WISH_MORE, sensor] if wish > 0.0 else counts[WISH_LESS, sensor], 1))


@kernel
def opponents(wish: float, sensor: int, counts: Ints) -> int:
    """How many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    if wish == 0.0:
        return int(max(counts[EITHER, sensor], 1))
    return int(max(counts[NEGATIVE, sensor] if wish > 0.0 else counts[POSITIVE, sensor], 1))
