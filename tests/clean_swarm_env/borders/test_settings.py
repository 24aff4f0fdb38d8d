"""The settings of all borders: help shows them, mistakes are told, and spaces name what they hold."""

import copy
import inspect
import pickle
import pydoc
import re

import numpy as np
import pytest

from clean_swarm_env import Batch, clean_swarm_v0, load_mission
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.borders.spaces import action_space, observation_space
from clean_swarm_env.learning.episodes import EnvSettings
from selector.documents.find import SHIPPED
from tests.clean_swarm_env.courses import begun

BORDERS = [
    clean_swarm_v0.parallel_env, clean_swarm_v0.env, clean_swarm_v0.raw_env, clean_swarm_v0.CleanSwarm,
    CleanSwarmTeam, RobotVectorEnv, TeamVectorEnv,
]  # fmt: skip


@pytest.mark.parametrize("border", BORDERS, ids=lambda border: border.__name__)
def test_help_shows_every_setting(border):
    shown = inspect.signature(border).parameters
    assert EnvSettings.__annotations__.keys() | {"mission", "reward"} <= shown.keys()
    assert "settings" not in shown
    assert re.search(r"knowledge: '?Named \| None'? = None", pydoc.render_doc(border, renderer=pydoc.plaintext))


@pytest.mark.parametrize(("wrong", "meant"), [("knowlege", "knowledge"), ("obsevation", "observation")])
def test_a_mistyped_setting_is_told_with_the_one_that_was_meant(wrong, meant):
    for border in BORDERS:
        with pytest.raises(TypeError, match=f"unknown setting '{wrong}' .*; did you mean '{meant}'") as told:
            border(**{wrong: "avoidance"})
        assert "\n" not in str(told.value)


def test_episodes_can_be_shortened_for_learners():
    for settings in ({}, {"mission": "exploring"}, {"family": "crowded"}):
        batch = begun(Batch(time_limit=2.0, **settings), [1])
        assert [batch.step(np.tile(batch.choices.default, (batch.rows, 1))).truncated[0] for _ in "ab"] == [False, True]
    with pytest.raises(ValueError, match="mission: time_limit: expected"):
        Batch(time_limit=-1.0)


def test_an_environment_of_a_family_sees_the_terms_of_its_mission():
    further = {path.stem for path in (SHIPPED / "missions").glob("*.yaml") if load_mission(path.stem).terms}
    assert {"exploring", "transport"} <= further
    alone, family = Batch("exploring"), Batch(family="clustered")
    assert alone.observer.names == family.observer.names
    assert {name for name in family.observer.names if name.startswith("finds")}
    assert Batch("exploring", action={"mode": "velocity"}).observer.names[-1] == family.observer.names[-1]
    chosen = Batch("exploring", observation={"terms": ["cargo"]})
    assert chosen.observer.names == ("carrying", "recycled")
    patient = Batch("exploring", observation={"patience": 30.0})
    assert patient.observer.names == alone.observer.names
    assert patient.observer.config.patience == 30.0


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda space: pickle.loads(pickle.dumps(space))])
def test_spaces_name_what_they_hold_and_copies_do_too(copied):
    batch = Batch(family="clustered")
    assert copied(observation_space(batch)).names == batch.observer.names
    assert copied(action_space(batch)).names == dict(batch.options)
    assert len(observation_space(batch, 2).names) == 2 * batch.observer.width


def test_pictures_have_the_size_that_is_asked_for():
    env = begun(CleanSwarmTeam(render_mode="rgb_array", picture={"side": 300, "numbers": False}), seed=1)
    height, width, _ = env.render().shape
    assert width in (299, 300, 301)
    assert height > width
    env.close()
    with pytest.raises(ValueError, match="picture: side: expected"):
        Batch(picture={"side": 10})
