import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes import find, goals
from clean_swarm_env.scenes.served import expertise
from tests.paths import ROOT
from train.analysis.statistics import summarise
from train.cli import run as goal_cli
from train.cli.app import app
from train.goals.goal_tables import as_markdown, as_page
from train.goals.scene_runs import GoalOutcome, GoalRequest, MeasureComparison, as_mapping, run_goal

runner = CliRunner()


def call(*arguments):
    return runner.invoke(app, ["run", *arguments])


def test_a_goal_prints_its_measures_with_target_and_baseline():
    result = call("MaxValue", "--runs", "3")
    assert result.exit_code == 0, result.output
    assert "MaxValue by GossipMax: 20 robots, 12 s, open, seeds 0 to 2" in result.output
    row = next(line for line in result.output.splitlines() if "rounds to agreement" in line)
    assert re.search(r"≤ 6 .* yes +yes", row), row
    assert "target of rounds to agreement: 13 m across" in result.output


def test_json_holds_the_same_figures_for_equal_seeds():
    first, again = (call("FindBarycenter", "--runs", "2", "--seed", "4", "--json") for _ in range(2))
    assert first.exit_code == 0, first.output
    assert first.stdout == again.stdout
    given = json.loads(first.stdout)
    assert given["option"] == "Barycenter"
    assert given["seeds"] == [4, 5]
    assert given["targets_are_for_this_setting"]
    assert [measure["unit"] for measure in given["measures"]] == ["m", "-"]


def test_options_of_the_command_reach_the_scene():
    options = ("--robots", "4", "--seconds", "2", "--arena", "torus", "--option", "RepulsionGradient", "--runs", "1")
    result = call("AgentCollisionAvoidance", *options)
    assert result.exit_code == 0, result.output
    assert "by RepulsionGradient: 4 robots, 2 s, torus, seed 0" in result.output
    assert "targets are stated for 10 robots, 120 s, torus" in result.output
    given = json.loads(call("AgentCollisionAvoidance", *options, "--json").stdout)
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
    given = json.loads(call("MaxValue", "--configs", str(tmp_path), "--runs", "2", "--json").stdout)
    assert given["option"] == "Mine"
    assert given["measures"][0]["mechanism"]["mean"] == 1.0  # everybody hears everybody


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((), "run: expected a goal or --all, got neither; the goals are AgentCollisionAvoidance, "),
        (("MaxValue", "--all"), "run: expected a goal or --all, got both"),
        (("--all", "--robots", "3"), "--robots: expected one goal, not --all"),
        (("MaxValue", "--output", "x.md"), "--output: expected --all, got one goal"),
        (("MaxValue", "--runs", "0"), "--runs: expected a whole number of at least 1, got 0"),
        (("MaxValue", "--seconds", "nan"), "--seconds: expected a positive number up to 1e+07, got nan"),
        (("MaxValue", "--arena", "cave"), "--arena: expected torus or open, got 'cave'"),
        (("MaxValeu",), "unknown goal 'MaxValeu'"),
        (("MaxValue", "--option", "Shout"), "goal MaxValue: unknown option 'Shout'"),
        (("MaxValue", "--configs", "/nowhere"), "/nowhere: no such directory"),
    ],
)
def test_what_cannot_be_meant_is_one_line(arguments, expected):
    result = call(*arguments)
    assert isinstance(result.exception, ConfigurationError)
    assert expected in str(result.exception)
    assert "\n" not in str(result.exception)


def test_all_goals_go_into_one_page(tmp_path, monkeypatch):
    from clean_swarm_env import scenes

    monkeypatch.setattr(scenes, "goals", lambda: ("FindBarycenter", "MaxValue"))
    page = tmp_path / "goals.md"
    result = call("--all", "--runs", "2", "--output", str(page))
    assert result.exit_code == 0, result.output
    text = page.read_text(encoding="utf-8")
    assert "| FindBarycenter, Barycenter | distance of the elected robot" in text
    assert find("MaxValue").baseline in text
    assert re.search(r"\d of 2 goals meet", " ".join(text.split()))
    assert call("--all", "--runs", "1", "--output", str(tmp_path / "new" / "x.md")).exit_code == 0
    assert (tmp_path / "new" / "x.md").exists()


def compared(measure, mechanism, baseline):
    mechanism, baseline = np.array(mechanism), np.array(baseline)
    return MeasureComparison(measure, summarise(mechanism), summarise(baseline), summarise(mechanism - baseline))


def test_a_baseline_is_beaten_by_an_interval_only():
    lower = find("MaxValue").measures[0]
    assert compared(lower, [3.0, 4.0, 5.0], [9.0, 9.0, 12.0]).beats
    assert compared(lower, [3.0, 4.0, 9.0], [9.0, 9.0, 4.0]).beats is False
    assert compared(lower, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats is False
    higher = find("CollectiveExploration").measures[0]
    assert compared(higher, [9.0, 9.0, 12.0], [3.0, 4.0, 5.0]).beats


def test_a_goal_is_reached_by_all_of_its_measures():
    scene = find("MaxValue")
    good = [compared(measure, [1.0, 1.0, 0.5], [9.0, 8.0, 9.0]) for measure in scene.measures]
    bad = compared(scene.measures[1], [5.0, 6.0, 5.0], [9.0, 8.0, 9.0])
    assert GoalOutcome(scene, "x", scene.setting, range(3), tuple(good)).reached
    assert not GoalOutcome(scene, "x", scene.setting, range(3), (good[0], bad)).reached


def test_page_and_mapping_of_a_real_outcome():
    outcome = run_goal(GoalRequest("FindBarycenter", runs=3, seed=7))
    assert as_markdown([outcome]).count("\n| FindBarycenter") == 2
    assert "over 3 runs with seeds 7 to 9" in " ".join(as_page([outcome]).split())
    assert as_mapping(outcome)["reached"] == outcome.reached


def test_the_command_knows_every_kind_of_ground():
    assert goal_cli.ARENAS == ("torus", "open")
    assert {find(goal).setting.ground for goal in goals()} == set(goal_cli.ARENAS)


def test_the_page_in_the_docs_is_about_the_scenes_as_they_are():
    text = (ROOT / "docs" / "goal_results.md").read_text(encoding="utf-8")
    for goal in goals():
        scene = find(goal)
        assert f"| {goal} | {scene.story} ({scene.setting.ground}) | {scene.baseline} |" in text
        assert f"\n| {goal}, {expertise(goal).name} |" in text
        for measure in scene.measures:
            assert re.search(rf"\| {re.escape(measure.name)}.*\| [≤≥] {measure.target:g} \|", text), measure.name


def test_a_goal_runs_by_another_expert_knowledge():
    result = call("AgentCollisionAvoidance", "--knowledge", "original", "--runs", "1", "--seconds", "2")
    assert "AgentCollisionAvoidance by RepulsionGradient" in result.output  # of equal scores the first is taken


def test_expert_knowledge_that_does_not_cover_a_goal_names_those_that_it_does():
    result = call("CircleFormation", "--knowledge", "cleaning")
    assert isinstance(result.exception, ConfigurationError)
    assert "cleaning.yaml: unknown goal 'CircleFormation'" in str(result.exception)
