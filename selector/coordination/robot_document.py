"""Robot documents: YAML files of behaviour networks, made of the models of `selector.vocabulary`.

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
      approach: # inside a behaviour: sensors of the network around by their kind, and components as in a configuration
        mechanisms: {go: {type: ChemotaxisBalch}}
        sensors: {distance: number, moving: {type: VectorPresent, mechanism: go}}
        behaviours: {Go: {action: {type: Move, mechanism: go}, preconditions: [near]}}
    root: robot
    parameters: {reach: 1.0}
    facts: {door_shut: {keep: newest, means: that the door is shut}}

The name of an entry of `conditions` may be given in place of a condition. A network knows the named conditions of the
networks around it, and must not give their names another meaning. An inner network decides and acts while the
behaviour that holds it runs; behaviours of an inner network may hold further networks. In the root network, a behaviour
`G: {type: Coordinator, goal: G}` holds the configuration that serves the goal G now and adds its sensors; with
`during: [A, B]` its options only steer what the behaviours A and B command.
What robots tell each other is under `facts`, see `FactRule`: the action `Tell` tells it, and the sensors `Heard`,
`HeardValue` and `HeardAge` read it, in the root network, too.
A file with `base: NAME` has what differs from that document; null leaves a part of it out.
`$reach` in place of a value stands for the parameter of that name, which the reader of the file may override.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from selector.configurations.host import trial_host
from selector.configurations.running import RunningConfiguration
from selector.coordination.robot_network import Coordinators, InnerNetworkSpec, NetworkSpec, RobotNetwork
from selector.documents.errors import DocumentError, shown, validated, within
from selector.documents.fields import Closed, Name, checked_name
from selector.documents.find import find_file
from selector.documents.parameters import Content, check_parameters_used, resolved
from selector.documents.plain import must_fit, must_know, short
from selector.documents.reading import read_mapping
from selector.vocabulary.conditions import NamedConditions
from selector.vocabulary.constructors import checked_parameters
from selforg.components import FactRule
from selforg.network.model.behaviours import NetworkSettings

MOST_FACTS = 16
"""Facts that the robots of a document tell; each is looked for whenever a robot tells one."""
MOST_NETWORKS = 50
"""Networks of a robot, each counted wherever it stands; each costs a robot its own state and some milliseconds."""


class NetworksSpec(Closed):
    """A file of networks; each network is checked when it is built, beginning with the root."""

    description: str = ""
    """What the robot is."""
    root: Name
    """The outermost network."""
    networks: dict[Name, dict[str, Any]]
    """Networks by name."""
    facts: Annotated[dict[Name, dict[Name, Any]], Field(max_length=MOST_FACTS)] = Field(default_factory=dict)
    """What robots tell each other, by name; see `FactRule`."""


def load_network(
    path: Path,
    coordinators: Coordinators | None = None,
    parameters: Mapping[str, Any] | None = None,
    settings: NetworkSettings | None = None,
) -> RobotNetwork:
    """Return the root network of a YAML file with the networks inside it.

    Args:
        path: the file.
        coordinators: models of the coordinators of the root network, by goal.
        parameters: values that override the parameters of the file.
        settings: replace the settings of the root network.

    Raises:
        DocumentError: file, key and what is wrong: unknown keys, sensors, conditions, networks, goals and parameters,
            an activator that does not fit its sensor, networks that hold each other in a circle, one name for two
            conditions or sensors.

    """
    return network_from(read_robot(path), shown(path), coordinators, parameters, settings)


def read_robot(path: Path, below: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return the content of a YAML file, laid over that of the document that its `base` names.

    Mappings are merged, and what is null is left out. `below` names the documents that are based on it.
    """
    content = read_mapping(path)
    if "base" not in content:
        return content
    where = f"{shown(path)}: base"
    name = checked_name(content["base"], where)
    must_fit(path.stem not in below, where, "no circle of documents", " > ".join((*below, path.stem, name)))
    base = read_robot(find_file("robots", name, (path.parent.parent,), f"{where}: "), (*below, path.stem))
    return laid_over(base, {key: value for key, value in content.items() if key != "base"}, shown(path))


def laid_over(base: Mapping[str, Any], changes: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return `base` with `changes`: mappings are merged, and what is null is left out; `where` begins errors."""
    merged = dict(base)
    for key, value in changes.items():
        below = merged.get(key)
        if value is None:
            must_fit(key in merged, f"{where}: {key}", "a part of the base to leave out", "an unknown one")
            del merged[key]
        elif isinstance(below, Mapping) and isinstance(value, Mapping):
            merged[key] = laid_over(below, value, f"{where}: {key}")
        else:
            merged[key] = value
    return merged


def network_from(
    content: Content,
    where: str = "networks",
    coordinators: Coordinators | None = None,
    parameters: Mapping[str, Any] | None = None,
    settings: NetworkSettings | None = None,
) -> RobotNetwork:
    """Return the root network of the content of a YAML file; `where` names the file in errors."""
    with within(where):
        check_parameters_used(content)
        filled = resolved(content, parameters or {})
    file = validated(NetworksSpec, filled, where)
    facts: dict[str, FactRule] = {}
    for name, given in file.facts.items():
        checked = checked_parameters(FactRule, given, f"{where}: facts.{name}")
        with within(f"{where}: facts.{name}"):
            facts[name] = FactRule(**checked)
    return _Nesting(file.networks, where, coordinators or {}, settings, facts).of(file.root, {}, ())


def coordinated_goals(path: Path) -> tuple[str, ...]:
    """Return the goals that the coordinators of the root network of a YAML file serve, in the order of the file."""
    content = read_robot(path)
    networks, root = content.get("networks"), content.get("root")
    network = networks.get(root) if isinstance(networks, dict) and isinstance(root, str) else None
    behaviours = network.get("behaviours") if isinstance(network, dict) else None
    held = behaviours.values() if isinstance(behaviours, dict) else ()
    goals = [b.get("goal") for b in held if isinstance(b, dict) and b.get("type") == "Coordinator"]
    return tuple(goal for goal in goals if isinstance(goal, str))  # mistakes are reported when the network is loaded


def known_conditions(content: Content, outside: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return the conditions that a network knows by name, its own and those of the networks around it."""
    own = content.get("conditions", {})
    must_fit(isinstance(own, dict), f"{where}.conditions", "a mapping", short(own))
    for name, condition in own.items():
        if name in outside and outside[name] != condition:
            raise DocumentError(f"{where}.conditions.{name}: means something else in a network around this one")
    return {**outside, **own}


@dataclass(frozen=True)
class _Nesting:
    """Builds networks with the networks inside them, from the outside in."""

    networks: Mapping[str, Content]
    file: str
    coordinators: Coordinators
    settings: NetworkSettings | None
    facts: Mapping[str, FactRule]
    numbers: Iterator[int] = field(default_factory=count)
    """Numbers of the networks in the order in which they are met."""

    def of(self, name: str, outside: Mapping[str, Any], path: tuple[str, ...]) -> RobotNetwork:
        """Return a network inside those of `path`, whose named conditions are `outside`."""
        must_know("network", name, sorted(self.networks), self.file)
        where = f"{self.file}: networks.{name}"
        if name in path:
            raise DocumentError(f"{where}: networks must not contain each other: {' > '.join((*path, name))}")
        if next(self.numbers) >= MOST_NETWORKS:
            raise DocumentError(f"{where}: expected at most {MOST_NETWORKS} networks inside each other, got more")
        named = known_conditions(self.networks[name], outside, where)
        given, names = self.networks[name], NamedConditions(named)
        spec = (
            validated(InnerNetworkSpec, given, where, context=names)
            if path
            else validated(NetworkSpec, given, where, context=names)
        )
        inner = {b: held.network for b, held in spec.behaviours.items() if held.network is not None}
        held = {b: self.of(other, named, (*path, name)) for b, other in inner.items()}
        if isinstance(spec, InnerNetworkSpec):
            model = RunningConfiguration(spec, trial_host(spec, self.facts), where).network.model
            with within(where):
                return RobotNetwork(model, held, spec=spec)
        with within(where):
            model = spec.build(self.coordinators, self.settings)
            sensors = spec.sensors_of(self.facts)
            return RobotNetwork(model, held, during=spec.during, facts=self.facts, sensors=sensors)
