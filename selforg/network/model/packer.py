"""Packing a network model: declared behaviours and goals become the arrays of `PackedModel`."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.records import Packed
from selforg.network.model import packed
from selforg.network.model.activators import BOOLEAN_RULE, EQUAL_RULE, THRESHOLD_RULE
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings, Sensor, column_of
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional, Tree, leaves
from selforg.network.model.packed import PackedModel

COMPOSED = {Conjunction: packed.CONJUNCTION, Disjunction: packed.DISJUNCTION}

Pair = tuple[int, int]  # an effect and a wish


class LeafRow(NamedTuple):
    """A condition: its sensor, and its activator in numbers."""

    sensor: int
    kind: int
    a: float
    b: float
    low: float
    high: float
    direction: float


class RootRow(NamedTuple):
    """The node that a precondition of a behaviour, or a condition of a goal, is satisfied by."""

    owner: int
    node: int
    tag: int


class EffectRow(NamedTuple):
    """An effect of behaviour `owner`."""

    owner: int
    sensor: int
    tag: int
    change: float


class WishRow(NamedTuple):
    """A wish of behaviour `owner`, or of goal `owner` - B."""

    owner: int
    sensor: int
    leaf: int
    tag: int
    optional: bool
    directions: tuple[float, ...]


class Packer:
    """Walks the behaviours, then the goals of one model, and collects what they have.

    Attributes:
        roots: for each behaviour the nodes of its preconditions, of optional ones and alternatives too.

    """

    def __init__(
        self,
        sensors: Sequence[Sensor],
        behaviours: Sequence[Behaviour],
        goals: Sequence[Goal],
        settings: NetworkSettings,
    ) -> None:
        self.sensors, self.behaviours, self.goals, self.settings = sensors, behaviours, goals, settings
        self.roots: list[list[int]] = [[] for _ in behaviours]
        self._columns = {sensor.name: column for column, sensor in enumerate(sensors)}
        self._leaves: dict[LeafRow, int] = {}  # equal conditions are one leaf
        self._nodes: list[tuple[int, list[int]]] = []  # kind and children
        self._preconditions: list[RootRow] = []
        self._conditions: list[RootRow] = []
        self._effects: list[EffectRow] = []
        self._wishes: list[WishRow] = []

    def pack(self) -> Packed[PackedModel]:
        """Return the packed model."""
        for b, behaviour in enumerate(self.behaviours):
            self._add_behaviour(b, behaviour)
        for g, goal in enumerate(self.goals):
            for condition in goal.conditions:
                node = self._add_tree(condition, len(self.behaviours) + g, -1, f"goal {goal.name!r}")
                self._conditions.append(RootRow(g, node, -1))
        return Packed(self._record())

    def _add_behaviour(self, b: int, behaviour: Behaviour) -> None:
        where = f"behaviour {behaviour.name!r}"
        for tag, interface in behaviour.interfaces:
            for precondition in interface.preconditions:
                node = self._add_tree(precondition, b, tag, where)
                if not isinstance(precondition, Optional):
                    self._preconditions.append(RootRow(b, node, tag))
                self.roots[b].append(node)
            for effect in interface.effects:
                if abs(effect.change) > 1.0 and self.settings.algorithm == "default":
                    what = f"effect {effect.change} on {effect.sensor!r} is larger than 1"
                    warnings.warn(f"{where}: {what}: it can support what it hinders", stacklevel=4)
                self._effects.append(EffectRow(b, column_of(self._columns, effect.sensor, where), tag, effect.change))

    def _add_tree(self, condition: Tree | Optional, owner: int, tag: int, where: str) -> int:
        """Add the nodes of a condition tree and the wishes of its owner; return the root node."""
        optional = isinstance(condition, Optional)
        tree = condition.of if isinstance(condition, Optional) else condition
        root = self._add_node(tree, where)
        for leaf in leaves(tree):
            sensor = column_of(self._columns, leaf.condition.sensor, where)
            index = self._add_leaf(leaf.condition, where)
            self._wishes.append(WishRow(owner, sensor, index, tag, optional, leaf.directions))
        return root

    def _add_node(self, tree: Tree, where: str) -> int:
        if isinstance(tree, Condition):
            node = packed.LEAF, [self._add_leaf(tree, where)]
        elif isinstance(tree, Negation):
            node = packed.NEGATION, [self._add_node(tree.of, where)]
        else:
            node = COMPOSED[type(tree)], [self._add_node(branch, where) for branch in tree.of]
        self._nodes.append(node)
        return len(self._nodes) - 1

    def _add_leaf(self, condition: Condition, where: str) -> int:
        activator = condition.activator
        column = column_of(self._columns, condition.sensor, where)
        kind = self.sensors[column].kind
        if activator.kind not in (THRESHOLD_RULE, EQUAL_RULE) and (kind == "fact") != (activator.kind == BOOLEAN_RULE):
            raise ValueError(f"{where}: {type(activator).__name__} does not fit sensor {condition.sensor!r} (a {kind})")
        a, b, direction = activator.parameters
        row = LeafRow(column, activator.kind, a, b, activator.low, activator.high, direction)
        return self._leaves.setdefault(row, len(self._leaves))

    def _pairs(self, of_goals: bool) -> list[Pair]:
        """Return which effect meets which wish, of goals or of other behaviours, about one sensor, by sensor."""
        return [
            (e, u)
            for sensor in range(len(self.sensors))
            for e, effect in enumerate(self._effects)
            if effect.sensor == sensor
            for u, wish in enumerate(self._wishes)
            if wish.sensor == sensor and wish.owner != effect.owner
            if (wish.owner >= len(self.behaviours)) == of_goals
        ]

    def _record(self) -> PackedModel:
        sensors, behaviours, goals = len(self.sensors), len(self.behaviours), len(self.goals)
        effects, wishes, settings = self._effects, self._wishes, self.settings
        about_effects = [(effect.sensor, e) for e, effect in enumerate(effects)]
        about_wishes = [(wish.sensor, u) for u, wish in enumerate(wishes) if wish.owner < behaviours]
        about_goal_wishes = [(wish.sensor, u) for u, wish in enumerate(wishes) if wish.owner >= behaviours]
        pairs, goal_pairs = self._pairs(of_goals=False), self._pairs(of_goals=True)
        return PackedModel(
            is_fact=ints(sensor.kind == "fact" for sensor in self.sensors),
            leaf_sensor=ints(leaf.sensor for leaf in self._leaves),
            leaf_kind=ints(leaf.kind for leaf in self._leaves),
            leaf_a=floats(leaf.a for leaf in self._leaves),
            leaf_b=floats(leaf.b for leaf in self._leaves),
            leaf_low=floats(leaf.low for leaf in self._leaves),
            leaf_high=floats(leaf.high for leaf in self._leaves),
            leaf_direction=floats(leaf.direction for leaf in self._leaves),
            node_kind=ints(kind for kind, _ in self._nodes),
            node_first=firsts((k for k, (_, children) in enumerate(self._nodes) for _ in children), len(self._nodes)),
            node_child=ints(child for _, children in self._nodes for child in children),
            precondition_first=firsts((root.owner for root in self._preconditions), behaviours),
            precondition_node=ints(root.node for root in self._preconditions),
            precondition_tag=ints(root.tag for root in self._preconditions),
            ready_threshold=floats(behaviour.ready_threshold for behaviour in self.behaviours),
            priority=ints(behaviour.priority for behaviour in self.behaviours),
            interruptable=ints(behaviour.interruptable for behaviour in self.behaviours),
            timeout=ints(-1 if behaviour.timeout is None else behaviour.timeout for behaviour in self.behaviours),
            independent=ints(behaviour.planner_independent for behaviour in self.behaviours),
            effect_first=firsts((effect.owner for effect in effects), behaviours),
            effect_owner=ints(effect.owner for effect in effects),
            effect_sensor=ints(effect.sensor for effect in effects),
            effect_tag=ints(effect.tag for effect in effects),
            effect_change=floats(effect.change for effect in effects),
            goal_first=firsts((root.owner for root in self._conditions), goals),
            goal_node=ints(root.node for root in self._conditions),
            goal_permanent=ints(goal.permanent for goal in self.goals),
            goal_threshold=floats(goal.satisfaction_threshold for goal in self.goals),
            goal_priority=floats(goal.priority for goal in self.goals),
            wish_first=firsts((wish.owner for wish in wishes), behaviours + goals),
            wish_owner=ints(wish.owner for wish in wishes),
            wish_sensor=ints(wish.sensor for wish in wishes),
            wish_leaf=ints(wish.leaf for wish in wishes),
            wish_tag=ints(wish.tag for wish in wishes),
            wish_optional=ints(wish.optional for wish in wishes),
            turn_first=firsts((u for u, wish in enumerate(wishes) for _ in wish.directions), len(wishes)),
            turn_direction=floats(direction for wish in wishes for direction in wish.directions),
            sensor_effect_first=firsts((sensor for sensor, _ in about_effects), sensors),
            sensor_effect=ints(e for _, e in sorted(about_effects)),
            sensor_wish_first=firsts((sensor for sensor, _ in about_wishes), sensors),
            sensor_wish=ints(u for _, u in sorted(about_wishes)),
            sensor_goal_wish_first=firsts((sensor for sensor, _ in about_goal_wishes), sensors),
            sensor_goal_wish=ints(u for _, u in sorted(about_goal_wishes)),
            pairs=ints(
                n for e, u in pairs for n in (e, u, effects[e].owner, wishes[u].owner, effects[e].sensor)
            ).reshape(-1, 5),
            goal_pair_effect=ints(e for e, _ in goal_pairs),
            goal_pair_wish=ints(u for _, u in goal_pairs),
            uniform=int(settings.algorithm == "uniform"),
            max_parallel=settings.max_parallel or 0,
            by_goal_priority=int(settings.goal_priority),
            strict_progress=int(settings.strict_progress),
            situation_weight=settings.weights.situation,
            goal_weight=settings.weights.goal,
            conflictor_weight=settings.weights.conflictor,
            predecessor_weight=settings.weights.predecessor,
            successor_weight=settings.weights.successor,
            plan_weight=settings.weights.plan,
            activation_decay=settings.activation_decay,
            activation_threshold=settings.activation_threshold,
            threshold_decay=settings.threshold_decay,
        )


def ints(values: Iterable[int]) -> Ints:
    """Return whole numbers as an array."""
    return np.array(list(values), dtype=np.int64)


def floats(values: Iterable[float]) -> Floats:
    """Return numbers as an array."""
    return np.array(list(values), dtype=np.float64)


def firsts(owners: Iterable[int], count: int) -> Ints:
    """Return (count + 1,) where the entries of each owner begin when entries are sorted by owner."""
    return np.searchsorted(np.sort(ints(owners)), np.arange(count + 1)).astype(np.int64)
