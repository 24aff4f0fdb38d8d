"""For how long robots have not got on, compared with the rule written plainly."""

import numpy as np

from selforg.space import Torus
from selforg.standstill import GOT_ON_BEYOND, Standstill


def test_robots_wait_until_they_are_outside_their_circle():
    rng, space, rows = np.random.default_rng(1), Torus(3.0, 2.0), 6
    standstill = Standstill(rows, space)
    positions, places = rng.uniform(0.0, 1.0, (rows, 2)) * space.extent, np.zeros((rows, 2))
    waited, longest = np.zeros(rows, int), 0
    for tick in range(300):
        positions = space.wrap(positions + rng.normal(size=(rows, 2)) * np.linspace(0.01, 0.2, rows)[:, None])
        got_on = np.hypot(*space.offsets(places, positions).T) > GOT_ON_BEYOND
        places[got_on] = positions[got_on]
        waited = np.where(got_on, 0, waited + 1)
        standstill.note(positions)
        np.testing.assert_array_equal(standstill.waited, waited)
        longest = max(longest, waited.max())
        if tick == 200:
            standstill.reset(np.array([0, 3]))
            waited[[0, 3]], places[[0, 3]] = 0, 0.0
    assert longest > 20
    assert (waited < 20).any()
