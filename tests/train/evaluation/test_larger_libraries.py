"""Libraries with more options than strategies were trained for, and the baselines of every table."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from selector.knowledge import load_knowledge
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Problem
from tests.paths import TRAINED
from tests.train.learning.trainings import written
from train.evaluation.conditions import conditions_of, remarks_on, with_baselines
from train.learning.config import load_training
from train.learning.curriculum import Curriculum
from train.running.trials import run_trials

GOAL, SIX = "AvoidCollision", load_knowledge("repulsion").options("AvoidCollision")
LEARNED = ("policy:general", "learned:rules")
OWN = (TRAINED,)


@pytest.mark.parametrize("member", LEARNED)
def test_what_was_trained_decides_as_in_the_library_it_was_trained_for(member):
    names = load_policy(find_policy("general", OWN)).spec.observations
    teams, seen = np.zeros(500, dtype=np.int64), np.random.default_rng(1).uniform(-1, 1, (500, len(names)))
    large, small = (Problem.of(load_knowledge(name), GOAL, names) for name in ("avoidance", "repulsion"))
    deciders = [decider_named(member, OWN).build(problem, teams) for problem in (large, small)]
    chosen, expected = (decider.decide(seen.astype(np.float32)).options for decider in deciders)
    np.testing.assert_array_equal(chosen, expected)
    thought, known = (decider.opinions() for decider in deciders)
    np.testing.assert_allclose(thought[:, : len(SIX)], known, rtol=1e-12)
    assert (thought[:, len(SIX) :] <= known.min(axis=1, keepdims=True)).all()


@pytest.mark.parametrize("option", [option.name for option in SIX])
def test_more_options_change_no_mission_of_the_others(option):
    results = []
    for knowledge in ("avoidance", "repulsion"):
        scenario = load_family("crowded").with_knowledge(knowledge).scenario(5, 0, "train")
        mission = scenario.mission.model_copy(update={"time_limit": 20.0})
        scenario = type(scenario)(scenario.id, scenario.seed, mission, scenario.start)
        results += run_trials([scenario], lambda problem, teams: decider_named(f"fixed:{option}").build(problem, teams))
    assert results[0] == results[1]
    assert results[0].collision_samples_per_s[1] > 0


def test_options_that_a_strategy_was_trained_without_are_named():
    options = [option.name for option in load_knowledge("avoidance").options(GOAL)]
    batch = Batch("table1", knowledge="avoidance")
    told = remarks_on(conditions_of([*LEARNED, "fixed", "fsm:rule", "Random"], options), batch, GOAL, OWN)
    missing = ", ".join(options[len(SIX) :])
    assert told == [f"{name}: never takes {missing}, which it was trained without" for name in LEARNED]
    assert remarks_on(conditions_of(LEARNED, options), Batch("table1", knowledge="repulsion"), GOAL, OWN) == []


def test_off_and_random_come_beside_once():
    given, mission = conditions_of(["fixed", "fsm:rule"], ("A", "Off")), MissionConfig()
    labels = list(with_baselines(given, ("A", "Off"), mission))
    assert labels == ["fixed:A", "fixed:Off", "fsm:rule", "Random"]
    assert list(with_baselines(conditions_of(["Random"], ("A",)), ("A",), mission)) == ["Random"]
    for options in (("A", "Off"), ("A+Patrol", "Off+Patrol", "Off+LevyWalk")):
        assert list(with_baselines({}, options, mission)) == ["fixed:Off", "Random"]


def test_a_training_learns_the_options_of_the_knowledge_that_its_task_names(tmp_path):
    for knowledge, large in (("repulsion", False), (None, True)):
        task = {"family": "random", "worlds": 1, "knowledge": knowledge}
        config = load_training(str(written(tmp_path, "bandit", tasks=[task])), "bandit")
        options = Curriculum(config, 1).batches[0].options[GOAL]
        assert options[: len(SIX)] == tuple(option.name for option in SIX)
        assert ("Off" in options) == large == (len(options) > len(SIX))
