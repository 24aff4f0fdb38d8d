"""A whole control period of the physics with its collision counts, in as few calls as contacts allow (compiled).

A world runs through its substeps by itself; while robots touch, Chipmunk is called from here. Only where bodies need
other seam copies, or the world has no space yet, it is handed back: pymunk is told and does one substep, and
`settle_and_go_on` takes the world up again. The same substeps and counts, in the same order within each world, as
`Physics.substep` and `CollisionCounter.count` by turns.

Shapes: W worlds, N robots a world, R = W * N rows, K collision distances.
"""

from collections.abc import Callable

import numpy as np

from clean_swarm_env.physics.chipmunk_calls import SPACE, touch
from clean_swarm_env.physics.collisions import Flags, Floats, Ints, count_world, counts_of
from clean_swarm_env.physics.drive import drive_of, steer_rows
from clean_swarm_env.physics.motion import land, push, search_contacts, steer_world
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import inlined, lean_kernel

# positions (R, 2), headings (R,), bodies (R, 4), wanted (R, 2), forces (R, 2), seam copies needed (R,), present (R,),
# patience (W,), handles (W, HANDLES), seam copies that pymunk has (R,), whether pymunk's state holds (W,)
Motion = tuple[Floats, Floats, Floats, Floats, Floats, np.ndarray, Flags, Ints, Ints, np.ndarray, Flags]
# contact search, width, height [m], reach of a touch [m], zone of seam copies [m], timestep [s], settling [substeps],
# stiffness [kg/s]
Sizes = tuple[int, float, float, float, float, float, int, float]
MOTION_TABLES = Layout("f2", "f1", "f2", "f2", "f2", "u1", "b1", "i1", "i2", "u1", "b1")
SIZE_TABLE = Layout("whole", "number", "number", "number", "number", "number", "whole", "number")
motion_of: Callable[[Bundle], Motion] = MOTION_TABLES.unbundle
sizes_of: Callable[[Bundle], Sizes] = SIZE_TABLE.unbundle


@inlined
def count(world: int, motion: Bundle, counts: Bundle, entered: Ints) -> None:
    """Count one world and add what was entered to `entered` (R,)."""
    positions, _, _, _, _, _, present, patience, _, _, _ = motion_of(motion)
    (
        before, counted, squares, samples, events, in_contact, now, near, following, cells, listed, pairs, origins,
        width, height, furthest,
    ) = counts_of(counts)  # fmt: skip
    count_world(
        world, positions, present, before, counted, squares, samples, events, in_contact, now, near, following, cells,
        listed, pairs, origins, width, height, furthest,
    )  # fmt: skip
    robots = positions.shape[0] // patience.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        entered[row] += now[row]


@inlined
def can_touch(world: int, motion: Bundle) -> bool:
    """Tell whether Chipmunk can be called for the next substep of a world: it has a space, with the right copies."""
    _, _, _, _, _, copies, _, _, handles, copied, _ = motion_of(motion)
    robots = copies.shape[0] // handles.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        if copies[row] != copied[row]:
            return False
    return bool(handles[world, SPACE] != 0)


@inlined
def settle(world: int, motion: Bundle, sizes: Bundle) -> None:
    """Take over what a substep of pymunk came to."""
    positions, _, bodies, _, _, _, _, patience, _, _, current = motion_of(motion)
    _, width, height, _, _, timestep, _, _ = sizes_of(sizes)
    robots = positions.shape[0] // patience.shape[0]
    crossed = land(positions, bodies, world * robots, (world + 1) * robots, width, height, timestep)
    # A seam crossed moves the body by a world size; and in free motion pymunk is not asked at all.
    current[world] = not crossed and patience[world] > 1


@lean_kernel
def go_on(
    world: int,
    left: int,
    motion: Bundle,
    sizes: Bundle,
    speed: Floats,
    turn_rate: Floats,
    counts: Bundle,
    entered: Ints,
) -> int:
    """Run a world through its `left` substeps; returns the substeps left if the next one is for Python to do."""
    positions, headings, bodies, wanted, forces, copies, present, patience, handles, _, current = motion_of(motion)
    search, width, height, reach, zone, timestep, settling, stiffness = sizes_of(sizes)
    robots = positions.shape[0] // patience.shape[0]
    first, end = world * robots, (world + 1) * robots
    while left > 0:
        contact = search_contacts(world, positions, present, patience, search, width, height, reach, settling)
        steer_world(
            first, end, not contact, positions, headings, bodies, wanted, present, speed, turn_rate, width, height,
            timestep,
        )  # fmt: skip
        if contact:
            push(forces, copies, positions, bodies, wanted, present, first, end, height, zone, stiffness)
            if not can_touch(world, motion):
                return left
            touch(world, handles, bool(current[world]), timestep)
            settle(world, motion, sizes)
        count(world, motion, counts, entered)
        left -= 1
    return 0


@lean_kernel
def begin_tick(
    substeps: int, motion: Bundle, sizes: Bundle, speed: Floats, turn_rate: Floats, counts: Bundle, entered: Ints,
    left: Ints,
) -> int:  # fmt: skip
    """Begin a tick of every world; fills `left` (W,) and returns how many worlds have substeps left."""
    waiting = 0
    for row in range(entered.shape[0]):
        entered[row] = 0
    for world in range(left.shape[0]):
        left[world] = go_on(world, substeps, motion, sizes, speed, turn_rate, counts, entered)
        waiting += left[world] > 0
    return waiting


@lean_kernel
def drive_and_begin_tick(
    vectors: Floats, has_command: Flags, in_place: Flags, now: float, drive: Bundle, substeps: int, motion: Bundle,
    sizes: Bundle, counts: Bundle, entered: Ints, left: Ints,
) -> int:  # fmt: skip
    """Let the drives take their commands, see `DifferentialDrive.command`, and begin a tick with what they do."""
    steer_rows(vectors, has_command, in_place, motion_of(motion)[1], now, drive)
    speed, turn_rate, _, _ = drive_of(drive)
    waiting = 0  # from here on `begin_tick`; called, it would be compiled twice
    for row in range(entered.shape[0]):
        entered[row] = 0
    for world in range(left.shape[0]):
        left[world] = go_on(world, substeps, motion, sizes, speed, turn_rate, counts, entered)
        waiting += left[world] > 0
    return waiting


@lean_kernel
def settle_and_go_on(
    world: int, left: int, motion: Bundle, sizes: Bundle, speed: Floats, turn_rate: Floats, counts: Bundle,
    entered: Ints,
) -> int:  # fmt: skip
    """Take a world up again after a substep that Python has had pymunk do; see `go_on`."""
    settle(world, motion, sizes)
    count(world, motion, counts, entered)
    return go_on(world, left - 1, motion, sizes, speed, turn_rate, counts, entered)
