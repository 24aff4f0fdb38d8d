"""Items at one point, or closer than gradients can be told apart, are all seen and brought away one by one."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import mission_begun
from selforg.network.state import EXECUTING
from tests.clean_swarm_env.courses import long_course, mission

ROBOTS = ((1.0, 1.0, 0.0), (3.0, 8.0, 1.0), (9.0, 3.0, 2.0))
PLACES = {
    "equal": [(5.5, 9.0)] * 2,
    "ten": [(5.5, 9.0)] * 10,
    "closer than squares can say": [(5.5, 9.0), (5.5 + 1e-15, 9.0), (5.5, 9.0 + 4e-15)],
    "a hair apart": [(5.5, 9.0 + k * 1e-9) for k in range(4)],
    "just apart": [(5.5, 9.0 + k * 2e-6) for k in range(4)],
    "across the seam": [(0.0, 9.0), (11.0, 9.0), (np.nextafter(11.0, 0.0), 9.0)],
    "three piles": [(5.5, 9.0)] * 3 + [(2.0, 2.0)] * 3 + [(2.75, 5.5)] * 3,
}
STANDING = 10.0
"""Time after which a robot that is to go to garbage and gets no direction counts as stuck [s]."""


def driven(items, seed, **changes):
    """Return the result of a mission with items at places, and the longest time for which a robot was stuck [s]."""
    config = mission(robots={"count": 3}, garbage={"count": len(items)}, time_limit=3000.0, **changes)
    course = mission_begun(config, StartConfiguration(id="pile", robots=ROBOTS, items=tuple(items)), seed)
    minds, moving = course.worlds.minds, course.worlds.network.model.behaviour_index["MoveToGarbage"]
    stuck, longest = np.zeros(3), 0.0
    while not course.over[0]:
        course.tick()
        goes = course.worlds.network.state.marks[:, EXECUTING, moving] == 1
        stuck = (stuck + 0.2) * (goes & ~minds.commands.vectors.any(axis=1))
        longest = max(longest, stuck.max())
    return course.finished[0].result, longest


@long_course
@pytest.mark.parametrize("places", PLACES)
@pytest.mark.parametrize("delivery", [{}, {"loss": 0.3}])
def test_piles_are_brought_away(places, delivery):
    result, longest = driven(PLACES[places], 1, delivery=delivery)
    assert result.completed
    assert longest < STANDING
