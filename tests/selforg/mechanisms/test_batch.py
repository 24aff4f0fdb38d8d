"""A world in a batch equals the world alone, bit for bit; rows only meet through the buffer."""

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, Patrol, Pheromone, RepulsionFernandez, RepulsionGradient
from selforg.randomness import DirectionStream
from selforg.space import Torus

TICKS, ROBOTS = 150, 5


def run(worlds, capacity=64):
    """Run robots that follow the sum of all mechanisms; return the trajectory of each world (T, ROBOTS, 2)."""
    space = Torus(11.0, 11.0)
    rngs = [np.random.default_rng(seed) for seed in worlds]
    rows = len(worlds) * ROBOTS
    poses = OwnPoses(space, rows, np.repeat(np.arange(len(worlds)), ROBOTS))
    items = SoBuffer(BufferSettings(aggregation={"DEFAULT": "new"}, view_distance=1.0), space, poses)
    trail = SoBuffer(BufferSettings(view_distance=4.0, aggregation_distance=0.1, min_diffusion=0.3), space, poses)
    trail.table.reserve(capacity)
    streams = [np.random.default_rng((seed, row)) for seed in worlds for row in range(ROBOTS)]
    pheromone = Pheromone(attraction=-1, evaporation_period=1.0)  # evaporates fast: much comes and goes
    stream = DirectionStream(streams, block=16)
    patrol = Patrol(trail, directions=stream, channels=["Pheromone"], pheromone=pheromone)
    mechanisms = [
        RepulsionFernandez(poses, view_distance=2.0),
        RepulsionGradient(poses),
        ChemotaxisBalch(items),
        patrol,
    ]
    positions = np.concatenate([rng.random((ROBOTS, 2)) * 11 for rng in rngs])
    for team, rng in enumerate(rngs):
        items.store_static(team, "garbage", rng.random((10, 2)) * 11, 0.0)
    trace = []
    for tick in range(TICKS):
        now = tick * 0.2
        poses.update(positions, None, now)
        step = sum(mechanism.move(now)[0].copy() for mechanism in mechanisms)
        patrol.deposit(now)
        positions = space.wrap(positions + 0.2 * np.clip(step, -1, 1))
        trace.append(positions)
    return np.array(trace).reshape(TICKS, len(worlds), ROBOTS, 2).swapaxes(0, 1)


def test_a_world_alone_equals_the_world_in_a_batch():
    together = run([3, 1, 4, 15, 9])
    np.testing.assert_array_equal(run([4])[0], together[2])
    np.testing.assert_array_equal(run([9, 4], capacity=100_000)[1], together[2])
    np.testing.assert_array_equal(run([9, 4])[0], together[4])
