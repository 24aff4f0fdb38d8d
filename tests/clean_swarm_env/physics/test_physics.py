"""Physics on the torus: free motion, contacts at seams as anywhere, same bits alone and in a batch."""

import math
from copy import deepcopy

import numpy as np
import pytest

from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.motion import ALWAYS_TOUCHING
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from selforg.commands import Commanded
from selforg.compiler.records import Packed
from selforg.program import Program
from tests.clean_swarm_env.physics.substeps import substep

SIZE = 11.0
MIDDLE = (5.5, 5.5)
PLACES = {
    "left and right seam": (0.0, 5.5),
    "lower and upper seam": (5.5, 0.0),
    "corner": (0.0, 0.0),
    "just inside the upper right corner": (10.9, 10.9),
    "just inside the lower right corner": (10.9, 0.1),
    "just inside the upper left corner": (0.1, 10.9),
}
MEETINGS = {  # relative places [m] and headings [rad] of two robots driving at 1 m/s
    "head-on": ([(-0.613, 0.0), (0.613, 0.0)], [0.0, math.pi]),
    "head-on, touching at exactly two radii": ([(-0.75, 0.0), (0.75, 0.0)], [0.0, math.pi]),
    "head-on, upwards": ([(0.0, -0.613), (0.0, 0.613)], [math.pi / 2, -math.pi / 2]),
    "head-on, along the diagonal": ([(-0.5, -0.5), (0.5, 0.5)], [math.pi / 4, -3 * math.pi / 4]),
    "head-on, along the other diagonal": ([(0.5, -0.5), (-0.5, 0.5)], [3 * math.pi / 4, -math.pi / 4]),
    "glancing": ([(-0.7, 0.0), (0.7, 0.21)], [0.0, math.pi]),
    "from the side": ([(-0.6, 0.1), (0.0, -0.7)], [0.0, math.pi / 2]),
    "one pushes a standing one": ([(-0.8, 0.02), (0.0, 0.0)], [0.0, 0.0]),
}


def shorter(offsets, size=SIZE):
    return (offsets + size / 2) % size - size / 2


def placed(worlds, robots, seed, first=0, **settings):
    """Worlds of robots at random places, all in motion soon; `first` is the number of the first one."""
    physics = Physics(PhysicsSettings(worlds, robots, **settings))
    for world in range(worlds):
        rng = np.random.default_rng((seed, first + world))
        physics.place(world, rng.uniform(0, physics.settings.width, (robots, 2)), rng.uniform(-3, 3, robots))
    return physics


def wander(physics, substeps, seed, first=0):
    """Positions (T, R, 2) of a walk whose commands depend on the seed and the world only."""
    worlds, robots = physics.settings.worlds, physics.settings.robots
    streams = [np.random.default_rng((seed, first + world)) for world in range(worlds)]
    history = []
    for number in range(substeps):
        if number % 4 == 0:
            speed = np.concatenate([stream.uniform(0, 1, robots) for stream in streams])
            turn_rate = np.concatenate([stream.uniform(-2, 2, robots) for stream in streams])
        substep(physics, speed, turn_rate)
        history.append(physics.positions.copy())
    return np.array(history)


def meeting(place, start, headings, speeds=(1.0, 1.0), substeps=80):
    """Positions (T, 2, 2) of two robots relative to the place at which they meet."""
    physics = Physics(PhysicsSettings(1, 2))
    physics.place(0, np.array(start) + place, np.array(headings))
    history = []
    for _ in range(substeps):
        substep(physics, np.array(speeds), np.zeros(2))
        assert (physics.positions >= 0.0).all()
        assert (physics.positions < SIZE).all()
        history.append(shorter(physics.positions - place))
    return np.array(history)


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("name", MEETINGS)
def test_two_robots_meet_across_a_seam_as_in_the_middle(name, place):
    start, headings = MEETINGS[name]
    speeds = (1.0, 0.0) if "standing" in name else (1.0, 1.0)
    expected = meeting(np.array(MIDDLE), start, headings, speeds)
    distances = np.linalg.norm(expected[:, 0] - expected[:, 1], axis=1)
    free = np.array(start) + np.cumsum(0.05 * np.ones((80, 1, 1)), 0) * np.array(
        [
            [speed * math.cos(heading), speed * math.sin(heading)]
            for speed, heading in zip(speeds, headings, strict=True)
        ]
    )
    assert np.abs(expected - free).max() > 0.02, "they did not touch, so nothing is compared"
    assert distances.min() > 0.4 - 1e-9
    found = meeting(np.array(place), start, headings, speeds)
    assert np.abs(shorter(found - expected)).max() < 1e-6


def test_robots_that_push_each_other_stay_apart_and_stand_still():
    history = meeting(np.array(MIDDLE), [(-0.613, 0.0), (0.613, 0.0)], [0.0, math.pi])
    distances = np.linalg.norm(history[:, 0] - history[:, 1], axis=1)
    assert distances.min() >= 0.5 - 2.0 * 0.05  # seen one substep late at most, at 2 m/s towards each other
    assert (distances[30:] > 0.48).all()
    assert distances[-1] == pytest.approx(0.495, abs=0.002)  # two radii without the slop


@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
def test_free_robots_move_by_speed_along_the_heading_before_the_turn(contacts):
    physics = Physics(PhysicsSettings(1, 2, contacts=contacts))
    places, headings = np.array([[1.0, 1.0], [6.0, 6.0]]), np.array([0.3, -2.0])
    physics.place(0, places, headings)
    speed, turn_rate = np.array([0.7, 0.4]), np.array([1.5, -2.0])
    for _ in range(40):
        step = speed[:, None] * np.stack([np.cos(headings), np.sin(headings)], 1)
        places = (places + 0.05 * step) % SIZE
        headings = headings + 0.05 * turn_rate
        substep(physics, speed, turn_rate)
        np.testing.assert_allclose(physics.positions, places, atol=1e-12)
        np.testing.assert_allclose(physics.bodies[:, 2:], step, atol=1e-12)
        np.testing.assert_allclose(np.exp(1j * physics.headings), np.exp(1j * headings), atol=1e-12)
        assert (np.abs(physics.headings) <= math.pi).all()


def test_robots_pass_through_each_other_only_where_they_may():
    start, headings = np.array([[4.0, 5.0], [6.0, 5.0]]), np.array([0.0, math.pi])
    ends = {}
    for contacts in ("solid", "pass_through"):
        physics = Physics(PhysicsSettings(1, 2, contacts=contacts))
        physics.place(0, start, headings)
        for _ in range(40):
            substep(physics, np.ones(2), np.zeros(2))
        ends[contacts] = physics.positions[:, 0].tolist()
    assert ends["pass_through"] == pytest.approx([6.0, 4.0])
    assert ends["solid"][0] < 5.0 < ends["solid"][1]


@pytest.mark.parametrize("seed", range(5))
def test_free_motion_and_pymunk_are_one_integrator(seed):
    """Calling pymunk in every substep gives the same as calling it only while robots touch."""
    sparing, always = (placed(1, 2, seed, width=2.0, height=2.0) for _ in range(2))
    always.motion = Packed(always.motion.record._replace(search=ALWAYS_TOUCHING))
    engaged = []
    for walk in range(20):
        apart = shorter(wander(sparing, 20, walk) - wander(always, 20, walk), 2.0)
        np.testing.assert_allclose(apart, 0.0, atol=1e-9)
        engaged.append(bool(sparing.motion.record.patience[0]))
    assert True in engaged
    assert False in engaged


def test_a_robot_that_is_pushed_over_a_seam_stays_in_contact():
    """A chain of three across the corner: only copies of copies could miss a pair here."""
    start = np.array([(-0.9, -0.05), (0.0, 0.0), (0.55, 0.6)])
    runs = []
    for place in (MIDDLE, (0.0, 0.0), (0.2, 10.9)):
        physics = Physics(PhysicsSettings(1, 3))
        physics.place(0, start + place, np.array([0.0, 0.0, -math.pi / 2]))
        history = []
        for _ in range(60):
            substep(physics, np.array([1.0, 0.0, 1.0]), np.zeros(3))
            history.append(shorter(physics.positions - place))
        runs.append(np.array(history))
    assert np.abs(runs[0][-1, 1]).max() > 0.3, "the robot in the middle was not pushed"
    # Three bodies are solved by iteration, which begins anew where a contact changes to another copy.
    np.testing.assert_allclose(shorter(runs[1] - runs[0]), 0.0, atol=5e-3)
    np.testing.assert_allclose(shorter(runs[2] - runs[0]), 0.0, atol=5e-3)


def test_a_crowd_stays_solid_and_inside():
    physics = placed(1, 60, 11)
    wander(physics, 200, 12)  # random places overlap at first
    for positions in wander(physics, 200, 13):
        offsets = shorter(positions[:, None] - positions[None, :])
        distances = np.linalg.norm(offsets, axis=2)[np.triu_indices(60, 1)]
        assert distances.min() > 0.3
    assert (positions >= 0.0).all()
    assert (positions < SIZE).all()


@pytest.mark.parametrize("world", [0, 3])
def test_a_world_of_a_batch_has_the_bits_it_has_alone(world):
    walk = wander(placed(4, 12, 3), 200, 4)
    assert np.array_equal(wander(placed(1, 12, 3, world), 200, 4, world), walk[:, 12 * world : 12 * world + 12])


def test_place_leaves_no_trace():
    used, fresh = placed(2, 20, 5), placed(2, 20, 5)
    wander(used, 150, 6)
    for world in range(2):
        rng = np.random.default_rng((5, world))
        used.place(world, rng.uniform(0, SIZE, (20, 2)), rng.uniform(-3, 3, 20))
    assert not used.bodies[:, 2:].any()
    assert np.array_equal(wander(used, 150, 9), wander(fresh, 150, 9))


def test_place_changes_one_world_and_wraps():
    physics = placed(2, 3, 5)
    other = physics.positions[:3].copy()
    physics.place(1, np.array([[-1.0, 12.0], [11.0, 0.0], [-1e-18, 5.0]]), np.array([4.0, -math.pi, 3 * math.pi]))
    assert np.array_equal(physics.positions[:3], other)
    np.testing.assert_allclose(physics.positions[3:], [[10.0, 1.0], [0.0, 0.0], [0.0, 5.0]])
    np.testing.assert_allclose(physics.headings[3:], [4.0 - 2 * math.pi, math.pi, math.pi])


def drive_about(physics, ticks, seed):
    """Run ticks with random commands; return positions (T, R, 2) and velocities."""
    rows, rng = len(physics.positions), np.random.default_rng(seed)
    drive = DifferentialDrive(rows)
    counter = CollisionCounter(physics.settings.worlds, physics.settings.robots, 11.0, 11.0)
    commands = Packed(Commanded(np.zeros((rows, 2)), np.ones(rows, np.bool_), np.zeros(rows, np.bool_)))
    history = []
    for tick in range(ticks):
        commands.record.vectors[:] = rng.normal(0.0, 1.0, (rows, 2))
        Program(lambda: [physics.ticking(4, commands, drive, counter)]).run(0.2 * tick)
        history.append(np.hstack([physics.positions, physics.bodies[:, 2:]]))
    return np.array(history)


def test_a_robot_that_was_taken_away_leaves_no_motion_behind():
    physics = placed(1, 3, 4)
    wander(physics, 20, 5)
    physics.remove(1)
    wanted = physics.motion.record.wanted
    assert not wanted[1].any()
    assert not physics.bodies[1, 2:].any()
    assert wanted[[0, 2]].all()


@pytest.mark.parametrize("ticks", [0, 1, 17, 30])
def test_between_ticks_the_arrays_are_all_there_is(ticks):
    physics = placed(1, 12, 4, width=4.0, height=4.0)
    drive_about(physics, ticks, 2)
    copy = deepcopy(physics)
    original = drive_about(physics, 20, 3)
    drive_about(placed(1, 7, 9, width=3.0, height=3.0), 5, 5)  # other worlds in between
    assert np.array_equal(drive_about(copy, 20, 3), original)


def test_robots_in_a_jam_sink_in_little():
    """Of twelve robots that all drive to one point no two overlap by more than a tenth of their radius."""
    physics = placed(1, 12, 4)
    for _ in range(300):
        offsets = shorter(np.array(MIDDLE) - physics.positions)
        physics.headings[:] = np.arctan2(offsets[:, 1], offsets[:, 0])
        substep(physics, np.ones(12), np.zeros(12))
    apart = np.hypot(*np.moveaxis(shorter(physics.positions[:, None] - physics.positions[None]), -1, 0))
    np.fill_diagonal(apart, np.inf)
    assert 0.5 - 0.025 < apart.min() < 0.5


@pytest.mark.parametrize(
    ("world", "positions", "headings", "message"),
    [
        (1, np.zeros((2, 2)), np.zeros(2), "world: expected 0 to 0, got 1"),
        (0, np.zeros((3, 2)), np.zeros(2), r"positions of world 0: expected finite numbers of shape \(2, 2\)"),
        (0, np.full((2, 2), np.nan), np.zeros(2), "positions of world 0: expected finite"),
        (0, np.zeros((2, 2)), np.zeros(1), r"headings of world 0: expected finite numbers of shape \(2,\)"),
    ],
)
def test_wrong_placements_are_refused(world, positions, headings, message):
    with pytest.raises(ValueError, match=message):
        Physics(PhysicsSettings(1, 2)).place(world, positions, headings)
