"""Start configurations: uniform, apart, and the same for a seed, independent of other draws."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clean_swarm_env.config.frames import frame_of
from clean_swarm_env.config.load import load_experiment, load_mission, random_starts
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import distances, draw_places, for_start, random_start, run_seed
from clean_swarm_env.config.tasks import item_rows
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch, mission_begun
from clean_swarm_env.tasks import TASKS, ItemsConfig, Task, TaskSettings, TaskState
from clean_swarm_env.tasks.cleaning.missions import CleaningStarts
from clean_swarm_env.tasks.foraging import Foraging
from selector.documents.errors import shown


def _mission(count: int = 5, contacts: str = "solid", items: int = 10, **world: float) -> MissionConfig:
    return MissionConfig.model_validate(
        {
            "world": {"contacts": contacts, **world},
            "robots": {"count": count},
            "task": {"garbage": {"count": items}, "stations": {"recycling": [0, 0], "dump": [1, 1]}},
        }
    )


@settings(max_examples=30)
@given(seed=st.integers(0, 2**63), count=st.integers(1, 40), width=st.floats(8, 20), height=st.floats(8, 20))
def test_random_starts_lie_on_the_torus_and_solid_robots_apart(seed, count, width, height):
    mission = _mission(count, width=width, height=height)
    start = random_start(mission, seed, 3)
    assert for_start(mission, start) == mission
    robots, items = np.array(start.robots), np.array(start.items)
    assert robots.shape == (count, 3)
    assert items.shape == (10, 2)
    for i in range(count):
        for j in range(i):  # naive minimum image, apart from the code under test
            dx, dy = robots[i, :2] - robots[j, :2]
            images = [np.hypot(dx + a * width, dy + b * height) for a in (-1, 0, 1) for b in (-1, 0, 1)]
            assert min(images) >= 0.5
    assert np.all(np.abs(robots[:, 2]) <= np.pi)


def test_items_lie_evenly_about_spots_across_the_seam_too():
    size, spots = np.array([7.0, 11.0]), np.array([[0.2, 10.9], [4.0, 5.0]])
    task = {"garbage": {"spot_radius": 2.0}, "stations": {"recycling": [0, 0], "dump": [1, 1]}}
    about = {"world": {"width": 7.0, "height": 11.0}, "task": task}
    mission = MissionConfig.model_validate(about)
    drawn = draw_places(4000, np.random.default_rng(4), mission, spots.tolist())
    assert drawn.min() >= 0.0
    assert (drawn < size).all()
    offsets = np.abs(drawn[:, None] - spots)
    distances = np.hypot(*np.moveaxis(np.minimum(offsets, size - offsets), 2, 0))  # (M, S)
    near = distances.min(axis=1)
    assert near.max() <= 2.0
    assert np.mean(distances.argmin(axis=1) == 0) == pytest.approx(0.5, abs=0.03)
    assert np.mean(near < np.sqrt(2.0)) == pytest.approx(0.5, abs=0.03)  # half of the disc holds half of the items
    assert np.ptp(draw_places(50, np.random.default_rng(1), mission, [(3.0, 3.0)]), axis=0).max() <= 4.0


def test_random_starts_are_uniform():
    starts = [random_start(_mission(), 11, k) for k in range(400)]
    robots = np.concatenate([np.array(start.robots) for start in starts])
    items = np.concatenate([np.array(start.items) for start in starts])
    for values, low, high in (
        *((robots[:, c], 0, 11) for c in (0, 1)),
        (robots[:, 2], -np.pi, np.pi),
        (items[:, 0], 0, 11),
    ):
        share = np.histogram(values, bins=4, range=(low, high))[0] / len(values)
        assert share == pytest.approx([0.25] * 4, abs=5 * np.sqrt(0.25 * 0.75 / len(values)))


def test_a_scenario_does_not_depend_on_the_others_and_its_items_not_on_the_robots():
    alone = random_start(_mission(), 5, 7)
    among = [random_start(_mission(), 5, k) for k in range(9)]
    assert among[7] == alone
    assert len({start.robots for start in among}) == 9
    assert random_start(_mission(), 6, 7).robots != alone.robots
    assert random_start(_mission(9), 5, 7).items == alone.items


def test_the_limit_of_solid_robots_can_be_placed_and_the_ones_that_pass_through_anyhow():
    assert len(random_start(_mission(277), 0, 0).robots) == 277
    assert len(random_start(_mission(2000, contacts="pass_through"), 0, 0).robots) == 2000


def test_a_placement_that_cannot_succeed_ends_with_an_error(monkeypatch):
    monkeypatch.setattr("clean_swarm_env.config.starts.START_TRIES", 20)
    crowded = _mission().model_copy(update={"robots": _mission().robots.model_copy(update={"count": 500})})
    with pytest.raises(ConfigurationError, match=r"robots\.count: expected room for 500 solid robots 0\.01 m apart"):
        random_start(crowded, 0, 0)


def test_run_seeds_depend_on_seed_and_scenario_only():
    assert run_seed(3, "101") == run_seed(3, "101")
    assert len({run_seed(seed, str(k)) for seed in range(20) for k in range(20)}) == 400


def test_the_start_configurations_of_table_1_are_the_documented_draw():
    starts = load_experiment("table1").starts
    assert [start.id for start in starts] == ["1", "2", "3", "4", "5"]
    for k, start in enumerate(starts):
        drawn = random_start(load_mission("table1"), 2017, k)
        assert np.array(start.robots) == pytest.approx(np.array(drawn.robots), abs=5.1e-4)
        assert np.array(start.items) == pytest.approx(np.array(drawn.items), abs=5.1e-4)


CASE = {
    "id": 101,
    "robots": [[1.0, 1.0, 0.5], [3.0, 1.0, -0.5]],
    "items": [[5.0, 5.0]],
    "measured": {"a": {"duration_s": 3.5}},
}
FILE = {"torus_m": [10, 12], "recycling": [1, 2], "dump": [3, 4], "cases": [CASE]}


def _file(tmp_path, content: object):
    path = tmp_path / "starts.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def test_a_file_of_starts_brings_its_world_and_counts(tmp_path):
    starts = CleaningStarts.read(_file(tmp_path, FILE))
    mission = starts.world_of(MissionConfig())
    assert (mission.world.width, mission.world.height) == (10.0, 12.0)
    assert (mission.task.stations.recycling, mission.task.stations.dump) == ((1.0, 2.0), (3.0, 4.0))
    mission = for_start(mission, starts.starts[0])
    assert (mission.robots.count, mission.task.garbage.count) == (2, 1)
    assert starts.starts[0] == StartConfiguration(id="101", robots=((1, 1, 0.5), (3, 1, -0.5)), items=((5, 5),))
    assert starts.measured == {"101": {"a": {"duration_s": 3.5}}}


def test_a_file_of_starts_says_where_robots_of_another_task_begin(tmp_path):
    starts = Foraging.Starts.read(_file(tmp_path, {"torus_m": [24, 26], "cases": [CASE | {"items": []}]}))
    mission = for_start(starts.world_of(load_mission("Foraging")), starts.starts[0])
    worlds = mission_begun(mission, starts.starts[0], 3).worlds
    assert worlds.extent.tolist() == [24.0, 26.0]
    assert worlds.physics.positions.tolist() == [[1.0, 1.0], [3.0, 1.0]]


def test_measured_figures_and_further_keys_are_optional(tmp_path):
    case = {key: value for key, value in CASE.items() if key != "measured"} | {"note": "mine"}
    starts = CleaningStarts.read(_file(tmp_path, FILE | {"cases": [case], "source": "elsewhere"}))
    assert starts.measured == {"101": {}}


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("{", "expected JSON"),
        ("[]", "expected a mapping of keys, got list"),
        ({"torus_m": [1, 1]}, "missing key"),
        (FILE | {"cases": []}, "cases: expected at least 1 item"),
        (FILE | {"torus_m": [0, 1]}, "torus_m.0: expected greater than 0, got 0"),
        (FILE | {"cases": [CASE | {"robots": [[1, 2]]}]}, "cases.0.robots.0.2: missing value"),
        (FILE | {"cases": [CASE | {"items": [[1, "x"]]}]}, "cases.0.items.0.1: expected a valid number, got 'x'"),
        (FILE | {"cases": [CASE, CASE]}, "cases: expected unique ids, got '101' twice"),
    ],
)
def test_a_malformed_file_of_starts_is_one_line(tmp_path, content, expected):
    path = _file(tmp_path, content)
    with pytest.raises(ConfigurationError) as caught:
        CleaningStarts.read(path)
    assert expected in str(caught.value)
    assert str(caught.value).startswith(f"{shown(path)}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("robots", "items", "expected"),
    [
        ([[1, 1, 0], [11.5, 1, 0]], [[1, 1]], r"scenario 7: robots\.1: expected a point on the torus 11 m x 11 m, got"),
        ([[1, 1, 0]], [[1, -1]], r"scenario 7: items\.0: expected a point on the torus"),
        (
            [[0.1, 5, 0], [10.9, 5, 0]],
            [],
            r"scenario 7: robots\.1: expected solid robots at least 0\.5 m apart, got 0\.2 m",
        ),
    ],
)
def test_a_start_that_does_not_fit_the_mission_is_refused(robots, items, expected):
    start = StartConfiguration.model_validate({"id": 7, "robots": robots, "items": items})
    with pytest.raises(ConfigurationError, match=expected):
        for_start(MissionConfig(), start)


def test_robots_that_pass_through_may_start_on_each_other():
    start = StartConfiguration.model_validate({"id": 7, "robots": [[1, 1, 0], [1, 1, 0]], "items": []})
    assert for_start(load_mission("reference"), start).robots.count == 2


def test_distances_cross_the_seam():
    size = np.array([11.0, 11.0])
    others = np.array([[5.0, 5.0], [10.9, 10.9]])
    assert distances(np.array([0.1, 0.1]), others, size).min() == pytest.approx(0.2 * np.sqrt(2))
    assert distances(np.array([0.1, 0.1]), others[:0], size).shape == (0,)


class Stacking(TaskSettings):
    """A task with boxes."""

    boxes: ItemsConfig = ItemsConfig(count=3, respawn=2.0)


class Stack(Task[Stacking, TaskState]):
    """Robots are where starts have them, beside boxes."""

    name, priced, goal = "Stack", True, "CollectiveExploration"

    def place(self, start):
        self.boxes = start.items

    def result(self):
        return {}

    def cost(self, world, values):
        return 0.0


def test_a_setting_declares_the_items_of_starts_families_and_batches(monkeypatch):
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    TASKS.register(Stack)
    family = random_starts(load_mission("Stack"))
    assert (family.items, family.respawn, item_rows(family.mission)) == ((3, 3), (2.0, 2.0), 40)
    scenario = family.scenario(1, 0, "test")
    batch = Batch(family=family, split="test")
    batch.reset([1])
    assert batch.worlds.task.boxes.tolist() == [list(place) for place in scenario.start.items] != []
    fewer = for_start(family.mission, scenario.start.model_copy(update={"items": ((1.0, 1.0),)}))
    assert (fewer.task.boxes.count, frame_of(fewer)) == (1, frame_of(family.mission))
