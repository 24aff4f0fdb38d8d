"""Garbage and cargo against plain Python."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from clean_swarm_env.physics.cells import cells_along
from clean_swarm_env.tasks.cleaning.cargo import handle_cargo_as_decided
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, DONE, LYING, NOTHING, Garbage
from selforg.compiler.records import Packed
from selforg.network.state import STARTED
from selforg.walls.segments import no_walls
from tests.clean_swarm_env.world.records import floor_record, minds_record

EXTENT = np.array([11.0, 7.0])
PICK, RECYCLE, DUMP = 0, 2, 3  # columns of `started`, one of which means something else
COLUMNS = np.array([PICK, RECYCLE, DUMP])


def _handle(garbage, robots, started):
    """Let the behaviours act that have just `started` (R, B); return the items picked."""
    places, worlds = np.asarray(robots, float), np.arange(len(robots)) // garbage.robots
    nearest = [_nearest_lying(garbage, *place)[0] for place in zip(worlds, places, strict=True)]
    cells = np.empty(cells_along(garbage.stage.shape[1], 0.6, EXTENT), np.int64)
    floor = floor_record(garbage, places, EXTENT, nearest=np.array(nearest), pick_distance=0.6, cells=cells)
    minds = minds_record(len(robots), behaviours=4, handling=COLUMNS)
    minds.marks[:, STARTED] = started
    count = handle_cargo_as_decided(
        0.0, np.arange(len(robots)), Packed(floor).handle, Packed(minds).handle, no_walls().handle
    )
    return floor.picked[:count].tolist()


def _nearest_lying(garbage, world, place):
    """Return the nearest item that lies, or NOTHING, and its distance on the torus."""
    offsets = np.abs(garbage.positions[world] - place)
    lying = garbage.stage[world] == LYING
    distances = np.where(lying, np.hypot(*np.minimum(offsets, EXTENT - offsets).T), np.inf)
    return (distances.argmin() if lying.any() else NOTHING), distances.min()


def _starting(robots, **what):
    started = np.zeros((robots, 4), np.int64)
    for row, column in what.items():
        started[int(row[1:]), column] = 1
    return started


def _garbage(items, robots=2, worlds=1):
    garbage = Garbage(worlds, len(items), robots)
    for world in range(worlds):
        garbage.place(world, np.asarray(items, float))
    return garbage


@settings(max_examples=50)
@given(st.integers(0, 10_000), st.sampled_from([6, 100]))
def test_who_comes_too_late_picks_the_item_that_is_nearest_now(seed, items):
    rng = np.random.default_rng(seed)
    garbage = _garbage(rng.random((items, 2)) * EXTENT)
    garbage.stage[0] = rng.integers(3, size=items)
    garbage.stage[0, 0] = LYING
    first, second = garbage.positions[0, 0], garbage.positions[0, 0] + rng.uniform(-0.1, 0.1, 2)
    wanted = _nearest_lying(garbage, 0, second % EXTENT)[0]
    picked = _handle(garbage, [first, second % EXTENT], _starting(2, r0=PICK, r1=PICK))
    assert picked[0] == [0, 0]
    if wanted != 0:
        assert picked[1] == [1, wanted]
        return
    late = picked[1][1] if len(picked) > 1 else NOTHING
    if late != NOTHING:
        garbage.stage[0, late] = LYING
    nearest, near = _nearest_lying(garbage, 0, second % EXTENT)
    assert late == (nearest if near <= 0.6 else NOTHING)


def test_an_item_goes_through_its_stages():
    garbage = _garbage([[1.0, 1.0], [5.0, 5.0]])
    robots = [[1.0, 1.5], [9.0, 3.0]]
    assert _handle(garbage, robots, _starting(2, r0=PICK)) == [[0, 0]]
    assert garbage.stage.tolist() == [[CARRIED, LYING]]
    assert garbage.cargo.tolist() == [0, NOTHING]
    _handle(garbage, robots, _starting(2, r0=DUMP))  # what is not recycled is not dumped
    assert garbage.done.tolist() == [0]
    _handle(garbage, robots, _starting(2, r0=RECYCLE))
    assert garbage.recycled.tolist() == [1, 0]
    _handle(garbage, robots, _starting(2, r0=DUMP))
    assert garbage.stage.tolist() == [[DONE, LYING]]
    assert garbage.cargo.tolist() == [NOTHING, NOTHING]
    assert garbage.recycled.tolist() == [0, 0]
    assert garbage.done.tolist() == [1]


def test_nobody_takes_a_second_item_or_one_out_of_reach():
    garbage = _garbage([[1.0, 1.0], [1.2, 1.0], [10.9, 6.9]])
    _handle(garbage, [[1.0, 1.0], [4.0, 4.0]], _starting(2, r0=PICK, r1=PICK))
    assert _handle(garbage, [[1.0, 1.0], [4.0, 4.0]], _starting(2, r0=PICK, r1=PICK)) == []
    assert garbage.cargo.tolist() == [0, NOTHING]
    assert _handle(garbage, [[1.0, 1.0], [0.1, 0.1]], _starting(2, r1=PICK)) == [[1, 2]]  # across the corner


def test_recycling_and_dumping_without_cargo_do_nothing():
    garbage = _garbage([[1.0, 1.0]])
    _handle(garbage, [[1.0, 1.0], [4.0, 4.0]], _starting(2, r0=RECYCLE, r1=DUMP))
    assert garbage.recycled.tolist() == [0, 0]
    assert garbage.done.tolist() == [0]


def test_worlds_have_items_of_their_own_and_are_laid_out_one_by_one():
    garbage = _garbage([[1.0, 1.0]], robots=1, worlds=2)
    assert _handle(garbage, [[1.0, 1.0], [1.0, 1.0]], _starting(2, r1=PICK)) == [[1, 0]]
    assert garbage.stage.tolist() == [[LYING], [CARRIED]]
    garbage.place(1, np.array([[2.0, 2.0]]))
    assert garbage.stage.tolist() == [[LYING], [LYING]]
    assert garbage.cargo.tolist() == [NOTHING, NOTHING]
    assert garbage.positions.tolist() == [[[1.0, 1.0]], [[2.0, 2.0]]]


def test_what_was_put_down_for_others_stays_so_until_another_item_takes_its_row():
    garbage = _garbage([[1.0, 1.0]])
    assert not garbage.hand_over(0, np.array([2.0, 2.0]), 5)
    _handle(garbage, [[1.0, 1.0], [4.0, 4.0]], _starting(2, r0=PICK))
    assert garbage.hand_over(0, np.array([2.0, 2.0]), 5)
    assert (garbage.stage.tolist(), garbage.positions.tolist()) == ([[LYING]], [[[2.0, 2.0]]])
    assert (garbage.paid.tolist(), garbage.blind.tolist()) == ([[1]], [5, 0])
    _handle(garbage, [[4.0, 4.0], [2.0, 2.0]], _starting(2, r1=PICK))
    _handle(garbage, [[4.0, 4.0], [2.0, 2.0]], _starting(2, r1=RECYCLE))
    assert garbage.paid.tolist() == [[1]]
    _handle(garbage, [[4.0, 4.0], [2.0, 2.0]], _starting(2, r1=DUMP))
    assert garbage.arrive(0, np.array([3.0, 3.0]))
    assert garbage.paid.tolist() == [[0]]
    garbage.hand_over(0, np.array([2.0, 2.0]), 5)
    garbage.place(0, np.array([[1.0, 1.0]]))
    assert (garbage.paid.tolist(), garbage.blind.tolist()) == ([[0]], [0, 0])
