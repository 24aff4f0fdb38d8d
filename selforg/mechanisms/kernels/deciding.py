"""Decision rules: what one row makes of its neighbours' spread values. Compiled, chosen by an integer."""

from typing import Annotated, NamedTuple

from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Recording, Words, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight, open_store

DECIDE_QUORUM, DECIDE_GOSSIP_MAX, DECIDE_BARYCENTER = 0, 1, 2


class DecisionRule(NamedTuple):
    """A decision rule, what rows have decided so far, and room for what they decide now."""

    rule: int  # DECIDE_
    see_bits: int  # SEE_ bits
    view_distance: float  # [m]
    threshold: float  # of a quorum: number of neighbours
    key: int  # code of the payload entry that is compared
    before: Annotated[Floats, "N", READ]  # values up to now
    values: Annotated[Floats, "N", SCRATCH]  # room for values
    states: Annotated[Ints, "N", SCRATCH]  # room for states; they come in as they are up to now
    decided: Annotated[Flags, "N", SCRATCH]  # room for whether there is a decision


DECISION_RULE = Recording(DecisionRule)
open_decision_rule = DECISION_RULE.open


@lean_kernel
def decide_rows(
    now: float,
    rows: Ints,
    sight: Words[Sight],
    deciding: Words[DecisionRule],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write value, state and whether there is a decision for `rows` (R,) into those rows of `deciding`.

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    d, known, pairs = open_decision_rule(deciding), open_poses(poses).rows, open_sight(sight).pairs
    for index in range(len(rows)):
        row = int(rows[index])
        d.values[row] = d.before[row]
        found, sees = 0, known[row, c.ROW_POSES] > 0
        d.decided[row] = sees or d.rule != DECIDE_BARYCENTER  # distances need an own position
        if sees:
            margins = (d.view_distance, d.view_distance, d.view_distance)
            found = gather(look_all_around(row, now, d.see_bits, margins, 0, sight, poses), sight, poses, store)
        if found > len(pairs):
            return index
        if d.rule == DECIDE_QUORUM:
            d.values[row] = found
            d.states[row] = found >= d.threshold
        elif d.rule == DECIDE_GOSSIP_MAX:
            d.values[row] = highest(d.before[row], found, d.key, sight, store)
        elif found > 0:
            d.values[row] = 0.0
            for other in range(found):
                d.values[row] += pairs[other, c.PAIR_DISTANCE]
            d.states[row] = all_above(d.values[row], found, d.key, sight, store)
    return len(rows)


@part
def highest(own: float, found: int, key: int, sight: Words[Sight], store: Words[Store]) -> float:
    """Return the maximum of the own value and those that the first `found` pairs carry under `key`."""
    s, pairs = open_store(store), open_sight(sight).pairs
    for index in range(found):
        slot = int(pairs[index, c.PAIR_SLOT])
        if slot >= 0 and s.marks[slot, c.MARK_KEY] == key:
            own = max(own, s.far[slot, c.FAR_VALUE])
    return own


@part
def all_above(own: float, found: int, key: int, sight: Words[Sight], store: Words[Store]) -> bool:
    """Return whether all of the first `found` pairs carry a value above `own`; one without a value counts as equal."""
    s, pairs = open_store(store), open_sight(sight).pairs
    for index in range(found):
        slot = int(pairs[index, c.PAIR_SLOT])
        if slot < 0 or s.marks[slot, c.MARK_KEY] != key or not s.far[slot, c.FAR_VALUE] > own:
            return False
    return True
