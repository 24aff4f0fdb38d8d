"""Small worlds for tests of gradients and mechanisms."""

from dataclasses import dataclass

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.randomness import DirectionStream
from selforg.space import Euclidean, Space, Torus

SPACES = {"torus": Torus(11.0, 7.0), "plane": Euclidean(2), "volume": Euclidean(3)}


@dataclass
class World:
    space: Space
    poses: OwnPoses
    buffer: SoBuffer
    rng: np.random.Generator


def make_world(space="torus", rows=5, teams=None, seed=1, size=8.0, settings=None, now=0.0, **pose_options):
    rng = np.random.default_rng(seed)
    where = SPACES[space] if isinstance(space, str) else space
    poses = OwnPoses(where, rows, teams, **pose_options)
    buffer = SoBuffer(settings or BufferSettings(), where, poses)
    poses.update(rng.random((rows, where.dim)) * size, rng.uniform(-3, 3, rows), now)
    return World(where, poses, buffer, rng)


def scatter(world, count, now=0.0, channel="trail", team=0, size=8.0, **fields):
    positions = world.rng.random((count, world.space.dim)) * size
    world.buffer.store_static(team, channel, positions, now, **fields)
    return positions


def set_pose(poses, row, position, heading, now):
    fields = {"diffusion": 1.0, "goal_radius": 0.5, "attraction": -1}
    poses.set_gradient(row, Gradient(poses.channel, tuple(position), heading=tuple(heading), stamp=now, **fields))


def directions(rows, dim=2, seed=9):
    return DirectionStream([np.random.default_rng((seed, row)) for row in range(rows)], dim)
