"""The loop of scores: runs begin with what a knowledge store knows, and give back what they learned."""

import csv
import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.learning.batch import Batch
from selector.knowledge import ENOUGH, knowledge_from, load_knowledge
from selector.store import KnowledgeStore, RewardSums
from tests.paths import ROOT
from tests.train.commands import told
from train.evaluation import pipeline
from train.running import needs

NEAR, GRADIENT, FAR = "RepulsionFernandez-view0.5", "RepulsionGradient", "RepulsionFernandez"
WRONG = {
    "goals": {
        "AvoidCollision": [
            {"configuration": FAR, "score": 1.0, "parameters": {"view_distance": 2.0}},
            {"configuration": GRADIENT, "score": 0.5, "parameters": {"view_distance": 1.5}},
            {"name": NEAR, "configuration": FAR, "score": 0.0, "parameters": {"view_distance": 0.5}},
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
        {"name": "bandit", "strategy": {"name": "UCB1", "parameters": {"exploration": 0.05, "prior": 0.0}}},
    ],
    "scenarios": 8,
}
UCB = ("--strategy", "UCB1:exploration=0.05,prior=0")


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run the command line in a directory of its own: code, output, errors."""
    monkeypatch.chdir(tmp_path)
    for kind, name, content in (
        ("knowledge", "wrong", WRONG), ("families", "rooms", ROOMS), ("experiments", "chosen", EXPERIMENT)
    ):  # fmt: skip
        (tmp_path / "my" / kind).mkdir(parents=True)
        (tmp_path / "my" / kind / f"{name}.yaml").write_text(yaml.safe_dump(content))

    def call(*words, configs=True):
        own = ["--configs", "my"] if configs else []
        return told(capsys, *words, *own)

    return call


def test_force_scores_what_the_machine_is_too_small_for(run, monkeypatch):
    monkeypatch.setattr(needs, "LONGEST", 0.0)
    code, _, err = run("study", "score", "rooms", "--store", "s.sqlite")
    assert code == 2
    assert "--force starts them anyway" in err
    monkeypatch.setattr(pipeline, "evaluate", lambda evaluation, console: asked.append(evaluation) or 0)
    asked = []
    assert run("study", "score", "rooms", "--store", "s.sqlite", "--force")[0] == 0
    assert all("--force" in evaluation.request.words for evaluation in asked)
    assert asked


def learn(run, *words, store="s.sqlite", strategy=UCB):
    code, out, err = run("evaluate", "--family", "rooms", "--store", store, "--learn", *strategy, *words)
    assert code == 0, err
    return out


def taken(directory, condition=None):
    """The option of AvoidCollision in each mission of an evaluation that learned."""
    lines = map(json.loads, (directory / "choices.jsonl").read_text().splitlines())
    return [one["options"]["AvoidCollision"] for one in lines if condition in (None, one["condition"])]


def figures(directory):
    with (directory / "runs.csv").open(newline="") as file:
        return [{k: v for k, v in row.items() if k not in ("wall_s", "condition")} for row in csv.DictReader(file)]


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


def test_wrong_scores_are_put_right_by_missions_and_a_later_process_profits_at_once(run, tmp_path):
    learn(run, "--scenarios", 12, "--output", "first")
    first = taken(tmp_path / "first")
    assert first[:3] == [FAR, GRADIENT, NEAR]  # as the expert ranks them
    assert first[-5:].count(NEAR) >= 4
    assert {name: count for name, (count, _) in held().items()} == {name: first.count(name) for name in set(first)}
    code, _, err = run(
        "evaluate", "--family", "rooms", "--strategy", "MaxScore", "--strategy", f"fixed:{NEAR}",
        "--strategy", f"fixed:{FAR}", "--store", "s.sqlite", "--scenarios", 2, "--seed", 5, "--output", "later",
    )  # fmt: skip
    assert code == 0, err
    rows = figures(tmp_path / "later")
    by_score, far, near = rows[0::4], rows[2::4], rows[3::4]
    assert by_score == near != far
    assert run("evaluate", "--family", "rooms", "--strategy", "MaxScore", "--scenarios", 2, "--seed", 5,
               "--output", "expert")[0] == 0  # fmt: skip
    assert figures(tmp_path / "expert")[0::2] == far
    learn(run, "--scenarios", 2, "--seed", 5, "--output", "second")
    assert taken(tmp_path / "second") == [NEAR, NEAR]


def test_a_run_depends_on_what_the_store_knew_at_its_beginning_and_its_manifest_says_it(run, tmp_path):
    tell("s.sqlite", {FAR: [0.5, 0.6], NEAR: [0.8]})
    for name in ("a", "b"):
        shutil.copy("s.sqlite", f"{name}.sqlite")
        learn(run, "--scenarios", 3, "--output", name, store=f"{name}.sqlite")
    assert figures(tmp_path / "a") == figures(tmp_path / "b")
    assert (tmp_path / "a/choices.jsonl").read_bytes() == (tmp_path / "b/choices.jsonl").read_bytes()
    known = json.loads((tmp_path / "a/manifest.json").read_text())["learned"]["AvoidCollision"]
    assert {name: one["count"] for name, one in known.items()} == {FAR: 2, NEAR: 1}
    assert known[FAR]["mean"] == pytest.approx(0.55, abs=1e-7)
    assert taken(tmp_path / "a")[0] == GRADIENT  # the only one that nobody had tried


def test_a_run_that_is_continued_begins_with_what_was_known_then_and_nothing_counts_twice(run, tmp_path):
    learn(run, "--scenarios", 5, "--output", "whole", store="whole.sqlite")
    learn(run, "--scenarios", 3, "--output", "cut")
    tell("s.sqlite", {FAR: [1.0] * 50})  # another process goes on meanwhile
    learn(run, "--scenarios", 5, "--output", "cut", "--resume")
    assert figures(tmp_path / "cut") == figures(tmp_path / "whole")
    assert taken(tmp_path / "cut") == taken(tmp_path / "whole")
    both, whole = held(), held("whole.sqlite")
    assert both[FAR][0] == whole[FAR][0] + 50
    assert {name: both[name] for name in (GRADIENT, NEAR)} == {name: whole[name] for name in (GRADIENT, NEAR)}
    learn(run, "--scenarios", 5, "--output", "cut", "--resume")
    assert held() == both


def test_scores_that_a_store_did_not_get_are_given_when_the_run_goes_on(run):
    learn(run, "--scenarios", 1, "--output", "r")
    shutil.copy("s.sqlite", "before.sqlite")
    learn(run, "--scenarios", 3, "--output", "r", "--resume")
    whole = held()
    shutil.copy("before.sqlite", "s.sqlite")  # as if the disk had been full, or the command killed
    for _ in range(2):
        learn(run, "--scenarios", 3, "--output", "r", "--resume")
        assert held() == whole


def test_the_same_missions_are_not_learned_again(run, tmp_path):
    learn(run, "--scenarios", 1, "--output", "a")
    before = held()
    code, _, err = run("evaluate", "--family", "rooms", "--store", "s.sqlite", "--learn", *UCB, "--scenarios", 1)
    assert code == 2
    assert err.startswith(
        "error: s.sqlite: holds what 'family rooms, AvoidCollision, seed 0' learned already; take another --seed"
    )
    learn(run, "--scenarios", 1, "--seed", 1, "--output", "b", strategy=(*UCB, "--strategy", "fixed"))
    after = held()  # the bandit's mission is one of those of the fixed options
    assert sum(count for count, _ in after.values()) == sum(count for count, _ in before.values()) + 3


def test_processes_that_learn_at_once_lose_nothing(run, tmp_path):
    words = ["evaluate", "--family", "rooms", "--configs", "my", "--store", "s.sqlite", "--learn", *UCB]
    program = "from train.cli import main; main()"
    both = [
        subprocess.Popen(
            [sys.executable, "-c", program, *words, "--scenarios", "3", "--seed", str(seed), "--output", f"p{seed}"],
            env=os.environ | {"PYTHONPATH": str(ROOT)}, cwd=tmp_path, stdout=subprocess.DEVNULL,
        )
        for seed in (1, 2)
    ]  # fmt: skip
    assert [process.wait(timeout=300) for process in both] == [0, 0]
    scores = [
        (one["options"]["AvoidCollision"], one["score"])
        for seed in (1, 2)
        for one in map(json.loads, (tmp_path / f"p{seed}" / "choices.jsonl").read_text().splitlines())
    ]
    for name, (count, mean) in held().items():
        own = [score for option, score in scores if option == name]
        assert (count, mean) == (len(own), pytest.approx(np.mean(own), abs=1e-7))
    assert sum(count for count, _ in held().values()) == 6


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--learn",), "--learn: expected --store FILE"),
        (("--store", "none.sqlite"), "none.sqlite: no such knowledge store"),
        (("--store", "s.sqlite", "--learn", "--workers", 2), "--workers: expected 1 with --learn"),
        (
            ("--store", "s", "--learn", "--strategy", "fsm:rule", "--knowledge", "avoidance"),
            "--learn: fsm:rule: expected a strategy that chooses",
        ),
        (("--store", "other.sqlite", "--learn"), "wrong.yaml: goals.AvoidCollision.RepulsionGradient: means"),
        (("--store", "other.sqlite"), "wrong.yaml: goals.AvoidCollision.RepulsionGradient: means"),
    ],
)
def test_mistakes_are_one_line_and_nothing_is_written(run, tmp_path, words, line):
    other = KnowledgeStore("other.sqlite")
    options = {"AvoidCollision": [{"configuration": GRADIENT, "score": 1.0, "parameters": {"view_distance": 9.0}}]}
    other.introduce(knowledge_from({"goals": options}))
    code, _, err = run("evaluate", "--family", "rooms", "--knowledge", "wrong", *words, "--output", "none")
    assert code == 2
    assert line in err
    assert len(err.strip().splitlines()) == 1
    assert not (tmp_path / "none").exists()


def test_an_experiment_begins_with_the_store_but_for_the_scores_of_its_conditions(run, fake_missions, tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, GRADIENT: [0.2] * ENOUGH, NEAR: [0.9] * ENOUGH}, "mission hall")
    words = ("evaluate", "chosen", "--workers", 1, "--store", "s.sqlite")
    code, out, _ = run(*words, "--condition", "by score", "--output", "only", "--all")
    assert code == 0
    assert "known at the beginning in the context 'mission hall'" in out
    assert "0.9000 [0.9000, 0.9000]" in (tmp_path / "only/table.md").read_text()
    assert run(*words, "--learn", "--output", "r")[0] == 0
    assert set(taken(tmp_path / "r", "by score")) == {NEAR}
    assert set(taken(tmp_path / "r", "forced")) == {GRADIENT}


def test_a_bandit_of_an_experiment_learns_and_its_missions_can_be_repeated(run, fake_missions, tmp_path):
    assert run("evaluate", "chosen", "--workers", 1, "--store", "s.sqlite", "--learn", "--output", "r")[0] == 0
    assert taken(tmp_path / "r", "bandit")[:3] == [FAR, GRADIENT, NEAR]
    for scenario, option in (("1", FAR), ("3", NEAR)):
        words = ("--robot", 0, "--time", 1, "--scenario", scenario, "--condition", "bandit", "--json")
        code, out, err = run("explain", "r", *words, configs=False)
        assert code == 0, err
        assert json.loads(out)["options"] == {"AvoidCollision": option}


def test_scores_of_a_family_are_determined_with_counts_and_spreads(run, tmp_path):
    words = ("study", "score", "rooms", "--store", "s.sqlite", "--scenarios", 2, "--workers", 1)
    code, out, err = run(*words, "--output", "r")
    assert code == 0, err
    cost = {}
    with (tmp_path / "r" / "runs.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            cost.setdefault(row["condition"].removeprefix("fixed:"), []).append(float(row["cost_s"]))
    assert set(cost) == {NEAR, GRADIENT, FAR}
    for name, (count, mean) in held().items():
        assert (count, mean) == (2, pytest.approx(1.0 - np.mean(cost[name]) / 400.0, abs=1e-6))
    assert "known now in the context 'mission rooms'" in out
    code, _, err = run(*words, "--output", "again")
    assert code == 2
    assert "holds what 'family rooms, AvoidCollision, seed 0' learned already" in err
    before = held()
    assert run(*words, "--output", "r", "--resume")[0] == 0
    assert held() == before


def test_every_goal_of_a_family_is_scored(run, tmp_path):
    two = ROOMS | {"name": "two", "mission": {"base": "cleaning-patrol", "time_limit": 5.0}}
    (tmp_path / "my/families/two.yaml").write_text(yaml.safe_dump(two))
    words = ("study", "score", "two", "--store", "s.sqlite", "--scenarios", 1, "--workers", 1)
    code, _, err = run(*words)
    assert code == 0, err
    contents = KnowledgeStore("s.sqlite", create=False).contents()
    learned, known = contents.learned, contents.knowledge("s.sqlite")
    assert len(known.goals) == 2
    assert {(key.goal, key.option) for key in learned} == {
        (goal, option.name) for goal in known.goals for option in known.options(goal)
    }
    assert {entry.moments.count for entry in learned.values()} == {1}


def test_results_that_learned_go_on_learning_or_not_at_all(run, tmp_path):
    learn(run, "--scenarios", 1, "--output", "learned")
    code, _, err = run("evaluate", "--family", "rooms", *UCB, "--scenarios", 2, "--output", "learned", "--resume")
    assert code == 2
    assert "has other results: learns: expected None, got True" in err


def test_missions_that_learn_are_recorded_and_explained_with_the_option_chosen(run, tmp_path):
    learn(run, "--scenarios", 2, "--output", "r", "--record")
    assert len(list((tmp_path / "r" / "recordings").iterdir())) >= 2
    for scenario, option in (("test-1", FAR), ("test-2", GRADIENT)):
        words = ("--robot", 0, "--time", 1, "--scenario", scenario, "--json")
        code, out, err = run("explain", "r", *words, configs=False)
        assert code == 0, err
        assert json.loads(out)["options"] == {"AvoidCollision": option}


def test_scores_of_an_experiment_are_those_of_all_its_options(run, fake_missions):
    code, out, err = run("study", "score", "chosen", "--store", "s.sqlite", "--scenarios", 6, "--workers", 1)
    assert code == 0, err
    assert {name: count for name, (count, _) in held(context="mission hall").items()} == {NEAR: 6, GRADIENT: 6, FAR: 6}
    assert f"AvoidCollision - {GRADIENT}" in out


def test_scores_of_a_goal_decide_what_serves_it(run):
    code, out, err = run("study", "score", "ReachGoal", "--store", "s.sqlite", "--scenarios", ENOUGH)
    assert code == 0, err
    assert "ReachGoal - ChemotaxisGe" in out
    code, out, _ = run("run", "ReachGoal", "--runs", 2, "--json")
    assert json.loads(out)["option"] == "ChemotaxisBalch"
    code, out, _ = run("run", "ReachGoal", "--runs", 2, "--seed", 50, "--store", "s.sqlite", "--learn", "--json")
    found = json.loads(out)
    known = found["known"]["ReachGoal"]
    best = max(known, key=lambda name: known[name]["mean"])
    assert best == found["option"] == "ChemotaxisGe"
    assert {one["count"] for one in known.values()} == {ENOUGH}
    code, _, err = run("run", "ReachGoal", "--runs", 2, "--seed", 50, "--store", "s.sqlite", "--learn")
    assert code == 2
    assert "holds what 'task ReachGoal, seed 50, 2 runs' learned already" in err
    code, out, _ = run("run", "ReachGoal", "--robots", 3, "--runs", 1, "--store", "s.sqlite", "--json")
    assert json.loads(out)["known"] == {}  # another setting


def test_unknown_names_are_one_line(run):
    code, _, err = run("study", "score", "Nothing", "--store", "s.sqlite")
    assert code == 2
    assert err.startswith("error: unknown family, experiment or task 'Nothing' (known: ")
    code, _, err = run("study", "score", "chosen", "--store", "s.sqlite", "--knowledge", "library")
    assert code == 2
    assert "--knowledge: expected a family or a task" in err


def test_learned_scores_become_expert_knowledge_that_a_mission_names(run, tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, GRADIENT: [0.2], NEAR: [0.7, 0.9] * ENOUGH})
    words = ("learn", "knowledge", "export", "my/knowledge/learned.yaml", "--store", "s.sqlite")
    code, _, err = run(*words, "--context", "mission hut", configs=False)
    assert code == 2
    assert "unknown context 'mission hut' (known: mission rooms" in err
    assert run(*words, "--context", "mission rooms", configs=False)[0] == 0
    written = load_knowledge("learned", [tmp_path / "my"])
    assert written.scores("AvoidCollision").tolist() == pytest.approx([0.1, 0.2, 0.8], abs=1e-6)
    assert written.rewards("AvoidCollision")[0].tolist() == [ENOUGH, 1, 2 * ENOUGH]
    (tmp_path / "my" / "missions").mkdir()
    (tmp_path / "my" / "missions" / "hut.yaml").write_text(yaml.safe_dump({"knowledge": "learned"}))
    batch = Batch(load_mission("hut", [tmp_path / "my"]), directories=(tmp_path / "my",))
    model = batch.worlds.coordinators[0].model
    assert model.options[int(batch.choices.default[0])] == NEAR
    assert model.problem.rewards[0].tolist() == [ENOUGH, 1, 2 * ENOUGH]


def test_a_mission_names_its_store(run, tmp_path):
    tell("s.sqlite", {FAR: [0.1] * ENOUGH, NEAR: [0.9] * ENOUGH}, "mission hut")
    (tmp_path / "my" / "missions").mkdir()
    content = {"name": "hut", "knowledge": "wrong", "store": "s.sqlite"}
    (tmp_path / "my" / "missions" / "hut.yaml").write_text(yaml.safe_dump(content))
    batch = Batch(load_mission("hut", [tmp_path / "my"]), directories=(tmp_path / "my",))
    assert batch.options["AvoidCollision"][int(batch.choices.default[0])] == NEAR
    shutil.copy("my/families/rooms.yaml", "my/families/hut.yaml")
    family = ROOMS | {"name": "hut", "mission": {"base": "hut", "time_limit": 400.0}}
    (tmp_path / "my/families/hut.yaml").write_text(yaml.safe_dump(family))
    words = ("evaluate", "--family", "hut", "--strategy", "MaxScore", "--strategy", f"fixed:{NEAR}", "--scenarios", 1)
    assert run(*words, "--output", "r")[0] == 0
    by_score, _, near = figures(tmp_path / "r")
    assert by_score == near
    assert json.loads((tmp_path / "r/manifest.json").read_text())["learned"]["AvoidCollision"][NEAR]["count"] == ENOUGH
