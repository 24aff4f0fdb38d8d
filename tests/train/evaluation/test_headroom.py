"""The headroom of a family: the search finds what is planted, and is judged on other scenarios."""

from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from selector.documents.errors import DocumentError
from tests.train.commands import run
from tests.train.records import record
from train.evaluation.choosing import headroom
from train.evaluation.choosing.headroom import (
    RULE_FOUND,
    SINGLE,
    HeadroomRequest,
    RuleSearch,
    headroom_of,
    headroom_table,
    scenario_kinds,
)

SITUATIONS = ("free_far", "free_near", "carrying_far", "carrying_near")


def request(**changes):
    family = load_family("random-bumpers")
    family = family.model_copy(update={"mission": family.mission.model_copy(update={"time_limit": 30.0})})
    return replace(HeadroomRequest(family, SITUATIONS, 0, searched=2, judged=4), **changes)


def results_of(excesses, completed=True):
    return [record(cost_s=float(excess), completed=completed).result for excess in excesses]


def test_the_search_finds_the_planted_rule(monkeypatch):
    planted = np.array([2, 0, 1, 3])
    search = RuleSearch(request())

    def results(self, scenarios, rules):
        return results_of(10.0 + (rules != planted).sum(axis=1) + (rules[:, 0] == 5))

    monkeypatch.setattr(RuleSearch, "results", results)
    assert search.single() in planted
    assert search.rule().tolist() == planted.tolist()
    assert search.missions <= 2 * (7 + 3 * 4 * 7)


def test_what_was_found_is_judged_on_test_scenarios(monkeypatch):
    splits, trials = [], headroom.run_trials

    def noted(scenarios, maker, settings):
        splits.append({scenario.id.partition("-")[0] for scenario in scenarios})
        return trials(scenarios, maker, settings)

    monkeypatch.setattr(headroom, "run_trials", noted)
    monkeypatch.setattr(headroom, "MOST_ROUNDS", 1)
    found = headroom_of(request())
    assert splits[-4:] == [{"test"}] * 4
    assert set().union(*splits[:-4]) == {"train"}
    assert set(found.excesses) == {SINGLE, RULE_FOUND, "fixed:Off", "Random"}
    assert [claim.against for claim in found.claims] == [SINGLE] * 3
    assert found.excesses[RULE_FOUND] / found.excesses[SINGLE] == pytest.approx(found.claims[0].ratio)
    assert "4 scenarios: no statement; " in headroom_table(found, "random-bumpers").notes[-1]


def test_the_best_choice_for_each_kind_of_scenario_is_found_and_judged(monkeypatch):
    family = load_family("clustered")
    asked = HeadroomRequest(family, (), 0, searched=8, judged=12, goal="AvoidCollision+ExplorationPatrol")
    planted = {"spots 0 stations 2": "ORCA+Patrol", "spots 1 stations 2": "PredictiveSteering+Finds"}
    options = RuleSearch(asked).problem.options

    def results(self, scenarios, rules):
        wanted = [options.index(planted[kind]) for kind in scenario_kinds(scenarios)]
        return results_of([10.0 + abs(option - best) for (option,), best in zip(rules, wanted, strict=True)])

    def lost(self, scenarios, member):
        return results_of(np.full(len(scenarios), 99.0), completed=False)

    monkeypatch.setattr(RuleSearch, "results", results)
    monkeypatch.setattr(RuleSearch, "results_of", lost)
    found = headroom_of(asked)
    assert found.rule == planted
    assert found.excesses[RULE_FOUND] == 10.0 < found.excesses[SINGLE]
    assert found.excesses["fixed:Off"] == found.excesses["Random"] == 99.0
    assert found.missions == 8 * len(options)
    left = {row.label: row.groups[0][0] for row in headroom_table(found, family.name).rows}
    assert left == {SINGLE: "0%", RULE_FOUND: "0%", "fixed:Off": "100%", "Random": "100%"}
    told = "spots 0 stations 2 ORCA+Patrol, spots 1 stations 2 PredictiveSteering+Finds"
    assert told in str(headroom_table(found, family.name))


def test_unknown_situations_are_one_line(capsys):
    assert run("headroom", "random", "--situations", "free_far,asleep") == 2
    assert "--situations: unknown component 'asleep'" in capsys.readouterr().err
    with pytest.raises(DocumentError):
        RuleSearch(request(situations=("asleep",)))


def test_situations_may_come_from_the_terms_of_a_mission():
    asked = request(situations=("finds_none", "finds_apart"))
    with pytest.raises(DocumentError, match="--situations: unknown component 'finds_none'"):
        RuleSearch(asked)
    mission = asked.family.mission.model_copy(update={"terms": ("finds",)})
    seeing = asked.family.model_copy(update={"mission": mission})
    assert "finds_apart" in RuleSearch(replace(asked, family=seeing)).problem.features
