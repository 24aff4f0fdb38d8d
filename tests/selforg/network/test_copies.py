"""A copy of a network goes on by itself: with the same bits, and without the original's memory."""

import copy
import gc
import pickle

import numpy as np
import pytest

from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import cleaning_model, wandering

ROWS, BEFORE, AFTER = 30, 6, 20
WAYS = [copy.deepcopy, lambda network: pickle.loads(pickle.dumps(network))]


def readings():
    return wandering(np.random.default_rng(4), BEFORE + AFTER, ROWS)


def everything(network):
    return [np.copy(array) for array in network.state]


def live(network, course):
    for now in course:
        network.readings[:] = now
        network.step()
    return everything(network)


def assert_equal(ones, others):
    for one, other in zip(ones, others, strict=True):
        np.testing.assert_array_equal(one, other)


def planned():
    model = cleaning_model()
    return BehaviourNetwork(model, ROWS, Planner(model))


def explained():
    return BehaviourNetwork(cleaning_model(), ROWS, explained=True)


@pytest.mark.parametrize("way", WAYS, ids=["deepcopy", "pickle"])
@pytest.mark.parametrize("make", [planned, explained])
def test_a_copy_made_in_the_middle_goes_on_like_the_original(make, way):
    course = readings()
    original = make()
    live(original, course[:BEFORE])
    before = everything(original)
    duplicate = way(original)
    ended = live(duplicate, course[BEFORE:])
    assert_equal(everything(original), before)  # the copy's life leaves no trace in it
    assert_equal(ended, live(original, course[BEFORE:]))


@pytest.mark.parametrize("way", WAYS, ids=["deepcopy", "pickle"])
def test_a_copy_goes_on_when_the_original_is_gone(way):
    course = readings()
    expected = live(planned(), course)
    original = planned()
    live(original, course[:BEFORE])
    duplicate = way(original)
    del original
    gc.collect()
    litter = [np.full(size, -1, dtype=np.int64) for size in range(1, 5000, 7)]  # what would now lie in its place
    assert_equal(live(duplicate, course[BEFORE:]), expected)
    assert len(litter) > 0


@pytest.mark.parametrize("way", WAYS, ids=["deepcopy", "pickle"])
def test_what_is_set_in_a_copy_reaches_its_kernels(way):
    network = way(planned())
    network.enable(np.arange(ROWS), 0, False)
    network.set_priority(np.arange(ROWS), 1, 3)
    assert (network.state.marks[:, 1, 0] == 0).all()
    network.readings[0, 0] = 0.5
    with pytest.raises(ValueError, match="row 0: sensor 'garbage_seen'"):
        network.step()
