"""The built-in planner against planners of others (extra `planning`, engine `up-aries`)."""

import numpy as np
import pytest

from selforg.network.planning.engines.whole_numbers import in_whole_numbers
from selforg.network.planning.problem import (
    ChangeNumber,
    FactIs,
    NumberIs,
    PlanningAction,
    PlanningGoal,
    PlanningProblem,
    SetFact,
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
    return int(answer.cost / min(action.cost for action in problem.actions))


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


@pytest.mark.parametrize("seed", SEEDS)
def test_counting_grid_steps_changes_no_plan(seed):
    problem, facts, numbers = generated(seed)
    search = ForwardSearch(problem)
    counted, readings = in_whole_numbers(problem, search.read_state(facts, numbers))
    answer = ForwardSearch(counted).plan(facts, np.array(readings, dtype=float), [0])
    expected = search.plan(facts, numbers, [0])
    assert getattr(answer, "actions", answer) == getattr(expected, "actions", expected)


def test_a_number_that_nothing_changes_keeps_only_the_truth_of_its_bounds():
    problem = PlanningProblem(
        ("done",),
        ("x",),
        (PlanningAction("go", (NumberIs(0, ">=", 0.25), NumberIs(0, "<", 0.75)), (SetFact(0),)),),
        (PlanningGoal("done", FactIs(0)),),
    )
    for reading, expected in ((0.25, Plan((0,), 1.0)), (0.75, Unsolvable()), (-3.0, Unsolvable())):
        state = ForwardSearch(problem).read_state(np.array([False]), np.array([reading]))
        counted, readings = in_whole_numbers(problem, state)
        assert ForwardSearch(counted).plan(np.array([False]), np.array(readings, float), [0]) == expected


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
    assert sum(problem.actions[index].cost for index in other) == answer.cost
    world = execute(problem, facts, numbers, other)
    assert true_in(problem.goals[0].condition, world)


@pytest.mark.parametrize("seed", SEEDS)
def test_pddl_written_and_read_back_has_the_same_plan(seed):
    pytest.importorskip("unified_planning")
    from selforg.network.planning.engines.pddl import read_pddl
    from selforg.network.planning.engines.unified import write_pddl

    problem, facts, numbers = generated(seed)
    again, start = read_pddl(*write_pddl(problem, facts, numbers, [0]))
    answer, expected = ForwardSearch(again).plan(*start, [0]), ForwardSearch(problem).plan(facts, numbers, [0])
    if isinstance(expected, Plan):
        assert [again.actions[index].name for index in answer.actions] == [
            problem.actions[index].name for index in expected.actions
        ]
    assert getattr(answer, "cost", answer) == getattr(expected, "cost", expected)


def test_the_robot_model_goes_to_pddl_and_back():
    pytest.importorskip("unified_planning")
    from selforg.network.planning.engines.pddl import read_pddl
    from selforg.network.planning.engines.unified import write_pddl

    state = robot_state("garbage_seen", "garbage_found", "rep_bool", avoidance=0.123456789)
    domain, text = write_pddl(robot_problem(), *state, [0, 1, 2])
    assert "(:action MoveToGarbage" in domain or "(:action movetogarbage" in domain
    assert "0.123456789" in text
    again, start = read_pddl(domain, text)
    answer = ForwardSearch(again).plan(*start, [0])
    names = [again.actions[index].name.lower() for index in answer.actions]
    chain = "movetogarbage pickgarbage movetorecycling recycle movetodump dump patrol avoid"
    assert names == chain.split()


def test_an_engine_takes_the_place_of_the_built_in_search():
    pytest.importorskip("up_aries")
    from selforg.network.planning.engines.engine import EngineSearch
    from selforg.network.planning.priorities import plan_by_priority

    problem = robot_problem()
    facts, numbers = robot_state("carrying", "garbage_found", "rep_bool", avoidance=0.7)
    search = EngineSearch(problem, "aries")
    answer = plan_by_priority(search, search.read_state(facts, numbers), (0, 1, 2))
    assert answer.goals == (0, 1, 2)
    world = execute(problem, facts, numbers, answer.outcome.actions)
    assert all(true_in(goal.condition, world) for goal in problem.goals)


def test_an_engine_without_an_answer_in_time_says_so():
    pytest.importorskip("up_aries")
    from selforg.network.planning.engines.engine import EngineSearch

    problem = PlanningProblem(
        ("a",), ("x",), (PlanningAction("up", (), (ChangeNumber(0, 1.0),)),), (PlanningGoal("a", FactIs(0)),)
    )
    answer = EngineSearch(problem, "aries", timeout=1.0).plan(np.array([False]), np.array([0.0]), [0])
    assert isinstance(answer, Unknown | Unsolvable)


def test_unknown_engines_list_the_installed():
    pytest.importorskip("unified_planning")
    from selforg.network.planning.engines.engine import EngineSearch

    with pytest.raises(ValueError, match=r"unknown planning engine 'ares' \(installed: .*sequential_simulator"):
        EngineSearch(robot_problem(), "ares")


PDDL = """
(define (domain rover) (:requirements :strips :typing :negative-preconditions :numeric-fluents)
  (:types place) (:predicates (at ?p - place) (road ?a ?b - place)) (:functions (charge))
  (:action drive :parameters (?a ?b - place)
    :precondition (and (at ?a) (road ?a ?b) (>= (charge) 2))
    :effect (and (not (at ?a)) (at ?b) (decrease (charge) 2)))
  (:action load :parameters () :precondition () :effect (increase (charge) 1)))
"""
START = """
(define (problem trip) (:domain rover) (:objects one two three - place)
  (:init (at one) (road one two) (road two three) (= (charge) 3)) (:goal (at three)))
"""


def test_pddl_of_others_with_parameters_is_grounded_and_solved():
    pytest.importorskip("unified_planning")
    from selforg.network.planning.engines.pddl import read_pddl

    problem, start = read_pddl(PDDL, START)
    answer = ForwardSearch(problem).plan(*start, [0])
    assert [problem.actions[index].name for index in answer.actions].count("load") == 1
    assert answer.cost == 3.0


def test_pddl_beyond_facts_and_constants_is_refused():
    pytest.importorskip("unified_planning")
    from selforg.network.planning.engines.pddl import read_pddl

    domain = PDDL.replace("(increase (charge) 1)", "(assign (charge) 9)")
    with pytest.raises(ValueError, match="action 'load': expected an increase or a decrease of 'charge'"):
        read_pddl(domain, START)
