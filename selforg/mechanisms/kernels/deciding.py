"""Decision rules: what one row makes of its neighbours' spread values. Compiled, chosen by an integer."""

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel, part
from selforg.gradients.store.candidates import store_of
from selforg.gradients.store.columns import DISTANCE, KEY, POSES, SLOT, VALUE
from selforg.gradients.store.gathering import gather
from selforg.gradients.store.pose_cells import poses_of

QUORUM, GOSSIP_MAX, BARYCENTER = 0, 1, 2


@lean_kernel
def decide_rows(
    begin: int, rule: int, now: float, see: int, view: float, threshold: float, key: int, rows: Ints, channels: Ints,
    poses: Bundle, store: Bundle, pairs: Floats, before: Floats, values: Floats, states: Ints, decided: Flags,
) -> int:  # fmt: skip
    """Write value, state and whether there is a decision for rows[begin:] (R,) into `values`, `states`, `decided` (R,).

    before: (N,) values up to now; key: code of the payload entry that is compared; states come in as they are now.
    Returns how many rows are done, fewer than R if `pairs` is too short.
    """
    for index in range(begin, len(rows)):
        row = int(rows[index])
        values[index] = before[row]
        decided[index] = poses_of(poses)[1][row, POSES] > 0
        if not decided[index]:
            continue
        found = gather(row, (view, view, view), see, len(pairs) + 1, now, channels, poses, store, pairs)
        if found > len(pairs):
            return index
        if rule == QUORUM:
            values[index] = found
            states[index] = found >= threshold
        elif rule == GOSSIP_MAX:
            values[index] = highest(before[row], pairs, found, key, store)
        elif found > 0:
            values[index] = 0.0
            for other in range(found):
                values[index] += pairs[other, DISTANCE]
            states[index] = all_above(values[index], pairs, found, key, store)
    return len(rows)


@part
def highest(own: float, pairs: Floats, found: int, key: int, store: Bundle) -> float:
    """Return the maximum of the own value and those that the first `found` pairs carry under `key`."""
    _, _, far, marks, _, _, _, _, _ = store_of(store)
    for index in range(found):
        slot = int(pairs[index, SLOT])
        if slot >= 0 and marks[slot, KEY] == key:
            own = max(own, far[slot, VALUE])
    return own


@part
def all_above(own: float, pairs: Floats, found: int, key: int, store: Bundle) -> bool:
    """Tell whether all of the first `found` pairs carry a value above `own`; one without a value counts as equal."""
    _, _, far, marks, _, _, _, _, _ = store_of(store)
    for index in range(found):
        slot = int(pairs[index, SLOT])
        if slot < 0 or marks[slot, KEY] != key or not far[slot, VALUE] > own:
            return False
    return True
