"""Plans for numbers that are only used up: the same as without the shortcut, and the same in the whole class."""

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.model.activators import Boolean, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from selforg.network.planning.problem import (
    PlanningGoal,
    PlanningProblem,
    all_of,
    fact_is,
    number_is,
    planning_action,
)
from selforg.network.planning.search import ForwardSearch, Plan, plan_by_priority
from selforg.network.planning.spending import SpendingSearch, spent_numbers
from selforg.network.planning.task import PlanTask

FACTS = 4


def drawn_problem(chance, above=True):
    """Return a random problem whose one number is lowered and asked to be high, or the mirror image of it."""
    sign, relation = (-1.0, ">=") if above else (1.0, "<=")
    actions = []
    for name in range(5):
        pre = [fact_is(int(fact), bool(chance.integers(2))) for fact in chance.choice(FACTS, chance.integers(3), False)]
        if chance.random() < 0.7:
            pre.append(number_is(0, relation, -sign * 0.5 * float(chance.integers(4))))
        effects = [(int(fact), bool(chance.random() < 0.7)) for fact in chance.choice(FACTS, 2, False)]
        if chance.random() < 0.7:
            effects.append((0, sign * 0.5 * float(chance.integers(1, 4))))
        actions.append(planning_action(f"a{name}", tuple(pre), tuple(effects), float(chance.integers(1, 4))))
    goals = [
        PlanningGoal(
            f"g{k}", all_of((fact_is(k), number_is(0, relation, -sign * 0.5 * float(chance.integers(3))))), k + 1
        )
        for k in range(2)
    ]
    return PlanningProblem(tuple(f"f{k}" for k in range(FACTS)), ("fuel",), tuple(actions), tuple(goals))


def spent_of(problem):
    return spent_numbers(PlanTask(problem.actions, all_of(g.condition for g in problem.goals), 1))


@pytest.mark.parametrize("above", [True, False])
def test_plans_are_those_of_the_whole_search_and_hold_for_their_class(above):
    chance = np.random.default_rng(5)
    plans = shared = 0
    for _ in range(60):
        problem = drawn_problem(chance, above)
        spent = spent_of(problem)
        search, whole = SpendingSearch(problem, ForwardSearch, spent), ForwardSearch(problem)
        facts = chance.random(FACTS) < 0.4
        for reach in (0, 2):
            of_class = None
            for reading in np.arange(-0.6, 9.0, 0.3):
                numbers = np.array([reading if above else -reading])
                plan, is_of_class = search.plan(facts, numbers, (0, 1), reach)
                assert plan == plan_by_priority(whole, whole.read_state(facts, numbers), (0, 1))
                plans += isinstance(plan.outcome, Plan)
                clamped = tuple(number.clamped(round(numbers[0] * 1e9), reach) for number in spent)
                beyond = spent and clamped != (round(numbers[0] * 1e9),)
                if beyond and is_of_class:
                    assert of_class in (None, plan)
                    of_class = plan
                    shared += 1
    assert plans > 500
    assert shared > 500


def test_numbers_that_are_filled_up_or_asked_to_be_low_are_not_spent():
    use = planning_action("use", (number_is(0, ">=", 1.0),), ((0, -1.0), (0, True)))
    fill = planning_action("fill", (), ((0, 1.0),))
    empty = PlanningGoal("empty", number_is(0, "<=", 0.0))
    done = PlanningGoal("done", fact_is(0))
    (spent,) = spent_of(PlanningProblem(("done",), ("fuel",), (use,), (done,)))
    assert (spent.above, spent.edge, spent.grid) == (True, 10**9, 10**9)
    assert not spent_of(PlanningProblem(("done",), ("fuel",), (use, fill), (done,)))
    assert not spent_of(PlanningProblem(("done",), ("fuel",), (use,), (done, empty)))


def chain_model(length):
    """Return a model whose plan has `length` behaviours, each of which takes 1 of the fuel."""
    facts = [f"done{k}" for k in range(length)]
    behaviours = []
    for k, fact in enumerate(facts):
        pre = [Condition("fuel", Threshold(1.0))]
        pre += [Condition(facts[k - 1], Boolean())] if k else []
        behaviours.append(Behaviour(f"Do{k}", pre, [Effect(fact, 1.0), Effect("fuel", -1.0)]))
    sensors = [*(Sensor(fact, "fact") for fact in facts), Sensor("fuel")]
    return NetworkModel(sensors, behaviours, [Goal("Done", [Condition(facts[-1], Boolean())])])


@pytest.mark.parametrize("readings", [[9.0, 2.5, 3.0, 0.5, 2.0, 4.9], [0.5, 2.0, 2.5, 3.0, 4.9, 9.0]])
def test_a_network_remembers_no_further_than_the_fuel_lasts(readings):
    network = BehaviourNetwork(chain_model(3), len(readings), Planner(chain_model(3)))
    network.readings[:, -1] = readings
    for _ in range(4):  # the memory is widened, and what it then holds is asked
        network.state.plan_marks[:, st.PLAN_ALARM] = 1
        network.step()
        np.testing.assert_array_equal(network.state.plan_marks[:, st.PLAN_KNOWN], np.array(readings) >= 3.0)
    assert network.planner.memory.reach > 0
