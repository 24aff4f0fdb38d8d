import pytest

from selforg.network.model.activators import Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, leaves
from selforg.network.model.model import NetworkModel

SENSORS = (Sensor("door", "fact"), Sensor("distance"))
OPEN, NEAR = Condition("door", Boolean()), Condition("distance", Linear(5.0, 1.0))


THROUGH = Goal("through", (OPEN,))


def build(sensors=SENSORS, behaviours=(), goals=(THROUGH,)):
    return NetworkModel(sensors, behaviours, goals)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"sensors": (*SENSORS, Sensor("door"))}, "sensor names must be unique, got more than once: door"),
        ({"behaviours": (Behaviour("go"), Behaviour("go"))}, "behaviour names must be unique, got more than once: go"),
        ({"goals": (Goal("g", (OPEN,)), Goal("g", (NEAR,)))}, "goal names must be unique, got more than once: g"),
        (
            {"behaviours": (Behaviour("go", (Condition("dor", Boolean()),)),)},
            r"behaviour 'go': unknown sensor 'dor' \(known: door, distance\)",
        ),
        (
            {"behaviours": (Behaviour("go", effects=(Effect("x", 1.0),)),)},
            r"behaviour 'go': unknown sensor 'x' \(known: door, distance\)",
        ),
        ({"goals": (Goal("g", (Condition("y", Boolean()),)),)}, "goal 'g': unknown sensor 'y'"),
        (
            {"goals": (Goal("g", (Negation(Condition("distance", Boolean())),)),)},
            r"goal 'g': Boolean does not fit sensor 'distance' \(a number\)",
        ),
        (
            {"behaviours": (Behaviour("go", (Conjunction(OPEN, Condition("door", Linear(0.0, 1.0))),)),)},
            r"behaviour 'go': Linear does not fit sensor 'door' \(a fact\)",
        ),
        (
            {"goals": (Goal("g", (Condition("door", Greedy()),)),)},
            r"goal 'g': Greedy does not fit sensor 'door' \(a fact\)",
        ),
    ],
)
def test_a_wrong_model_says_where(parts, message):
    with pytest.raises(ValueError, match=message):
        build(**parts)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Linear(2.0, 2.0), "Linear: expected different readings zero and full, got 2.0"),
        (lambda: Boolean(low=0.6, high=0.5), "Boolean: expected 0 <= low <= high <= 1, got 0.6 and 0.5"),
        (lambda: Threshold(1.0, high=1.5), "Threshold: expected 0 <= low <= high <= 1"),
        (Conjunction, "Conjunction: expected at least one condition"),
        (Disjunction, "Disjunction: expected at least one condition"),
        (lambda: Goal("g", ()), "goal 'g': expected at least one condition"),
        (lambda: Behaviour("b", ready_threshold=1.2), r"behaviour 'b': ready_threshold must lie in \[0, 1\], got 1.2"),
        (lambda: Behaviour("b", timeout=-1), "behaviour 'b': timeout must be >= 0 steps or None, got -1"),
        (lambda: Behaviour("b", cost=0.0), "behaviour 'b': cost must be positive and finite, got 0.0"),
        (lambda: NetworkSettings(threshold_decay=0.0), r"threshold_decay must lie in \(0, 1\], got 0.0"),
        (lambda: NetworkSettings(activation_decay=1.1), r"activation_decay must lie in \[0, 1\], got 1.1"),
        (lambda: NetworkSettings(max_parallel=0), "max_parallel must be at least 1 or None, got 0"),
        (lambda: NetworkSettings(activation_threshold=float("inf")), "activation_threshold must be finite, got inf"),
        (lambda: Sensor("s", "boolean"), "sensor 's': kind must be one of fact, number, got 'boolean'"),
        (lambda: Effect("s", float("nan")), "effect on 's': expected a finite change, got nan"),
        (lambda: NetworkSettings(algorithm="maes"), "algorithm must be one of default, uniform, got 'maes'"),
    ],
)
def test_a_wrong_part_says_what(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_equal_and_threshold_may_look_at_a_fact():
    build(goals=(Goal("g", (Condition("door", Equal(0.0)), Condition("door", Threshold(0.5)))),))


def test_an_effect_larger_than_one_is_warned_of():
    with pytest.warns(UserWarning, match="behaviour 'go': effect 1.5 on 'distance' is larger than 1"):
        build(behaviours=(Behaviour("go", effects=(Effect("distance", 1.5),)),))


def test_leaves_carry_the_directions_of_the_negations_above_them():
    far = Condition("distance", Threshold(3.0))
    tree = Negation(Conjunction(OPEN, NEAR, Negation(far)))
    assert [(leaf.condition, leaf.directions) for leaf in leaves(tree)] == [
        (OPEN, (-1.0,)),
        (NEAR, (1.0,)),  # the direction of the last condition on that sensor counts for both
        (far, (-1.0, 1.0)),
    ]
