"""Copies and pickles of what holds records are independent of the original, and go on with the same bits."""

import copy
import gc
import pickle

import numpy as np
import pytest

from selforg.commands import Commands
from selforg.gradients.delivery import Delivery, PoseDelivery
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SteeringMechanism
from selforg.mechanisms.depositing import DepositingMechanism
from selforg.parameters import parameters_of
from selforg.randomness import next_direction
from tests.selforg.worlds import directions, make_world, scatter, set_pose

gc.freeze()  # else each `gc.collect` below looks through all that was imported
TICKS = 4


def assert_copies_are_independent(make, play):
    """`make` returns something new, `play` uses it for some ticks from a time on and returns an array."""
    alone = make()
    first, second = play(alone, 1.0), play(alone, 2.0)
    original = make()
    np.testing.assert_array_equal(play(original, 1.0), first)
    twin, orphan = copy.deepcopy(original), pickle.loads(pickle.dumps(original))
    np.testing.assert_array_equal(play(twin, 2.0), second)
    np.testing.assert_array_equal(play(original, 2.0), second)  # the twin has changed nothing here
    del original, twin
    gc.collect()
    np.testing.assert_array_equal(play(orphan, 2.0), second)


def world_of(rows=5, **options):
    world = make_world(rows=rows, seed=2, size=4.0, settings=BufferSettings(aggregation_distance=0.1), **options)
    for sign in (-1, 0, 1):
        scatter(world, 12, channel=f"sign{sign}", attraction=sign, goal_radius=0.2, size=4.0, evaporation_factor=0.9,
                evaporation_period=0.15)  # fmt: skip
    return world


def play_mechanism(mechanism, begin):
    """Let everybody walk, and return all answers."""
    poses, seen = mechanism.poses, []
    for tick in range(TICKS):
        now = begin + 0.1 * tick
        poses.update(poses.positions + 0.05, np.full(poses.rows, now), now)
        if isinstance(mechanism, MovementMechanism):
            vectors, active = mechanism.move(now)
            seen += [vectors.copy().ravel(), active.astype(float)]
        elif isinstance(mechanism, DecisionMechanism):
            decision = mechanism.spread(now)
            seen += [decision.values, decision.states.astype(float)]
        elif isinstance(mechanism, SteeringMechanism):
            commands = Commands(poses.rows, 2)
            commands.vectors[:], commands.commanded[:] = (0.3, 0.2), True
            mechanism.steer(now, np.arange(poses.rows), commands.packed.words)
            seen.append(commands.vectors.ravel())
        else:
            mechanism.spread(now)
        if isinstance(mechanism, DepositingMechanism):
            mechanism.deposit(now)
        seen.append(Queries(mechanism.buffer).gather(now).pairs.ravel())
    return np.concatenate(seen)


@pytest.mark.parametrize("name", MECHANISMS.names())
def test_copies_of_mechanisms_are_independent(name):
    def make():
        world, kind = world_of(), MECHANISMS.find(name)
        parameters = {key: one(world.buffer) if callable(one) else one for key, one in kind.example.items()}
        if "directions" in parameters_of(kind):
            parameters["directions"] = directions(5)
        return kind(world.buffer, **parameters)

    assert_copies_are_independent(make, play_mechanism)


def test_a_copy_writes_where_its_own_owner_looks():
    def make():
        mechanism = MECHANISMS.create("FollowAll", world_of().buffer)
        return mechanism, np.zeros((5, 2)), np.zeros(5, dtype=np.bool_)

    def play(owner, begin):
        mechanism, vectors, active = owner
        for tick in range(TICKS):
            mechanism.move_into(begin + 0.3 * tick, np.array([1, 3]), vectors, active)
        return vectors.copy()

    assert_copies_are_independent(make, play)


def test_copies_of_poses_that_rows_hear_are_independent():
    def make():
        poses = world_of(rows=6, hearing=True, history=3).poses
        generators = [np.random.default_rng(row) for row in range(6)]
        return PoseDelivery(poses, np.array([2.5]), np.array([0.4]), generators)

    def play(hearing, begin):
        poses = hearing.poses
        for tick in range(TICKS):
            poses.update(poses.positions * 0.98, None, begin + 0.1 * tick)
            hearing.deliver()
        set_pose(poses, 3, (1.0, begin), (1.0, 0.0), begin + 0.9)
        return np.concatenate([poses.own.ravel(), poses.row_table.ravel().astype(float)])

    assert_copies_are_independent(make, play)


@pytest.mark.parametrize("rows", [4, 50])
@pytest.mark.parametrize("delivery", ["ideal", "lossy"])
def test_copies_of_buffers_are_independent_also_while_they_grow(rows, delivery):
    def make():
        world = world_of(rows=rows)
        if delivery == "lossy":
            generators = [np.random.default_rng(row) for row in range(rows)]
            kind = type(world.buffer)
            delay = Delivery(reach=2.0, loss=0.3, delay=0.25, generators=generators)
            return kind(world.buffer.settings, world.space, world.poses, delay), world.rng
        return world.buffer, world.rng

    def play(owner, begin):
        buffer, rng = owner
        seen = []
        for tick in range(TICKS):
            now = begin + 0.1 * tick
            buffer.deliver(now)
            buffer.store_static(0, f"new{begin}", rng.random((30, 2)) * 4, now, evaporation_factor=0.5,
                                evaporation_period=0.2)  # fmt: skip
            messages, tags = buffer.blank(rows, "spread")
            messages[:, :2], messages[:, 3], tags[:, 2] = rng.random((rows, 2)), 2.0, np.arange(rows)
            buffer.spread(messages, tags, now)
            seen.append(Queries(buffer).gather(now, None, Filter(view_distance=np.inf)).pairs.ravel())
        return np.concatenate(seen)

    assert_copies_are_independent(make, play)


def test_copies_of_streams_are_independent():
    def play(stream, begin):
        taken = []
        for tick in range(30):
            stream.refill()
            taken += next_direction(stream.vectors, stream.cursor, stream.low, tick % 3)
        return np.array(taken)

    assert_copies_are_independent(lambda: directions(3), play)
