"""Libraries with more options than strategies were trained for, and the baselines of every table."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from selector.knowledge import load_knowledge
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Problem
from train.evaluation.entrants import entrants_of, member_pilot, never_taken, with_baselines
from train.learning.config import load_training
from train.learning.curriculum import Curriculum
from train.running.trials import run_trials

GOAL, SIX = "AvoidCollision", load_knowledge("repulsion").options("AvoidCollision")
SHIPPED = ("policy:general", "learned:rules", "learned:careful")


def test_the_library_begins_with_the_options_that_policies_were_trained_for():
    assert load_knowledge("avoidance").options(GOAL)[: len(SIX)] == SIX
    assert load_policy(find_policy("general")).spec.options == tuple(option.name for option in SIX)


@pytest.mark.parametrize("member", SHIPPED)
def test_what_ships_decides_as_in_the_library_it_was_trained_for(member):
    names = load_policy(find_policy("general")).spec.observations
    teams, seen = np.zeros(500, dtype=np.int64), np.random.default_rng(1).uniform(-1, 1, (500, len(names)))
    large, small = (Problem.of(load_knowledge(name), GOAL, names) for name in ("avoidance", "repulsion"))
    pilots = [member_pilot(member, problem, teams) for problem in (large, small)]
    chosen, expected = (pilot.choose(seen.astype(np.float32)) for pilot in pilots)
    np.testing.assert_array_equal(chosen, expected)
    thought, known = (pilot.opinions() for pilot in pilots)
    np.testing.assert_allclose(thought[:, : len(SIX)], known, rtol=1e-12)
    assert (thought[:, len(SIX) :] <= known.min(axis=1, keepdims=True)).all()


@pytest.mark.parametrize("member", ["policy:general", "learned:rules"])
def test_a_policy_that_lists_its_options_in_another_order_takes_the_same_ones(member):
    names = load_policy(find_policy("general")).spec.observations
    teams, seen = np.zeros(500, dtype=np.int64), np.random.default_rng(2).uniform(-1, 1, (500, len(names)))
    problem = Problem.of(load_knowledge("avoidance"), GOAL, names)
    turned = problem.only(problem.options[::-1])
    first, second = (member_pilot(member, p, teams).choose(seen.astype(np.float32)) for p in (problem, turned))
    assert [problem.options[k] for k in first] == [turned.options[k] for k in second]


@pytest.mark.parametrize("option", [option.name for option in SIX])
def test_more_options_change_no_mission_of_the_others(option):
    results = []
    for knowledge in ("avoidance", "repulsion"):
        scenario = load_family("crowded").with_knowledge(knowledge).scenario(5, 0, "train")
        mission = scenario.mission.model_copy(update={"time_limit": 20.0})
        scenario = type(scenario)(scenario.id, scenario.seed, mission, scenario.start)
        results += run_trials([scenario], lambda problem, teams: member_pilot(f"fixed:{option}", problem, teams))
    assert results[0] == results[1]
    assert results[0].collision_samples_per_s[1] > 0


def test_options_that_a_strategy_was_trained_without_are_named():
    options = [option.name for option in load_knowledge("avoidance").options(GOAL)]
    missing = never_taken(entrants_of([*SHIPPED, "fixed", "rule", "Random"], options), options)
    assert missing == dict.fromkeys(SHIPPED, options[len(SIX) :])
    assert never_taken(entrants_of(SHIPPED, options), options[: len(SIX)]) == {}


def test_off_and_random_come_beside_once():
    labels = [e.label for e in with_baselines(entrants_of(["fixed", "rule"], ("A", "Off")), ("A", "Off"))]
    assert labels == ["fixed:A", "fixed:Off", "rule", "Random"]
    assert [e.label for e in with_baselines(entrants_of(["Random"], ("A",)), ("A",))] == ["Random"]
    assert [e.label for e in with_baselines([], ("A", "Off"))] == ["fixed:Off", "Random"]


@pytest.mark.parametrize("name", ["rules", "careful"])
def test_a_training_learns_the_options_of_the_knowledge_that_its_task_names(name):
    config = load_training(name, "bandit")
    named = Curriculum(config.model_copy(update={"tasks": (config.tasks[0].model_copy(update={"worlds": 1}),)}), 1)
    assert named.batches[0].options[GOAL] == tuple(option.name for option in SIX)
    own = config.tasks[0].model_copy(update={"worlds": 1, "knowledge": None})
    assert "Off" in Curriculum(config.model_copy(update={"tasks": (own,)}), 1).batches[0].options[GOAL]
