"""The headroom of a family: the search finds what is planted, and is judged on other scenarios."""

import numpy as np

from clean_swarm_env.config.load import load_family
from docs.comparison.headroom import RULE_FOUND, SINGLE, HeadroomEvaluation, main, scenario_kinds
from docs.comparison.hidden import OWN, against_told
from tests.train.commands import cut
from tests.train.records import record
from train.request import Request


def test_kinds_name_what_collisions_do_and_their_price_where_that_differs():
    hidden = load_family(str(OWN.parent / "families" / "hidden.yaml"))
    kinds = set(scenario_kinds([hidden.scenario(1, k, "test") for k in range(60)]))
    told = {" harmless price 2", " price 2", " price 20", " drop price 2", " drop price 20"}
    assert kinds == {f"spots 0 stations 2{each}" for each in told}
    assert set(scenario_kinds([load_family("packed-1").scenario(1, 0, "test")])) == {"spots 0 stations 2"}


def test_the_table_has_the_cheapest_first_beside_the_best_pair_and_told():
    costs = {"told": [1.0, 3.0, 2.0, 2.0], "rule": [2.0, 4.0, 4.0, 2.0], "best": [2.0, 6.0, 4.0, 4.0]}
    excesses = {label: np.array(own)[None, :, None] for label, own in costs.items()}
    lines = against_told(excesses, {"told": 0, "rule": 1}).splitlines()
    assert [line.split("|")[1].strip() for line in lines[2:]] == ["`told`", "`rule`", "`best`"]
    assert "| 1 | 0.750 [" in lines[3]
    assert lines[3].split("|")[5].startswith(" 1.500 [")


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


def test_a_search_among_many_options_drops_the_worse_half_and_judges_who_is_left():
    goal = "AvoidCollision+ExplorationPatrol"
    family = load_family("bumpers-or-not-1")
    evaluation = HeadroomEvaluation(Request("bumpers-or-not-1", scenarios=12, goal=goal), 16, family, finalists=3)
    planted = {"spots 0 stations 2": "ORCA+Patrol", "spots 0 stations 2 harmless": "Off+Finds"}
    places = {kind: evaluation.problem.options.index(option) for kind, option in planted.items()}
    both = evaluation.problem.options.index("PredictiveSteering+Patrol")  # second best in each kind

    def excess(task, scenario):
        [kind], option = scenario_kinds([scenario]), task.chosen[scenario.id]
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


def test_a_search_that_was_cut_off_goes_on_to_the_same_results(tmp_path, monkeypatch):
    family = load_family("random-bumpers")
    mission = family.mission.model_copy(update={"time_limit": 5.0, "knowledge": "repulsion"})
    short = family.model_copy(update={"mission": mission})
    monkeypatch.setattr("docs.comparison.headroom.load_family", lambda *_: short)
    words = ["random-bumpers", "AvoidCollision", "--searched", "2", "--judged", "2", "--output"]
    main([*words, str(tmp_path / "whole")])
    cut(tmp_path / "whole", tmp_path / "cut", slice(None, None, 5))
    main([*words, str(tmp_path / "cut")])
    whole, again = ((tmp_path / name / "table.md").read_text() for name in ("whole", "cut"))
    assert whole == again
    assert "best choice for each case" in whole
