"""Walking: a kernel for a formula of your own, which then runs for one robot or a million pairs."""

from collections.abc import Callable
from functools import cache
from typing import TypeAlias

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.store.columns import DIFFUSION, DISTANCE, GOAL, PAIR_DIFFUSION, PAIR_GOAL, POSES, SIGN
from selforg.gradients.store.gathering import gather
from selforg.gradients.store.pose_cells import poses_of
from selforg.mechanisms.kernels.rules import MAX_SPEED, MIN_SPEED, PARAMETERS, VIEW, add, full_length, limit

# (distance, own goal radius, own reach, diffusion, goal radius [m], attraction -1, 0, +1) -> length of a contribution:
# towards the gradient if positive, away from it if negative; minus infinity is full repulsion, of the gradient's reach
Formula: TypeAlias = Callable[[float, float, float, float, float, float], float]
Walk: TypeAlias = Callable[..., tuple[int, bool]]


@cache
def make_walk(formula: Formula) -> Walk:
    """Return a kernel that sums `formula`, a function compiled with `kernel`, over what rows see.

    The kernel is called as `FormulaMechanism` does it; it takes and returns what `moving.move_rows` does.
    """

    @lean_kernel
    def walk(
        begin: int, now: float, see: int, rows: Ints, places: Ints, channels: Ints, parameters: Floats, poses: Bundle,
        store: Bundle, drawn: Floats, cursor: Ints, pairs: Floats, vectors: Floats, active: Flags,
    ) -> tuple[int, bool]:  # fmt: skip
        own, known, _, _, _, _, _, _, _ = poses_of(poses)
        view, total, low = parameters[VIEW], parameters[PARAMETERS:], False
        for index in range(begin, len(rows)):
            row = int(rows[index])
            total[:] = 0.0
            found = 0
            if known[row, POSES] > 0:
                found = gather(row, (view, view, view), see, len(pairs) + 1, now, channels, poses, store, pairs)
            if found > len(pairs):
                return index, low
            own_goal, own_reach = own[row, 0, GOAL], own[row, 0, DIFFUSION] + own[row, 0, GOAL]
            for i in range(found):
                length = formula(
                    pairs[i, DISTANCE], own_goal, own_reach, pairs[i, PAIR_DIFFUSION], pairs[i, PAIR_GOAL],
                    pairs[i, SIGN],
                )  # fmt: skip
                add(total, pairs, i, length, full_length(pairs, i), row, drawn, cursor)
            limit(total, parameters[MIN_SPEED], parameters[MAX_SPEED])
            active[places[index]] = found > 0
            for axis in range(vectors.shape[1]):
                vectors[places[index], axis] = total[axis]
            low |= 2 * cursor[row] >= drawn.shape[1]
        return len(rows), low

    return walk
