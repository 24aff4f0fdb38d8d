"""The built-in planner against planners of others (extra `planning`, engine `up-aries`)."""

import numpy as np
import pytest

from selforg.network.planning.problem import (
    STEPS_PER_UNIT,
    PlanningGoal,
    PlanningProblem,
    fact_is,
    number_is,
    planning_action,
)
from selforg.network.planning.search import ForwardSearch, Unknown, Unsolvable
from tests.selforg.network.planning.generated_problems import generated
from tests.selforg.network.planning.planner_reference import execute, true_in
from tests.selforg.network.planning.robot_problem import robot_problem, robot_state

SOLVABLE = (
    *(1, 2, 4, 6, 8, 9, 10, 11, 12, 13, 15, 17, 18, 19, 21, 22, 23, 26, 27, 29),
    *(30, 31, 33, 34, 35, 36, 37, 38, 39, 42, 43, 46, 47, 48, 49, 50, 51, 53),
)
"""Seeds of the first problems that have a plan of few steps: the other engine is no friend of long plans."""
UNSOLVABLE = (7, 14, 16, 24, 59, 64, 67, 70, 79, 80, 87, 96)
UNSOLVABLE_HORIZON = 4
"""Steps up to which the other engine proves that there is no plan."""


def horizon(problem, answer):
    """Return the most steps that a plan can have that costs no more: none costs less than its cheapest action."""
    return int(answer.cost * STEPS_PER_UNIT / min(action.cost for action in problem.actions))


def outcome(seed):
    problem, facts, numbers = generated(seed)
    return ForwardSearch(problem).plan(facts, numbers, [0])


def test_the_generated_problems_are_a_mixture():
    assert all(isinstance(outcome(seed), Unsolvable) for seed in UNSOLVABLE)
    assert sum(len(outcome(seed).actions) >= 3 for seed in SOLVABLE) >= 15
    assert 15 <= sum(bool(generated(seed)[0].numbers) for seed in (*SOLVABLE, *UNSOLVABLE)) <= 35


@pytest.mark.extra
def test_a_number_that_nothing_changes_keeps_only_the_truth_of_its_bounds():
    pytest.importorskip("up_aries")
    from tests.selforg.network.planning import aries_horizon

    go = planning_action("go", (number_is(0, ">=", 0.25), number_is(0, "<", 0.75)), ((0, True),))
    search = ForwardSearch(PlanningProblem(("done",), ("x",), (go,), (PlanningGoal("done", fact_is(0)),)))
    for reading, expected in ((0.25, (0,)), (0.75, None), (-3.0, None)):
        assert aries_horizon.best_plan(search, np.array([False]), np.array([reading]), (0,), 1) == expected


@pytest.mark.extra
@pytest.mark.parametrize("seed", [*SOLVABLE, *UNSOLVABLE])
def test_costs_are_those_of_an_optimal_engine(seed):
    pytest.importorskip("up_aries")
    from tests.selforg.network.planning import aries_horizon

    problem, facts, numbers = generated(seed)
    search = ForwardSearch(problem)
    answer = search.plan(facts, numbers, [0])
    if isinstance(answer, Unsolvable):
        assert aries_horizon.best_plan(search, facts, numbers, [0], UNSOLVABLE_HORIZON) is None
        return
    other = aries_horizon.best_plan(search, facts, numbers, [0], horizon(problem, answer))
    assert sum(problem.actions[index].cost for index in other) == answer.cost * STEPS_PER_UNIT
    world = execute(problem, facts, numbers, other)
    assert true_in(problem.goals[0].condition, world)


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


@pytest.mark.extra
def test_an_engine_without_an_answer_in_time_says_so():
    pytest.importorskip("up_aries")
    from selforg.network.planning.pddl import EngineSearch

    problem = PlanningProblem(
        ("a",), ("x",), (planning_action("up", (), ((0, 1.0),)),), (PlanningGoal("a", fact_is(0)),)
    )
    answer = EngineSearch(problem, "aries", timeout=1.0).plan(np.array([False]), np.array([0.0]), [0])
    assert isinstance(answer, Unknown | Unsolvable)
