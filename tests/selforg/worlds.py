"""Small worlds for tests of gradients and mechanisms."""

from dataclasses import dataclass

import numpy as np

from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SteeringMechanism
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.depositing import DepositingMechanism
from selforg.parameters import parameters_of
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


def world_of(rows=5, **options):
    """Robots among gradients of all signs, which evaporate."""
    world = make_world(rows=rows, seed=2, size=4.0, settings=BufferSettings(aggregation_distance=0.1), **options)
    for sign in (-1, 0, 1):
        scatter(world, 12, channel=f"sign{sign}", attraction=sign, goal_radius=0.2, size=4.0, evaporation_factor=0.9,
                evaporation_period=0.15)  # fmt: skip
    return world


def build(name, world, seed=3):
    """Make a mechanism by its name, with the parameters of its example and random directions of its own."""
    example = MECHANISMS.find(name).example
    parameters = {key: one(world.buffer) if callable(one) else one for key, one in example.items()}
    if "directions" in parameters_of(MECHANISMS.find(name)):
        parameters["directions"] = directions(world.poses.rows, world.space.dim, seed)
    return MECHANISMS.find(name)(world.buffer, **parameters)


def answers(mechanism: Mechanism, begin: float, ticks: int = 4) -> np.ndarray:
    """Let everybody walk for some ticks from a time on; return all that the mechanism says, and all that is seen."""
    poses, seen = mechanism.poses, []
    for tick in range(ticks):
        now = begin + 0.1 * tick
        poses.update(poses.positions + 0.05, np.full(poses.rows, now), now)
        if isinstance(mechanism, MovementMechanism):
            vectors, active = mechanism.move(now)
            seen += [vectors.copy().ravel(), active.astype(float)]
        elif isinstance(mechanism, SteeringMechanism):
            commands = Commands(poses.rows, 2)
            commands.vectors[:], commands.commanded[:] = (0.3, 0.2), True
            mechanism.steer(now, np.arange(poses.rows), commands.packed.handle)
            seen.append(commands.vectors.ravel())
        else:
            decision = mechanism.spread(now)
            seen += [decision.values, decision.states] if isinstance(mechanism, DecisionMechanism) else []
        if isinstance(mechanism, DepositingMechanism):
            mechanism.deposit(now)
        seen.append(Queries(mechanism.buffer).gather(now).pairs.ravel())
    return np.concatenate(seen)
