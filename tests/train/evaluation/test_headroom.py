"""The headroom of a family: the search finds what is planted, and is judged on other scenarios."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from selector.documents.errors import DocumentError
from tests.train.commands import cut, done
from tests.train.records import record
from train.evaluation import headroom
from train.evaluation.headroom import (
    RULE_FOUND,
    SINGLE,
    HeadroomEvaluation,
    RuleTask,
    scenario_kinds,
)
from train.request import Request

pytestmark = pytest.mark.usefixtures("undrawn")
SITUATIONS = ("free_far", "free_near", "carrying_far", "carrying_near")


def evaluation_of(situations=SITUATIONS, scenarios=4, searched=2, name="random-bumpers", family=None, **more):
    return HeadroomEvaluation(Request(name, scenarios=scenarios, **more), situations, searched, family)


def played(evaluation, excess):
    """Return the records of all runs that the search asks for; `excess`: task, scenario -> excess cost [s]."""
    done, rounds = {}, []
    while tasks := evaluation.tasks(done):
        rounds.append(tasks)
        for task in tasks:
            for scenario, key in zip(task.scenarios, task.keys, strict=True):
                done[key] = record(*key, cost_s=float(excess(task, scenario)))
    return done, rounds


def rows_of(evaluation, done):
    [grid] = evaluation.publication(list(done.values())).grids
    return {label: cells for label, *cells in grid.rows}, grid.notes


def test_the_search_finds_the_planted_rule_and_judges_it_on_test_scenarios():
    planted, evaluation = (2, 0, 1, 3), evaluation_of()

    def excess(task, scenario):
        if not isinstance(task, RuleTask):
            return 99.0
        rule = task.rules[scenario.id]
        return 10.0 + sum(own != best for own, best in zip(rule, planted, strict=True)) + (rule[0] == 5)

    done, rounds = played(evaluation, excess)
    searches, judged = rounds[:-1], rounds[-1]
    assert {task.first.id[:5] for tasks in searches for task in tasks} == {"train"}
    assert {task.first.id[:5] for task in judged} == {"test-"}
    assert [task.condition for task in judged] == [SINGLE, RULE_FOUND, "fixed:Off", "Random"]
    rows, notes = rows_of(evaluation, done)
    assert rows[SINGLE][1:3] == ["13.0", "1"]
    assert rows[RULE_FOUND][1:3] == ["10.0", "0.769"]
    found = ", ".join(f"{name} {evaluation.options[k]}" for name, k in zip(SITUATIONS, planted, strict=True))
    assert f"best choices: {found}" in notes
    assert "4 scenarios: no statement; " in notes[-1]
    assert len(done) - 4 * 4 <= 2 * (7 + 3 * 4 * 7)


def test_a_search_among_many_options_drops_the_worse_half_and_judges_who_is_left():
    goal = "AvoidCollision+ExplorationPatrol"
    family = load_family("bumpers-or-not-1")
    evaluation = HeadroomEvaluation(Request("bumpers-or-not-1", scenarios=12, goal=goal), (), 16, family, finalists=3)
    planted = {"spots 0 stations 2": "ORCA+Patrol", "spots 0 stations 2 harmless": "Off+Finds"}
    places = {kind: evaluation.options.index(option) for kind, option in planted.items()}
    both = evaluation.options.index("PredictiveSteering+Patrol")  # second best in each kind

    def excess(task, scenario):
        [kind], [option] = scenario_kinds([scenario]), task.rules[scenario.id]
        far = abs(option - places[kind])
        return 10.0 + (0 if far == 0 else 2 if option == both else 5 + far)

    done, rounds = played(evaluation, excess)
    first, *_, judged = rounds
    assert {scenario.id for task in first for scenario in task.scenarios} == {f"train-{k}" for k in range(1, 5)}
    rows, notes = rows_of(evaluation, done)
    assert set(rows) >= {SINGLE, RULE_FOUND, "fixed:ORCA+Patrol", "fixed:Off+Finds"}
    assert 4 <= len(rows) <= 2 + 3 + 2
    assert {task.condition for task in judged} == set(rows)
    assert next(iter(rows)) == RULE_FOUND  # the lowest first
    assert (rows[SINGLE][1], rows[RULE_FOUND][1]) == ("12.0", "10.0")
    assert "best single choice: PredictiveSteering+Patrol" in notes
    assert "best choices: " + ", ".join(f"{kind} {option}" for kind, option in planted.items()) in notes
    assert f"ratio to the best in hindsight of {len(rows) - 1}, best single choice: 0.833 [0.833, 0.833]" in notes
    searched = sum(scenario.startswith("train") for scenario, _ in done)
    assert 35 * 4 < searched < 35 * 16 / 1.4


def test_a_race_in_each_situation_finds_what_is_a_bad_single_choice():
    evaluation = HeadroomEvaluation(Request("random-bumpers", scenarios=4), SITUATIONS[:2], 8, finalists=2)
    planted = (9, 3)

    def excess(task, scenario):
        rule = np.array(task.rules[scenario.id])
        return 50.0 - 20.0 * (rule == planted).sum() + 15.0 * (rule == planted[::-1]).sum() - 5.0 * (rule == 5).sum()

    done, _ = played(evaluation, excess)
    rows, notes = rows_of(evaluation, done)
    assert (rows[SINGLE][1], rows[RULE_FOUND][1]) == ("40.0", "10.0")
    assert not {f"fixed:{evaluation.options[option]}" for option in planted} <= set(rows)
    assert f"best choices: free_far {evaluation.options[9]}, free_near {evaluation.options[3]}" in notes


def test_rules_may_be_told_what_no_robot_senses():
    asked = Request("seasons-1", scenarios=4, goal="AvoidCollision+ExplorationPatrol")
    situations = ("true_anywhere", "true_spots")
    with pytest.raises(DocumentError, match="--situations: unknown component 'true_anywhere'"):
        HeadroomEvaluation(asked, situations, 2)
    assert "true_spots" in HeadroomEvaluation(asked, situations, 2, told=("true_season",)).problem.features


def test_a_search_that_was_cut_off_goes_on_to_the_same_results(tmp_path, monkeypatch):
    monkeypatch.setattr(headroom, "MOST_ROUNDS", 1)
    family = load_family("random-bumpers")
    family = family.model_copy(update={"mission": family.mission.model_copy(update={"time_limit": 5.0})})
    monkeypatch.setattr("train.evaluation.family.load_family", lambda *_: family)
    words = ["study", "headroom", "random-bumpers", "--knowledge", "repulsion", "--situations", "free_far,free_near"]
    words += ["--searched", 2, "--judged", 2, "--workers", 1, "--output"]
    done(*words, tmp_path / "whole")
    cut(tmp_path / "whole", tmp_path / "cut", slice(None, None, 5))
    done(*words, tmp_path / "cut", "--resume")
    whole, again = ((tmp_path / name / "table.md").read_text() for name in ("whole", "cut"))
    assert whole == again


def test_situations_may_come_from_the_terms_of_a_mission():
    situations = ("finds_none", "finds_apart")
    with pytest.raises(DocumentError, match="--situations: unknown component 'finds_none'"):
        evaluation_of(situations)
    family = load_family("random-bumpers")
    mission = family.mission.model_copy(update={"terms": ("finds",)})
    seeing = evaluation_of(situations, family=family.model_copy(update={"mission": mission}))
    assert "finds_apart" in seeing.problem.features
