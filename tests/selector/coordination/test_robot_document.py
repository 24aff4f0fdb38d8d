"""Robots in YAML: the shipped one, coordinators, parameters, and mistakes that only a file can have."""

import re
from functools import partial

import pytest
import yaml

from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import coordinated_goals, load_network, network_from, read_robot
from selector.coordination.robot_network import merged_networks
from selector.documents.errors import DocumentError
from selector.documents.find import SHIPPED
from selector.knowledge import load_knowledge
from selforg.network.model.activators import Linear
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings
from selforg.network.model.conditions import Condition, Negation
from tests.selector.changes import changed as changed_in
from tests.selector.refusing import refusal
from tests.selforg.network.cleaning import TASKS, condition, effect

GOAL = "AvoidCollision"
PATH = SHIPPED / "robots" / "cleaning.yaml"


@pytest.fixture(scope="module")
def coordinators():
    return {GOAL: CoordinatorModel(GOAL, load_knowledge("cleaning"), Library())}


changed = partial(changed_in, yaml.safe_load(PATH.read_text()))


def behaviour(name, **fields):
    return changed("networks", "robot", "behaviours", name, to=fields)


def facts(**rules):
    return changed("facts", to=rules)


def telling(action):
    whole = behaviour("Dump", network="tell") | {"facts": {"door": {}}}
    whole["networks"]["tell"] = {"behaviours": {"Do": {"action": action}}}
    return whole


def test_the_shipped_robot_is_the_one_declared_in_python(coordinators):
    nested = load_network(PATH, coordinators)
    assert nested.inner == {}
    model = nested.model
    assert model.behaviours == (
        *(
            Behaviour(
                name, tuple(map(condition, needs.split())), tuple(map(effect, does.split())), ready_threshold=ready
            )
            for name, (needs, does, ready) in TASKS.items()
        ),
        coordinators[GOAL].behaviour(),
    )
    assert model.goals == (
        Goal("PatrolEnvironment", (condition("patrolled"),)),
        Goal("GarbageCleaned", (condition("!garbage_found"),)),
        Goal(GOAL, (Negation(condition("rep_bool")),)),
    )
    assert model.sensors[-2:] == coordinators[GOAL].sensors


def test_parameters_and_settings_are_laid_over_the_file(coordinators):
    settings = NetworkSettings(max_parallel=3)
    model = load_network(PATH, coordinators, {"transport_full_range": 5.5}, settings).model
    transport = model.behaviours[model.behaviour_index["MoveToDump"]]
    assert Condition("dist_dump", Linear(0.0, 5.5)) in transport.preconditions
    assert model.settings is settings
    with pytest.raises(DocumentError, match=r"cleaning\.yaml: parameters: unknown parameter 'far' \(known: transport_"):
        load_network(PATH, coordinators, {"far": 1.0})


def test_a_coordinator_may_have_conditions_and_a_priority_of_its_own(coordinators):
    own = behaviour(GOAL, type="Coordinator", goal=GOAL, preconditions=["no garbage"], priority=2)
    coordinator = network_from(own, coordinators=coordinators).model.behaviours[-1]
    assert coordinator.preconditions == (condition("!garbage_found"),)
    assert coordinator.priority == 2
    assert coordinator.alternatives == coordinators[GOAL].behaviour().alternatives


def test_conditions_that_exclude_each_other_may_be_optional_or_count_a_little(coordinators):
    away = {"sensor": "garbage_at", "activator": {"type": "Boolean", "desired": False}}
    for other in ({**away, "optional": True}, {**away, "activator": {"type": "Boolean", "desired": False, "low": 0.9}}):
        network_from(behaviour("Rest", preconditions=["at garbage", other]), "my.yaml", coordinators)
    network_from(behaviour("Rest", preconditions=["at garbage", away], ready_threshold=0.0), "my.yaml", coordinators)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (
            behaviour("Avoid", type="Coordinator", goal=GOAL),
            f"networks.robot: behaviours.Avoid.goal: expected the name of the coordinator, got '{GOAL}'",
        ),
        (
            behaviour("Rest", type="Coordinator", goal="Rest"),
            "behaviours.Rest.goal: unknown coordinated goal 'Rest' (known: AvoidCollision",
        ),
        (behaviour("Rest", type="Coordinator"), "expected a coordinator with a goal and without a network"),
        (behaviour("Rest", goal=GOAL), "expected a goal for a coordinator only"),
        (behaviour("Rest", during=["Dump"]), "expected a goal for a coordinator only"),
        (
            behaviour(GOAL, type="Coordinator", goal=GOAL, during=["Dump"]),
            "behaviours.AvoidCollision.during: expected options that only steer, got RepulsionFernandez-view2.0",
        ),
        (
            behaviour(GOAL, type="Coordinator", goal=GOAL, during=["Dance"]),
            "behaviours.AvoidCollision.during: unknown behaviour 'Dance' (known: AvoidCollision, ",
        ),
        (behaviour("Rest", type="Coordinater"), "behaviours.Rest.type: expected 'Behaviour' or 'Coordinator', got 'C"),
        (behaviour(GOAL, preconditions=["no garbage"]), "goal 'AvoidCollision': unknown sensor 'rep_bool'"),
        (
            changed("networks", "robot", "sensors", "rep_len", to="number"),
            "networks.robot: sensor names must be unique, got more than once: rep_len",
        ),
        (
            behaviour("Rest", preconditions=[{"sensor": "at_dump", "activator": {"type": "Bolean"}}]),
            "Condition.activator.type: unknown activator 'Bolean' (known: Boolean, Equal, Greedy, Linear, ",
        ),
        (
            behaviour("Rest", preconditions=["at garbage", "not at garbage"]),
            "behaviours.Rest: preconditions: expected conditions that can be true together, got 'garbage_at' both true",
        ),
        (
            behaviour("Rest", preconditions=["at garbage", {"type": "Negation", "of": "at garbage"}]),
            "behaviours.Rest: preconditions: expected conditions that can be true together, got 'garbage_at' both true",
        ),
        (changed("parameters", "idle", to=1.0), "parameters.idle: nothing in the configuration uses $idle"),
        (facts(door={"keep": "oldest"}), "facts.door: keep must be one of newest, largest, got 'oldest'"),
        (facts(door={"diffusion": float("nan")}), "facts.door: diffusion: expected a finite number, got nan"),
        (
            facts(door={"evaporation_period": 1e-9}),
            "facts.door: gradient: evaporation_period must be 0 or at least 1e-06 s, got 1e-09",
        ),
        (facts(door={"colour": 1.0}), "facts.door: colour: unknown key 'colour' (known: diffusion, evaporation_factor"),
        (
            facts(**{"two\nlines": {}}),
            "facts.two lines.[key]: expected up to 100 letters, digits and -_. beginning and ending",
        ),
        (facts(**{f"f{k}": {} for k in range(17)}), "facts: expected at most 16 "),
        (
            telling({"type": "Tell", "fact": "window"}),
            "networks.tell: unknown fact 'window' (known: door); the robots'",
        ),
        (
            telling({"type": "Tell", "fact": "door", "value": float("inf")}),
            "Tell.value: expected a finite number, got inf",
        ),
        (
            changed("networks", "robot", "sensors", "told", to={"type": "Heard", "fact": "door"}),
            "networks.robot: sensors.told.fact: unknown fact 'door' (known: none); the robots' document declares facts",
        ),
        (
            changed("networks", "robot", "sensors", "far", to={"type": "Lidar"}),
            "sensors.far: expected fact, number, or a sensor of a fact, as the outermost network has no other comp",
        ),
    ],
)
def test_a_mistake_is_one_line_that_says_where(document, message, coordinators):
    told = refusal(network_from, document, "my.yaml", coordinators)
    assert told.startswith("my.yaml: ")
    assert message in told


def test_inner_networks_have_no_coordinators(coordinators):
    whole = behaviour("Rest", network="inner")
    whole["networks"]["inner"] = {
        "sensors": {"at_dump": "fact"},
        "behaviours": {GOAL: {"type": "Coordinator", "goal": GOAL}},
    }
    with pytest.raises(DocumentError, match=r"networks\.inner: behaviours\..*unknown coordinated goal .*known: none"):
        network_from(whole, coordinators=coordinators)


def based(tmp_path, text, name="own"):
    path = tmp_path / "robots" / f"{name}.yaml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return path


def test_a_document_has_what_differs_from_its_base(tmp_path, coordinators):
    text = "base: cleaning\nnetworks: {robot: {behaviours: {Dump: null, Patrol: {cost: 2.0}}}}\n"
    path = based(tmp_path, text)
    assert coordinated_goals(path) == (GOAL,)
    own, base = (load_network(one, coordinators).model for one in (path, PATH))
    assert [b.name for b in own.behaviours] == [b.name for b in base.behaviours if b.name != "Dump"]
    assert own.behaviours[0].cost == 2.0
    assert own.behaviours[0].effects == base.behaviours[0].effects
    further = based(tmp_path, "base: own\nnetworks: {robot: {goals: {GarbageCleaned: null}}}\n", "further")
    assert list(load_network(further, coordinators).model.goal_index) == ["PatrolEnvironment", GOAL]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("base: own\n", r"own\.yaml: base: expected no circle of documents, got own > own > own"),
        ("base: nobody\n", r"own\.yaml: base: .*nobody"),
        ("base: 3\n", r"own\.yaml: base"),
        ("base: cleaning\nnetworks: {robot: {behaviours: {Fly: null}}}\n",
         r"own\.yaml: networks: robot: behaviours: Fly: expected a part of the base to leave out"),
    ],
)  # fmt: skip
def test_a_base_that_does_not_fit_is_one_line(text, message, tmp_path):
    assert re.search(message, refusal(read_robot, based(tmp_path, text)))


def test_documents_of_one_mission_share_what_has_the_same_name(coordinators):
    whole = network_from(changed("description", to="whole"), coordinators=coordinators)
    part = network_from(changed("networks", "robot", "behaviours", "Dump", to=None), coordinators=coordinators)
    both = merged_networks({"whole": whole, "part": part})
    assert both.model.behaviours == whole.model.behaviours
    assert [left.behaviours for left in both.left_out] == [(), ("Dump",)]
    assert merged_networks({"whole": whole}) is whole
    other = network_from(changed("networks", "robot", "behaviours", "Dump", "cost", to=3.0), coordinators=coordinators)
    with pytest.raises(DocumentError, match="robots of other: behaviour Dump: expected the same as in the documents"):
        merged_networks({"whole": whole, "other": other})
