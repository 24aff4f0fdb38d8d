from functools import partial

import pytest
import yaml

from selector.coordination.robot_document import load_network, network_from
from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import NetworkSettings, Weights
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional
from tests.selector.changes import changed as changed_in
from tests.selector.refusing import refusal

TEXT = """
root: robot
networks:
  robot:
    sensors: {seen: fact, far: number}
    conditions:
      near: {sensor: far, activator: {type: Linear, zero: 5.0, full: 1.0}}
      seen: {sensor: seen, activator: {type: Boolean}}
      lost: {type: Negation, of: seen}
    behaviours:
      Approach:
        preconditions: [seen, {type: Conjunction, of: [near, lost], optional: true}]
        effects: [{sensor: far, change: -1.0}]
        timeout: 3
        network: approach
      Search: {preconditions: [lost], effects: [{sensor: seen, change: 1.0}]}
    goals:
      Reach: {conditions: [near], satisfaction_threshold: 0.8}
    settings: {max_parallel: 1, weights: {plan: 0.0}, activation_threshold: 0.5}
  approach:
    sensors: {far: number}
    behaviours:
      Straight: {preconditions: [near]}
      Detour: {preconditions: [{type: Negation, of: near}], ready_threshold: 0.1}
"""
SEEN, NEAR = Condition("seen", Boolean()), Condition("far", Linear(5.0, 1.0))


CONTENT = yaml.safe_load(TEXT)
changed = partial(changed_in, CONTENT)


def test_a_file_becomes_the_model_it_describes(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(TEXT)
    nested = load_network(path)
    model = nested.model
    assert [(s.name, s.kind) for s in model.sensors] == [("seen", "fact"), ("far", "number")]
    approach, search = model.behaviours
    assert tuple(approach.preconditions) == (SEEN, Optional(Conjunction(NEAR, Negation(SEEN))))
    assert (approach.timeout, search.timeout) == (3, None)
    assert model.goals[0].satisfaction_threshold == 0.8
    assert model.settings == NetworkSettings(weights=Weights(plan=0.0), activation_threshold=0.5, max_parallel=1)
    assert [b.name for b in nested.inner["Approach"].model.behaviours] == ["Straight", "Detour"]


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (
            changed("root", to="robt"),
            "networks: unknown network 'robt' (known: approach, robot; did you mean 'robot'?)",
        ),
        (
            changed("networks", "robot", "behaviours", "Approach", "network", to="aproach"),
            "networks: unknown network 'aproach' (known: approach, robot; did you mean 'approach'?)",
        ),
        (changed("networks", "robot", "sensors", "far", to=None), "behaviour 'Approach': unknown sensor 'far'"),
        (changed("networks", "robot", "sensors", "far", to="fact"), "Linear does not fit sensor 'far' (a fact)"),
        (
            changed("networks", "robot", "behaviours", "Search", "precondition", to=[]),
            "networks: networks.robot: behaviours.Search.precondition: unknown key",
        ),
        (
            changed("networks", "robot", "behaviours", "Search", "preconditions", to=["lots"]),
            "networks.robot: behaviours.Search.preconditions.0: unknown condition 'lots' (known: lost, near, seen; "
            "did you mean 'lost'?)",
        ),
        (
            changed(
                "networks", "approach", "conditions", to={"near": {"sensor": "far", "activator": {"type": "Greedy"}}}
            ),
            "networks.approach.conditions.near: means something else in a network around this one",
        ),
        (
            changed("networks", "approach", "behaviours", "Straight", "network", to="robot"),
            "networks.robot: networks must not contain each other: robot > approach > robot",
        ),
        (
            changed("networks", "robot", "conditions", "seen", to={"type": "Negation", "of": "lost"}),
            "cyclic reference detected",
        ),
        (
            changed("networks", "robot", "settings", to={"max_parallel": 0}),
            "networks.robot: settings.max_parallel: expected greater than or equal to 1, got 0",
        ),
        (
            changed("networks", "approach", "sensors", to={"seen": "fact"}),
            "networks.approach: behaviour 'Straight': unknown sensor 'far' (known: seen)",
        ),
    ],
)
def test_a_mistake_is_one_line_that_says_where(document, message):
    assert message in refusal(network_from, document)


def test_the_same_condition_may_be_named_again():
    again = changed(
        "networks", "approach", "conditions", to={"near": CONTENT["networks"]["robot"]["conditions"]["near"]}
    )
    assert network_from(again).inner["Approach"].model.behaviours[0].preconditions == (NEAR,)
