"""Steering mechanisms beside naive references in plain Python, and what all of them promise."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import minimize

from selforg.commands import Commands
from selforg.compiler.decorators import kernel
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery, PoseDelivery
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, ORCA, PredictiveSteering, SteeringMechanism
from selforg.mechanisms.steering.base import OTHER_COLUMNS, note_others
from selforg.space import Torus
from tests.selforg.worlds import directions, make_world

NAMES = [name for name in MECHANISMS.names() if issubclass(MECHANISMS.find(name), SteeringMechanism)]
DT, SIDE = 0.2, 11.0


@kernel
def noted(row, now, view, others, poses):
    return note_others(row, now, view, others, poses)


def moving(rows=8, side=4.0, seed=0, teams=None, **options):
    """Robots that crowd in a corner of a torus, with two poses each, one tick apart."""
    rng = np.random.default_rng(seed)
    world = make_world(Torus(SIDE, SIDE), rows=rows, teams=teams, seed=seed, size=side, **options)
    velocities, headings = rng.uniform(-1, 1, (rows, 2)), rng.uniform(-np.pi, np.pi, rows)
    places = world.poses.positions + DT * velocities
    world.poses.update(places, headings, DT)
    return world.poses, places, headings, velocities


def wishes(rows, seed=0):
    rng = np.random.default_rng(seed + 1000)
    commands = Commands(rows, 2)
    angles = rng.uniform(-np.pi, np.pi, rows)
    commands.vectors[:] = rng.uniform(0.3, 1.0, (rows, 1)) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    commands.commanded[:] = True
    return commands


def nearest(offset):
    return (offset + SIDE / 2) % SIDE - SIDE / 2


def seen_by(row, places, velocities, reach):
    """Return offset and velocity of the robots within `reach` of a row."""
    offsets = [nearest(place - places[row]) for place in places]
    near = [k for k, offset in enumerate(offsets) if k != row and np.hypot(*offset) <= reach]
    return [(offsets[k], velocities[k]) for k in near]


def predicted(wish, heading, others, distance=0.591, margin=0.05, horizon=1.64, caution=0.46, urgency=37.6, right=0.0):
    """Return the velocity that promises most, in plain Python."""
    speed, forward = math.hypot(*wish), math.atan2(wish[1], wish[0])
    best = -math.inf, (0.0, 0.0)
    degrees = (0, 15, -15, 30, -30, 50, -50, 75, -75, 105, -105, 150, -150)
    tried = [*itertools.product(degrees, (1.0, 0.5, 0.2)), (0, 0.0)]
    for degree, share in tried:
        direction = forward + math.radians(degree)
        turn = abs(math.remainder(direction - heading, 2 * math.pi)) if share else 0.0
        candidate = np.array([math.cos(direction), math.sin(direction)]) * share * speed
        drives = candidate / 2 + share * speed / 2 * np.array([math.cos(heading), math.sin(heading)])
        if turn > math.pi / 3:
            drives = candidate / 2
        promise = share * math.cos(math.radians(degree)) - 0.35 * turn / math.pi - (right if degree < 0 else 0.0)
        for offset, velocity in others:
            closing = velocity - drives
            if offset @ closing >= 0:
                continue
            time = min(-(offset @ closing) / (closing @ closing), horizon)
            d = np.linalg.norm(offset + time * closing)
            near = max(distance + margin - d, 0) / margin
            promise -= caution * (near + urgency * max(distance - d, 0) * (1.2 - time / horizon))
        if promise > best[0] + 1e-12:
            best = promise, tuple(candidate)
    return best[1]


@pytest.mark.parametrize("seed", range(25))
def test_predictive_steering_takes_what_promises_most(seed):
    poses, places, headings, velocities = moving(side=2.5, seed=seed)
    commands = wishes(8, seed)
    before = commands.vectors.copy()
    right = 0.1 * (seed % 2)
    PredictiveSteering(poses, view_distance=1.0, right_cost=right).steer(DT, np.arange(8), commands.packed.handle)
    for row in range(8):
        others = seen_by(row, places, velocities, 2.5)
        expected = predicted(before[row], headings[row], others, right=right) if others else before[row]
        np.testing.assert_allclose(commands.vectors[row], expected, atol=1e-9)
    assert (commands.vectors != before).any()


def nearest_meeting(name, start, goals, noise=0.0, seed=0, **options):
    """Let two points of at most 1 m/s drive to `goals`; return how close they come [m]."""
    rng, place, apart = np.random.default_rng(seed), np.array(start), []
    poses, drives = make_world(Torus(SIDE, SIDE), rows=2).poses, goals - place
    steering = MECHANISMS.find(name)(poses, view_distance=1.0, **options)
    for tick in range(1, 40):
        poses.update(place + noise * rng.normal(size=(2, 2)), np.arctan2(*drives.T[::-1]), DT * tick)
        commands, way = Commands(2, 2), goals - place
        commands.vectors[:] = way / np.maximum(np.linalg.norm(way, axis=1), 1.0)[:, None]
        commands.commanded[:] = True
        steering.steer(DT * tick, np.arange(2), commands.packed.handle)
        drives = commands.vectors
        place = place + DT * drives
        apart.append(np.linalg.norm(place[0] - place[1]))
    return min(apart[2:])


def test_points_that_meet_head_on_pass_on_the_left_where_the_right_costs_a_little():
    nearest = {}
    for cost in (0.0, 0.02):
        starts = [5.5 + 2.5 * np.outer((-1, 1), unit(0.3 * seed)) for seed in range(20)]
        met = [
            nearest_meeting("PredictiveSteering", start, start[::-1], 1e-4, seed, right_cost=cost)
            for seed, start in enumerate(starts)
        ]
        nearest[cost] = min(met)
    assert nearest[0.0] < 0.3  # they dodge left and right by turns
    assert nearest[0.02] > 0.6


def test_two_robots_at_one_place_part():
    assert nearest_meeting("ORCA", np.full((2, 2), 5.0), np.full((2, 2), (8.0, 5.0))) > 0.6


def test_who_did_not_get_on_dares_to_come_near_for_some_seconds():
    poses, *_ = moving(rows=2, side=0.1)
    steering = PredictiveSteering(poses, view_distance=1.0, daring=0.0, directions=directions(2))
    blocked = []
    for tick in range(70):
        now = DT * (tick + 2)
        poses.update(np.array([[5.0, 5.0], [5.55, 5.0]]), np.zeros(2), now)
        commands = Commands(2, 2)
        commands.vectors[:], commands.commanded[:] = (1.0, 0.0), True
        steering.steer(now, np.array([0]), commands.packed.handle)
        blocked.append(commands.vectors[0].tolist() != [1.0, 0.0])
    assert all(blocked[1:24])
    dared = blocked.index(False, 1)
    assert 24 <= dared <= 27
    assert 5 <= blocked[dared:].index(True) <= 20  # 1 to 4 s


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def nearest_on_the_border(offset, radius, time, relative):
    """Return the nearest point on the border of a velocity obstacle: the cut-off cone of Fig. 1 of the authors."""
    distance, forward, centre = np.hypot(*offset), np.arctan2(offset[1], offset[0]), offset / time
    from_centre = relative - centre
    if distance <= radius:
        return centre + radius / time * from_centre / np.linalg.norm(from_centre)
    half = np.arcsin(radius / distance)
    legs = [unit(forward + s * half) for s in (1, -1)]
    begin = np.sqrt(distance**2 - radius**2) / time
    beside = (np.arctan2(from_centre[1], from_centre[0]) - forward) % (2 * np.pi) - np.pi
    facing = forward + np.pi + np.clip(beside, half - np.pi / 2, np.pi / 2 - half)
    found = [centre + radius / time * unit(facing), *(max(relative @ leg, begin) * leg for leg in legs)]
    return min(found, key=lambda point: np.linalg.norm(point - relative))


def permitted(own, offset, velocity, radius=0.65, horizon=2.0, period=0.2):
    """Return point and normal of the half-plane by the nearest point of the border."""
    apart = np.hypot(*offset) > radius
    time, relative = horizon if apart else period, own - velocity
    change = nearest_on_the_border(offset, radius, time, relative) - relative
    closest = min(np.linalg.norm(offset - relative * t) for t in np.linspace(0, time, 4001))
    inside = closest < radius if apart else np.hypot(*(relative - offset / time)) < radius / time
    return own + change / 2, change / np.linalg.norm(change) * (1 if inside else -1)


@pytest.mark.parametrize("seed", range(25))
def test_orca_takes_the_permitted_velocity_nearest_to_the_command(seed):
    poses, places, _, velocities = moving(rows=6, side=[3.0, 2.0, 1.2][seed % 3], seed=seed)
    commands = wishes(6, seed)
    before = commands.vectors.copy()
    ORCA(poses, view_distance=1.0).steer(DT, np.arange(6), commands.packed.handle)
    for row in range(6):
        planes = [permitted(velocities[row], *other) for other in seen_by(row, places, velocities, 2.5)]

        def worst(v, planes=planes):
            return max((float((point - v) @ normal) for point, normal in planes), default=-1.0)

        found, wish, speed = commands.vectors[row], before[row], np.linalg.norm(before[row])
        assert np.linalg.norm(found) <= speed + 1e-9
        disc = [{"type": "ineq", "fun": lambda v, s=speed: s**2 - v[0] ** 2 - v[1] ** 2}]
        least = minimize(
            lambda z: z[2],
            [0.0, 0.0, worst(np.zeros(2))],
            constraints=[
                disc[0],
                *({"type": "ineq", "fun": lambda z, p=p, n=n: z[2] - (p - z[:2]) @ n} for p, n in planes),
            ],
        ).x[2]
        if least > 1e-3:  # none is permitted
            assert worst(found) <= least + 1e-4
            continue
        assert worst(found) <= 1e-4
        inside = [{"type": "ineq", "fun": lambda v, p=p, n=n: (v - p) @ n} for p, n in planes]
        nearest_one = minimize(lambda v, w=wish: ((v - w) ** 2).sum(), found, constraints=[*disc, *inside])
        assert np.linalg.norm(found - wish) <= np.sqrt(nearest_one.fun) + 1e-4


@pytest.mark.long
@pytest.mark.extra
def test_orca_takes_the_velocities_of_rvo2():
    """RVO2 is the library of the authors, in numbers of 32 bits; `pyrvo` binds it, here without its requirements."""
    pyrvo = pytest.importorskip("pyrvo", reason="needs pyrvo, by hand: pip install --no-deps pyrvo==0.4.3")
    apart = []
    for seed in range(325):
        poses, places, _, velocities = moving(rows=6, side=[3.0, 2.0, 1.2][seed % 3], seed=seed)
        commands, simulator = wishes(6, seed), pyrvo.RVOSimulator(0.2, 2.5, 10, 2.0, 1.0, 0.325, 1.0)
        for row, (place, velocity, wish) in enumerate(
            zip(places.tolist(), velocities.tolist(), commands.vectors.tolist(), strict=True)
        ):
            simulator.add_agent(place)
            simulator.set_agent_velocity(row, velocity)
            simulator.set_agent_pref_velocity(row, wish)
            simulator.set_agent_max_speed(row, math.hypot(*wish))
        simulator.do_step()
        ORCA(poses, view_distance=1.0).steer(DT, np.arange(6), commands.packed.handle)
        theirs = [simulator.get_agent_velocity(row).to_tuple() for row in range(6)]
        apart += np.abs(commands.vectors - theirs).max(axis=1).tolist()
    assert max(apart) < 5e-3
    assert np.quantile(apart, 0.99) < 1e-4


def build(name, poses):
    return MECHANISMS.find(name)(poses, view_distance=1.0, **MECHANISMS.find(name).example)


def beside_a_goal(poses):
    """Return a buffer of the robots with a gradient that attracts them."""
    buffer = SoBuffer(BufferSettings(), poses.space, poses)
    buffer.store_static(0, "goal", [[2.5, 1.0]], DT)
    return buffer


@pytest.mark.parametrize("name", NAMES)
def test_rows_that_nobody_is_near_to_or_that_do_not_move_keep_their_commands(name):
    poses, *_ = moving(rows=6, teams=[0, 1, 2, 3, 3, 3], side=1.0)
    commands = wishes(6)
    commands.commanded[3], commands.in_place[4] = False, True
    commands.vectors[5] = 0.0
    before = commands.vectors.copy()
    build(name, poses).steer(DT, np.arange(6), commands.packed.handle)
    np.testing.assert_array_equal(commands.vectors, before)
    assert commands.commanded.tolist() == [True, True, True, False, True, True]


@pytest.mark.parametrize("name", NAMES)
def test_steering_keeps_to_the_speed(name):
    poses, *_ = moving(side=2.0)
    commands = wishes(8)
    before = commands.vectors.copy()
    build(name, beside_a_goal(poses)).steer(DT, np.arange(8), commands.packed.handle)
    assert (commands.vectors != before).any()
    speeds = np.linalg.norm(commands.vectors, axis=1)
    assert (speeds <= np.linalg.norm(before, axis=1) + 1e-9).all()


@pytest.mark.parametrize("name", NAMES)
def test_steering_needs_a_plane(name):
    with pytest.raises(ValueError, match="expected a space of 2 dimensions, got 3"):
        MECHANISMS.find(name)(make_world("volume").poses)


def test_places_and_velocities_are_those_of_the_poses_received():
    poses = make_world(Torus(SIDE, SIDE), rows=2, history=6, hearing=True).poses
    delivery = PoseDelivery(poses, Delivery(np.array([3.0]), np.zeros(1)))
    place, seen = 10.0, []
    for tick in range(9):
        now = DT * tick
        poses.update(np.array([[1.0, 5.0], [place % SIDE, 5.0]]), np.zeros(2), now + 1.0)
        delivery.rule.reach[0] = 3.0 if tick in (0, 2, 3) else 0.0
        delivery.deliver()
        others = np.zeros((2, OTHER_COLUMNS))
        count = noted(0, now + 1.0, 10.0, others, poses.packed.handle)
        seen.append(others[0, [0, 2]].round(9).tolist() if count else None)
        place += 0.1 * (tick + 1)  # ever faster
    assert seen[0] == [-2.0, 0.0]  # a single pose has no velocity
    assert seen[1] == [-2.0, 0.0]
    assert seen[2] == [-1.7, 0.75]  # 0.3 m in two ticks: the pose between got lost
    assert seen[3] == [-1.4, 1.5]
    assert seen[4] == [-1.1, 1.5]  # carried on
    assert seen[7] == [-0.2, 1.5]
    assert seen[8] == [-1.4, 0.0]  # the pose before is forgotten
