"""Planners of others in place of the built-in one (extra `planning`, engine `up-aries`)."""

import numpy as np
import pytest

from selforg.network.planning.problem import (
    PlanningGoal,
    PlanningProblem,
    fact_is,
    number_is,
    planning_action,
)
from selforg.network.planning.search import ForwardSearch, Plan, Unknown, Unsolvable
from tests.selforg.network.planning.generated_problems import generated
from tests.selforg.network.planning.planner_reference import execute, true_in
from tests.selforg.network.planning.robot_problem import robot_problem, robot_state

SOLVABLE = (1, 2, 4, 6, 8, 9, 10, 11, 12, 13, 15, 17, 18, 19, 21, 22, 23, 26, 27, 29)
"""Seeds of the first problems that have a plan."""


@pytest.mark.extra
def test_a_number_that_nothing_changes_keeps_only_the_truth_of_its_bounds():
    pytest.importorskip("up_aries")
    from selforg.network.planning.pddl import EngineSearch

    go = planning_action("go", (number_is(0, ">=", 0.25), number_is(0, "<", 0.75)), ((0, True),))
    problem = PlanningProblem(("done",), ("x",), (go,), (PlanningGoal("done", fact_is(0)),))
    for reading, expected in ((0.25, Plan), (0.75, Unknown | Unsolvable), (-3.0, Unknown | Unsolvable)):
        answer = EngineSearch(problem, "aries", timeout=1.0).plan(np.array([False]), np.array([reading]), [0])
        assert isinstance(answer, expected)


@pytest.mark.extra
@pytest.mark.parametrize("seed", SOLVABLE)
def test_plans_of_an_engine_can_be_executed_and_reach_the_goal(seed):
    pytest.importorskip("up_aries")
    from selforg.network.planning.pddl import EngineSearch

    problem, facts, numbers = generated(seed)
    answer = EngineSearch(problem, "aries").plan(facts, numbers, [0])
    assert answer.cost >= ForwardSearch(problem).plan(facts, numbers, [0]).cost
    assert true_in(problem.goals[0].condition, execute(problem, facts, numbers, answer.actions))


@pytest.mark.extra
def test_the_robot_model_goes_to_pddl():
    pytest.importorskip("unified_planning")
    from unified_planning.io import PDDLReader

    from selforg.network.planning.pddl import environment, write_pddl

    texts = write_pddl(robot_problem(), *robot_state("garbage_seen", avoidance=0.123456789), (0, 1, 2))
    again = PDDLReader(environment()).parse_problem_string(*texts)
    assert [action.name.lower() for action in again.actions] == [one.name.lower() for one in robot_problem().actions]
    assert [str(fluent) for fluent, value in again.explicit_initial_values.items() if value.is_true()] == [
        "garbage_seen"
    ]


@pytest.mark.extra
def test_an_engine_takes_the_place_of_the_built_in_search():
    pytest.importorskip("up_aries")
    from selforg.network.planning.pddl import EngineSearch
    from selforg.network.planning.search import plan_by_priority

    problem = robot_problem()
    facts, numbers = robot_state("carrying", "garbage_found", "rep_bool", avoidance=0.7)
    search = EngineSearch(problem, "aries")
    answer = plan_by_priority(search, search.read_state(facts, numbers), (0, 1, 2))
    assert answer.goals == (0, 1, 2)
    world = execute(problem, facts, numbers, answer.outcome.actions)
    assert all(true_in(goal.condition, world) for goal in problem.goals)
