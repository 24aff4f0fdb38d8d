"""A network inside a behaviour of a robot's document: it senses, decides and acts while the behaviour runs."""

import copy
from functools import partial

import numpy as np
import pytest
import yaml

from selector.configurations.host import Host, host_memory
from selector.coordination.robot_document import network_from
from selector.coordination.robots import CoordinatedRobots
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.space import Euclidean
from tests.selector.changes import changed as changed_in
from tests.selector.refusing import refusal

TEXT = """
root: robot
networks:
  robot:
    sensors: {wanted: fact, charge: number}
    conditions:
      wanted: {sensor: wanted, activator: {type: Boolean}}
    behaviours:
      Tidy: {preconditions: [wanted], effects: [{sensor: wanted, change: -1.0}], network: tidy}
      Rest: {preconditions: [{type: Negation, of: wanted}], effects: [{sensor: charge, change: 1.0}]}
    goals:
      Done: {conditions: [{type: Negation, of: wanted}, {sensor: charge, activator: {type: Greedy}}]}
    settings: {activation_threshold: 0.5}
  tidy:
    mechanisms:
      go: {type: ChemotaxisBalch, parameters: {channels: [goal], min_speed: 0.5}}
    targets: {goal: {channels: [goal]}}
    knowledge: {told: false}
    expects: {measured: number}
    sensors:
      charge: number
      seen: {type: GoalPresent, target: goal}
      told: {type: Known, name: told}
    behaviours:
      Go:
        action: {type: Move, mechanism: go}
        preconditions: [{sensor: seen, activator: {type: Boolean}}]
      Call:
        action: {type: Act, call: ring}
        preconditions: [{sensor: charge, activator: {type: Threshold, threshold: 5.0}}]
        network: deep
  deep:
    sensors: {told: fact}
    behaviours:
      Say: {action: {type: Act, call: say}, preconditions: [{sensor: told, activator: {type: Boolean, desired: false}}]}
"""


CONTENT = yaml.safe_load(TEXT)
changed = partial(changed_in, CONTENT)


def robots_of(rows=3, document=None):
    """Return robots on a line of which the first two see the goal, with what they called."""
    network = network_from(document or CONTENT)
    poses = OwnPoses(Euclidean(2), rows)
    poses.update(np.array([[0.0, 0.0], [1.0, 0.0], [90.0, 0.0]])[:rows], np.zeros(rows), 0.1)
    gradients = SoBuffer(BufferSettings(), poses.space, poses)
    gradients.store_static(0, "goal", np.array([[4.0, 0.0]]), 0.0, diffusion=6.0)
    called = []
    calls = {name: lambda now, rows, name=name: called.append((name, rows.tolist())) for name in ("ring", "say")}
    host = Host(poses, {"gradients": gradients}, memory=host_memory(network.all_specs(), rows), calls=calls)
    return CoordinatedRobots([], host, network=network, explained=True), called


def readings(robots, wanted, charge):
    robots.network.readings[:, 0], robots.network.readings[:, 1] = wanted, charge


def running(robots):
    """Return the rows in which each behaviour inside runs."""
    return {
        f"{inner.name}/{behaviour.name}": np.flatnonzero(inner.network.executing[:, b]).tolist()
        for inner in robots.inner
        for b, behaviour in enumerate(inner.network.model.behaviours)
    }


def test_what_lies_in_a_behaviour_senses_and_acts_while_it_runs():
    robots, called = robots_of()
    readings(robots, [1, 0, 1], [9.0, 9.0, 0.0])
    commands = robots.tick(0.2)
    assert running(robots) == {"Tidy/Go": [0], "Tidy/Call": [0], "Tidy/Call/Say": [0]}
    assert commands.commanded.tolist() == [True, False, False]
    assert commands.vectors[0, 0] > 0.0
    assert called == [("ring", [0]), ("say", [0])]
    tidy, deep = robots.inner
    np.testing.assert_array_equal(tidy.network.readings, [[9.0, 1.0, 0.0], [0, 0, 0], [0.0, 0.0, 0.0]])
    assert (tidy.name, deep.name) == ("Tidy", "Tidy/Call")


def test_when_the_behaviour_stops_all_stops_that_lies_in_it():
    robots, called = robots_of()
    readings(robots, 1, 9.0)
    robots.tick(0.2)
    readings(robots, [1, 0, 0], 9.0)
    robots.tick(0.4)
    assert running(robots) == {"Tidy/Go": [0], "Tidy/Call": [0], "Tidy/Call/Say": [0]}
    assert called == [("ring", [0, 1, 2]), ("say", [0, 1, 2])]
    readings(robots, 1, 9.0)
    robots.tick(0.6)
    assert called[2:] == [("ring", [1, 2]), ("say", [1, 2])]
    robots.reset(np.array([0]))
    assert all(0 not in rows for rows in running(robots).values())


def test_robots_are_alone_as_in_company():
    life = (np.random.default_rng(3).random((40, 3)) < 0.6).astype(float)
    together, _ = robots_of()
    alone, _ = robots_of(1)
    for step, wanted in enumerate(life):
        readings(together, wanted, 9.0)
        readings(alone, wanted[:1], 9.0)
        many, one = together.tick(0.2 * step), alone.tick(0.2 * step)
        np.testing.assert_array_equal(many.vectors[:1], one.vectors)


def test_a_copy_made_in_the_middle_goes_on_like_the_original():
    original, _ = robots_of()
    readings(original, [1, 1, 0], 9.0)
    original.tick(0.2)
    duplicate, before = copy.deepcopy(original), running(original)
    readings(duplicate, [0, 1, 1], 9.0)
    vectors = duplicate.tick(0.4).vectors.copy()
    assert running(original) == before != running(duplicate)
    readings(original, [0, 1, 1], 9.0)
    np.testing.assert_array_equal(original.tick(0.4).vectors, vectors)
    assert running(original) == running(duplicate)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (
            changed("networks", "tidy", "behaviours", "Go", "action", to={"type": "Move", "mechanism": "run"}),
            "mine.yaml: networks.tidy: behaviours.Go.action.mechanism: unknown mechanism 'run' (known: go)",
        ),
        (
            changed("networks", "tidy", "mechanisms", "go", "parameters", to={"speed": 1.0}),
            "mine.yaml: networks.tidy: mechanisms.go.parameters: speed: unknown key 'speed' (known: channels",
        ),
        (
            changed("networks", "tidy", "sensors", "charge", to="fact"),
            "mine.yaml: networks.robot: network in behaviour 'Tidy': sensor 'charge' is a fact, outside a number",
        ),
        (
            changed("networks", "deep", "sensors", to={"untold": "fact"}),
            "networks.deep: behaviour 'Say': unknown sensor 'told' (known: untold)",
        ),
        (
            changed("networks", "robot", "behaviours", "Rest", to={"action": {"type": "Act", "call": "ring"}}),
            "networks.robot: behaviours.Rest.action: unknown key 'action'",
        ),
    ],
)
def test_a_mistake_inside_is_one_line_that_says_where(document, message):
    assert message in refusal(network_from, document, "mine.yaml")
