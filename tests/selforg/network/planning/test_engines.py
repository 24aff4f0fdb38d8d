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
from selforg.network.planning.search import ForwardSearch, Plan, Unknown, Unsolvable
from tests.selforg.network.planning.generated_problems import generated
from tests.selforg.network.planning.planner_reference import execute, true_in
from tests.selforg.network.planning.robot_problem import robot_problem, robot_state

SOLVABLE, UNSOLVABLE = 38, 12
LONGEST_HORIZON = 6
"""Steps that the other engine, which is no friend of long plans, has to look ahead at most."""
UNSOLVABLE_HORIZON = 4
"""Steps up to which the other engine proves that there is no plan."""


def horizon(problem, answer):
    """Return the most steps that a plan can have that costs no more: none costs less than its cheapest action."""
    return int(answer.cost * STEPS_PER_UNIT / min(action.cost for action in problem.actions))


def chosen():
    """Return the seeds of the first problems of each kind that are small enough for the other engine."""
    solvable, unsolvable = [], []
    seed = 0
    while len(solvable) < SOLVABLE or len(unsolvable) < UNSOLVABLE:
        problem, facts, numbers = generated(seed)
        answer = ForwardSearch(problem, node_limit=1000).plan(facts, numbers, [0])
        if isinstance(answer, Unsolvable):
            unsolvable.append(seed)
        elif isinstance(answer, Plan) and horizon(problem, answer) <= LONGEST_HORIZON:
            solvable.append(seed)
        seed += 1
    return [*solvable[:SOLVABLE], *unsolvable[:UNSOLVABLE]]


SEEDS = chosen()


def outcome(seed):
    problem, facts, numbers = generated(seed)
    return ForwardSearch(problem).plan(facts, numbers, [0])


def test_the_generated_problems_are_a_mixture():
    outcomes = [outcome(seed) for seed in SEEDS]
    lengths = [len(answer.actions) for answer in outcomes if isinstance(answer, Plan)]
    assert sum(length >= 3 for length in lengths) >= 15
    assert sum(bool(generated(seed)[0].numbers) for seed in SEEDS) >= 15
    assert sum(not generated(seed)[0].numbers for seed in SEEDS) >= 15


def test_a_number_that_nothing_changes_keeps_only_the_truth_of_its_bounds():
    pytest.importorskip("up_aries")
    from tests.selforg.network.planning import aries_horizon

    go = planning_action("go", (number_is(0, ">=", 0.25), number_is(0, "<", 0.75)), ((0, True),))
    search = ForwardSearch(PlanningProblem(("done",), ("x",), (go,), (PlanningGoal("done", fact_is(0)),)))
    for reading, expected in ((0.25, (0,)), (0.75, None), (-3.0, None)):
        assert aries_horizon.best_plan(search, np.array([False]), np.array([reading]), (0,), 1) == expected


@pytest.mark.parametrize("seed", SEEDS)
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


def test_an_engine_without_an_answer_in_time_says_so():
    pytest.importorskip("up_aries")
    from selforg.network.planning.pddl import EngineSearch

    problem = PlanningProblem(
        ("a",), ("x",), (planning_action("up", (), ((0, 1.0),)),), (PlanningGoal("a", fact_is(0)),)
    )
    answer = EngineSearch(problem, "aries", timeout=1.0).plan(np.array([False]), np.array([0.0]), [0])
    assert isinstance(answer, Unknown | Unsolvable)


def test_unknown_engines_list_the_installed():
    pytest.importorskip("unified_planning")
    from selforg.network.planning.pddl import EngineSearch

    with pytest.raises(ValueError, match=r"unknown planning engine 'ares' \(installed: .*sequential_simulator"):
        EngineSearch(robot_problem(), "ares")
