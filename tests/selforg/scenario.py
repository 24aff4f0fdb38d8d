"""Prints digests of what mechanisms, named by arguments, and a network do in some ticks, for comparing processes."""

import hashlib
import json
import sys

import numpy as np

from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import cleaning_model, wandering
from tests.selforg.worlds import answers, build, world_of


def of_network(rows: int = 4, steps: int = 12) -> np.ndarray:
    """Return all that a small network knows in the course of a life."""
    model, known = cleaning_model(), []
    network = BehaviourNetwork(model, rows, Planner(model), explained=True)
    for now in wandering(np.random.default_rng(3), steps, rows):
        network.readings[:] = now
        network.step()
        known += [np.ravel(array).astype(float) for array in network.state]
    return np.concatenate(known)


def digests(names: list[str]) -> dict[str, str]:
    """Return a digest of all numbers, by the name of the mechanism; -0 counts as 0."""
    told = {name: answers(build(name, world_of()), 1.0) for name in names} | {"network": of_network()}
    return {name: hashlib.sha256((numbers + 0.0).tobytes()).hexdigest() for name, numbers in told.items()}


if __name__ == "__main__":
    print(json.dumps(digests(sys.argv[1:])))
