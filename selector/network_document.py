"""Behaviour networks from YAML, in the words of `vocabulary`: sensors, conditions, behaviours, goals, inner networks.

    networks:
      robot:
        sensors: {garbage_seen: fact, distance: number}
        conditions:
          near: {sensor: distance, activator: {type: Linear, zero: 5.0, full: 1.0}}
        behaviours:
          Approach: {preconditions: [near], effects: [{sensor: distance, change: -1.0}], network: approach}
        goals:
          Clean: {conditions: [{type: Negation, of: near}]}
        settings: {max_parallel: 1}
      approach: ...
    root: robot

Where a condition is expected, the name of one under `conditions` may stand. A network sees the named conditions of
those it lies in, and must not give their names another meaning.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from selector.documents import Closed, DocumentError, Flag, Name, Number, Share, read_mapping, shown, unknown, validated
from selector.vocabulary import AnyCondition, BehaviourSpec, GoalSpec
from selforg.network.behaviours import Goal, NetworkSettings, Sensor, Weights
from selforg.network.model import NetworkModel
from selforg.network.nesting import NestedModel

Content = dict[str, Any]


class HoldingBehaviourSpec(BehaviourSpec):
    """A behaviour that may hold a network."""

    network: Name | None = None
    """Name of the network that decides while the behaviour runs."""


class ReachableGoalSpec(GoalSpec):
    """A goal that may be content with less than full satisfaction."""

    satisfaction_threshold: Share = 1.0
    """Satisfaction from which it counts as reached [-]."""


class WeightsSpec(Closed):
    """How much each term counts in the activation of a behaviour."""

    situation: Number = 1.0
    """Satisfaction of its own preconditions [-]."""
    goal: Number = 1.0
    """Goals that its effects help [-]."""
    conflictor: Number = 1.0
    """Goals and other behaviours that its effects hinder [-]."""
    predecessor: Number = 1.0
    """Ready behaviours that help it [-]."""
    successor: Number = 1.0
    """Behaviours that it makes ready [-]."""
    plan: Number = 1.0
    """Its place in the plan [-]."""


class SettingsSpec(Closed):
    """How a network decides; the meaning of each is that of `NetworkSettings`."""

    algorithm: Literal["default", "uniform"] = "default"
    """Products of effect and wish, or their Euclidean length."""
    weights: WeightsSpec = WeightsSpec()
    """Weights of the terms."""
    activation_decay: Share = 0.9
    """Share of activation kept from step to step [-]."""
    activation_threshold: Number = 7.0
    """Threshold at the start [-]."""
    threshold_decay: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.8
    """Factor on the threshold while nothing runs [-]."""
    max_parallel: Annotated[int, Field(strict=True, ge=1)] | None = None
    """Behaviours that may run at once; any number by default."""
    goal_priority: Flag = False
    """Whether goals of higher priority give more."""
    strict_progress: Flag = False
    """Whether a step of the plan is passed only when its effects were seen."""

    def build(self) -> NetworkSettings:
        """Return the settings this declares."""
        weights = Weights(**self.weights.model_dump())
        return NetworkSettings(**{**self.model_dump(exclude={"weights"}), "weights": weights})


class NetworkSpec(Closed):
    """One network, its named conditions already in their places."""

    sensors: Annotated[dict[Name, Literal["fact", "number"]], Field(min_length=1)]
    """What each sensor reads."""
    conditions: dict[Name, AnyCondition] = Field(default_factory=dict)
    """Conditions to be used by name."""
    behaviours: Annotated[dict[Name, HoldingBehaviourSpec], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, ReachableGoalSpec] = Field(default_factory=dict)
    """Goals by name."""
    settings: SettingsSpec = SettingsSpec()
    """How it decides."""

    def build(self) -> NetworkModel:
        """Return the model this declares."""
        sensors = [Sensor(name, kind) for name, kind in self.sensors.items()]
        behaviours = [spec.build(name) for name, spec in self.behaviours.items()]
        goals = [_goal(spec.build(name), spec.satisfaction_threshold) for name, spec in self.goals.items()]
        return NetworkModel(sensors, behaviours, goals, self.settings.build())


class NetworksSpec(Closed):
    """A file of networks; what each holds is checked when it is reached from the root."""

    root: Name
    """The outermost network."""
    networks: dict[Name, dict[str, Any]]
    """Networks by name."""


def load_network(path: Path) -> NestedModel:
    """Return the root network of a YAML file with everything it holds.

    Raises:
        DocumentError: file, key and what is wrong: unknown keys, sensors, conditions and networks, an activator that
            does not fit its sensor, networks that hold each other in a circle, one name for two conditions.

    """
    return network_from(read_mapping(path), shown(path))


def network_from(content: Mapping[str, Any], where: str = "networks") -> NestedModel:
    """Return the root network of what a YAML file holds; `where` names it in errors."""
    file = validated(NetworksSpec, content, where)
    return _nested(file.networks, file.root, {}, (), where)


def _nested(
    networks: Mapping[str, Content], name: str, outside: Mapping[str, Any], path: tuple[str, ...], file: str
) -> NestedModel:
    """Build a network that lies in those of `path`, whose named conditions are `outside`."""
    if name not in networks:
        raise DocumentError(f"{file}: {unknown('network', name, sorted(networks))}")
    where = f"{file}: networks.{name}"
    if name in path:
        raise DocumentError(f"{where}: networks must not hold each other: {' > '.join((*path, name))}")
    content = networks[name]
    named = _named(content, outside, where)
    spec = validated(NetworkSpec, _in_place(content, named, where), where)
    inner = {b: held.network for b, held in spec.behaviours.items() if held.network is not None}
    try:
        model = spec.build()
        held = {b: _nested(networks, other, named, (*path, name), file) for b, other in inner.items()}
        return NestedModel(model, held)
    except DocumentError:
        raise
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error


def _named(content: Content, outside: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return the conditions that a network knows by name, its own and those of the networks it lies in."""
    own = content.get("conditions", {})
    if not isinstance(own, dict):
        raise DocumentError(f"{where}.conditions: expected a mapping, got {own!r}")
    for name, condition in own.items():
        if name in outside and outside[name] != condition:
            raise DocumentError(f"{where}.conditions.{name}: means something else in a network around this one")
    return {**outside, **own}


def _in_place(content: Content, named: Mapping[str, Any], where: str) -> Content:
    """Return the content with every name of a condition replaced by what it stands for."""
    filled = dict(content)
    for section, key in (("behaviours", "preconditions"), ("goals", "conditions")):
        parts = content.get(section)
        if isinstance(parts, dict):
            filled[section] = {
                name: _resolve_in(part, key, named, f"{where}.{section}.{name}.{key}") for name, part in parts.items()
            }
    own = content.get("conditions")
    if isinstance(own, dict):
        filled["conditions"] = {
            name: _resolved(condition, named, f"{where}.conditions.{name}", (name,)) for name, condition in own.items()
        }
    return filled


def _resolve_in(part: Any, key: str, named: Mapping[str, Any], where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    if not (isinstance(part, dict) and isinstance(part.get(key), list)):
        return part
    return {**part, key: [_resolved(condition, named, where) for condition in part[key]]}


def _resolved(condition: Any, named: Mapping[str, Any], where: str, path: tuple[str, ...] = ()) -> Any:  # noqa: ANN401
    """Replace names in a condition tree; `path` are the named conditions that it is part of."""
    if isinstance(condition, str):
        if condition not in named:
            raise DocumentError(f"{where}: {unknown('condition', condition, sorted(named))}")
        if condition in path:
            raise DocumentError(f"{where}: conditions must not contain each other: {' > '.join((*path, condition))}")
        return _resolved(named[condition], named, where, (*path, condition))
    if isinstance(condition, dict) and "of" in condition:
        below = condition["of"]
        if isinstance(below, list):
            return {**condition, "of": [_resolved(part, named, where, path) for part in below]}
        return {**condition, "of": _resolved(below, named, where, path)}
    return condition


def _goal(goal: Goal, threshold: float) -> Goal:
    return Goal(goal.name, goal.conditions, goal.priority, goal.permanent, threshold)
