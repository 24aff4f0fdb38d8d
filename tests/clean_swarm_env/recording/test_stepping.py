import numpy as np
import pytest

from clean_swarm_env.recording.stepping import DONE, JOINED, look_at_worlds


@pytest.mark.parametrize(
    ("joined", "done", "found"),
    [([0, 0], [1, 2], 0), ([0, 1], [1, 2], JOINED), ([0, 0], [1, 3], DONE), ([1, 0], [2, 3], JOINED | DONE)],
)
def test_a_world_that_robots_joined_or_whose_items_are_all_done_is_found(joined, done, found):
    known, arrived = np.zeros(2, np.int64), np.array([2, 3])
    assert look_at_worlds(np.array(joined), known, np.array(done), arrived) == found
