"""A copy or pickle of what holds records goes on with the same bits, whatever becomes of the original."""

import copy
import gc
import pickle
from functools import partial

import numpy as np
import pytest

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.queries import Filter, Queries
from selforg.mechanisms import MECHANISMS
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import cleaning_model, wandering
from tests.selforg.worlds import answers, build, world_of

ROWS = 50


def lossy_buffer():
    world, generators = world_of(rows=ROWS), [np.random.default_rng(row) for row in range(ROWS)]
    delivery = Delivery(reach=2.0, loss=0.3, delay=0.25, generators=generators)
    return SoBuffer(world.buffer.settings, world.space, world.poses, delivery), world.rng


def grow(owner, begin):
    """Give a buffer more than it holds; return what is seen."""
    (buffer, rng), seen = owner, []
    for now in begin + 0.1 * np.arange(4.0):
        buffer.deliver(now)
        fading = {"evaporation_factor": 0.5, "evaporation_period": 0.2}
        buffer.store_static(0, f"new{begin}", rng.random((30, 2)) * 4, now, **fading)
        messages, tags = buffer.blank(ROWS, "spread")
        messages[:, :2], messages[:, 3], tags[:, 2] = rng.random((ROWS, 2)), 2.0, np.arange(ROWS)
        buffer.spread(messages, tags, now)
        seen.append(Queries(buffer).gather(now, None, Filter(view_distance=np.inf)).pairs.ravel())
    return np.concatenate(seen)


def decide(network, begin):
    """Let a network live; return all that it knows."""
    for now in wandering(np.random.default_rng(int(begin)), 12, network.rows):
        network.readings[:] = now
        network.step()
    return np.concatenate([np.ravel(array).astype(float) for array in network.state])


MODEL = cleaning_model()
CASES = {
    **{name: (lambda name=name: build(name, world_of()), answers) for name in MECHANISMS.names()},
    "buffer": (lossy_buffer, grow),
    "planned network": (lambda: BehaviourNetwork(MODEL, 30, Planner(MODEL)), decide),
    "explained network": (partial(BehaviourNetwork, MODEL, 30, explained=True), decide),
}
"""How to make something, and how it is used from a time on: all that it then knows is returned."""


@pytest.mark.parametrize("case", CASES)
def test_a_copy_and_a_pickle_go_on_alone_with_the_same_bits(case):
    make, use = CASES[case]
    original = make()
    use(original, 1.0)
    copies = copy.deepcopy(original), pickle.loads(pickle.dumps(original))
    expected = use(original, 2.0)  # what this changes is not theirs
    del original
    gc.collect()
    for twin in copies:
        np.testing.assert_array_equal(use(twin, 2.0), expected)
