"""Among how many behaviours a flow of activation is shared, and which effects and wishes take part (compiled).

An effect or wish is *live* when its behaviour is part of the network and it is not one of an alternative that the row
does not hold; it counts for others only while its behaviour is operational.
"""

from __future__ import annotations

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.packed import Floats, Ints, begin_of, float_begin_of
from selforg.network.state import state as st

# counts (COUNTS, S): operational behaviours that have, on a sensor,
POSITIVE, NEGATIVE, EITHER, WISH_MORE, WISH_LESS, COUNTS = range(6)  # an effect up, down, any; a wish up, down


@inlined
def operational(row: int, b: int, marks: Ints) -> bool:
    """Whether the other behaviours take notice of behaviour `b`."""
    return bool(marks[row, st.PRESENT, b] == 1 and marks[row, st.ENABLED, b] == 1)


@inlined
def find_live(
    row: int, ints: Ints, floats: Floats, marks: Ints, kept: Ints, live_effect: Ints, live_wish: Ints
) -> None:
    """Fill `live_effect` (E,) and `live_wish` (U,) for `row`; `kept` (R, U)."""
    owner, tag = begin_of(ints, t.EFFECT_OWNER), begin_of(ints, t.EFFECT_TAG)
    change, wish_owner = float_begin_of(floats, t.EFFECT_CHANGE), begin_of(ints, t.WISH_OWNER)
    behaviours = marks.shape[2]
    for e in range(live_effect.shape[0]):
        b, held = ints[owner + e], ints[tag + e]
        shown = held < 0 or held == marks[row, st.ALTERNATIVE, b]
        live_effect[e] = 1 if shown and floats[change + e] != 0.0 and marks[row, st.PRESENT, b] else 0
    for u in range(live_wish.shape[0]):  # a goal's wishes are always live
        b = ints[wish_owner + u]
        live_wish[u] = 1 if b >= behaviours or (kept[row, u] and marks[row, st.PRESENT, b]) else 0


@inlined
def count_effects(ints: Ints, floats: Floats, heard: Ints, live: Ints, counts: Ints) -> None:
    """Fill POSITIVE, NEGATIVE and EITHER of `counts`; `heard` (B,) says which behaviours are operational."""
    firsts, entry = begin_of(ints, t.SENSOR_EFFECT_FIRST), begin_of(ints, t.SENSOR_EFFECT)
    owner, change = begin_of(ints, t.EFFECT_OWNER), float_begin_of(floats, t.EFFECT_CHANGE)
    for sensor in range(counts.shape[1]):
        positive, negative, either = 0, 0, 0
        last_positive, last_negative, last = -1, -1, -1  # a behaviour's effects on one sensor follow each other
        for k in range(ints[firsts + sensor], ints[firsts + sensor + 1]):
            e = ints[entry + k]
            b = ints[owner + e]
            if not live[e] or not heard[b]:
                continue
            if floats[change + e] > 0.0 and b != last_positive:
                positive += 1
                last_positive = b
            if floats[change + e] < 0.0 and b != last_negative:
                negative += 1
                last_negative = b
            if b != last:
                either += 1
                last = b
        counts[POSITIVE, sensor], counts[NEGATIVE, sensor], counts[EITHER, sensor] = positive, negative, either


@inlined
def count_wishes(row: int, ints: Ints, heard: Ints, live: Ints, wishes: Floats, counts: Ints) -> None:
    """Fill WISH_MORE and WISH_LESS of `counts` from the wishes (R, U) of `row`."""
    firsts, entry = begin_of(ints, t.SENSOR_WISH_FIRST), begin_of(ints, t.SENSOR_WISH)
    owner = begin_of(ints, t.WISH_OWNER)
    for sensor in range(counts.shape[1]):
        more, less = 0, 0
        last_more, last_less = -1, -1
        for k in range(ints[firsts + sensor], ints[firsts + sensor + 1]):
            u = ints[entry + k]
            b = ints[owner + u]
            if not live[u] or not heard[b]:
                continue
            if wishes[row, u] > 0.0 and b != last_more:
                more += 1
                last_more = b
            if wishes[row, u] < 0.0 and b != last_less:
                less += 1
                last_less = b
        counts[WISH_MORE, sensor], counts[WISH_LESS, sensor] = more, less


@inlined
def helpers(effect: float, sensor: int, counts: Ints) -> int:
    """How many share what goes to effects of this sign, at least 1."""
    return int(max(counts[POSITIVE, sensor] if effect > 0.0 else counts[NEGATIVE, sensor], 1))


@inlined
def wishers(wish: float, sensor: int, counts: Ints) -> int:
    """How many share what goes to wishes of this sign, at least 1."""
    return int(max(counts[WISH_MORE, sensor] if wish > 0.0 else counts[WISH_LESS, sensor], 1))


@inlined
def opponents(wish: float, sensor: int, counts: Ints) -> int:
    """How many share the inhibition of a wish: those whose effect goes against it, at least 1."""
    if wish == 0.0:
        return int(max(counts[EITHER, sensor], 1))
    return int(max(counts[NEGATIVE, sensor] if wish > 0.0 else counts[POSITIVE, sensor], 1))
