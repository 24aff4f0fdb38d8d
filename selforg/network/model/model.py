"""A network model: sensors, behaviours and goals, checked and packed for the kernels.

A model is built once; `BehaviourNetwork` runs it for any number of rows.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Iterable, Sequence

from selforg.network.model import packed as t
from selforg.network.model.activators import BOOLEAN, EQUAL, THRESHOLD
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Leaf, Negation, Optional, Tree, leaves

Entry = tuple[int, int]  # an effect or a wish, and the sensor it is about
LEAF_NUMBERS = (t.LEAF_A, t.LEAF_B, t.LEAF_LOW, t.LEAF_HIGH, t.LEAF_DIRECTION)
_COMPOSED = {Conjunction: t.CONJUNCTION, Disjunction: t.DISJUNCTION}


class NetworkModel:
    """The declared network and its packed form.

    Attributes:
        ints, floats: the packed form, see `tables`.
        precondition_roots: for each behaviour the nodes of its preconditions, of optional ones and alternatives too.

    Raises:
        ValueError: for a doubled name, an unknown sensor, or an activator that does not fit the sensor's kind.

    Warns:
        UserWarning: for an effect larger than 1, by which the default algorithm turns inhibition into support (Q17).

    """

    def __init__(
        self,
        sensors: Sequence[Sensor],
        behaviours: Sequence[Behaviour],
        goals: Sequence[Goal],
        settings: NetworkSettings | None = None,
    ) -> None:
        self.sensors = tuple(sensors)
        self.behaviours = tuple(behaviours)
        self.goals = tuple(goals)
        self.settings = settings or NetworkSettings()
        self.sensor_index = _index("sensor", [s.name for s in self.sensors])
        self.behaviour_index = _index("behaviour", [b.name for b in self.behaviours])
        self.goal_index = _index("goal", [g.name for g in self.goals])
        packer = _Packer(self)
        self.ints, self.floats = packer.packed()
        self.precondition_roots = tuple(map(tuple, packer.roots))

    def sensor(self, name: str, where: str) -> int:
        """Index of the sensor `name`, which `where` refers to."""
        if name not in self.sensor_index:
            known = ", ".join(self.sensor_index)
            raise ValueError(f"{where}: unknown sensor {name!r} (known: {known})")
        return self.sensor_index[name]


def _index(what: str, names: Sequence[str]) -> dict[str, int]:
    index = {name: k for k, name in enumerate(names)}
    if len(index) < len(names):
        doubled = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"{what} names must be unique, got more than once: {', '.join(doubled)}")
    return index


class _Packer:
    """Walks a model once and collects the sections of `tables`."""

    def __init__(self, model: NetworkModel) -> None:
        self.model = model
        self.ints: dict[int, list[int]] = defaultdict(list)
        self.floats: dict[int, list[float]] = defaultdict(list)
        self.roots: list[list[int]] = [[] for _ in model.behaviours]
        self.leaves: dict[tuple[int, int, tuple[float, ...]], int] = {}  # equal conditions are one leaf

    def packed(self) -> tuple[t.Ints, t.Floats]:
        self.ints[t.NODE_FIRST].append(0)
        self.ints[t.TURN_FIRST].append(0)
        for behaviour in range(len(self.model.behaviours)):
            self._behaviour(behaviour)
        self._close(t.PRECONDITION_FIRST, t.PRECONDITION_NODE)
        self._close(t.EFFECT_FIRST, t.EFFECT_SENSOR)
        for goal in range(len(self.model.goals)):
            self._goal(goal)
        self._close(t.GOAL_FIRST, t.GOAL_NODE)
        self._close(t.WISH_FIRST, t.WISH_SENSOR)
        self._by_sensor()
        self._settings()
        return t.pack_ints(self.ints), t.pack_floats(self.floats)

    def _behaviour(self, b: int) -> None:
        behaviour = self.model.behaviours[b]
        where = f"behaviour {behaviour.name!r}"
        for first, content in (
            (t.PRECONDITION_FIRST, t.PRECONDITION_NODE),
            (t.EFFECT_FIRST, t.EFFECT_SENSOR),
            (t.WISH_FIRST, t.WISH_SENSOR),
        ):
            self._close(first, content)
        for tag, interface in behaviour.interfaces:
            for precondition in interface.preconditions:
                optional = isinstance(precondition, Optional)
                node = self._tree(precondition.of if optional else precondition, b, tag, where)  # type: ignore[union-attr,arg-type]
                self.roots[b].append(node)
                if not optional:
                    self.ints[t.PRECONDITION_NODE].append(node)
                    self.ints[t.PRECONDITION_TAG].append(tag)
            for effect in interface.effects:
                self._warn_of_large(effect, where)
                self.ints[t.EFFECT_OWNER].append(b)
                self.ints[t.EFFECT_SENSOR].append(self.model.sensor(effect.sensor, where))
                self.ints[t.EFFECT_TAG].append(tag)
                self.floats[t.EFFECT_CHANGE].append(effect.change)
        self.ints[t.INTERRUPTABLE].append(int(behaviour.interruptable))
        self.ints[t.TIMEOUT].append(-1 if behaviour.timeout is None else behaviour.timeout)
        self.floats[t.READY_THRESHOLD].append(behaviour.ready_threshold)

    def _warn_of_large(self, effect: Effect, where: str) -> None:
        if abs(effect.change) > 1.0 and self.model.settings.algorithm == "default":
            told = (
                f"{where}: effect {effect.change} on {effect.sensor!r} is larger than 1: it can support what it hinders"
            )
            warnings.warn(told, stacklevel=5)

    def _goal(self, g: int) -> None:
        goal = self.model.goals[g]
        self._close(t.GOAL_FIRST, t.GOAL_NODE)
        self._close(t.WISH_FIRST, t.WISH_SENSOR)
        for condition in goal.conditions:
            node = self._tree(condition, len(self.model.behaviours) + g, -1, f"goal {goal.name!r}")
            self.ints[t.GOAL_NODE].append(node)
        self.ints[t.PERMANENT].append(int(goal.permanent))
        self.floats[t.GOAL_THRESHOLD].append(goal.satisfaction_threshold)

    def _tree(self, tree: Tree, owner: int, tag: int, where: str) -> int:
        """Add a condition tree's nodes and its owner's wishes; return the root node."""
        root = self._node(tree, where)
        for leaf in leaves(tree):
            self._wish(leaf, self._leaf(leaf.condition, where), owner, tag, where)
        return root

    def _node(self, tree: Tree, where: str) -> int:
        if isinstance(tree, Condition):
            return self._close_node(t.LEAF, [self._leaf(tree, where)])
        if isinstance(tree, Negation):
            return self._close_node(t.NEGATION, [self._node(tree.of, where)])
        return self._close_node(_COMPOSED[type(tree)], [self._node(branch, where) for branch in tree.of])

    def _close_node(self, kind: int, children: Iterable[int]) -> int:
        self.ints[t.NODE_CHILD].extend(children)
        self.ints[t.NODE_KIND].append(kind)
        self._close(t.NODE_FIRST, t.NODE_CHILD)
        return len(self.ints[t.NODE_KIND]) - 1

    def _leaf(self, condition: Condition, where: str) -> int:
        activator = condition.activator
        sensor = self.model.sensor(condition.sensor, where)
        is_fact = self.model.sensors[sensor].kind == "fact"
        fits = activator.kind in (THRESHOLD, EQUAL) or is_fact == (activator.kind == BOOLEAN)
        if not fits:
            kind = self.model.sensors[sensor].kind
            raise ValueError(f"{where}: {type(activator).__name__} does not fit sensor {condition.sensor!r} (a {kind})")
        numbers = (*activator.parameters, activator.low, activator.high, activator.direction)
        known = self.leaves.setdefault((sensor, activator.kind, numbers), len(self.leaves))
        if known == len(self.ints[t.LEAF_SENSOR]):
            self.ints[t.LEAF_SENSOR].append(sensor)
            self.ints[t.LEAF_KIND].append(activator.kind)
            for section, number in zip(LEAF_NUMBERS, numbers, strict=True):
                self.floats[section].append(number)
        return known

    def _wish(self, leaf: Leaf, index: int, owner: int, tag: int, where: str) -> None:
        self.ints[t.WISH_OWNER].append(owner)
        self.ints[t.WISH_SENSOR].append(self.model.sensor(leaf.condition.sensor, where))
        self.ints[t.WISH_LEAF].append(index)
        self.ints[t.WISH_TAG].append(tag)
        self.floats[t.TURN_DIRECTION].extend(leaf.directions)
        self.ints[t.TURN_FIRST].append(len(self.floats[t.TURN_DIRECTION]))

    def _close(self, first: int, content: int) -> None:
        """Note where the next owner's entries begin (or the last one's end)."""
        self.ints[first].append(len(self.ints[content]))

    def _by_sensor(self) -> None:
        """Index effects and wishes by the sensor they are about."""
        behaviours = len(self.model.behaviours)
        owners = self.ints[t.WISH_OWNER]
        about = self.ints[t.WISH_SENSOR]
        of_behaviours = [(u, about[u]) for u, owner in enumerate(owners) if owner < behaviours]
        of_goals = [(u, about[u]) for u, owner in enumerate(owners) if owner >= behaviours]
        effects = list(enumerate(self.ints[t.EFFECT_SENSOR]))
        for first, content, entries in (
            (t.SENSOR_EFFECT_FIRST, t.SENSOR_EFFECT, effects),
            (t.SENSOR_WISH_FIRST, t.SENSOR_WISH, of_behaviours),
            (t.SENSOR_GOAL_WISH_FIRST, t.SENSOR_GOAL_WISH, of_goals),
        ):
            for sensor in range(len(self.model.sensors)):
                self._close(first, content)
                self.ints[content].extend(k for k, s in entries if s == sensor)
            self._close(first, content)
        self._pair(effects, of_behaviours, t.PAIR_EFFECT, t.PAIR_WISH)
        self._pair(effects, of_goals, t.GOAL_PAIR_EFFECT, t.GOAL_PAIR_WISH)

    def _pair(self, effects: list[Entry], wishes: list[Entry], effect_section: int, wish_section: int) -> None:
        """List which effect meets which wish: same sensor, different owners."""
        for sensor in range(len(self.model.sensors)):
            about = [u for u, s in wishes if s == sensor]
            for e in (e for e, s in effects if s == sensor):
                met = [u for u in about if self.ints[t.WISH_OWNER][u] != self.ints[t.EFFECT_OWNER][e]]
                self.ints[effect_section].extend([e] * len(met))
                self.ints[wish_section].extend(met)

    def _settings(self) -> None:
        model, settings = self.model, self.model.settings
        self.ints[t.SENSOR_IS_FACT] = [int(sensor.kind == "fact") for sensor in model.sensors]
        counts = [len(model.sensors), len(model.behaviours), len(model.goals)]
        self.ints[t.SIZES] = [*counts, len(self.ints[t.NODE_KIND]), len(self.ints[t.WISH_SENSOR])]
        self.ints[t.OPTIONS] = [
            int(settings.algorithm == "uniform"),
            settings.max_parallel or 0,
            int(settings.goal_priority),
            int(settings.strict_progress),
        ]
        w = settings.weights
        self.floats[t.WEIGHTS] = [w.situation, w.goal, w.conflictor, w.predecessor, w.successor, w.plan]
        self.floats[t.DYNAMICS] = [settings.activation_decay, settings.threshold_decay]
        self.floats[t.GOAL_PRIORITY] = [float(goal.priority) for goal in model.goals]
