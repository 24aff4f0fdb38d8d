"""Sharing, the third stage of a step: how many behaviours share a flow of activation (compiled).

A behaviour is *operational* when it is part of the network and switched on: only then do the others count it. An
effect or a wish is *live* when its behaviour is part of the network and it belongs to no alternative that the row does
not hold. A live effect counts for others only while its behaviour is operational; so does a live wish.
"""

from __future__ import annotations

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Words
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import state as st
from selforg.network.state.state import RowStates, open_states
from selforg.network.step.scratch import EITHER, NEGATIVE, POSITIVE, WISH_LESS, WISH_MORE, Scratch, open_scratch


@inlined
def share_row(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Find for `row` the operational behaviours, the live effects and wishes, and how many behaviours share each."""
    find_operational(row, states, scratch)
    find_live(row, model, states, scratch)
    count_effects(model, scratch)
    count_wishes(row, model, states, scratch)


@inlined
def is_operational(row: int, b: int, marks: Ints) -> bool:
    """Return whether behaviour `b` is part of the network and switched on."""
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
    for u in range(live_wish.shape[0]):  # the wishes of goals are always live
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
        positive, negative, either = count_owners(
            effects, firsts[sensor], firsts[sensor + 1], owner, change, live, operational
        )
        counts[POSITIVE, sensor], counts[NEGATIVE, sensor], counts[EITHER, sensor] = positive, negative, either


@inlined
def count_wishes(row: int, model: Words[PackedModel], states: Words[RowStates], scratch: Words[Scratch]) -> None:
    """Fill WISH_MORE and WISH_LESS of `counts` for every sensor from the wishes of `row`."""
    m, own = open_model(model), open_scratch(scratch)
    firsts, about, owner = m.sensor_wish_first, m.sensor_wish, m.wish_owner
    live, operational, counts = own.live_wish, own.operational, own.counts
    wishes = open_states(states).wishes[row]
    for sensor in range(counts.shape[1]):
        more, less, _ = count_owners(about, firsts[sensor], firsts[sensor + 1], owner, wishes, live, operational)
        counts[WISH_MORE, sensor], counts[WISH_LESS, sensor] = more, less


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
