"""A planner by name: the built-in search, none, or an engine."""

import sys

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.pddl import EngineSearch, environment
from selforg.network.planning.planner import Planner, check_planner, planner_named
from selforg.network.planning.search import ForwardSearch
from tests.selforg.network.cleaning import cleaning_model, wandering


class Asked(ForwardSearch):
    """Notes that it was asked."""

    asked = 0

    def plan_from(self, state, goals):
        Asked.asked += 1
        return super().plan_from(state, goals)


def test_off_is_no_planner_and_built_in_plans():
    model = cleaning_model()
    assert planner_named(model, "off") is None
    assert isinstance(planner_named(model, "built-in"), Planner)


def test_another_search_takes_the_place_of_the_built_in_one():
    model = cleaning_model()
    question = np.zeros(len(model.sensors)), np.zeros(8, np.int64), np.ones(3, np.int64)
    expected = Planner(model).plan(*question)
    Asked.asked = 0
    assert Planner(model, Asked).plan(*question) == expected
    assert expected
    assert Asked.asked > 0


def test_without_the_library_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "unified_planning.shortcuts", None)
    environment.cache_clear()
    message = r"planner 'aries' is neither 'built-in' nor 'off', and .*pip install '\.\[planning\]'"
    with pytest.raises(ModuleNotFoundError, match=message):
        check_planner("aries")
    environment.cache_clear()


@pytest.mark.extra
def test_engines_that_are_not_installed_list_those_that_are():
    pytest.importorskip("unified_planning")
    with pytest.raises(ValueError, match=r"unknown planning engine 'ares' \(installed: "):
        planner_named(cleaning_model(), "ares")


@pytest.mark.extra
@pytest.mark.long
def test_an_engine_gives_the_network_plans_that_reach_what_the_built_in_ones_reach():
    pytest.importorskip("up_aries")
    model, rows = cleaning_model(), 4
    networks = [BehaviourNetwork(model, rows, planner_named(model, name)) for name in ("built-in", "aries")]
    for step, readings in enumerate(wandering(np.random.default_rng(3), 12, rows)):
        for network in networks:
            network.readings[:] = readings
            network.step()
        ours, theirs = (network.state.plan_marks[:, st.PLAN_KNOWN] for network in networks)
        np.testing.assert_array_equal(ours, theirs, err_msg=f"step {step}: a plan is known")
    assert any(isinstance(held.search, EngineSearch) for held in networks[1].planner._searches.values())
