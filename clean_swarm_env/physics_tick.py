"""A whole control period of the physics with its collision counts, in as few calls as contacts allow (compiled).

A world runs through its substeps by itself until robots touch; then it is handed back, pymunk does one substep, and
`settle_and_go_on` takes it up again. The same substeps and counts, in the same order within each world, as
`Physics.substep` and `CollisionCounter.count` by turns.

Shapes: W worlds, N robots a world, R = W * N rows, K collision distances.
"""

import numpy as np

from clean_swarm_env.collisions import Flags, Floats, Ints, count_world
from clean_swarm_env.physics_motion import land, push, search_contacts, steer_world
from selforg.compiled import inlined, lean_kernel

# positions (R, 2), headings (R,), bodies (R, 4), wanted (R, 2), forces (R, 2), copies (R,), present (R,), patience (W,)
Motion = tuple[Floats, Floats, Floats, Floats, Floats, np.ndarray, Flags, Ints]
# contact search, width, height [m], reach of a touch [m], zone of seam copies [m], timestep [s], settling [substeps],
# stiffness [kg/s]
Sizes = tuple[int, float, float, float, float, float, int, float]
# see CollisionCounter.tables
Counts = tuple[
    Floats, Flags, Floats, Ints, Ints, Flags, Ints, Ints, Ints, Ints, Ints, Ints, Floats, float, float, float
]  # fmt: skip


@inlined
def count(world: int, motion: Motion, counts: Counts, entered: Ints) -> None:
    """Count one world and add what was entered to `entered` (R,)."""
    positions, _, _, _, _, _, present, patience = motion
    (
        before, counted, squares, samples, events, in_contact, now, near, following, cells, listed, pairs, origins,
        width, height, furthest,
    ) = counts  # fmt: skip
    count_world(
        world, positions, present, before, counted, squares, samples, events, in_contact, now, near, following, cells,
        listed, pairs, origins, width, height, furthest,
    )  # fmt: skip
    robots = positions.shape[0] // patience.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        entered[row] += now[row]


@lean_kernel
def go_on(
    world: int, left: int, motion: Motion, sizes: Sizes, speed: Floats, turn_rate: Floats, counts: Counts, entered: Ints
) -> int:
    """Run a world through its `left` substeps until robots touch; returns the substeps left, the next one pymunk's."""
    positions, headings, bodies, wanted, forces, copies, present, patience = motion
    search, width, height, reach, zone, timestep, settling, stiffness = sizes
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
            return left
        count(world, motion, counts, entered)
        left -= 1
    return 0


@lean_kernel
def begin_tick(
    substeps: int, motion: Motion, sizes: Sizes, speed: Floats, turn_rate: Floats, counts: Counts, entered: Ints,
    left: Ints,
) -> int:  # fmt: skip
    """Begin a tick of every world; fills `left` (W,) and returns how many worlds have substeps left."""
    engaged = 0
    for row in range(entered.shape[0]):
        entered[row] = 0
    for world in range(left.shape[0]):
        left[world] = go_on(world, substeps, motion, sizes, speed, turn_rate, counts, entered)
        engaged += left[world] > 0
    return engaged


@lean_kernel
def settle_and_go_on(
    world: int, left: int, motion: Motion, sizes: Sizes, speed: Floats, turn_rate: Floats, counts: Counts,
    entered: Ints, current: Flags,
) -> int:  # fmt: skip
    """Take a world up again after a substep of pymunk; see `go_on`. `current` (W,): pymunk's state holds."""
    positions, _, bodies, _, _, _, _, patience = motion
    robots = positions.shape[0] // patience.shape[0]
    crossed = land(positions, bodies, world * robots, (world + 1) * robots, sizes[1], sizes[2], sizes[5])
    # A seam crossed moves the body by a world size; and in free motion pymunk is not asked at all.
    current[world] = not crossed and patience[world] > 1
    count(world, motion, counts, entered)
    return go_on(world, left - 1, motion, sizes, speed, turn_rate, counts, entered)
