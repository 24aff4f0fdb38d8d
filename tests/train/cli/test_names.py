"""Every shipped name of missions means the same at every border and command."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family, load_named
from clean_swarm_env.config.task_names import COMPARED, KIND_WORDS, named_file, task_names
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.episodes import episodes_of
from selector.documents.find import SHIPPED, files_of
from train.cli.listing import check_named
from train.learning.config import TaskConfig
from train.live.chosen import chosen, playable

NAMES = sorted({*task_names(), *(name for kind in KIND_WORDS for name in files_of(kind))})
QUICK = ("table1", "patrol", "robustness", "table1-starts", "Foraging")
"""A mission that is an experiment, an experiment, one with disturbances, a family, and a task."""


def missions_of(name):
    """The mission that a name means, by how it is asked for; of a family, what all its missions share."""
    found = load_named(name)
    sizes = {"size": found.tori[0]} if isinstance(found, FamilyConfig) and len(found.tori) > 1 else {}
    episode = episodes_of(name, sizes).following((0, 0, 1))[0].mission
    family = TaskConfig(family=name).load()
    return {
        "loaded": found.mission if isinstance(found, FamilyConfig) else found,
        "environment": episode,
        "play": chosen(name, 1, 0, "MaxScore", ()).scenario.mission,
        "family": load_family(name).mission,
        "training": family.mission,
    }


@pytest.mark.parametrize("name", [pytest.param(one, marks=() if one in QUICK else pytest.mark.long) for one in NAMES])
def test_a_name_means_the_same_mission_everywhere(name):
    check_named((), name=name)
    assert name in playable(())
    found = missions_of(name)
    tasks = {how: mission.task.name for how, mission in found.items()}
    assert len(set(tasks.values())) == 1, tasks
    others = {how: (mission.knowledge, mission.network.robot) for how, mission in found.items()}
    assert len(set(others.values())) == 1, others


def test_an_experiment_is_its_mission_in_an_environment():
    env = clean_swarm_v0.parallel_env("patrol")
    env.reset(seed=1)
    assert env.unwrapped.options == clean_swarm_v0.parallel_env("cleaning-patrol").unwrapped.options
    assert load_named("patrol") == load_named("cleaning-patrol")


def test_the_starts_of_an_experiment_are_those_of_its_family(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text("name: own\nmission: table1\nstarts: table1\nconditions: [{name: a}]\n", encoding="utf-8")
    family = load_family(str(path))
    drawn = [family.scenario(0, k, "test").start for k in range(6)]
    assert [one.id for one in drawn] == [*(one.id for one in load_family("table1-starts").starts), drawn[0].id]
    assert np.isfinite(drawn[0].robots[0]).all()


def test_a_file_of_the_user_stands_before_all_of_ours(tmp_path):
    (tmp_path / "families").mkdir()
    file = tmp_path / "families" / "patrol.yaml"
    file.write_text("name: patrol\nmission: table1\nitems: [3, 4]\n", encoding="utf-8")
    for kinds in (tuple(KIND_WORDS), COMPARED):
        assert named_file("patrol", (tmp_path,), kinds=kinds) == file
        assert named_file("patrol", kinds=kinds) == SHIPPED / "experiments" / "patrol.yaml"


@pytest.mark.parametrize(
    "name", ["tabel1", "", "../table1", "tablé1", "TABLE1", "a" * 300, "table1 ", "\u202etable1", "nul\0l"]
)
def test_a_name_that_nothing_has_is_one_line(name):
    for ask in (load_named, load_family, episodes_of, lambda one: check_named((), name=one)):
        with pytest.raises(ConfigurationError) as error:
            ask(name)
        assert len(str(error.value).splitlines()) == 1
