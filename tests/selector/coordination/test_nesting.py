import pytest

from selector.coordination.robot_network import RobotNetwork
from selforg.network.model.activators import Boolean
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel

A, B, C = (Sensor(name, "fact") for name in "abc")
STEADY = NetworkSettings(activation_threshold=0.5, threshold_decay=1.0)


def needs(sensor, value=True):
    return Condition(sensor.name, Boolean(value))


def network(sensors, behaviours):
    return NetworkModel(sensors, behaviours, [Goal("g", (needs(sensors[0]),))], STEADY)


INNERMOST = RobotNetwork(network([C], [Behaviour("x", (needs(C),)), Behaviour("y", (needs(C, False),))]))
MIDDLE = RobotNetwork(network([B, C], [Behaviour("deep", (needs(B),)), Behaviour("flat")]), {"deep": INNERMOST})
OUTER = RobotNetwork(network([A, B, C], [Behaviour("hold", (needs(A),)), Behaviour("free")]), {"hold": MIDDLE})


@pytest.mark.parametrize(
    ("holder", "inner", "message"),
    [
        ("holds", INNERMOST, r"network in behaviour 'holds': unknown behaviour 'holds' \(known: hold, free;"),
        ("hold", RobotNetwork(network([Sensor("d", "fact")], ())), "in behaviour 'hold': unknown sensor 'd'"),
        (
            "hold",
            RobotNetwork(NetworkModel([Sensor("a")], (), ())),
            "in behaviour 'hold': sensor 'a' is a number, outside a fact",
        ),
    ],
)
def test_a_wrong_nesting_says_where(holder, inner, message):
    with pytest.raises(ValueError, match=message):
        RobotNetwork(OUTER.model, {holder: inner})
