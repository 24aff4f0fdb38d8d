"""A few ticks of a small world with mechanisms of every kind; prints all numbers, to be compared between processes."""

import json

import numpy as np

from selforg.gradients.queries import Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import (
    ChemotaxisGe,
    DepositPheromonesMin,
    Exploitation,
    Flocking,
    FlockingReynolds,
    FollowAll,
    FollowStrongest,
    GossipMax,
    Patrol,
    RepulsionFernandez,
)
from tests.selforg.worlds import directions, make_world, scatter


def play(ticks: int = 4) -> list[float]:
    """Return every movement, decision and pair that is seen."""
    world = make_world(rows=5, size=3.0, settings=BufferSettings(aggregation_distance=0.3))
    for sign in (-1, 0, 1):
        scatter(world, 20, channel=f"sign{sign}", attraction=sign, diffusion=2.0, size=5.0, evaporation_factor=0.5,
                evaporation_period=0.3)  # fmt: skip
    kinds = (RepulsionFernandez, ChemotaxisGe, FollowAll, FollowStrongest, Exploitation, FlockingReynolds, Flocking)
    movers = [kind(world.buffer) for kind in kinds]
    depositing = [kind(world.buffer, directions=directions(5)) for kind in (Patrol, DepositPheromonesMin)]
    gossip, seen = GossipMax(world.buffer, value=np.arange(5.0)), []
    for tick in range(ticks):
        now = 0.2 * (1 + tick)
        step = sum(mechanism.move(now)[0].copy() for mechanism in movers + depositing)
        for mechanism in depositing:
            mechanism.deposit(now)
        world.poses.update(world.space.wrap(world.poses.positions + 0.1 * step), np.full(5, now), now)
        seen += [step.ravel(), gossip.spread(now).values, Queries(world.buffer).gather(now).pairs.ravel()]
        seen.append(Queries(world.buffer).choose("strongest", now)[0].ravel())
    return np.concatenate(seen).tolist()


if __name__ == "__main__":
    print(json.dumps(play()))
