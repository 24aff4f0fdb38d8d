"""Configuration files: the shipped ones load, and each mistake is one line with file, key, expected and given."""

import math
from pathlib import Path

import pytest
from pydantic import BaseModel

from clean_swarm_env.config import mission as config
from clean_swarm_env.config.free_places import robots_that_fit
from clean_swarm_env.config.load import load_experiment, load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig, WorldConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.given import mission_from
from selector.documents.fields import Closed
from selector.documents.find import files_of
from tests.fields import descriptions

MODELS = [
    model
    for model in vars(config).values()
    if isinstance(model, type) and issubclass(model, Closed) and model is not Closed
]


@pytest.mark.parametrize("name", files_of("experiments"))
def test_every_shipped_experiment_loads(name):
    experiment = load_experiment(name)
    assert experiment.name == name
    assert experiment.description


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_every_field_says_what_it_is(model: type[BaseModel]):
    for name, description in descriptions(model).items():
        assert description.endswith("."), name
        field = model.model_fields[name]
        is_quantity = isinstance(field.default, float) and not isinstance(field.default, bool)
        is_rate = "per second" in description
        assert not is_quantity or "[" in description or is_rate, f"{name} states no unit"


@pytest.mark.parametrize(("radius", "expected"), [(0.25, (0.55, 1.0)), (0.1, (0.25, 0.7))])
def test_pairs_count_as_colliding_by_the_radius_of_the_robots(radius, expected):
    mission = mission_from({"base": "table1", "robots": {"radius": radius}})
    assert mission.counted_distances == pytest.approx(expected)


def test_the_reference_mission_is_the_one_of_the_robot_model():
    mission = load_mission("reference")
    assert mission.world.contacts == "pass_through"
    assert mission.counted_distances == (0.5, 1.0)
    assert mission.world.physics_steps_per_tick == 4
    assert (mission.robots.pose_goal_radius, mission.robots.pose_diffusion) == (0.5, 1.0)
    assert (mission.network.activation_threshold, mission.network.threshold_decay) == (7.0, 0.8)
    assert mission.robots.turn_in_place_beyond == pytest.approx(math.radians(60))


def test_the_published_table_has_the_published_means():
    reference = load_experiment("table1").reference
    assert reference is not None
    durations = {name: figures["duration_s"] for name, figures in reference.figures.items()}
    assert sum(durations["RepulsionFernandez-view2.0"]) / 5 == pytest.approx(846.72, abs=0.01)
    assert sum(durations["RepulsionGradient-view1.5"]) / 5 == pytest.approx(266.43, abs=0.01)


def _written(tmp_path: Path, mission: str = "", rest: str = "") -> str:
    path = tmp_path / "x.yaml"
    mission_line = f"mission: {{{mission}}}\n" if mission else ""
    path.write_text(f"name: x\nconditions: [{{name: a}}]\n{mission_line}{rest}\n", encoding="utf-8")
    return str(path)


MISTAKES = [
    ("world: {widht: 3}", "", "mission.world.widht: unknown key 'widht' (known: contacts, "),
    ("base: table1, world: {widht: 3}", "", "did you mean 'width'?"),
    ("robots: {radius: -1}", "", "mission.robots.radius: expected greater than or equal to 0.001, got -1"),
    (
        "robots: {count: 278}",
        "",
        "mission.robots.count: expected at most 277 solid robots of radius 0.25 m on 11 m x 11 m",
    ),
    ("robots: {radius: 2.0}", "", "mission.robots.count: expected at most 4 solid robots of radius 2 m"),
    ("robots: {radius: 2.76, count: 1}", "", "mission.robots.count: expected at most 0"),
    ("robots: {count: 5.5}", "", "mission.robots.count: expected a valid integer, got 5.5"),
    ("robots: {radius: true}", "", "mission.robots.radius: expected a valid number, got True"),
    ("world: {width: .inf}", "", "mission.world.width: expected a finite number, got inf"),
    ("task: {stations: {dump: [12, 3]}}", "", "mission.task.stations.dump: expected a point on the torus 11 m x 11 m"),
    ("task: {stations: {recycling: [1, -0.1]}}", "", "mission.task.stations.recycling: expected a point on the torus"),
    ("world: {width: 8}", "", "mission.task.stations.dump: expected a point on the torus 8 m x 11 m"),
    (
        "task: {stations: {further_dumps: [[1, 1], [1, 12]]}}",
        "",
        "mission.task.stations.further_dumps.1: expected a point on the torus",
    ),
    ("task: {stations: {dump: [12]}}", "", "mission.task.stations.dump.1: missing value"),
    ("garbage: {count: 3}", "", "mission.garbage: expected it below `task:`, as task.garbage, got garbage beside"),
    ("world: {control_rate: 3}", "", "mission.world.control_rate: expected a rate that divides physics_rate 20 Hz"),
    ("decision_period: 0.3", "", "mission.decision_period: expected a whole multiple of the control period 0.2 s"),
    ("collision_distances: [0]", "", "mission.collision_distances.0: expected greater than or equal to 0.001, got 0"),
    ("task: {patrol: {min_speed: 2}}", "", "mission.task.patrol.min_speed: expected a speed up to max_speed"),
    ("base: tabel1", "", "mission.base: unknown mission or task 'tabel1' (known: "),
    ("", "mision: table1", "mision: unknown key 'mision'"),
    ("", "starts: [{id: 1, robots: [[1, 2]], items: []}]", "starts.0.robots.0.2: missing value"),
    ("", "starts: nowhere", "starts: unknown set of start configurations 'nowhere' (known: table1"),
    ("", "name: y", "line 3: key 'name' twice"),
    ("", "conditions: []", "line 3: key 'conditions' twice"),
]


@pytest.mark.parametrize(("mission", "rest", "expected"), MISTAKES)
def test_a_mistake_is_one_line_with_file_and_key(tmp_path, mission, rest, expected):
    with pytest.raises(ConfigurationError) as caught:
        load_experiment(_written(tmp_path, mission, rest))
    message = str(caught.value)
    assert expected in message
    assert "x.yaml: " in message
    assert "\n" not in message


def test_conditions_with_one_name_are_refused(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("name: x\nconditions: [{name: a}, {name: a}]\n", encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"x\.yaml: conditions: expected unique names, got 'a' twice"):
        load_experiment(str(path))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("tabel1", r"unknown mission, family, experiment or task 'tabel1' .*table1, table1-reference.*mean 'table1'"),
        ("x/y.yaml", r"x/y\.yaml: no such file"),
    ],
)
def test_unknown_experiments_list_what_exists(name, message):
    with pytest.raises(ConfigurationError, match=message):
        load_experiment(name)


def test_a_given_directory_is_searched_before_the_shipped_one(tmp_path):
    (tmp_path / "missions").mkdir()
    (tmp_path / "missions" / "table1.yaml").write_text("name: mine\ntime_limit: 1e2\n", encoding="utf-8")
    assert load_mission("table1", [tmp_path]).name == "mine"
    assert load_mission("table1", [tmp_path]).time_limit == 100.0
    assert load_experiment("table1", [tmp_path]).mission.name == "mine"
    assert "table1-reference" in files_of("experiments", [tmp_path])


def test_changes_are_laid_over_mapping_by_mapping():
    base = {"a": {"b": 1, "c": 2}, "d": 3}
    assert with_changes(base, {"a": {"b": 5}, "d": {"e": 1}}) == {"a": {"b": 5, "c": 2}, "d": {"e": 1}}
    assert base == {"a": {"b": 1, "c": 2}, "d": 3}


def test_robots_that_pass_through_each_other_always_fit():
    world = WorldConfig(contacts="pass_through")
    robots = {"count": robots_that_fit(world, 0.25) + 1000}
    assert MissionConfig.model_validate({"world": world.model_dump(), "robots": robots}).robots.count > 1000
