"""`clean-swarm run`: a task by an option and by its baseline; tasks of files of the user's own."""

import json
import re

import numpy as np
import pytest

from clean_swarm_env.config.tasks import find_task
from selector.configurations.library import Library
from selector.knowledge import load_knowledge
from tests.paths import ROOT
from tests.train.commands import apart, done, refused
from train.analysis.task_report import measured_strategies
from train.evaluation.task_run import TaskOutcome, TaskRun, tasks_to_run

ORIGINAL = load_knowledge("original")


def test_a_task_prints_its_measures_with_target_and_baseline():
    out = done("run", "MaxValue", "--runs", "3")
    assert "MaxValue by GossipMax: 20 robots, 12 s, open, 3 runs of seed 0" in out
    row = next(line for line in out.splitlines() if "rounds to agreement" in line)
    assert re.search(r"≤ 6 .* yes +- ", row), row
    assert "target of rounds to agreement: 13 m across" in out


def test_json_holds_the_same_figures_for_equal_seeds():
    first, again = (done("run", "FindBarycenter", "--runs", "2", "--seed", "4", "--json") for _ in range(2))
    assert first == again
    given = json.loads(first)
    assert (given["option"], given["seed"], given["runs"]) == ("Barycenter", 4, 2)
    assert given["targets_are_for_this_setting"]
    assert [measure["unit"] for measure in given["measures"]] == ["m", "-"]


def test_options_of_the_command_reach_the_mission():
    options = (
        "--robots",
        "4",
        "--seconds",
        "2",
        "--arena",
        "open",
        "--option",
        "RepulsionGradient-view1.5",
        "--runs",
        "1",
    )
    out = done("run", "AgentCollisionAvoidance", *options)
    assert "by RepulsionGradient-view1.5: 4 robots, 2 s, open, 1 run of seed 0" in out
    assert "targets are stated for 10 robots, 120 s, torus" in out
    given = json.loads(done("run", "AgentCollisionAvoidance", *options, "--json"))
    assert given["measures"][0]["beats_baseline"] is None  # one run has no interval
    assert not given["targets_are_for_this_setting"]


def test_own_configurations_and_knowledge_go_before_the_shipped_ones(tmp_path):
    (tmp_path / "knowledge").mkdir()
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "knowledge" / "library.yaml").write_text("goals: {MaxValue: [{configuration: Mine, score: 1.0}]}\n")
    mine = (
        "expects: {measured: number}\n"
        "mechanisms: {gossip: {type: GossipMax, parameters: {value: measured, view_distance: 9.0}}}\n"
        "behaviours: {Tell: {action: {type: Decide, mechanism: gossip}}}\n"
    )
    (tmp_path / "mechanisms" / "Mine.yaml").write_text(mine)
    given = json.loads(done("run", "MaxValue", "--configs", tmp_path, "--runs", "2", "--json"))
    assert given["option"] == "Mine"
    assert given["measures"][0]["own"]["mean"] == 1.0  # everybody hears everybody


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("MaxValue", "--runs", "0"), "--runs: expected a whole number of at least 1, got 0"),
        (("MaxValue", "--seconds", "nan"), "--seconds: expected a positive number up to 1e+07, got nan"),
        (("MaxValue", "--arena", "cave"), "--arena: expected torus or open, got 'cave'"),
        (("MaxValeu",), "unknown task 'MaxValeu'"),
        (("Cleaning",), "unknown task with a baseline 'Cleaning'"),
        (("MaxValue", "--option", "Shout"), "goal MaxValue: unknown option 'Shout'"),
        (("MaxValue", "--configs", "/nowhere"), "/nowhere: no such directory"),
        (("CircleFormation", "--knowledge", "cleaning"), "cleaning.yaml: unknown goal 'CircleFormation'"),
    ],
)
def test_what_cannot_be_meant_is_one_line(arguments, expected):
    assert expected in refused("run", *arguments)


def compared(measure, own, baseline, times=3):
    values = {name: {measure.name: np.array(found * times)} for name, found in (("x", own), ("base", baseline))}
    return measured_strategies([measure], values, "base")[0]


def test_a_baseline_is_beaten_by_sign_flips_only():
    lower = find_task("MaxValue").measures[0]
    assert compared(lower, [3.0, 4.0, 5.0], [9.0, 9.0, 12.0]).beats
    assert compared(lower, [3.0, 4.0, 5.0], [9.0, 9.0, 12.0], 1).beats is None
    assert compared(lower, [3.0, 4.0, 9.0], [9.0, 9.0, 4.0]).beats is False
    assert compared(lower, [3.0, 4.0, 5.0], [3.0, 4.0, 5.0]).beats is False
    assert compared(lower, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats is False
    higher = find_task("CollectiveExploration").measures[0]
    assert compared(higher, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats


def test_a_task_is_reached_by_all_of_its_measures():
    measures, asked = find_task("MaxValue").measures, TaskRun("MaxValue")
    good = [compared(measure, [1.0, 1.0, 0.5], [9.0, 8.0, 9.0]) for measure in measures]
    bad = compared(measures[1], [5.0, 6.0, 5.0], [9.0, 8.0, 9.0])
    assert TaskOutcome(asked, "GossipMax", good).reached
    assert not TaskOutcome(asked, "GossipMax", (good[0], bad)).reached


def test_the_page_in_the_docs_is_about_the_tasks_as_they_are():
    text = (ROOT / "docs" / "goal_results.md").read_text(encoding="utf-8")
    assert "14 of 14 tasks meet all their targets" in " ".join(text.split())
    for name in tasks_to_run():
        task, ground = find_task(name), TaskRun(name).mission.world.ground
        assert f"| {name} | {task.story} ({ground}) | {task.baseline} |" in text
        for measure in task.measures:
            assert re.search(rf"\| {re.escape(measure.name)}.*\| [≤≥] {measure.target:g} \|", text), measure.name


def test_a_task_runs_by_another_expert_knowledge_beside_its_own_baseline():
    words = ("--knowledge", "original", "--runs", "1", "--seconds", "2")
    out = done("run", "AgentCollisionAvoidance", *words)
    assert "AgentCollisionAvoidance by RepulsionGradient-view1.5" in out  # of equal scores the first is taken
    done("run", "Foraging", *words)


def test_every_option_of_the_original_can_be_built_and_serves_a_goal_with_a_task():
    Library().check(ORIGINAL)
    assert set(ORIGINAL.goals) == set(load_knowledge("library").goals) == set(tasks_to_run())


EXAMPLE = str(ROOT / "examples" / "own_task.py")


def own(*words):
    """Run a command in a fork, which ends with what it imports, and return its output."""
    return apart(lambda: done(*words))


def test_a_task_of_a_users_own_runs_and_is_evaluated_recorded_and_replayed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (measure,) = json.loads(own("run", "Shepherding", "--import", EXAMPLE, "--runs", "5", "--json"))["measures"]
    assert measure["own"]["mean"] > measure["baseline"]["mean"]
    words = ("evaluate", "--family", "Shepherding", "--scenarios", "3", "--workers", "1", "--output", "r", "--record")
    own(f"--import={EXAMPLE}", *words)
    assert "sheep in the ring" in (tmp_path / "r" / "table.md").read_text()
    assert (tmp_path / "r" / "runs.csv").read_text().splitlines()[0].endswith("wall_s,sheep in the ring")
    assert f"--import={EXAMPLE}" in json.loads((tmp_path / "r" / "manifest.json").read_text())["command"]
    own("--import", EXAMPLE, "replay", "r", "--html", "page.html")
    assert (tmp_path / "page.html").stat().st_size > 10_000
    assert re.search("(?m)^Shepherding +12 robots", own("list", "tasks", "--import", EXAMPLE))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("evaluate --family own.yaml", f"only a file asks to import {EXAMPLE}:Shepherding"),
        ("evaluate --family Shepherding", "unknown mission, family or task 'Shepherding'"),
        ("evaluate --family Shepherding", "a task of your own: --import MODULE or FILE.py"),
        ("list --import=no_swarm", "no_swarm: No module named 'no_swarm'"),
        ("list --import", "--import: expected a module, or a file of Python code"),
        ("list --import no.py", "no.py: expected a module, or a file of Python code"),
        ("run Foraging --import broken.py", "broken.py:1: SyntaxError"),
        ("run Foraging --import raises.py", "raises.py:2: ValueError: two lines"),
        ("run Foraging --import ends.py", "ends.py:2: SystemExit: 3"),
        ("run Foraging --import taken.py", "'Foraging' is registered already"),
    ],
)
def test_a_file_of_strangers_runs_no_code_and_an_unknown_task_is_one_line(tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    mission = f"{{task: '{EXAMPLE}:Shepherding', time_limit: 10.0}}"
    (tmp_path / "own.yaml").write_text(f"{{name: own, description: Few., mission: {mission}, robots: [3, 3]}}")
    example = (ROOT / "examples" / "own_task.py").read_text()
    for name, code in {
        "broken": "def broken(:",
        "raises": "\nraise ValueError('two\\nlines')",
        "ends": "import sys\nsys.exit(3)",
        "taken": example.replace("class Shepherding", "class Foraging"),
    }.items():
        (tmp_path / f"{name}.py").write_text(code)
    assert said in apart(lambda: refused(*words.split()))
