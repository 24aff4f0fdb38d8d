"""No class of a batch of worlds forgets an array: all go through the walk that makes states."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.world.worlds import Worlds
from selforg.declared import walk
from selforg.sealing import sealed, unsealed
from tests.clean_swarm_env.copies import MISSIONS, actions_of
from tests.clean_swarm_env.courses import CROWD, avoidance, begun, worlds_at_start
from tests.paths import ROOT

KINDS = [("missions", name) for name in MISSIONS] + [("tasks", name) for name in TASKS.names()]
for kind in ("missions", "families"):
    KINDS += [(kind, path.stem) for path in sorted((ROOT / "configs" / kind).glob("*.yaml"))]


def made(kind, name):
    if kind == "families":
        tori = load_family(name).tori
        return Batch(worlds=2, family=name, size=tori[0] if len(tori) > 1 else None)
    return Batch({"task": name} if kind == "tasks" else MISSIONS.get(name, name), 2)


@pytest.mark.parametrize(("kind", "name"), KINDS)
def test_no_array_of_a_batch_is_forgotten(kind, name):
    batch = begun(made(kind, name), [1, 2])
    assert walk(batch).forgotten == []
    batch.step(actions_of(batch, np.random.default_rng(1)))
    assert walk(batch).forgotten == []


def test_an_array_that_nobody_declares_is_named_before_a_state_is_made():
    worlds = Worlds(CROWD, avoidance())
    worlds.mine = {"places": np.zeros(3)}
    with pytest.raises(TypeError, match=r"^Worlds.mine.places: expected a declaration \(selforg.arrays\)$"):
        worlds.get_state()


def test_indices_out_of_bounds_are_refused_whoever_made_the_state():
    worlds, others = worlds_at_start(CROWD, [1]), worlds_at_start(CROWD, [1])
    worlds.task.garbage.cargo[0] = 99
    before = others.get_state()
    with pytest.raises(ValueError, match=r"^state: task.garbage.cargo: expected indices from -1 to \d+, got -1 to 99$"):
        others.set_state(worlds.get_state())
    assert others.get_state() == before


def test_a_state_says_first_what_it_lacks_or_has_too_much():
    worlds = worlds_at_start(CROWD, [1])
    state = unsealed("world", worlds.get_state())
    with pytest.raises(ValueError, match=r"^state: options: expected \(\(.*\), got None$"):
        worlds.set_state(sealed("world", state._replace(likeness=b"\x80\x05}\x94.")))
