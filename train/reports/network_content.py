"""The content of a diagram of a network: panels of boxes in columns, and links between boxes.

A robot has one panel for each network, the outermost first. Its columns are sensors, preconditions, behaviours, effects
and goals; those of a mechanism configuration begin with its mechanisms and the gradients that queries choose.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

from selector.configurations.configuration import ConfigurationSpec
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import load_network
from selector.coordination.robot_network import RobotNetwork
from selector.documents.errors import shown, validated
from selector.documents.parameters import resolved
from selector.documents.reading import read_mapping
from selector.knowledge import Knowledge, Option
from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Goal, Interface, Sensor
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional, Tree, leaves

MINUS = "\N{MINUS SIGN}"


BoxKind = Literal[
    "mechanisms and targets", "sensors", "preconditions", "behaviours", "coordinators", "effects", "goals"
]
"""Kind of a box; each has a column, but coordinators are in that of behaviours."""
LinkKind = Literal[
    "is read by",
    "is needed by",
    "optional: adds its wish only",
    "effect: raises",
    "effect: lowers",
    "helps the goal",
    "hinders the goal",
]
"""Meaning of a link."""


class DiagramBox(NamedTuple):
    """A box for one part of the network; `lines` are its name and further text."""

    key: str
    kind: BoxKind
    lines: tuple[str, ...]


@dataclass
class NetworkPanel:
    """One network: its title, its boxes by their keys, and links: keys of both boxes -> kind."""

    title: str
    boxes: dict[str, DiagramBox] = field(default_factory=dict)
    links: dict[tuple[str, str], LinkKind] = field(default_factory=dict)
    changes: dict[str, tuple[str, float]] = field(default_factory=dict)
    """Key of an effect -> its sensor and the change."""

    @property
    def columns(self) -> list[list[DiagramBox]]:
        """The boxes of each column from left to right, without empty columns."""
        found: dict[BoxKind, list[DiagramBox]] = {kind: [] for kind in get_args(BoxKind)}
        for box in self.boxes.values():
            found["behaviours" if box.kind == "coordinators" else box.kind].append(box)
        return [column for column in found.values() if column]

    def add(self, key: str, kind: BoxKind, *lines: str) -> None:
        """Add a box, unless there is one of that key."""
        self.boxes.setdefault(key, DiagramBox(key, kind, lines))

    def link(self, start: str, end: str, kind: LinkKind) -> None:
        """Add a link, unless there is one between the boxes."""
        self.links.setdefault((start, end), kind)

    def add_sensor(self, sensor: Sensor, *lines: str) -> None:
        """Add a sensor."""
        self.add(f"sensor.{sensor.name}", "sensors", f"{sensor.name} ({sensor.kind})", *lines)

    def add_behaviour(self, behaviour: Behaviour, *lines: str) -> None:
        """Add a behaviour or coordinator, with its preconditions and effects."""
        key, ready = f"behaviour.{behaviour.name}", behaviour.ready_threshold
        from_when = [] if ready == Behaviour.ready_threshold else [f"ready from {ready:g}"]
        self.add(key, "coordinators" if behaviour.alternatives else "behaviours", behaviour.name, *lines, *from_when)
        for _, face in behaviour.interfaces:
            for tree in face.preconditions:
                needed = f"condition.{condition_in_words(tree)}"
                self.add(needed, "preconditions", condition_in_words(tree))
                self.link(needed, key, "optional: adds its wish only" if isinstance(tree, Optional) else "is needed by")
                for sensor in _read_by(tree):
                    self.link(f"sensor.{sensor}", needed, "is read by")
            for effect in face.effects:
                text = f"{effect.sensor} {'+' if effect.change >= 0.0 else MINUS}{abs(effect.change):g}"
                self.add(f"effect.{text}", "effects", text)
                self.changes[f"effect.{text}"] = (effect.sensor, effect.change)
                self.link(key, f"effect.{text}", "effect: raises" if effect.change > 0.0 else "effect: lowers")

    def add_goal(self, goal: Goal) -> None:
        """Add a goal, with links from all effects added before that bear on it."""
        key, wanted = f"goal.{goal.name}", map(condition_in_words, goal.conditions)
        self.add(key, "goals", goal.name, *wanted, *([] if goal.permanent else ["until it is reached"]))
        for leaf in (leaf for tree in goal.conditions for leaf in leaves(tree)):
            direction = leaf.directions[-1] if leaf.directions else leaf.condition.activator.direction
            for effect, (sensor, change) in self.changes.items():
                if sensor == leaf.condition.sensor:
                    self.link(effect, key, "helps the goal" if change * direction > 0.0 else "hinders the goal")


def robot_panels(path: Path, coordinators: Mapping[str, CoordinatorModel], knowledge: Knowledge) -> list[NetworkPanel]:
    """Return the panels of a robot's document, one for each network; `coordinators` by goal.

    Raises:
        DocumentError: the file has a mistake.

    """
    options = {goal: [*map(option_in_words, knowledge.options(goal))] for goal in coordinators}
    return list(_nested_panels(load_network(path, coordinators), f"robot {path.stem}", options))


def configuration_panels(path: Path) -> list[NetworkPanel]:
    """Return the panel of a mechanism configuration.

    Raises:
        DocumentError: the file has a mistake.

    """
    content = resolved(read_mapping(path), {})
    spec = validated(ConfigurationSpec, content, shown(path))
    panel = NetworkPanel(f"configuration {path.stem}")
    for section in ("mechanisms", "targets"):
        for name, declared in content.get(section, {}).items():
            rule = str(declared.get("rule", "nearest_attractive")).replace("_", " ")
            panel.add(
                f"{section}.{name}", "mechanisms and targets", name, declared.get("type") or f"the {rule} gradient"
            )
    for sensor in spec.network_sensors():
        declared = content["sensors"][sensor.name]
        panel.add_sensor(sensor, component_in_words(declared))
        for section, key in (("mechanisms", "mechanism"), ("targets", "target")):
            if key in declared:
                panel.link(f"{section}.{declared[key]}", f"sensor.{sensor.name}", "is read by")
    for behaviour in spec.network_behaviours():
        actions = content["behaviours"][behaviour.name]["action"]
        panel.add_behaviour(behaviour, *map(component_in_words, actions if isinstance(actions, list) else [actions]))
    for goal in spec.network_goals():
        panel.add_goal(goal)
    return [panel]


def _nested_panels(nested: RobotNetwork, title: str, options: Mapping[str, Sequence[str]]) -> Iterator[NetworkPanel]:
    """Yield the panels of a network; `options`: coordinator -> its options in words."""
    model, panel = nested.model, NetworkPanel(title)
    own = _sensors_of([face for b in model.behaviours for tag, face in b.interfaces if tag < 0])
    coming = {b.name: _sensors_of(b.alternatives) - own for b in model.behaviours}
    for sensor in model.sensors:
        panel.add_sensor(sensor, *(f"comes with {name}" for name, sensors in coming.items() if sensor.name in sensors))
    for behaviour in model.behaviours:
        inside = ["holds a network, below"] if behaviour.name in nested.inner else []
        panel.add_behaviour(behaviour, *options.get(behaviour.name, ()), *inside)
    for goal in model.goals:
        panel.add_goal(goal)
    yield panel
    for name, inner in nested.inner.items():
        yield from _nested_panels(inner, f"network inside {name}", {})


def _sensors_of(faces: Sequence[Interface]) -> set[str]:
    """Return the sensors that interfaces read or influence."""
    read = {sensor for face in faces for tree in face.preconditions for sensor in _read_by(tree)}
    return read | {effect.sensor for face in faces for effect in face.effects}


def _read_by(tree: Tree | Optional) -> list[str]:
    return [leaf.condition.sensor for leaf in leaves(tree.of if isinstance(tree, Optional) else tree)]


def condition_in_words(tree: Tree | Optional) -> str:
    """Return a condition as text, such as `not carrying` or `dist_dump: none at 0, full at 1`."""
    match tree:
        case Optional(of=of):
            return f"optional: {condition_in_words(of)}"
        case Condition(sensor=sensor, activator=activator):
            return _reading_in_words(sensor, activator)
        case Negation(of=Condition(sensor=sensor, activator=Boolean(desired=desired, low=0.0, high=1.0))):
            return _reading_in_words(sensor, Boolean(not desired))
        case Negation(of=of):
            return f"not ({condition_in_words(of)})"
        case Conjunction(of=parts):
            return " and ".join(_part_in_words(part) for part in parts)
        case Disjunction(of=parts):
            return " or ".join(_part_in_words(part) for part in parts)


def component_in_words(declared: Mapping[str, Any]) -> str:
    """Return the type of a component and the names to which it refers, such as `Move: avoidance`."""
    referred = [f"{value}" for key, value in declared.items() if key in ("mechanism", "target", "name", "call")]
    if "value" in declared:
        referred.append(f"= {_plain(declared['value'])}")
    kind = str(declared.get("type", ""))
    return f"{kind}: {' '.join(referred)}" if referred else kind


def option_in_words(option: Option) -> str:
    """Return an option of a coordinator with its score and parameters."""
    laid = ", ".join(f"{key} {_plain(value)}" for key, value in option.parameters.items())
    return f"{option.name}, score {option.score:g}" + (f": {laid}" if laid else "")


def _part_in_words(tree: Tree) -> str:
    text = condition_in_words(tree)
    return f"({text})" if isinstance(tree, Conjunction | Disjunction) and len(tree.of) > 1 else text


def _reading_in_words(sensor: str, activator: Activator) -> str:
    match activator:
        case Boolean(desired=desired):
            text = sensor if desired else f"not {sensor}"
        case Threshold(threshold=threshold, minimum=minimum):
            sign = "\N{GREATER-THAN OR EQUAL TO}" if minimum else "\N{LESS-THAN OR EQUAL TO}"
            text = f"{sensor} {sign} {threshold:g}"
        case Linear(zero=zero, full=full):
            text = f"{sensor}: none at {zero:g}, full at {full:g}"
        case Greedy(maximise=maximise):
            text = f"{sensor} ever {'more' if maximise else 'less'}"
        case Equal(value=value):
            text = f"{sensor} = {value:g}"
        case _:  # an activator of a user's own class
            given = ", ".join(f"{f.name} {getattr(activator, f.name)}" for f in fields(activator))
            text = f"{sensor}: {type(activator).__name__}({given})"
    if (activator.low, activator.high) != (0.0, 1.0):
        text += f" ({activator.low:g} to {activator.high:g})"
    return text


def _plain(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value}"
