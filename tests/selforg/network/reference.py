"""One robot's behaviour network, naive: plain dictionaries and loops, written from the rules in `golden/README.md`.

Nothing of `selforg.network` but the declarations is used, so that the compiled kernels have something to be compared
with.
"""

import math

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional, Tree
from selforg.network.model.model import NetworkModel


def clamp(value: float, low: float, high: float) -> float:
    return max(low, min(high, value))


def activation_and_wish(activator: Activator, reading: float) -> tuple[float, float]:
    match activator:
        case Boolean(desired=desired):
            if bool(reading) == desired:
                return activator.high, 0.0
            return activator.low, 1.0 if desired else -1.0
        case Equal(value=value):
            return (activator.high, 0.0) if reading == value else (activator.low, 1.0)
        case Greedy(maximise=maximise, step_size=step):
            return 1.0 if step == 0 else 0.0, 1.0 if maximise else -1.0
        case Threshold(threshold=threshold, minimum=minimum, value_range=span):
            if (reading >= threshold) if minimum else (reading <= threshold):
                return activator.high, 0.0
            full = 1.0 if minimum else -1.0
            return activator.low, clamp((threshold - reading) / span, -1.0, 1.0) if span else full
        case Linear(zero=zero, full=full):
            share = clamp((reading - zero) / (full - zero), 0.0, 1.0)
            wish = (full - reading) / abs(full - zero)
            satisfaction = activator.low + share * (activator.high - activator.low)
            return satisfaction, clamp(wish, 0.0, 1.0) if full > zero else clamp(wish, -1.0, 0.0)
    raise TypeError(activator)


def satisfaction_of(tree: Tree, readings: dict[str, float]) -> float:
    if isinstance(tree, Condition):
        return activation_and_wish(tree.activator, readings[tree.sensor])[0]
    if isinstance(tree, Negation):
        return 1.0 - satisfaction_of(tree.of, readings)
    parts = [satisfaction_of(part, readings) for part in tree.of]
    return math.prod(parts) if isinstance(tree, Conjunction) else max(parts)


def wishes_of(tree: Tree, readings: dict[str, float]) -> list[tuple[str, float, float]]:
    """(sensor, wish, direction) of every condition in the tree."""
    if isinstance(tree, Condition):
        return [(tree.sensor, activation_and_wish(tree.activator, readings[tree.sensor])[1], tree.activator.direction)]
    if not isinstance(tree, Negation):
        return [wish for part in tree.of for wish in wishes_of(part, readings)]
    below = wishes_of(tree.of, readings)
    last = {sensor: direction for sensor, _, direction in below}
    return [(sensor, negated(wish, -last[sensor]), -last[sensor]) for sensor, wish, _ in below]


def negated(wish: float, reversed_direction: float) -> float:
    if wish == 0.0:
        return reversed_direction
    return -(1.0 - wish) if wish > 0.0 else 1.0 - abs(wish)


class Node:
    """What is known of one behaviour."""

    def __init__(self, priority: int) -> None:
        self.activation = 0.0
        self.satisfaction = 0.0
        self.wishes: list[tuple[str, float]] = []
        self.components: dict[str, float] = {}
        self.ready = self.executing = self.finished = self.manual = False
        self.started = self.stopped = False
        self.enabled = self.present = True
        self.time = -1
        self.priority = priority
        self.alternative = 0


class ReferenceNetwork:
    """Steps one robot; the same events as `BehaviourNetwork`, by name."""

    def __init__(self, model: NetworkModel) -> None:
        self.model, self.settings = model, model.settings
        self.threshold = model.settings.activation_threshold
        self.thresholds: list[float] = []  # that this step has decided by
        self.nodes = {b.name: Node(b.priority) for b in model.behaviours}
        self.declared = {b.name: b for b in model.behaviours}
        self.goal_enabled = {goal.name: True for goal in model.goals}
        self.goal_satisfaction: dict[str, float] = {}
        self.goal_wishes: dict[str, list[tuple[str, float]]] = {}
        self.plan: list[str] = []
        self.plan_index = 0

    def finish(self, name: str) -> None:
        node = self.nodes[name]
        if node.executing:
            node.executing, node.time, node.finished = False, -1, True

    def enable(self, name: str, enabled: bool) -> None:
        self.nodes[name].enabled = enabled
        if not enabled:
            self.finish(name)

    def enable_goal(self, name: str, enabled: bool) -> None:
        self.goal_enabled[name] = enabled

    def set_priority(self, name: str, priority: int) -> None:
        self.nodes[name].priority = priority

    def start_by_hand(self, name: str, wanted: bool) -> None:
        self.nodes[name].manual = wanted

    def hold(self, name: str, alternative: int) -> None:
        self.nodes[name].alternative = alternative

    def remove(self, name: str) -> None:
        self.nodes[name].present = self.nodes[name].executing = False

    def step(self, readings: dict[str, float], guarantee: bool = False) -> None:
        self.sense(readings)
        for node in self.nodes.values():
            if node.finished:
                node.activation, node.finished = 0.0, False
        self.spread()
        for node in self.nodes.values():
            node.started = node.stopped = False
        self.thresholds = []
        self.select(advance=True)
        while guarantee and not self.running() and self.eligible():
            before = self.threshold
            self.select(advance=False)
            if self.threshold == before:
                break

    # conditions

    def interfaces(self, name: str):
        return [face for tag, face in self.declared[name].interfaces if tag in (-1, self.nodes[name].alternative)]

    def sense(self, readings: dict[str, float]) -> None:
        for name, node in self.nodes.items():
            trees = [tree for face in self.interfaces(name) for tree in face.preconditions]
            mandatory = [tree for tree in trees if not isinstance(tree, Optional)]
            every = [tree.of if isinstance(tree, Optional) else tree for tree in trees]
            node.satisfaction = math.prod(satisfaction_of(tree, readings) for tree in mandatory)
            node.ready = node.satisfaction >= self.declared[name].ready_threshold
            node.wishes = [wish[:2] for tree in every for wish in wishes_of(tree, readings)]
            if node.satisfaction > self.declared[name].ready_threshold:
                smallest: dict[str, float] = {}
                for sensor, wish in node.wishes:
                    if sensor not in smallest or abs(wish) < abs(smallest[sensor]):
                        smallest[sensor] = wish
                node.wishes = list(smallest.items())
        for goal in self.model.goals:
            satisfaction = math.prod(satisfaction_of(tree, readings) for tree in goal.conditions)
            self.goal_satisfaction[goal.name] = satisfaction
            self.goal_wishes[goal.name] = [w[:2] for tree in goal.conditions for w in wishes_of(tree, readings)]
            if satisfaction >= goal.satisfaction_threshold and not goal.permanent:
                self.goal_enabled[goal.name] = False

    # activation

    def operational(self, name: str) -> bool:
        return self.nodes[name].present and self.nodes[name].enabled

    def effects(self, name: str) -> list[tuple[str, float]]:
        return [(effect.sensor, effect.change) for face in self.interfaces(name) for effect in face.effects]

    def with_effect(self, sensor: str, fits) -> int:
        """Operational behaviours with an effect on `sensor` that `fits`, at least 1."""
        matching = [
            name
            for name in self.nodes
            if self.operational(name) and any(s == sensor and fits(change) for s, change in self.effects(name))
        ]
        return max(1, len(matching))

    def with_wish(self, sensor: str, sign: float) -> int:
        matching = [
            name
            for name, node in self.nodes.items()
            if self.operational(name) and any(s == sensor and wish * sign > 0.0 for s, wish in node.wishes)
        ]
        return max(1, len(matching))

    def helping(self, effect: float, wish: float) -> float:
        return math.hypot(effect, wish) if self.settings.algorithm == "uniform" else effect * wish

    def hindering(self, sensor: str, effect: float, wish: float) -> float:
        """Magnitude, already divided among those who do the same."""
        count = self.with_effect(sensor, lambda e: e != 0.0 if wish == 0.0 else e * wish < 0.0)
        if self.settings.algorithm == "uniform":
            return -math.hypot(effect, wish) / count
        if wish == 0.0:
            return -abs(effect) / count
        product = abs(effect * wish)
        return (-0.1 if product == 1.0 else -(1.0 - product)) / count

    def goal_weights(self) -> dict[str, float]:
        on = {goal.name: goal.priority for goal in self.model.goals if self.goal_enabled[goal.name]}
        if not self.settings.goal_priority or len(set(on.values())) < 2:
            return dict.fromkeys(on, 1.0)
        least, most = min(on.values()), max(on.values())
        return {name: 1.0 + (priority - least) / (most - least) for name, priority in on.items()}

    def spread(self) -> None:
        total = sum(node.activation for name, node in self.nodes.items() if self.operational(name))
        self.total = total if total != 0.0 else 1.0
        for name, node in self.nodes.items():
            node.components = self.components(name)
        for node in self.nodes.values():
            node.activation = max(0.0, self.settings.activation_decay * node.activation + sum(node.components.values()))

    def components(self, name: str) -> dict[str, float]:
        weights = self.settings.weights
        goals, goal_inhibition = self.from_goals(name)
        successors, conflictors = self.from_others_wishes(name)
        ahead = self.plan[self.plan_index :]
        return {
            "preconditions": weights.situation * self.nodes[name].satisfaction,
            "goals": weights.goal * goals,
            "goal_inhibition": weights.conflictor * goal_inhibition,
            "predecessors": weights.predecessor * self.from_others_effects(name),
            "successors": weights.successor * successors,
            "conflictors": weights.conflictor * conflictors,
            "plan": weights.plan / (ahead.index(name) + 1) if name in ahead else 0.0,
        }

    def from_goals(self, name: str) -> tuple[float, float]:
        helped = hindered = 0.0
        for goal, weight in self.goal_weights().items():
            for sensor, wish in self.goal_wishes[goal]:
                for about, effect in self.effects(name):
                    if about != sensor or effect == 0.0:
                        continue
                    if effect * wish > 0.0:
                        sharing = self.with_effect(sensor, lambda e, w=wish: e * w > 0.0)
                        helped += self.helping(effect, wish) * weight / sharing
                    else:
                        hindered += self.hindering(sensor, effect, wish) * weight
        return helped, hindered

    def from_others_effects(self, name: str) -> float:
        given = 0.0
        for other, node in self.nodes.items():
            if other == name or not self.operational(other) or not node.ready:
                continue
            for sensor, wish in self.nodes[name].wishes:
                for about, effect in self.effects(other):
                    if about == sensor and effect * wish * node.satisfaction > 0.0:
                        flow = self.helping(effect, wish) * node.activation / self.total
                        given += flow / self.with_wish(sensor, wish)
        return given

    def from_others_wishes(self, name: str) -> tuple[float, float]:
        successors = conflictors = 0.0
        for other, node in self.nodes.items():
            if other == name or not self.operational(other):
                continue
            share = node.activation / self.total
            for sensor, wish in node.wishes:
                for about, effect in self.effects(name):
                    if about != sensor or effect == 0.0:
                        continue
                    if effect * wish > 0.0:
                        if not node.ready:
                            sharing = self.with_effect(sensor, lambda e, mine=effect: e * mine > 0.0)
                            successors += self.helping(effect, wish) * share / sharing
                    else:
                        conflictors += self.hindering(sensor, effect, wish) * share
        return successors, conflictors

    # selection

    def running(self) -> list[str]:
        return [name for name, node in self.nodes.items() if node.executing]

    def eligible(self) -> bool:
        return any(self.operational(name) and n.ready and n.activation > 0.0 for name, n in self.nodes.items())

    def select(self, advance: bool) -> None:
        self.thresholds.append(self.threshold)
        present = [name for name in self.nodes if self.nodes[name].present]
        selected: list[str] = []
        started = False
        for name in sorted(present, key=lambda name: -self.nodes[name].activation):  # stable: ties as registered
            node = self.nodes[name]
            if node.executing:
                if self.must_stop(name, len(selected)):
                    self.stop(name)
                else:
                    selected.append(name)
                    node.time += 1 if advance else 0
            elif node.manual or self.may_start(name, selected):
                node.executing, node.time, node.started = True, 0, True
                selected.append(name)
                started = True
        if started:
            self.threshold /= self.settings.threshold_decay
        elif not self.running() and any(self.operational(name) for name in present):
            self.threshold *= self.settings.threshold_decay

    def must_stop(self, name: str, selected: int) -> bool:
        node, declared, limit = self.nodes[name], self.declared[name], self.settings.max_parallel
        if node.manual or not declared.interruptable:
            return False
        timed_out = declared.timeout is not None and node.time >= declared.timeout
        too_many = limit is not None and selected >= limit
        return timed_out or not node.ready or node.activation < self.threshold or too_many

    def may_start(self, name: str, selected: list[str]) -> bool:
        node, limit = self.nodes[name], self.settings.max_parallel
        if not (node.enabled and node.ready and node.activation >= self.threshold):  # Q16: disabled never starts
            return False
        mine = {sensor for sensor, _ in self.effects(name)}
        clashing = [n for n in self.running() if mine & {sensor for sensor, _ in self.effects(n)}]
        if not all(self.yields(other, name) for other in clashing):
            return False
        for other in clashing:
            self.stop(other)
            if other in selected:
                selected.remove(other)
        by_hand = [n for n, other in self.nodes.items() if other.present and other.manual and n not in selected]
        return limit is None or len(selected) + len(by_hand) < limit

    def yields(self, running: str, starting: str) -> bool:
        one, other = self.nodes[running], self.nodes[starting]
        weaker = one.priority < other.priority or (one.priority == other.priority and one.activation < other.activation)
        return self.declared[running].interruptable and not one.manual and weaker

    def stop(self, name: str) -> None:
        node = self.nodes[name]
        node.executing, node.time = False, -1
        node.stopped = node.stopped or not node.started  # it ran before this step
        node.started = False
