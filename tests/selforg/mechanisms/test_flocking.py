import numpy as np
import pytest

from selforg.gradients.gradient import Gradient
from selforg.mechanisms import Flocking, FlockingReynolds
from tests.selforg.worlds import directions, make_world, set_pose

OTHER = [(0.9, (4.0, 3.0)), (1.2, (4.2, 3.1))]
"""When [s] and where [m] the other robot spreads its pose."""
OWN = [(1.0, (3.0, 3.0)), (1.2, (3.1, 3.0))]


@pytest.mark.parametrize("kind", [FlockingReynolds, Flocking])
def test_a_flock_moves_alike_with_poses_that_are_shared_and_with_those_that_are_received(kind):
    moved = []
    for rows in (2, 1):
        world = make_world(rows=rows)
        world.poses.forget(np.arange(rows))
        for now, place in OWN:
            set_pose(world.poses, 0, place, (1.0, 0.0), now)
        for now, place in OTHER:
            if rows == 2:
                set_pose(world.poses, 1, place, (0.0, 1.0), now)
            else:
                pose = {"diffusion": 1.0, "goal_radius": 0.5, "attraction": -1, "heading": (0.0, 1.0), "moving": True}
                world.buffer.receive(Gradient("robot", place, source="another", stamp=now, **pose), now, row=0)
        moved.append(kind(world.buffer, directions=directions(rows)).move(1.2)[0][0])
    np.testing.assert_allclose(*moved, rtol=1e-12)
    assert abs(moved[0][1]) > 1e-3  # it notices the other
