"""What compiled code needs of the ground and the robots in a tick, as one bundle, and the two calls that take it."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.world.garbage import handle_cargo
from clean_swarm_env.world.movement import begin_acting
from clean_swarm_env.world.robot import read_sensors
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import kernel, lean_kernel
from selforg.network.state import state as st

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

# robots (R, 2), extent (2,), stations (W, 2, 2), limits (4,) [m] as `read_sensors` takes them
GROUND = ("f2", "f1", "f3", "f1")
# of `Garbage`: positions (W, M, 2) [m], stage (W, M), leftover (W, M), cargo (R,), recycled (R,), done (W,); and
# the nearest item (R,), room for what is picked (R, 2)
ITEMS = ("f3", "i2", "i2", "i1", "i1", "i1", "i1", "i2")
# readings (R, S) and mark table (R, MARK_LAYERS, B) of the network; its behaviours that handle cargo (3,), go to
# stations (K,), follow a mechanism (L,)
MINDS = ("f2", "i3", "i1", "i1", "i1")
# vectors (R, 2) [m/s], whether there is one (R,), whether to turn in place (R,), rows in which each of the L
# behaviours runs (L, R), how many (L,)
ORDERS = ("f2", "b1", "b1", "i2", "i1")
WORLD_TABLES = Layout(*GROUND, *ITEMS, *MINDS, *ORDERS)
Tables = tuple[
    Floats, Floats, Floats, Floats, Floats, Ints, Ints, Ints, Ints, Ints, Ints, Ints, Floats, Ints, Ints, Ints, Ints,
    Floats, Flags, Flags, Ints, Ints,
]  # fmt: skip
tables_of: Callable[[Bundle], Tables] = WORLD_TABLES.unbundle


@kernel
def sense(tables: Bundle) -> None:
    """Write the robots' own sensors into the readings; see `read_sensors`."""
    robots, extent, stations, limits, items, stage, _, cargo, recycled, _, nearest, _, readings = tables_of(tables)[:13]
    read_sensors(robots, extent, stations, limits, items, stage, cargo, recycled, readings, nearest)


@lean_kernel
def begin_to_act(tables: Bundle, pick_distance: float) -> int:
    """Handle cargo, forget the orders of the tick before and give those that need no mechanism.

    Returns how many items were picked; see `handle_cargo` and `begin_acting`.
    """
    (
        robots, extent, stations, _, items, stage, leftover, cargo, recycled, done, nearest, picked, _, marks, handling,
        transport, movers, vectors, commanded, in_place, running, counts,
    ) = tables_of(tables)  # fmt: skip
    number = handle_cargo(
        marks[:, st.STARTED], handling, robots, extent, pick_distance, nearest, items, stage, leftover, cargo, recycled,
        done, picked,
    )  # fmt: skip
    begin_acting(
        marks, transport, movers, robots, extent, stations, vectors, commanded, in_place, running, counts
    )  # fmt: skip
    return number
