"""No body gets through a wall or another body, however small, fast or crowded.

Missions raise the rate of their physics, and bodies that contacts would push too far wait (docs/walls.md).
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
DEEPEST, CLOSEST, FARTHEST, PUSHED = 0.6, 0.25, 0.5, 2.0
"""Bounds: how far a disc sinks into a wall [radii], how close two centres get [sum of both radii], the way of a body in
a step [radii], and the speed of a pushed body by that of the fastest drive [-]."""
ROUNDING = 1e-6


def mission(radius, speed, rate=20.0, **world):
    return MissionConfig(
        world={"physics_rate": rate, **world}, robots={"radius": radius, "max_speed": speed, "count": 2}
    )


def shortest(ways):
    """Return ways (..., 2) [m] across seams where that is shorter."""
    return ways - EXTENT * np.round(ways / EXTENT)


def side(begin, way, places):
    """Return on which side of a line from `begin` (..., 2) along `way` (..., 2) places are: 1 or -1."""
    (x, y), (dx, dy) = np.moveaxis(places - begin, -1, 0), np.moveaxis(way, -1, 0)
    return np.sign(dx * y - dy * x)


def crossed(lines, before, ways):
    """Return whether ways (N, 2) from places (N, 2) lead through lines (K, 4): (K, N)."""
    begin, end = lines[:, None, :2], lines[:, None, 2:]
    apart = side(begin, end - begin, before) * side(begin, end - begin, before + ways) < 0.0
    return apart & (side(before, ways, begin) * side(before, ways, end) < 0.0)


# Walls through (0, 0), along which x leads, and the directions from which queues of robots drive there.
QUEUES = {
    "wall": ([[-2, 0, 2, 0]], [90.0]),
    "corner": ([[-2, 0, 2, 0], [0, 0, 0, -2]], [90.0]),
    "wedge": ([[0, 0, 1.2, -2], [0, 0, -1.2, -2]], [90.0]),
    "lane": ([[-1, -2, -1, 2], [1, -2, 1, 2]], [90.0, -90.0]),  # as wide as the robots
    "open": ([], [0.0, 60.0, 120.0, 180.0, 240.0, 300.0]),
}
crowds = given(
    scene=st.sampled_from(sorted(QUEUES)),
    radius=st.floats(0.016, 0.3),
    speed=st.floats(0.1, 4.0),
    rate=st.sampled_from([5.0, 20.0, 60.0]),
    robots=st.integers(1, 12),
    alike=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)


def drive_crowd(scene, radius, speed, rate, robots, alike, seed, steps=60):
    """Let queues of robots drive at walls and at each other, and compare each substep with the bounds."""
    rng = np.random.default_rng(seed)
    radii = np.full(robots, max(0.016, radius * min(1.0, 6.0 / robots)))
    speeds = np.full(robots, speed)
    if not alike:
        radii = np.maximum(radii * rng.uniform(0.2, 1.0, robots), 0.016)
        speeds = speeds * rng.uniform(0.1, 1.0, robots)
    angle, centre, widest = rng.uniform(0.0, np.pi), rng.uniform(2.5, 3.5, 2), radii.max()
    turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    walls, directions = QUEUES[scene]
    corners = np.array(walls, float).reshape(-1, 2, 2)
    if scene == "lane":
        corners[..., 0] *= 1.2 * widest
    whole = images((corners @ turned + centre).reshape(-1, 4), EXTENT)
    headings = np.radians(np.resize(directions, robots))
    back = np.zeros(robots)
    for first in range(len(directions)):
        queue = radii[first :: len(directions)]
        back[first :: len(directions)] = np.cumsum(2.1 * queue) - 1.05 * queue
    back += {"wedge": 1.2, "open": 1.2}.get(scene, 0.0) * widest
    beside = {"wall": 0.5, "corner": 1.2}.get(scene, 0.0) * widest
    places = np.stack([beside - back * np.cos(headings), -back * np.sin(headings)], axis=1)
    timestep = 1.0 / mission(radii.min(), speeds.max(), rate).world.physics_rate
    physics = Physics(
        PhysicsSettings(1, robots, *EXTENT, radius=radii, timestep=timestep), packed_walls(whole, (0.0, 0.0), EXTENT)
    )
    physics.place(0, (places @ turned + centre) % EXTENT, headings + angle + rng.uniform(-0.2, 0.2, robots))
    sums = np.add.outer(radii, radii)
    for _ in range(steps):
        before = physics.positions.copy()
        if scene == "open":
            physics.headings[:] = np.arctan2(*shortest(centre - before).T[::-1])
        substep(physics, speeds, np.zeros(robots))
        ways = shortest(physics.positions - before)
        lengths = np.hypot(*ways.T)
        assert (lengths <= (FARTHEST + ROUNDING) * radii).all()
        assert lengths.max() < PUSHED * speeds.max() * timestep
        assert not crossed(whole, before, ways).any()
        apart = [distances_to(whole, place).min(initial=np.inf) for place in physics.positions]
        assert (apart >= (1.0 - DEEPEST - ROUNDING) * radii).all()
        apart = np.hypot(*shortest(physics.positions[:, None] - physics.positions[None]).T)
        assert (apart + 9.0 * np.eye(robots) >= (CLOSEST - ROUNDING) * sums).all()


@crowds
@settings(max_examples=30)
def test_no_body_gets_through_walls_corners_and_crowds(**case):
    drive_crowd(**case)


@pytest.mark.long
@crowds
@settings(max_examples=1000)
def test_no_body_gets_through_in_many_ways(**case):
    drive_crowd(**case)


@pytest.mark.parametrize(("scene", "robots"), [("lane", 12), ("wedge", 12), ("open", 150)])
def test_bodies_wait_where_the_solver_gives_way(scene, robots):
    drive_crowd(scene, 0.3, 4.0, 5.0, robots, alike=True, seed=1, steps=150)


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
