"""Worlds and their parts refuse to be copied at any moment, so that no copy shares memory with its original."""

import copy
import pickle

import pytest

from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.courses import mission, worlds_at_start


@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
@pytest.mark.parametrize("ticks", [0, 30])
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_worlds_and_their_parts_say_that_they_cannot_be_copied(contacts, ticks, copied):
    worlds = worlds_at_start(mission(world={"contacts": contacts}), [1])
    for _ in range(ticks):
        worlds.tick()
    for part in (worlds, worlds.floor, worlds.minds, worlds.physics):
        with pytest.raises(TypeError, match=f"{type(part).__name__} cannot be copied or pickled: Chipmunk keeps"):
            copied(part)


def test_what_holds_worlds_cannot_be_copied_either():
    with pytest.raises(TypeError, match="cannot be copied or pickled"):
        copy.deepcopy(Batch(mission()))


def test_the_message_says_what_to_do_instead():
    with pytest.raises(TypeError, match=r"Make another one of the same mission, reset it with the same start and seed"):
        copy.deepcopy(worlds_at_start(mission(), [1]))
