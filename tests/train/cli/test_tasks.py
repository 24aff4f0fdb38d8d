"""Tasks by `clean-swarm evaluate`: their measures beside targets and baselines; tasks of files of the user's own."""

import json
import re

import numpy as np
import pytest

from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.recording.reader import RecordedMission, events_of
from selector.configurations.library import Library
from selector.coordination.model import coordinator_models
from selector.knowledge import load_knowledge
from tests.paths import ROOT
from tests.train.commands import apart, done, refused
from train.analysis.task_report import measured_strategies
from train.evaluation.comparing import Comparing
from train.request import Request

ORIGINAL = load_knowledge("original")
WITH_BASELINE = [name for name in task_names() if find_task(name).baseline]
WORDS = ("--strategy", "MaxScore", "--workers", 1, "--output", "r", "--all")


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_a_task_prints_its_measures_with_target_and_baseline():
    out = done("evaluate", "MaxValue", *WORDS, "--scenarios", 3)
    assert "MaxValue: rounds to agreement" in out
    assert "target ≤ 6: 13 m across" in " ".join(out.split())
    assert [re.split(r"\s{2,}", line.strip())[0] for line in out.splitlines() if " - " in line and "yes" in line]


def test_targets_are_for_the_tasks_own_setting(tmp_path):
    (tmp_path / "few.yaml").write_text(
        "{name: few, task: AgentCollisionAvoidance, robots: {count: 4}, time_limit: 2.0, world: {ground: open}}"
    )
    done("evaluate", "few.yaml", *WORDS, "--scenarios", 1)
    table = (tmp_path / "r" / "table.md").read_text()
    assert "targets are stated for 10 robots, 120 s, torus, not for 4 robots, 2 s, open" in table


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
    given = ("--configs", tmp_path, "--strategy", "fixed:Mine", "--scenarios", 2, *WORDS[2:])
    done("evaluate", "MaxValue", *given)
    rows = [json.loads(line) for line in (tmp_path / "r" / "runs.jsonl").read_text().splitlines()]
    rounds = [row["measures"]["rounds to agreement"] for row in rows if row["condition"] == "fixed:Mine"]
    assert rounds == [1.0, 1.0]  # everybody hears everybody


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("MaxValue", "--scenarios", "0"), "--scenarios: expected a whole number of at least 1, got 0"),
        (("MaxValeu",), "experiment or task 'MaxValeu'"),
        (("MaxValue", "--strategy", "fixed:Shout"), "unknown option 'Shout'"),
        (("MaxValue", "--configs", "/nowhere"), "/nowhere: no such directory"),
        (("CircleFormation", "--knowledge", "cleaning"), "cleaning.yaml: unknown goal 'CircleFormation'"),
    ],
)
def test_what_cannot_be_meant_is_one_line(arguments, expected):
    assert expected in refused("evaluate", *arguments)


def compared(measure, own, baseline, times=3):
    values = {name: np.array(found * times) for name, found in (("x", own), ("base", baseline))}
    return measured_strategies([measure], {measure.name: values}, "base")[0]


def test_a_baseline_is_beaten_by_sign_flips_only():
    lower = find_task("MaxValue").measures[0]
    assert compared(lower, [3.0, 4.0, 5.0], [9.0, 9.0, 12.0]).beats
    assert compared(lower, [3.0, 4.0, 5.0], [9.0, 9.0, 12.0], 1).beats is None
    assert compared(lower, [3.0, 4.0, 9.0], [9.0, 9.0, 4.0]).beats is False
    assert compared(lower, [3.0, 4.0, 5.0], [3.0, 4.0, 5.0]).beats is False
    assert compared(lower, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats is False
    higher = find_task("CollectiveExploration").measures[0]
    assert compared(higher, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats


def test_the_page_in_the_docs_is_about_the_tasks_as_they_are():
    text = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    assert "14 of 14 tasks meet all their targets" in " ".join(text.split())
    for name in WITH_BASELINE:
        assert f"| {name}, " in text
        for measure in find_task(name).measures:
            assert re.search(rf"\| {re.escape(measure.name)}.*\| [≤≥] {measure.target:g} \|", text), measure.name


def test_a_task_runs_by_another_expert_knowledge():
    evaluation = Comparing(Request("AgentCollisionAvoidance", ("MaxScore",), scenarios=1, knowledge="original"))
    held = evaluation.problem.options[int(evaluation.batch.choices.default[0])]
    assert held == "RepulsionGradient-view1.5"  # of equal scores the first is taken
    assert done("evaluate", "AgentCollisionAvoidance", "--knowledge", "original", *WORDS, "--scenarios", 1)


def test_every_option_of_the_original_can_be_built_and_serves_a_goal_with_a_task():
    coordinator_models(ORIGINAL.goals, ORIGINAL, Library())
    assert set(ORIGINAL.goals) == set(load_knowledge("library").goals) == set(WITH_BASELINE)


EXAMPLE = str(ROOT / "examples" / "own_task.py")


def own(*words):
    """Run a command in a fork, which ends with what it imports, and return its output."""
    return apart(lambda: done(*words))


def test_a_task_of_a_users_own_is_evaluated_recorded_and_replayed(tmp_path):
    words = ("evaluate", "Shepherding", "--scenarios", "3", "--workers", "1", "--output", "r", "--record")
    own(f"--import={EXAMPLE}", *words)
    assert "sheep in the ring" in (tmp_path / "r" / "table.md").read_text()
    assert (tmp_path / "r" / "runs.csv").read_text().splitlines()[0].endswith("wall_s,sheep in the ring")
    assert f"--import={EXAMPLE}" in json.loads((tmp_path / "r" / "manifest.json").read_text())["command"]
    events = events_of(RecordedMission(next((tmp_path / "r" / "recordings").iterdir())))
    assert {(one.event, one.axis) for one in events} == {("sheep comes into the ring", "world")}
    own("--import", EXAMPLE, "replay", "r", "--html", "page.html")
    assert (tmp_path / "page.html").stat().st_size > 10_000
    assert re.search("(?m)^Shepherding +12 robots", own("list", "tasks", "--import", EXAMPLE))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("evaluate own.yaml", f"only a file asks to import {EXAMPLE}:Shepherding"),
        ("evaluate Shepherding", "experiment or task 'Shepherding'"),
        ("evaluate Shepherding", "a task of your own: --import MODULE or FILE.py"),
        ("list --import=no_swarm", "no_swarm: No module named 'no_swarm'"),
        ("list --import", "--import: expected a module, or a file of Python code"),
        ("list --import no.py", "no.py: expected a module, or a file of Python code"),
        ("evaluate Foraging --import broken.py", "broken.py:1: SyntaxError"),
        ("evaluate Foraging --import raises.py", "raises.py:2: ValueError: two lines"),
        ("evaluate Foraging --import ends.py", "ends.py:2: SystemExit: 3"),
        ("evaluate Foraging --import taken.py", "'Foraging' is registered already"),
    ],
)
def test_a_file_of_strangers_runs_no_code_and_an_unknown_task_is_one_line(tmp_path, words, said):
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
