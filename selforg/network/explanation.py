"""Explanation: a recorded step of one robot by name, what every behaviour got and why it runs or does not."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.network import plan_state as ps
from selforg.network import reasons as why
from selforg.network import state as st
from selforg.network.model.activators import Activator
from selforg.network.model.behaviours import Behaviour
from selforg.network.model.conditions import Condition, Optional, Tree
from selforg.network.model.model import NetworkModel
from selforg.network.model.packed import scratch_for
from selforg.network.recording import StepRecord
from selforg.network.step.satisfaction import evaluate_conditions


@dataclass(frozen=True)
class ConditionAccount:
    """A condition or a composition of conditions: what it is, and how far it is satisfied."""

    label: str
    satisfaction: float
    parts: tuple[ConditionAccount, ...] = ()


@dataclass(frozen=True)
class BehaviourAccount:
    """A behaviour after the step; `components` are what the step added to its activation."""

    name: str
    running: bool
    why: str
    activation: float
    satisfaction: float
    ready: bool
    components: dict[str, float]
    wishes: tuple[tuple[str, float], ...]
    conditions: tuple[ConditionAccount, ...]


@dataclass(frozen=True)
class GoalAccount:
    """A goal after the step."""

    name: str
    enabled: bool
    satisfaction: float
    wishes: tuple[tuple[str, float], ...]
    conditions: tuple[ConditionAccount, ...]


@dataclass(frozen=True)
class Explanation:
    """One step of one robot.

    Attributes:
        threshold: after the step.
        deciding: the threshold that activations were compared with.
        total: activation of all behaviours before the step.
        plan: names of its behaviours; None without a plan.
        plan_index: position of the one that is due.
        readings: what the sensors read, by name.
        behaviours: in falling activation, those that are not in the network left out.
        goals: in the model's order.

    """

    threshold: float
    deciding: float
    total: float
    plan: tuple[str, ...] | None
    plan_index: int
    readings: dict[str, float]
    behaviours: tuple[BehaviourAccount, ...]
    goals: tuple[GoalAccount, ...]


def explain(model: NetworkModel, record: StepRecord, row: int) -> Explanation:
    """Explain the step `record` of `row`, a row of the network.

    Raises:
        ValueError: a row that was not recorded.

    """
    found = np.flatnonzero(record.rows == row)
    if not len(found):
        raise ValueError(f"row {row} was not recorded (recorded: {', '.join(map(str, record.rows.tolist()))})")
    return _RecordReader(model, record, int(found[0])).explanation()


class _RecordReader:
    """Reads one row of a record with the model's names."""

    def __init__(self, model: NetworkModel, record: StepRecord, k: int) -> None:
        self.model, self.record, self.k = model, record, k
        self.names = [behaviour.name for behaviour in model.behaviours]
        self.nodes = _node_values(model, record.readings[k])

    def explanation(self) -> Explanation:
        record, k, model = self.record, self.k, self.model
        length, known = record.plan_marks[ps.LENGTH, k], record.plan_marks[ps.KNOWN, k]
        activation = record.values[st.ACTIVATION, k]
        order = [b for b in np.argsort(-activation, kind="stable") if record.marks[st.PRESENT, k, b]]
        return Explanation(
            threshold=float(record.row_values[st.THRESHOLD, k]),
            deciding=float(record.row_values[st.DECIDING, k]),
            total=float(record.row_values[st.TOTAL, k]),
            plan=tuple(self.names[b] for b in record.plan[k, :length]) if known else None,
            plan_index=int(record.plan_marks[ps.INDEX, k]),
            readings={
                sensor.name: float(value) for sensor, value in zip(model.sensors, record.readings[k], strict=True)
            },
            behaviours=tuple(self._behaviour(int(b)) for b in order),
            goals=tuple(self._goal(g) for g in range(len(model.goals))),
        )

    def _behaviour(self, b: int) -> BehaviourAccount:
        values, marks = self.record.values[:, self.k, b], self.record.marks[:, self.k, b]
        return BehaviourAccount(
            name=self.names[b],
            running=bool(marks[st.EXECUTING]),
            why=self._why(marks),
            activation=float(values[st.ACTIVATION]),
            satisfaction=float(values[st.SATISFACTION]),
            ready=bool(marks[st.READY]),
            components={name: float(values[layer]) for name, layer in st.COMPONENTS.items()},
            wishes=self._wishes(b),
            conditions=tuple(self._conditions_of(b, self.model.behaviours[b], int(marks[st.ALTERNATIVE]))),
        )

    def _why(self, marks: Ints) -> str:
        if len(marks) < st.EXPLAINED_LAYERS:
            return ""
        by = int(marks[st.BY])
        return why.WORDS[int(marks[st.REASON])].format(by=self.names[by] if by >= 0 else None)

    def _goal(self, g: int) -> GoalAccount:
        packed, goal = self.model.packed.record, self.model.goals[g]
        roots = packed.goal_node[packed.goal_first[g] : packed.goal_first[g + 1]]
        return GoalAccount(
            name=goal.name,
            enabled=bool(self.record.goal_enabled[self.k, g]),
            satisfaction=float(self.record.goal_satisfaction[self.k, g]),
            wishes=self._wishes(len(self.names) + g),
            conditions=tuple(self._tree(tree, int(root)) for tree, root in zip(goal.conditions, roots, strict=True)),
        )

    def _wishes(self, owner: int) -> tuple[tuple[str, float], ...]:
        packed = self.model.packed.record
        kept, wishes = self.record.wish_kept[self.k], self.record.wishes[self.k]
        mine = range(packed.wish_first[owner], packed.wish_first[owner + 1])
        return tuple((self.model.sensors[packed.wish_sensor[u]].name, float(wishes[u])) for u in mine if kept[u])

    def _conditions_of(self, b: int, behaviour: Behaviour, alternative: int) -> list[ConditionAccount]:
        roots = iter(self.model.precondition_roots[b])
        accounts = []
        for tag, interface in behaviour.interfaces:
            for precondition in interface.preconditions:
                tree = precondition.of if isinstance(precondition, Optional) else precondition
                account = self._tree(tree, next(roots))
                if isinstance(precondition, Optional):
                    account = ConditionAccount(f"optional: {account.label}", account.satisfaction, account.parts)
                if tag in (-1, alternative):
                    accounts.append(account)
        return accounts

    def _tree(self, tree: Tree, node: int) -> ConditionAccount:
        value = float(self.nodes[node])
        if isinstance(tree, Condition):
            reading = self.record.readings[self.k, self.model.sensor_index[tree.sensor]]
            return ConditionAccount(f"{tree.sensor} = {reading:.4g}, {in_short(tree.activator)}", value)
        below = tree.of if isinstance(tree.of, tuple) else (tree.of,)
        packed = self.model.packed.record
        children = packed.node_child[packed.node_first[node] : packed.node_first[node + 1]]
        parts = zip(below, children, strict=True)
        return ConditionAccount(type(tree).__name__, value, tuple(self._tree(part, int(at)) for part, at in parts))


def in_short(activator: Activator) -> str:
    """Return an activator as it would be written, without what has its default."""
    changed = [f for f in fields(activator) if f.name not in ("low", "high") or getattr(activator, f.name) != f.default]
    return f"{type(activator).__name__}({', '.join(f'{f.name}={getattr(activator, f.name)}' for f in changed)})"


def _node_values(model: NetworkModel, readings: Floats) -> Floats:
    """Return the satisfaction of every node (C,) at `readings` (S,)."""
    scratch = scratch_for(model.packed.record)
    evaluate_conditions(np.ascontiguousarray(readings[None]), model.packed.words, scratch.words)
    return scratch.record.node_satisfaction
