"""No body gets through a wall or another body, however small and fast: missions raise the rate of their physics.

One to three robots at a wall. Where more push at once, Chipmunk's solver gives way; docs/walls.md says how far.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from selforg.walls.segments import distances_to, images, packed_walls
from tests.clean_swarm_env.physics.substeps import substep

EXTENT = np.array([6.0, 6.0])
DEEPEST, CLOSEST, PUSHED = 0.6, 1.0, 1.4
"""Bounds: how far a disc sinks into a wall, and how close two centres get [radii]; speed by the own [-]."""


def mission(radius, speed, rate=20.0, **world):
    return MissionConfig(
        world={"physics_rate": rate, **world}, robots={"radius": radius, "max_speed": speed, "count": 2}
    )


def shortest(ways):
    """Return ways (..., 2) [m] across seams where that is shorter."""
    return ways - EXTENT * np.round(ways / EXTENT)


def side(line, places):
    """Return on which side of a line (4,) places (N, 2) are: 1 or -1."""
    (x, y), (dx, dy) = (places - line[:2]).T, line[2:] - line[:2]
    return np.sign(dx * y - dy * x)


def crossed(line, before, ways):
    """Return whether ways (N, 2) from places (N, 2) lead through a line (4,)."""
    apart = side(line, before) * side(line, before + ways) < 0.0
    ends = [
        np.sign(way[0] * (line[k + 1] - place[1]) - way[1] * (line[k] - place[0]))
        for k in (0, 2)
        for place, way in zip(before, ways, strict=True)
    ]
    return apart & (np.array(ends[: len(ways)]) * np.array(ends[len(ways) :]) < 0.0)


approaches = given(
    radius=st.floats(0.016, 0.3),
    speed=st.floats(0.1, 4.0),
    rate=st.sampled_from([5.0, 20.0, 60.0]),
    robots=st.integers(1, 3),
    corner=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)


def drive_at_walls(radius, speed, rate, robots, corner, seed):
    """Let a queue of robots drive at a wall, or into a corner, and compare each substep with the bounds."""
    rng = np.random.default_rng(seed)
    centre, angle = rng.uniform(2.5, 3.5, 2), rng.uniform(0.0, np.pi)
    along, ahead = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    walls = [[*(centre - 2.0 * along), *(centre + 2.0 * along)], [*centre, *(centre - 2.0 * ahead)]][: 1 + corner]
    whole = images(np.array(walls), EXTENT)
    timestep = 1.0 / mission(radius, speed, rate).world.physics_rate
    physics = Physics(
        PhysicsSettings(1, robots, *EXTENT, radius=radius, timestep=timestep), packed_walls(whole, (0.0, 0.0), EXTENT)
    )
    queue = radius * (1.05 + 2.3 * np.arange(robots)) + 0.02 * rng.uniform(size=robots)
    places = centre - queue[:, None] * ahead + (1.1 * radius + rng.uniform(0.0, radius, (robots, 1))) * along
    physics.place(0, places % EXTENT, angle + 0.5 * np.pi + rng.uniform(-0.6, 0.6, robots))
    for _ in range(40):
        before = physics.positions.copy()
        substep(physics, np.full(robots, speed), np.zeros(robots))
        ways = shortest(physics.positions - before)
        assert np.hypot(*ways.T).max() < PUSHED * speed * timestep
        assert not any(crossed(line, before, ways).any() for line in whole)
        assert min(distances_to(whole, place).min() for place in physics.positions) > (1.0 - DEEPEST) * radius
        apart = np.hypot(*shortest(physics.positions[:, None] - physics.positions[None]).T)
        assert (apart + 9.0 * np.eye(robots)).min() > CLOSEST * radius


@approaches
@settings(max_examples=20)
def test_no_body_gets_through_walls_and_corners(**case):
    drive_at_walls(**case)


@pytest.mark.long
@approaches
@settings(max_examples=400)
def test_no_body_gets_through_in_many_ways(**case):
    drive_at_walls(**case)


@pytest.mark.parametrize("radius", [0.016, 0.035, 0.04, 0.1])
def test_robots_that_meet_head_on_do_not_change_places(radius):
    timestep = 1.0 / mission(radius, 1.0).world.physics_rate
    physics = Physics(PhysicsSettings(1, 2, *EXTENT, radius=radius, timestep=timestep))
    physics.place(0, np.array([[2.9, 3.0], [3.1 + radius, 3.0]]), np.array([0.0, np.pi]))
    for _ in range(200):
        substep(physics, np.ones(2), np.zeros(2))
    assert physics.positions[0, 0] < physics.positions[1, 0] - radius


@pytest.mark.parametrize(
    ("radius", "speed", "world", "rate"),
    [
        (0.25, 1.0, {}, 20.0),  # as it was given
        (0.14, 1.0, {}, 20.0),
        (0.04, 1.0, {}, 70.0),
        (0.04, 1.0, {"control_rate": 4.0}, 72.0),  # a whole number of steps in a control period
        (0.04, 1.0, {"contacts": "pass_through"}, 20.0),  # nothing to get through
        (0.04, 1.0, {"contacts": "pass_through", "ground": "walled"}, 70.0),
    ],
)
def test_a_mission_raises_the_rate_where_bodies_would_get_through(radius, speed, world, rate):
    raised = mission(radius, speed, **world)
    assert raised.world.physics_rate == rate
    assert MissionConfig.model_validate(raised.model_dump()) == raised


def test_a_rate_that_no_mission_can_have_is_one_line():
    with pytest.raises(ValueError, match=r"expected at least 7 Hz, for 4 m/s and a radius of 0\.0016 m, got 5"):
        MissionConfig.model_validate({"robots": {"radius": 0.0016, "max_speed": 4.0}})
