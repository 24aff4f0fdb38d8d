"""Files of state machines: what they hold, and their mistakes in one line."""

import numpy as np
import pytest
import yaml

from selector.documents.errors import DocumentError
from selector.strategies.machine_file import load_machine
from selector.strategies.problem import Problem

GOOD = {
    "goal": "Goal",
    "start": "calm",
    "states": {
        "calm": {"option": "a", "transitions": [{"to": "alarmed", "when": "crowd", "above": 0.5}]},
        "alarmed": {"option": "b", "transitions": [{"to": "calm", "probability": 0.1}]},
    },
}


def written(tmp_path, content):
    path = tmp_path / "machine.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return str(path)


def test_a_machine_is_read(tmp_path):
    machine = load_machine(written(tmp_path, GOOD))
    assert [way.to for way in machine.ways] == ["alarmed", "calm"]
    assert machine.states["alarmed"].transitions[0].probability == 0.1
    machine.check_fits(Problem("Goal", ("a", "b"), np.zeros(2), ("crowd",)), "here")


def test_goals_are_taken_by_name_in_any_order(tmp_path):
    probing = {"robots": 1, "option": "b+Walk", "until": "crowd"}
    states = {"calm": {"option": "a+Patrol"}, "odd": {"option": "a"}}
    joint = {"goal": "Avoid+Explore", "start": "calm", "states": states, "probing": probing}
    machine = load_machine(written(tmp_path, joint))
    turned = machine.for_goal("Explore+Avoid")
    assert (turned.goal, turned.probing.option) == ("Explore+Avoid", "Walk+b")
    assert [state.option for state in turned.states.values()] == ["Patrol+a", "a"]
    assert turned.for_goal("Avoid+Explore") == machine
    for goal in ("Avoid+Explore", "Avoid+Walk", "Avoid"):
        assert machine.for_goal(goal) is machine


@pytest.mark.parametrize(
    ("key", "way", "line"),
    [
        ("to", "gone", r"states.calm.transitions.0.to: expected one of the states calm, alarmed, got gone"),
        (
            "above",
            None,
            r"states.calm.transitions.0.when: expected a component with a bound, above or below, got crowd",
        ),
        ("when", None, r"states.calm.transitions.0.when: expected a component that is compared, got none"),
        ("below", 0.2, r"states.calm.transitions.0.above: expected less than below, 0.2, got 0.5"),
        ("probability", 1.5, r"states.calm.transitions.0.probability: expected .*, got 1.5"),
        ("wehn", "crowd", r"states.calm.transitions.0.wehn: unknown key 'wehn'.*"),
    ],
)
def test_mistakes_are_one_line(tmp_path, key, way, line):
    transition = GOOD["states"]["calm"]["transitions"][0] | {key: way}
    content = GOOD | {"states": GOOD["states"] | {"calm": {"option": "a", "transitions": [transition]}}}
    with pytest.raises(DocumentError, match=rf"machine.yaml: {line}$"):
        load_machine(written(tmp_path, content))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"start": "nowhere"}, "start: expected one of the states calm, alarmed, got nowhere"),
        ({"states": {}}, "states: "),
        ({"probing": {"probability": 1.5}}, "probing.probability: expected less than or equal to 1, got 1.5"),
        ({"probing": {"robots": 2}}, "probing.robots: expected robots, option and until together, got 1 of them"),
        ({"probing": {"robots": -1}}, "probing.robots: expected "),
        (
            {"probing": {"sampled": True}},
            "probing.sampled: expected false: a machine gives no probabilities of options",
        ),
    ],
)
def test_a_start_and_a_state_are_needed(tmp_path, changes, line):
    with pytest.raises(DocumentError, match=line):
        load_machine(written(tmp_path, GOOD | changes))


@pytest.mark.parametrize(
    ("problem", "line"),
    [
        (
            Problem("Other", ("a", "b"), np.zeros(2), ("crowd",)),
            "here: made to decide Goal, got Other to decide",
        ),
        (Problem("Goal", ("a", "c"), np.zeros(2), ("crowd",)), "here: options: .*b"),
        (Problem("Goal", ("a", "b"), np.zeros(2), ("crowds",)), "here: unknown component 'crowd'"),
    ],
)
def test_a_machine_of_another_problem_is_refused(tmp_path, problem, line):
    with pytest.raises(DocumentError, match=line):
        load_machine(written(tmp_path, GOOD)).check_fits(problem, "here")
