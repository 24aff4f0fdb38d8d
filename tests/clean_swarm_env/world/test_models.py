"""Robots that differ: bodies and drives by model, the same bits alone and in a batch, and groups that cannot be."""

import numpy as np
import pytest
import yaml
from pettingzoo.test import parallel_api_test

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_family, random_starts
from clean_swarm_env.config.robots import RobotConfig, RobotModel
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.physics.collisions import CollisionCounter
from selector.documents.errors import DocumentError
from tests.clean_swarm_env.courses import CROWD, course, difference, mission, worlds_at_start
from tests.clean_swarm_env.physics.substeps import count

CARRIER = {"model": "carrier", "count": 3, "radius": 0.3, "max_speed": 0.5, "turn_gain": 4.0}
SCOUT = {"model": "scout", "count": 2, "radius": 0.15, "max_speed": 1.5, "drive": "holonomic", "pose_noise": 0.02}
JOINING = [{"at": 4.0, "do": "join", "robots": 2, "model": "scout"}, {"at": 6.0, "do": "join"}]


def team(**changes):
    size = {"width": 5.0, "height": 5.0}
    stations = {"recycling": [1.0, 1.0], "dump": [3.0, 3.0]}
    return mission(robots=[CARRIER, SCOUT], world=size, stations=stations, garbage={"count": 3}, **changes)


def test_groups_of_equal_robots_have_the_bits_of_a_team():
    groups = [{"model": "left", "count": 5}, {"model": "right", "count": 3}]
    alike = mission(**CROWD.model_dump(include={"world"}), robots=groups, garbage={"count": 2},
                    stations=CROWD.task.stations.model_dump(include={"recycling", "dump"}))  # fmt: skip
    courses = [course(worlds_at_start(config, [5]), 0, 120) for config in (CROWD, alike)]
    assert not difference(*courses)


def test_bodies_and_drives_are_those_of_the_models():
    worlds = worlds_at_start(team(events=JOINING), [3, 4])
    assert worlds.mission.models.tolist() == [0, 0, 0, 1, 1, 1, 1, 0]
    radii, speeds = (worlds.world.of_each(key) for key in ("radius", "max_speed"))
    nearest, fastest = np.inf, np.zeros(worlds.rows)
    for _ in range(150):
        worlds.tick()
        fastest = np.maximum(fastest, np.abs(worlds.floor.drive.speed))
        for world in range(2):
            rows = worlds.rows_of(world)
            rows = rows[worlds.physics.present[rows]]
            offsets = worlds.physics.positions[rows][:, None] - worlds.physics.positions[rows]
            away = np.linalg.norm((offsets + 2.5) % 5.0 - 2.5, axis=2) - radii[rows][:, None] - radii[rows]
            nearest = min(nearest, away[~np.eye(len(rows), dtype=bool)].min())
    assert worlds.physics.present.all()
    assert (fastest <= speeds).all()
    assert fastest[np.tile(worlds.mission.models == 1, 2)].min() > 0.5
    assert -0.08 < nearest < 0.01  # they touch, and sink in by a substep at most


def test_a_collision_is_the_same_gap_between_bodies_of_any_size():
    counter = CollisionCounter(1, 3, 11.0, 11.0, distances=(0.55,), wider=np.array([0.0, 0.2, -0.1]))
    places = np.array([[1.0, 1.0], [1.74, 1.0], [1.0, 1.44]])  # gaps: 0.04 m; 0.04 m; more
    count(counter, places)
    assert counter.samples[0, 0] == 2
    count(counter, places * [1.01, 1.01])
    assert counter.samples[0, 0] == 4
    count(counter, places * [1.02, 1.05])
    assert counter.samples[0, 0] == 4


def test_groups_are_agents_of_an_environment_and_a_family_of_random_starts():
    config = team(time_limit=20.0)
    parallel_api_test(clean_swarm_v0.parallel_env(config, action={"mode": "velocity"}), num_cycles=5)
    family = random_starts(config)
    assert family.robots == (5, 5)
    assert family.scenario(0, 0, "test").mission.robots == config.robots.model_copy(update={"capacity": 5})


MIXED = {"name": "mixed", "description": "", "mission": {"base": "scouts"}, "items": [24, 24]}


def family_of(folder, **changes):
    (folder / "mixed.yaml").write_text(yaml.safe_dump(MIXED | changes))
    return load_family(str(folder / "mixed.yaml"))


def test_a_family_draws_the_numbers_of_robots_of_models(tmp_path):
    family, drawn = family_of(tmp_path, groups={"scout": [1, 3], "carrier": [2, 5]}), set()
    assert (family.robots, family.largest.robots.count, family.largest.rows) == ((3, 8), 8, 8)
    for index in range(40):
        scenario = family.scenario(0, index, "test")
        counts = tuple(group.count for group in scenario.mission.robots.groups)
        assert len(scenario.start.robots) == sum(counts) == (scenario.mission.models[: sum(counts)] >= 0).sum()
        assert scenario.mission.rows == 8
        drawn.add(counts)
    assert {carriers for carriers, _ in drawn} == {2, 3, 4, 5}
    assert {scouts for _, scouts in drawn} == {1, 2, 3}
    others = family_of(tmp_path, groups={"scout": [2, 2]}).scenario(0, 0, "test").mission.robots.groups
    assert [group.count for group in others] == [4, 2]


def test_an_environment_has_the_same_numbers_of_models_in_all_worlds(tmp_path):
    family = family_of(tmp_path, groups={"scout": [1, 3]})
    with pytest.raises(DocumentError, match=r"^family mixed: groups\.scout: expected one number .*, got 1 to 3$"):
        Batch(family=family)
    assert Batch(family=family_of(tmp_path, groups={"scout": [2, 2]})).worlds.robots == 6


def test_one_group_is_a_team_and_a_mapping_is_one_model():
    assert RobotConfig.model_validate([{"count": 5}]).models == (RobotModel(count=5),)
    assert [model.model for model in RobotConfig(count=7).models] == ["robot"]
    assert mission(robots={"count": 7}).model_dump()["robots"]["count"] == 7
