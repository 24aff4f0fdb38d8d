"""Whole robots made of components: go to a goal, keep apart, find out who is the highest."""

import numpy as np
import pytest

from selforg.components import (
    Act,
    GoalDistance,
    GoalPresent,
    GoalReached,
    GoalSource,
    Known,
    Move,
    MovementSource,
    OrganisedRobots,
    RobotMemory,
    SetState,
    VectorLength,
    VectorPresent,
)
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, RepulsionGradient
from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from selforg.space import Euclidean
from tests.selforg.programs import Alone

STARTS = np.array([[0.0, 0.0], [0.6, 0.1], [0.0, 4.0], [0.5, 4.5]])
PERIOD = 0.2


def facts(*names):
    return [Sensor(name, "fact") for name in names]


def yes(name, wanted=True):
    return Condition(name, Boolean(wanted))


def traveller_model():
    """Keep apart if need be, else go to the goal; when there, say so once."""
    return NetworkModel(
        [*facts("near", "goal", "there", "told"), Sensor("far"), Sensor("pushed")],
        [
            Behaviour("Go", (yes("goal"), yes("there", False)), (Effect("there", 1.0), Effect("far", -1.0))),
            Behaviour("Avoid", (yes("near"),), (Effect("near", -1.0), Effect("pushed", -1.0))),
            Behaviour("Tell", (yes("there"), yes("told", False)), (Effect("told", 1.0),)),
        ],
        [
            Goal("arrive", (yes("told"), Condition("far", Linear(10.0, 0.0)))),
            Goal("apart", (yes("near", False),)),
        ],
        NetworkSettings(max_parallel=1),
    )


def travellers(starts):
    rows = len(starts)
    poses = OwnPoses(Euclidean(2), rows, goal_radius=0.25, diffusion=0.5)
    buffer = SoBuffer(BufferSettings(view_distance=20.0), poses.space, poses)
    poses.update(starts, np.zeros(rows), 0.0)
    buffer.store_static(0, "goal", np.array([[8.0, 2.0]]), 0.0, diffusion=20.0, goal_radius=1.5)
    push = MovementSource(RepulsionGradient(poses))
    goal = GoalSource(buffer)
    memory = RobotMemory(rows, {"told": False})
    model = traveller_model()
    robots = OrganisedRobots(
        BehaviourNetwork(model, rows, Planner(model)),
        {
            "near": VectorPresent(push, longer_than=0.05),
            "pushed": VectorLength(push),
            "goal": GoalPresent(goal),
            "there": GoalReached(goal),
            "far": GoalDistance(goal, unseen=20.0),
            "told": Known(memory["told"]),
        },
        {
            "Go": Move(MovementSource(ChemotaxisBalch(buffer, channels=("goal",), min_speed=0.5))),
            "Avoid": Move(push),
            "Tell": SetState(memory["told"], True),
        },
    )
    return poses, robots, memory


def travel(starts, ticks=300):
    poses, organised, memory = travellers(starts)
    robots = Alone(organised)
    positions, course = starts.copy(), []
    for tick in range(1, ticks + 1):
        now = tick * PERIOD
        poses.update(positions, np.zeros(len(starts)), now)
        positions = positions + robots.tick(now).vectors * PERIOD
        course.append(positions)
    return np.array(course), memory


def test_travellers_arrive_and_say_so():
    course, memory = travel(STARTS)
    assert memory["told"].values.tolist() == [1.0] * 4
    assert (np.linalg.norm(course[-1] - [8.0, 2.0], axis=1) < 2.5).all()


def test_the_order_of_the_robots_does_not_matter():
    order = np.array([2, 0, 3, 1])
    straight, _ = travel(STARTS, 100)
    permuted, _ = travel(STARTS[order], 100)
    np.testing.assert_allclose(permuted, straight[:, order], atol=1e-9)


def test_a_lone_robot_does_as_one_far_from_the_others():
    far = np.vstack([STARTS[:1], [[500.0, 500.0]]])
    together, _ = travel(far, 60)
    alone, _ = travel(STARTS[:1], 60)
    np.testing.assert_array_equal(together[:, :1], alone)


def test_only_the_rows_asked_for_act():
    _, robots, _ = travellers(STARTS)
    commands = Alone(robots).tick(0.2, np.array([2]))
    assert not commands.commanded[[0, 1, 3]].any()
    assert (robots.network.readings[[0, 1, 3]] == 0.0).all()


def test_a_host_function_is_called_when_its_behaviour_starts():
    called = []
    model = NetworkModel(
        facts("wanted"), [Behaviour("Do", (yes("wanted"),))], [], NetworkSettings(activation_threshold=0.5)
    )
    robots = OrganisedRobots(
        BehaviourNetwork(model, 3), {}, {"Do": Act(lambda now, rows: called.append((now, rows.tolist())))}
    )
    robots.network.readings[1, 0] = 1.0
    alone = Alone(robots)
    alone.tick(0.2)
    alone.tick(0.4)
    assert called == [(0.2, [1])]


@pytest.mark.parametrize(
    ("sensors", "actions", "message"),
    [
        ({"far": "told"}, {}, "sensor 'far' is a number, but Known reads a fact"),
        ({"fare": "told"}, {}, "sensor component: unknown sensor 'fare'"),
        ({}, {"Goo": Act(print)}, r"action: unknown behaviour 'Goo' \(known: Go, Avoid, Tell\)"),
    ],
)
def test_components_that_do_not_fit_are_refused(sensors, actions, message):
    known = Known(RobotMemory(1, {"told": False})["told"])
    with pytest.raises(ValueError, match=message):
        OrganisedRobots(BehaviourNetwork(traveller_model(), 1), dict.fromkeys(sensors, known), actions)
