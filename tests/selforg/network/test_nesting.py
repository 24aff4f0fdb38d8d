import numpy as np
import pytest

from selforg.network.model.activators import Boolean
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.nesting import NestedModel, NestedNetwork

A, B, C = (Sensor(name, "fact") for name in "abc")
STEADY = NetworkSettings(activation_threshold=0.5, threshold_decay=1.0)


def needs(sensor, value=True):
    return Condition(sensor.name, Boolean(value))


def network(sensors, behaviours):
    return NetworkModel(sensors, behaviours, [Goal("g", (needs(sensors[0]),))], STEADY)


INNERMOST = NestedModel(network([C], [Behaviour("x", (needs(C),)), Behaviour("y", (needs(C, False),))]))
MIDDLE = NestedModel(network([B, C], [Behaviour("deep", (needs(B),)), Behaviour("flat")]), {"deep": INNERMOST})
OUTER = NestedModel(network([A, B, C], [Behaviour("hold", (needs(A),)), Behaviour("free")]), {"hold": MIDDLE})


def running(nested):
    return {"/".join(path): rows.tolist() for path, rows in nested.running()}


def stepped(nested, a, b, c):
    nested.network.readings[:] = np.array([a, b, c], dtype=float).T
    nested.step()
    return running(nested)


def test_what_runs_inside_runs_only_while_its_holder_does():
    nested = NestedNetwork(OUTER, 3)
    found = stepped(nested, [1, 1, 0], [1, 0, 1], [0, 1, 1])
    assert found == {"hold": [0, 1], "free": [0, 1, 2], "hold/deep": [0], "hold/flat": [0, 1], "hold/deep/y": [0]}
    found = stepped(nested, [0, 1, 0], [1, 1, 1], [0, 1, 1])
    assert found == {"hold": [1], "free": [0, 1, 2], "hold/deep": [1], "hold/flat": [1], "hold/deep/x": [1]}
    assert stepped(nested, [0, 0, 0], [1, 1, 1], [0, 1, 1]) == {"free": [0, 1, 2]}


def test_rows_are_independent():
    rng = np.random.default_rng(3)
    life = (rng.random((30, 4, 3)) < 0.6).astype(float)
    together, order = NestedNetwork(OUTER, 4), [2, 0, 3, 1]
    permuted = NestedNetwork(OUTER, 4)
    for now in life:
        together.network.readings[:], permuted.network.readings[:] = now, now[order]
        together.step()
        permuted.step()
        expected = {path: sorted(order.index(row) for row in rows) for path, rows in running(together).items()}
        assert running(permuted) == expected


def test_only_the_rows_asked_for_decide_and_reset_begins_anew():
    nested = NestedNetwork(OUTER, 3)
    nested.network.readings[:] = 1.0
    nested.step(np.array([1]))
    assert running(nested) == {"hold": [1], "free": [1], "hold/deep": [1], "hold/flat": [1], "hold/deep/x": [1]}
    nested.reset(np.array([1]))
    assert running(nested) == {}


def test_with_planners_the_inner_network_follows_a_plan_of_its_own():
    inner = NestedModel(network([B], [Behaviour("make b", (), (Effect("b", 1.0),))]))
    outer = NestedModel(network([A, B], [Behaviour("hold", (), (Effect("a", 1.0),))]), {"hold": inner})
    nested = NestedNetwork(outer, 1, planned=True)
    nested.step()
    assert running(nested) == {"hold": [0], "hold/make b": [0]}
    assert nested.inner["hold"].network.plans.steps[0, 0] == 0


@pytest.mark.parametrize(
    ("holder", "inner", "message"),
    [
        ("holds", INNERMOST, r"network in behaviour 'holds': no such behaviour \(known: hold, free\)"),
        ("hold", NestedModel(network([Sensor("d", "fact")], ())), "in behaviour 'hold': unknown sensor 'd'"),
        (
            "hold",
            NestedModel(NetworkModel([Sensor("a")], (), ())),
            "in behaviour 'hold': sensor 'a' is a number, outside a fact",
        ),
    ],
)
def test_a_wrong_nesting_says_where(holder, inner, message):
    with pytest.raises(ValueError, match=message):
        NestedModel(OUTER.model, {holder: inner})
