"""The loop of scores: runs begin with what a knowledge store knows, and give back what they learned."""

import json
import shutil

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.learning.batch import Batch
from selector.knowledge import ENOUGH, Knowledge, Option, knowledge_from, load_knowledge
from selector.store import KnowledgeStore, RewardSums
from tests.train.commands import command, done, refused, runs

pytestmark = pytest.mark.usefixtures("undrawn")
NEAR, GRADIENT, FAR = "RepulsionFernandez-view0.5", "RepulsionGradient-view1.5", "RepulsionFernandez-view2.0"
WRONG = {
    "goals": {
        "AvoidCollision": [
            {"name": FAR, "score": 1.0},
            {"name": GRADIENT, "score": 0.5},
            {"name": NEAR, "score": 0.0},
        ]
    }
}
ROOMS = {
    "name": "rooms",
    "description": "Table 1 with fewer items, and scores that are wrong.",
    "mission": {"base": "table1", "knowledge": "wrong", "time_limit": 400.0},
    "items": [4, 4],
    "scenarios": 2,
}
EXPERIMENT = {
    "name": "chosen",
    "mission": {"knowledge": "wrong", "name": "hall"},
    "conditions": [
        {"name": "by score"},
        {"name": "forced", "scores": {"AvoidCollision": {GRADIENT: 9.0}}},
        {"name": "bandit", "strategy": "UCB1:exploration=0.05,prior=0"},
    ],
    "scenarios": 8,
}
UCB = ("--strategy", "UCB1:exploration=0.05,prior=0")


OWN = ("--configs", "my")
ONE = ("--workers", 1)


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in a directory with files of our own in `my`."""
    monkeypatch.chdir(tmp_path)
    for kind, name, content in (
        ("knowledge", "wrong", WRONG), ("families", "rooms", ROOMS), ("experiments", "chosen", EXPERIMENT)
    ):  # fmt: skip
        (tmp_path / "my" / kind).mkdir(parents=True)
        (tmp_path / "my" / kind / f"{name}.yaml").write_text(yaml.safe_dump(content))


LEARN = ("evaluate", "rooms", *OWN, "--learn")


def learn(*words, store="s.sqlite", strategy=UCB):
    return done(*LEARN, "--store", store, *strategy, *words)


def taken(directory):
    """The option of AvoidCollision in each mission of an evaluation that learned."""
    lines = map(json.loads, (directory / "choices.jsonl").read_text().splitlines())
    return [one["options"]["AvoidCollision"] for one in lines]


def figures(directory):
    return [{name: cell for name, cell in row.items() if name != "condition"} for row in runs(directory)]


def held(path="s.sqlite", context="mission rooms"):
    """Option -> count and mean of what a store holds in a context."""
    store = KnowledgeStore(str(path), create=False)
    contents = store.contents()
    learned = contents.scores(contents.knowledge(str(path)), context).get("AvoidCollision", {})
    return {name: (one.count, one.mean) for name, one in learned.items()}


def tell(path, rewards, context="mission rooms"):
    """Give a store rewards of the options of WRONG: option -> rewards."""
    store, known = KnowledgeStore(str(path)), knowledge_from(WRONG)
    store.introduce(known)
    sums = RewardSums("AvoidCollision", list(rewards))
    for k, some in enumerate(rewards.values()):
        sums.record(np.full(len(some), k), np.array(some, dtype=float))
    store.add(sums, source="told", context=context)


def test_wrong_scores_are_put_right_by_missions_and_a_later_process_profits_at_once(tmp_path):
    learn("--scenarios", 12, "--output", "first")
    first = taken(tmp_path / "first")
    assert first[:3] == [FAR, GRADIENT, NEAR]  # as the expert ranks them
    assert first[-5:].count(NEAR) >= 4
    assert {name: count for name, (count, _) in held().items()} == {name: first.count(name) for name in set(first)}
    words = ("evaluate", "rooms", *OWN, *ONE, "--strategy", "MaxScore", "--scenarios", 2, "--seed", 5)
    others = ("--strategy", f"fixed:{NEAR}", "--strategy", f"fixed:{FAR}")
    done(*words, *others, "--store", "s.sqlite", "--output", "later")
    rows = figures(tmp_path / "later")
    by_score, near, far = rows[0::4], rows[2::4], rows[3::4]
    assert by_score == near != far
    done(*words, "--output", "expert")
    assert figures(tmp_path / "expert")[0::2] == far
    learn("--scenarios", 2, "--seed", 5, "--output", "second")
    assert taken(tmp_path / "second") == [NEAR, NEAR]


def test_a_run_depends_on_what_the_store_knew_at_its_beginning_and_its_manifest_says_it(tmp_path):
    tell("s.sqlite", {FAR: [0.5, 0.6], NEAR: [0.8]})
    for name in ("a", "b"):
        shutil.copy("s.sqlite", f"{name}.sqlite")
        learn("--scenarios", 3, "--output", name, store=f"{name}.sqlite")
    assert figures(tmp_path / "a") == figures(tmp_path / "b")
    assert (tmp_path / "a/choices.jsonl").read_bytes() == (tmp_path / "b/choices.jsonl").read_bytes()
    known = json.loads((tmp_path / "a/manifest.json").read_text())["learned"]["AvoidCollision"]
    assert {name: one["count"] for name, one in known.items()} == {FAR: 2, NEAR: 1}
    assert known[FAR]["mean"] == pytest.approx(0.55, abs=1e-7)
    assert taken(tmp_path / "a")[0] == GRADIENT  # the only one that nobody had tried
    told = json.loads(done("explain", "a", "--robot", 0, "--time", 1, "--scenario", "test-1", "--json"))
    assert told["options"] == {"AvoidCollision": GRADIENT}


def test_a_run_that_is_continued_begins_with_what_was_known_then_and_nothing_counts_twice(tmp_path):
    learn("--scenarios", 5, "--output", "whole", store="whole.sqlite")
    learn("--scenarios", 3, "--output", "cut")
    tell("s.sqlite", {FAR: [1.0] * 50})  # another process goes on meanwhile
    learn("--scenarios", 5, "--output", "cut", "--resume")
    assert figures(tmp_path / "cut") == figures(tmp_path / "whole")
    assert taken(tmp_path / "cut") == taken(tmp_path / "whole")
    both, whole = held(), held("whole.sqlite")
    assert both[FAR][0] == whole[FAR][0] + 50
    assert {name: both[name] for name in (GRADIENT, NEAR)} == {name: whole[name] for name in (GRADIENT, NEAR)}
    learn("--scenarios", 5, "--output", "cut", "--resume")
    assert held() == both


def test_scores_that_a_store_did_not_get_are_given_when_the_run_goes_on():
    learn("--scenarios", 1, "--output", "r")
    shutil.copy("s.sqlite", "before.sqlite")
    learn("--scenarios", 3, "--output", "r", "--resume")
    whole = held()
    shutil.copy("before.sqlite", "s.sqlite")  # as if the disk had been full, or the command killed
    for _ in range(2):
        learn("--scenarios", 3, "--output", "r", "--resume")
        assert held() == whole


def test_the_same_missions_are_not_learned_again_and_results_that_learned_go_on_learning(tmp_path):
    learn("--scenarios", 1, "--output", "a")
    before = held()
    assert refused(*LEARN, *UCB, "--scenarios", 1, "--store", "s.sqlite").startswith(
        "error: s.sqlite: holds what 'family rooms, AvoidCollision, seed 0' learned already; take another --seed"
    )
    words = ("evaluate", "rooms", *OWN, *UCB, "--scenarios", 2, "--output", "a", "--resume")
    code, _, err = command(*words)
    assert code == 2
    assert "has other results: learns: expected None, got True" in err
    learn("--scenarios", 1, "--seed", 1, "--output", "b", strategy=(*UCB, "--strategy", "fixed"))
    after = held()  # the bandit's mission is one of those of the fixed options
    assert sum(count for count, _ in after.values()) == sum(count for count, _ in before.values()) + 3


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("evaluate ROOMS --learn", "--learn: expected --store FILE"),
        ("evaluate ROOMS --store none.sqlite", "none.sqlite: no such knowledge store"),
        ("evaluate ROOMS --store s.sqlite --learn --workers 2", "--workers: expected 1 with --learn"),
        (
            "evaluate ROOMS --store s --learn --strategy fsm:rule --knowledge avoidance",
            "--learn: fsm:rule: expected a strategy that chooses",
        ),
        (
            "evaluate ROOMS --store other.sqlite --learn",
            "wrong.yaml: goals.AvoidCollision.RepulsionGradient-view1.5: means",
        ),
        ("evaluate ROOMS --store other.sqlite", "wrong.yaml: goals.AvoidCollision.RepulsionGradient-view1.5: means"),
    ],
)
def test_mistakes_are_one_line_and_nothing_is_written(tmp_path, words, line):
    other = KnowledgeStore("other.sqlite")
    far = Option(name=GRADIENT, configuration="RepulsionGradient", score=1.0, parameters={"view_distance": 9.0})
    other.introduce(Knowledge({"AvoidCollision": (far,)}))
    given = words.replace("ROOMS", "rooms --knowledge wrong").split()
    assert line in refused(*given, *OWN, "--output", "none")
    assert not (tmp_path / "none").exists()


def test_an_experiment_begins_with_the_store_but_for_the_scores_of_its_conditions(fake_missions, tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, GRADIENT: [0.2] * ENOUGH, NEAR: [0.9] * ENOUGH}, "mission hall")
    words = ("evaluate", "chosen", *OWN, *ONE, "--store", "s.sqlite")
    out = done(*words, "--condition", "by score", "--output", "only", "--all")
    assert "known at the beginning in the context 'mission hall'" in out
    assert "0.9000 [0.9000, 0.9000]" in (tmp_path / "only/table.md").read_text()
    assert "--learn: expected with strategies" in refused(*words, "--learn", "--output", "none")
    assert not (tmp_path / "none").exists()


def test_scores_of_a_family_are_those_of_its_fixed_options(tmp_path):
    out = learn("--scenarios", 2, "--output", "r", strategy=("--strategy", "fixed"))
    cost = {}
    for row in runs(tmp_path / "r"):
        cost.setdefault(row["condition"].removeprefix("fixed:"), []).append(float(row["cost_s"]))
    assert set(cost) == {NEAR, GRADIENT, FAR}
    for name, (count, mean) in held().items():
        assert (count, mean) == (2, pytest.approx(1.0 - np.mean(cost[name]) / 400.0, abs=1e-6))
    assert "known now in the context 'mission rooms'" in out


def test_scores_of_a_goal_decide_what_serves_it(tmp_path):
    scored = ("--strategy", "fixed", "--store", "s.sqlite", "--learn", "--scenarios", ENOUGH)
    done("evaluate", "ReachGoal", *scored)
    words = ("evaluate", "ReachGoal", "--strategy", "MaxScore", *ONE, "--scenarios", 1, "--all")
    out = done(*words, "--store", "s.sqlite", "--output", "after")
    (taken,) = [line for line in out.splitlines() if line.split()[-1:] == ["taken"]]
    assert taken.split()[:3] == ["ReachGoal", "-", "ChemotaxisGe"]
    known = json.loads((tmp_path / "after" / "manifest.json").read_text())["learned"]["ReachGoal"]
    assert {one["count"] for one in known.values()} == {ENOUGH}


def test_learned_scores_become_expert_knowledge_that_a_mission_names(tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, GRADIENT: [0.2], NEAR: [0.7, 0.9] * ENOUGH})
    words = ("knowledge", "export", "my/knowledge/learned.yaml", "--store", "s.sqlite")
    assert "unknown context 'mission hut' (known: mission rooms" in refused(*words, "--context", "mission hut")
    done(*words, "--context", "mission rooms")
    written = load_knowledge("learned", [tmp_path / "my"])
    assert written.scores("AvoidCollision").tolist() == pytest.approx([0.1, 0.2, 0.8], abs=1e-6)
    assert written.rewards("AvoidCollision")[0].tolist() == [ENOUGH, 1, 2 * ENOUGH]
    (tmp_path / "my" / "missions").mkdir()
    (tmp_path / "my" / "missions" / "hut.yaml").write_text(yaml.safe_dump({"knowledge": "learned"}))
    batch = Batch(load_mission("hut", [tmp_path / "my"]), directories=(tmp_path / "my",))
    model = batch.worlds.coordinators[0].model
    assert model.options[int(batch.choices.default[0])] == NEAR
    assert model.problem.rewards[0].tolist() == [ENOUGH, 1, 2 * ENOUGH]


def test_a_mission_names_its_store(tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, NEAR: [0.9] * ENOUGH}, "mission hut")
    (tmp_path / "my" / "missions").mkdir()
    content = {"name": "hut", "knowledge": "wrong", "store": "s.sqlite"}
    (tmp_path / "my" / "missions" / "hut.yaml").write_text(yaml.safe_dump(content))
    batch = Batch(load_mission("hut", [tmp_path / "my"]), directories=(tmp_path / "my",))
    assert batch.options["AvoidCollision"][int(batch.choices.default[0])] == NEAR
    shutil.copy("my/families/rooms.yaml", "my/families/hut.yaml")
    family = ROOMS | {"name": "hut", "mission": {"base": "hut", "time_limit": 400.0}}
    (tmp_path / "my/families/hut.yaml").write_text(yaml.safe_dump(family))
    words = ("evaluate", "hut", "--strategy", "MaxScore", "--strategy", f"fixed:{NEAR}", "--scenarios", 1)
    done(*words, *OWN, *ONE, "--output", "r")
    by_score, _, near = figures(tmp_path / "r")
    assert by_score == near
    assert json.loads((tmp_path / "r/manifest.json").read_text())["learned"]["AvoidCollision"][NEAR]["count"] == ENOUGH
