"""Sharing, the third stage of a step: how many behaviours share a flow of activation (compiled).

A behaviour is *operational* when it is part of the network and switched on: the others take notice of it. An effect or
a wish is *live* when its behaviour is part of the network and it is not one of an alternative that the row does not
hold; it counts for others only while its behaviour is operational.
"""

from __future__ import annotations

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Words
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import state as st
from selforg.network.state.state import RowStates, open_states
from selforg.network.step.scratch import (
    EITHER,
    NEGATIVE,
    POSITIVE,
    WISH_LESS,
    WISH_MORE,
    Scratch,
    open_scratch,
)


@inlined
def share_row(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Find out for `row` who is operational, what is live, and how many share."""
    find_operational(row, states, scratch)
    find_live(row, model, states, scratch)
    count_effects(model, scratch)
    count_wishes(row, model, states, scratch)


@inlined
def is_operational(row: int, b: int, marks: Ints) -> bool:
    """Whether the other behaviours take notice of behaviour `b`."""
    return bool(marks[row, st.PRESENT, b] == 1 and marks[row, st.ENABLED, b] == 1)


@inlined
def find_operational(row: int, states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill `operational` for `row`."""
    marks, operational = open_states(states).marks, open_scratch(scratch).operational
    for b in range(operational.shape[0]):
        operational[b] = 1 if is_operational(row, b, marks) else 0


@inlined
def find_live(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill `live_effect` and `live_wish` for `row`."""
    m, s, own = open_model(model), open_states(states), open_scratch(scratch)
    owner, tag, change = m.effect_owner, m.effect_tag, m.effect_change
    wish_owner, kept, marks = m.wish_owner, s.wish_kept, s.marks
    live_effect, live_wish = own.live_effect, own.live_wish
    behaviours = marks.shape[2]
    for e in range(live_effect.shape[0]):
        b = owner[e]
        shown = tag[e] < 0 or tag[e] == marks[row, st.ALTERNATIVE, b]
        live_effect[e] = 1 if shown and change[e] != 0.0 and marks[row, st.PRESENT, b] else 0
    for u in range(live_wish.shape[0]):  # a goal's wishes are always live
        b = wish_owner[u]
        live_wish[u] = 1 if b >= behaviours or (kept[row, u] and marks[row, st.PRESENT, b]) else 0


@inlined
def count_effects(model: Words[PackedModel], scratch: Words[Scratch]) -> None:
    """Fill POSITIVE, NEGATIVE and EITHER of `counts` for every sensor."""
    m, own = open_model(model), open_scratch(scratch)
    firsts, effects = m.sensor_effect_first, m.sensor_effect
    owner, change = m.effect_owner, m.effect_change
    live, operational, counts = own.live_effect, own.operational, own.counts
    for sensor in range(counts.shape[1]):
        positive, negative, either = 0, 0, 0
        last_positive, last_negative, last = -1, -1, -1  # a behaviour's effects on one sensor follow each other
        for k in range(firsts[sensor], firsts[sensor + 1]):
            e = effects[k]
            b = owner[e]
            if not live[e] or not operational[b]:
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


@inlined
def count_wishes(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill WISH_MORE and WISH_LESS of `counts` for every sensor from the wishes of `row`."""
    m, own = open_model(model), open_scratch(scratch)
    firsts, about, owner = m.sensor_wish_first, m.sensor_wish, m.wish_owner
    live, operational, counts = own.live_wish, own.operational, own.counts
    wishes = open_states(states).wishes
    for sensor in range(counts.shape[1]):
        more, less = 0, 0
        last_more, last_less = -1, -1
        for k in range(firsts[sensor], firsts[sensor + 1]):
            u = about[k]
            b = owner[u]
            if not live[u] or not operational[b]:
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
