"""Arguments of Python: dictionaries, names and paths alike; others are refused in one line that names the key."""

import numpy as np
import pytest

from clean_swarm_env import Batch, ObservationConfig, clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv
from clean_swarm_env.config.starts import random_start
from selector.documents.find import SHIPPED
from tests.clean_swarm_env.courses import begun, mission


def test_dictionaries_are_taken_where_models_are():
    given = Batch(
        {"base": "table1", "task": {"garbage": {"count": 2}}},
        reward={"dumped": 2.0},
        observation={"terms": ["cargo"]},
        action={"mode": "velocity"},
    )
    assert given.mission == mission(garbage={"count": 2})
    assert given.rewards.weights["dumped"] == 2.0
    assert given.observer.names == ("carrying", "recycled")
    assert given.action.mode == "velocity"
    assert Batch({"task": {"garbage": {"count": 2}}}).mission.task.garbage.count == 2
    family = {"name": "mine", "description": "small", "mission": "table1", "items": [1, 1]}
    assert Batch(family=family).mission.task.garbage.count == 1


def test_names_strings_and_paths_are_taken_alike(tmp_path):
    path = SHIPPED / "missions" / "table1.yaml"
    assert Batch(path).mission == Batch(str(path)).mission == Batch("table1").mission
    (tmp_path / "knowledge").mkdir()
    text = (SHIPPED / "knowledge" / "avoidance.yaml").read_text(encoding="utf-8")
    (tmp_path / "knowledge" / "mine.yaml").write_text(text)
    shipped = Batch(knowledge="avoidance").options
    for directories in (tmp_path, str(tmp_path), [tmp_path], [str(tmp_path)]):
        assert Batch(knowledge="mine", directories=directories).options == shipped
    assert Batch(knowledge=tmp_path / "knowledge" / "mine.yaml").mission.knowledge.endswith("mine.yaml")
    assert Batch(family=SHIPPED / "families" / "table1-starts.yaml").robots == 5


WRONG = [
    ({"mission": {"base": "table1", "task": {"garbage": {"cuont": 2}}}}, "mission: task.garbage.cuont: unknown key"),
    ({"mission": 3}, "mission: expected a name, a path, a dictionary or a MissionConfig, got 3"),
    (
        {"mission": mission().model_copy(update={"time_limit": "x"})},
        "mission: time_limit: expected a valid number, got 'x'",
    ),
    ({"mission": mission().model_copy(update={"nonsense": 1})}, "mission: nonsense: unknown key 'nonsense'"),
    ({"reward": {"dumpt": 1.0}}, "reward: dumpt: unknown key 'dumpt'"),
    ({"reward": 3}, "reward: expected a dictionary or a RewardConfig, got 3"),
    ({"observation": ["cargo"]}, r"observation: expected a dictionary or a ObservationConfig, got \['cargo'\]"),
    (
        {"observation": ObservationConfig().model_copy(update={"terms": 3})},
        "observation: terms: expected a valid tuple",
    ),
    ({"action": {"mode": "fly"}}, "action: mode: expected 'option', 'velocity' or 'both', got 'fly'"),
    ({"split": "test"}, "split: expected with a family only, got 'test'"),
    ({"size": (6.0, 6.0)}, "size: expected with a family only"),
    ({"mission": "table1", "family": "table1"}, "family: expected a mission or a family, got both"),
    ({"worlds": 0}, "worlds: expected a whole number of at least 1, got 0"),
    ({"worlds": 1.5}, "worlds: expected a whole number of at least 1, got 1.5"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG, ids=[message[:40] for _, message in WRONG])
def test_wrong_arguments_are_refused_in_one_line_that_names_the_key(arguments, message):
    with pytest.raises((TypeError, ValueError), match=f"^{message}") as told:
        Batch(**arguments)
    assert "\n" not in str(told.value)


@pytest.fixture(scope="module")
def borders():
    return [clean_swarm_v0.parallel_env(), CleanSwarmTeam(), RobotVectorEnv(1)]


@pytest.mark.parametrize("seed", [1.5, True, -1, "1"])
def test_odd_seeds_are_refused_at_all_borders(borders, seed):
    for env in borders:
        with pytest.raises(ValueError, match=r"seeds?: expected .*, got"):
            env.reset(seed=seed)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ("x", TypeError, "options: expected a dictionary, got 'x'"),
        ({"strat": 1}, ValueError, "options: unknown key 'strat'"),
        ({"start": {"id": "1"}}, ValueError, r"options\['start'\]: robots: missing key"),
    ],
)
def test_odd_options_of_a_reset_are_refused_at_all_borders(borders, options, error, message):
    for env in borders:
        with pytest.raises(error, match=message):
            env.reset(options=options)
        env.reset(seed=1, options={"start": random_start(mission(), 3, 1).model_dump()})


def test_odd_actions_are_refused_at_all_borders(borders):
    for env in borders:
        env.reset(seed=1)
        for actions in (None, [0, 1], "x", {}):
            with pytest.raises((TypeError, ValueError), match=r"actions: expected .*") as told:
                env.step(actions)
            assert "\n" not in str(told.value)


def test_a_function_of_the_users_gives_the_rewards(tmp_path, monkeypatch):
    code = "def picked(batch):\n    return 10.0 * batch.progress.events[0]\n"
    (tmp_path / "my_rewards.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    for reward in (
        lambda batch: 10.0 * batch.progress.events[0],
        "my_rewards:picked",
        str(tmp_path / "my_rewards.py:picked"),
    ):
        batch = begun(Batch(reward=reward), [1])
        paid = sum(batch.step(np.full(5, 2)).rewards.sum() for _ in range(30))
        assert paid >= 10.0
        assert paid % 10.0 == 0.0
    for wrong in (lambda batch: 1.0, lambda batch: np.full(5, np.nan)):
        batch = begun(Batch(reward=wrong), [1])
        with pytest.raises(ValueError, match=r"expected finite numbers of shape \(5,\), got"):
            batch.step(np.zeros(5, dtype=np.int64))
    with pytest.raises(ValueError, match="reward: my_rewards defines no 'dropped'"):
        Batch(reward="my_rewards:dropped")
    with pytest.raises(ValueError, match="reward: no_such: No module named 'no_such'"):
        Batch(reward="no_such:dropped")


def test_a_term_of_the_users_is_named_by_its_module(tmp_path, monkeypatch):
    (tmp_path / "my_terms.py").write_text(
        "from clean_swarm_env import TERMS, Term\n\n@TERMS.register\nclass North(Term):\n    '''How far north.'''\n\n"
        "    name = 'north'\n    components = ('north',)\n\n    def write(self, rows, out):\n"
        "        around = self.observed.around.record\n"
        "        out[0, rows] = around.positions[rows, 1] / around.extent[1]\n"
    )
    monkeypatch.chdir(tmp_path)
    batch = Batch(observation={"terms": ["cargo", {"name": "my_terms:North", "weight": 2.0}]})
    assert batch.observer.names == ("carrying", "recycled", "north")
    assert batch.reset([1])[:, 2].min() > 0.0
