import copy
import re
from functools import partial

import pytest
import yaml

from selector.configurations.library import Library
from selector.coordination.model import interface_of
from selector.documents.errors import DocumentError
from selector.documents.find import SHIPPED
from selforg.network.model.activators import Boolean, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Sensor
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional
from tests.selector.changes import changed as changed_in
from tests.selector.refusing import refusal

AVOIDANCE = ["RepulsionFernandez", "RepulsionGradient"]


def shipped_content():
    return yaml.safe_load((SHIPPED / "mechanisms" / "RepulsionGradient.yaml").read_text())


def library_of(directory, content):
    (directory / "mechanisms").mkdir(exist_ok=True)
    (directory / "mechanisms" / "Mine.yaml").write_text(yaml.safe_dump(content))
    (directory / "mechanisms" / "Half.yaml").write_text("a: {b: [\n")  # nobody asks for it
    library = Library([directory])
    library.configuration("Mine")
    return library


changed = partial(changed_in, shipped_content())


@pytest.mark.parametrize("key", AVOIDANCE)
def test_shipped_configurations_are_the_avoidance_of_the_robot_model(key):
    spec = Library().configuration(key)
    assert spec.mechanisms["avoidance"].type == key
    assert spec.network_sensors() == (Sensor("rep_bool", "fact"), Sensor("rep_len", "number"))
    assert spec.sensors["rep_bool"].longer_than == 1e-9
    assert [action.mechanism for action in spec.behaviours["Avoid"].action] == ["avoidance"]
    assert spec.network_behaviours() == (
        Behaviour(
            "Avoid",
            (
                Condition("rep_bool", Boolean(True)),
                Optional(Condition("rep_len", Linear(0.0, 1.5))),
            ),
            (Effect("rep_len", -1.0), Effect("rep_bool", -1.0)),
            ready_threshold=0.8,
        ),
    )
    interface = interface_of(spec)
    assert interface.effects == spec.network_behaviours()[0].effects


@pytest.mark.parametrize(("key", "view"), [("RepulsionFernandez", 2.0), ("RepulsionGradient", 1.5)])
def test_parameters_are_laid_over_the_configuration(key, view):
    library = Library()
    assert library.configuration(key).mechanisms["avoidance"].parameters == {"view_distance": view}
    spec = library.configuration(key, {"view_distance": 0.7, "presence_threshold": 0.005, "full_length": 3.0})
    assert spec.mechanisms["avoidance"].parameters == {"view_distance": 0.7}
    assert spec.sensors["rep_bool"].longer_than == 0.005
    assert spec.behaviours["Avoid"].preconditions[1].activator.full == 3.0
    assert library.configuration(key).mechanisms["avoidance"].parameters == {"view_distance": view}


def test_nested_parameters_are_merged_key_by_key(tmp_path):
    content = shipped_content()
    content["parameters"]["trail"] = {"channel": "trail", "diffusion": 2.0}
    content["mechanisms"]["patrol"] = {"type": "Patrol", "parameters": {"pheromone": "$trail"}}
    library = library_of(tmp_path, content)
    merged = library.configuration("Mine", {"trail": {"diffusion": 3.0}})
    assert merged.mechanisms["patrol"].parameters["pheromone"] == {"channel": "trail", "diffusion": 3.0}
    with pytest.raises(DocumentError, match=r"parameters\.trail: unknown parameter 'd' \(known: channel, diffusion\)"):
        library.configuration("Mine", {"trail": {"d": 3}})
    with pytest.raises(DocumentError, match=r"parameters\.trail: expected a mapping, got 3"):
        library.configuration("Mine", {"trail": 3})


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"view": 1.0}, r"RepulsionGradient\.yaml: parameters: unknown parameter 'view' \(known: full_length, "),
        (
            {"presence_threshold": -1.0},
            r"sensors\.rep_bool\.VectorPresent\.longer_than: expected .*equal to 0, got -1\.0",
        ),
        ({"full_length": "far"}, r"behaviours\.Avoid\.preconditions\.1.*full: expected a valid number, got 'far'"),
        ({"full_length": 0.0}, r"behaviours\.Avoid.*expected different readings zero and full, got 0.0 for both"),
    ],
)
def test_parameters_that_cannot_be_are_refused_with_their_place(parameters, message):
    with pytest.raises(DocumentError, match=message):
        Library().configuration("RepulsionGradient", parameters)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (changed("mechanism", to={}), r"Mine\.yaml: mechanism: unknown key"),
        (changed("behaviours", to={}), r"behaviours: .*at least 1 item"),
        (changed("parameters", "idle", to=1.0), r"parameters\.idle: nothing in the configuration uses \$idle"),
        (
            changed("sensors", "rep_len", "mechanism", to="$far"),
            r"sensors\.rep_len\.mechanism: unknown parameter 'far'",
        ),
        (changed("sensors", "rep_len", "mechanism", to="x"), r"sensors\.rep_len\.mechanism: unknown mechanism 'x'"),
        (changed("sensors", "rep_len", "type", to="Width"), r"sensors\.rep_len\.type: unknown sensor 'Width'"),
        (
            changed("behaviours", "Avoid", "action", "mechanism", to="x"),
            r"Avoid\.action\.mechanism: unknown mechanism",
        ),
        (
            changed("behaviours", "Avoid", "effects", to=[{"sensor": "x", "change": 1.0}]),
            "effects: unknown sensor 'x'",
        ),
        (
            changed("behaviours", "Avoid", "effects", to=[{"sensor": "rep_len", "change": 2.0}]),
            "change: expected .* got 2",
        ),
        (
            changed("behaviours", "Avoid", "preconditions", 0, "sensor", to="rep_len"),
            "a Boolean activator on a fact, any other on a number, got Boolean on the number 'rep_len'",
        ),
        (changed("goals", to={"G": {"conditions": []}}), r"goals\.G\.conditions: .*at least 1 item"),
    ],
)
def test_a_mistake_in_a_file_shows_at_once(tmp_path, content, message):
    assert re.search(message, refusal(library_of, tmp_path, content))


def test_unknown_configurations_list_the_known():
    known = r"unknown configuration 'Repulsion' \(known: Barycenter, .* and \d\d more; did you mean 'Repulsion"
    with pytest.raises(DocumentError, match=known) as raised:
        Library().configuration("Repulsion")
    assert len(str(raised.value)) < 300


def test_a_directory_of_ones_own_adds_and_hides(tmp_path):
    library = library_of(tmp_path, shipped_content())
    assert set(library.keys) >= {"Mine", *AVOIDANCE}
    (tmp_path / "mechanisms" / "Mine.yaml").rename(tmp_path / "mechanisms" / "RepulsionFernandez.yaml")
    hidden = Library([tmp_path])
    assert hidden.configuration("RepulsionFernandez").mechanisms["avoidance"].type == "RepulsionGradient"


def test_conditions_are_composed_and_goals_declared(tmp_path):
    near = {"sensor": "rep_len", "activator": {"type": "Threshold", "threshold": 1.0}}
    present = {"type": "Condition", "sensor": "rep_bool", "activator": {"type": "Boolean"}}
    tree = {
        "type": "Disjunction",
        "optional": True,
        "of": [{"type": "Negation", "of": present}, {"type": "Conjunction", "of": [near, present]}],
    }
    content = copy.deepcopy(shipped_content())
    content["behaviours"]["Avoid"] |= {"priority": 2, "timeout": 5, "interruptable": False, "cost": 2.5}
    content["behaviours"]["Avoid"] |= {"planner_independent": True, "ready_threshold": 0.1}
    content["behaviours"]["Avoid"]["preconditions"].append(tree)
    content["goals"] = {
        "Clear": {"conditions": [{"type": "Negation", "of": present}], "priority": 3, "permanent": False}
    }
    spec = library_of(tmp_path, content).configuration("Mine")
    a, b = Condition("rep_len", Threshold(1.0)), Condition("rep_bool", Boolean(True))
    (behaviour,) = spec.network_behaviours()
    assert behaviour.preconditions[2] == Optional(Disjunction(Negation(b), Conjunction(a, b)))
    assert (behaviour.priority, behaviour.timeout, behaviour.interruptable, behaviour.cost) == (2, 5, False, 2.5)
    assert (behaviour.planner_independent, behaviour.ready_threshold) == (True, 0.1)
    assert spec.network_goals() == (Goal("Clear", (Negation(b),), priority=3, permanent=False),)
