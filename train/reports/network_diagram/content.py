"""The content of a diagram of a network: panels, which have columns of boxes, and links between boxes.

A robot has one panel for each network, the outermost first. Its columns are sensors, preconditions, behaviours, effects
and goals; those of a mechanism configuration begin with its mechanisms and the gradients that queries choose.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from selector.configurations.configuration import ConfigurationSpec
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import load_network
from selector.documents.errors import shown, validated
from selector.documents.parameters import resolved
from selector.documents.reading import read_mapping
from selector.knowledge import Knowledge
from selforg.network.model.behaviours import Behaviour, Goal, Sensor
from selforg.network.model.conditions import Condition, Optional, Tree, leaves
from selforg.network.nesting import NestedModel
from train.reports.network_diagram.words import (
    change_in_words,
    component_in_words,
    condition_in_words,
    option_in_words,
)

Options = Mapping[str, Sequence[str]]
"""By coordinator, its options in words."""


class BoxKind(Enum):
    """Kind of a box."""

    MECHANISM = "mechanisms and targets"
    SENSOR = "sensors"
    CONDITION = "preconditions"
    BEHAVIOUR = "behaviours"
    COORDINATOR = "coordinators"
    EFFECT = "effects"
    GOAL = "goals"


class LinkKind(Enum):
    """Meaning of a link."""

    READS = "is read by"
    NEEDED = "is needed by"
    WISHED = "optional: adds its wish only"
    RAISES = "effect: raises"
    LOWERS = "effect: lowers"
    HELPS = "helps the goal"
    HINDERS = "hinders the goal"


@dataclass(frozen=True)
class DiagramBox:
    """A box for one part of the network; `lines` are its name and further text."""

    key: str
    kind: BoxKind
    lines: tuple[str, ...]


@dataclass(frozen=True)
class DiagramLink:
    """An arrow from one box to another, by their keys."""

    start: str
    end: str
    kind: LinkKind


@dataclass(frozen=True)
class NetworkPanel:
    """One network: its title, its columns from left to right without empty ones, and the links."""

    title: str
    columns: tuple[tuple[DiagramBox, ...], ...]
    links: tuple[DiagramLink, ...]


def robot_panels(path: Path, coordinators: Mapping[str, CoordinatorModel], knowledge: Knowledge) -> list[NetworkPanel]:
    """Return the panels of a robot's document, one for each network; `coordinators` by goal.

    Raises:
        DocumentError: the file has a mistake.

    """
    options = {
        goal: [option_in_words(o.name, o.score, o.parameters) for o in knowledge.options(goal)] for goal in coordinators
    }
    return list(_nested_panels(load_network(path, coordinators), f"robot {path.stem}", options))


def configuration_panels(path: Path) -> list[NetworkPanel]:
    """Return the panel of a mechanism configuration.

    Raises:
        DocumentError: the file has a mistake.

    """
    content = resolved(read_mapping(path), {})
    spec = validated(ConfigurationSpec, content, shown(path))
    panel = _Panel()
    for section in ("mechanisms", "targets"):
        for name, declared in content.get(section, {}).items():
            rule = str(declared.get("rule", "nearest_attractive")).replace("_", " ")
            panel.add(f"{section}.{name}", BoxKind.MECHANISM, name, declared.get("type") or f"the {rule} gradient")
    for sensor in spec.network_sensors():
        declared = content["sensors"][sensor.name]
        panel.sensor(sensor, component_in_words(declared))
        for section, key in (("mechanisms", "mechanism"), ("targets", "target")):
            if key in declared:
                panel.link(f"{section}.{declared[key]}", f"sensor.{sensor.name}", LinkKind.READS)
    for behaviour in spec.network_behaviours():
        panel.behaviour(behaviour, _actions(content["behaviours"][behaviour.name]), BoxKind.BEHAVIOUR)
    for goal in spec.network_goals():
        panel.goal(goal)
    return [panel.finished(f"configuration {path.stem}")]


def _nested_panels(nested: NestedModel, title: str, options: Options) -> Iterator[NetworkPanel]:
    model, panel = nested.model, _Panel()
    own = {e.sensor for b in model.behaviours for e in b.effects} | set(_read_outside(model.behaviours))
    for sensor in model.sensors:
        held = [b.name for b in model.behaviours if b.alternatives and sensor.name in _shown_by(b) - own]
        panel.sensor(sensor, *(f"comes with {name}" for name in held))
    for behaviour in model.behaviours:
        lines = list(options.get(behaviour.name, ()))
        if behaviour.name in nested.inner:
            lines.append("holds a network, below")
        panel.behaviour(behaviour, lines, BoxKind.COORDINATOR if behaviour.alternatives else BoxKind.BEHAVIOUR)
    for goal in model.goals:
        panel.goal(goal)
    yield panel.finished(title)
    for name, inner in nested.inner.items():
        yield from _nested_panels(inner, f"network inside {name}", {})


class _Panel:
    """Collects the boxes and links of one panel."""

    def __init__(self) -> None:
        self.boxes: dict[str, DiagramBox] = {}
        self.links: dict[tuple[str, str], DiagramLink] = {}
        self.changes: dict[str, tuple[str, float]] = {}

    def add(self, key: str, kind: BoxKind, *lines: str) -> None:
        self.boxes.setdefault(key, DiagramBox(key, kind, lines))

    def link(self, start: str, end: str, kind: LinkKind) -> None:
        self.links.setdefault((start, end), DiagramLink(start, end, kind))

    def sensor(self, sensor: Sensor, *lines: str) -> None:
        self.add(f"sensor.{sensor.name}", BoxKind.SENSOR, f"{sensor.name} ({sensor.kind})", *lines)

    def behaviour(self, behaviour: Behaviour, lines: Sequence[str], kind: BoxKind) -> None:
        key = f"behaviour.{behaviour.name}"
        ready = behaviour.ready_threshold
        from_when = [] if ready == Behaviour.ready_threshold else [f"ready from {ready:g}"]
        self.add(key, kind, behaviour.name, *lines, *from_when)
        for _, face in behaviour.interfaces:
            for tree in face.preconditions:
                self._condition(tree, key)
            for effect in face.effects:
                text = change_in_words(effect.sensor, effect.change)
                self.add(f"effect.{text}", BoxKind.EFFECT, text)
                self.changes[f"effect.{text}"] = (effect.sensor, effect.change)
                self.link(key, f"effect.{text}", LinkKind.RAISES if effect.change > 0.0 else LinkKind.LOWERS)

    def _condition(self, tree: Tree | Optional, behaviour: str) -> None:
        text = condition_in_words(tree)
        self.add(f"condition.{text}", BoxKind.CONDITION, text)
        self.link(f"condition.{text}", behaviour, LinkKind.WISHED if isinstance(tree, Optional) else LinkKind.NEEDED)
        for condition in _conditions(tree):
            self.link(f"sensor.{condition.sensor}", f"condition.{text}", LinkKind.READS)

    def goal(self, goal: Goal) -> None:
        key = f"goal.{goal.name}"
        wanted = [condition_in_words(tree) for tree in goal.conditions]
        self.add(key, BoxKind.GOAL, goal.name, *wanted, *([] if goal.permanent else ["until it is reached"]))
        for leaf in (leaf for tree in goal.conditions for leaf in leaves(tree)):
            direction = leaf.directions[-1] if leaf.directions else leaf.condition.activator.direction
            for effect, (sensor, change) in self.changes.items():
                if sensor == leaf.condition.sensor:
                    self.link(effect, key, LinkKind.HELPS if change * direction > 0.0 else LinkKind.HINDERS)

    def finished(self, title: str) -> NetworkPanel:
        columns: dict[BoxKind, list[DiagramBox]] = {kind: [] for kind in BoxKind if kind is not BoxKind.COORDINATOR}
        for box in self.boxes.values():
            columns[BoxKind.BEHAVIOUR if box.kind is BoxKind.COORDINATOR else box.kind].append(box)
        return NetworkPanel(title, tuple(tuple(c) for c in columns.values() if c), tuple(self.links.values()))


def _actions(declared: Mapping[str, Any]) -> list[str]:
    actions = declared["action"]
    return [component_in_words(action) for action in (actions if isinstance(actions, list) else [actions])]


def _conditions(tree: Tree | Optional) -> list[Condition]:
    return [leaf.condition for leaf in leaves(tree.of if isinstance(tree, Optional) else tree)]


def _read_outside(behaviours: Sequence[Behaviour]) -> Iterator[str]:
    """Yield the sensors that behaviours read by preconditions of their own."""
    for behaviour in behaviours:
        for tree in behaviour.preconditions:
            yield from (condition.sensor for condition in _conditions(tree))


def _shown_by(coordinator: Behaviour) -> set[str]:
    """Return the sensors that the options of a coordinator read or influence."""
    read = {c.sensor for face in coordinator.alternatives for tree in face.preconditions for c in _conditions(tree)}
    return read | {effect.sensor for face in coordinator.alternatives for effect in face.effects}
