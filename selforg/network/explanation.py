"""Explanation: the last step of one robot by name, what every behaviour got and why it runs or does not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.network import state as st
from selforg.network.model.activators import Activator
from selforg.network.model.behaviours import Behaviour
from selforg.network.model.conditions import Condition, Optional, Tree
from selforg.network.model.model import NetworkModel
from selforg.network.model.packed import DECIDE_ONLY, scratch_for
from selforg.network.network import BehaviourNetwork
from selforg.network.step.satisfaction import evaluate_conditions

TERM_TITLES = {  # short, so that a table fits on a terminal
    "preconditions": "situation",
    "goals": "goals",
    "goal_inhibition": "inhib.",
    "predecessors": "pred.",
    "successors": "succ.",
    "conflictors": "confl.",
    "plan": "plan",
}


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


def explain(network: BehaviourNetwork, row: int) -> Explanation:
    """Explain the last step of a row of an `explained` network."""
    return _RowReader(network, row).explanation()


class _RowReader:
    """Reads one row of a network with the model's names."""

    def __init__(self, network: BehaviourNetwork, row: int) -> None:
        self.model, self.state, self.row = network.model, network.state, row
        self.explained = network.explained
        self.names = [behaviour.name for behaviour in self.model.behaviours]
        self.nodes = _node_values(self.model, self.state.readings[row])

    def explanation(self) -> Explanation:
        state, row, model = self.state, self.row, self.model
        length, known = state.plan_marks[row, st.PLAN_LENGTH], state.plan_marks[row, st.PLAN_KNOWN]
        activation = state.values[row, st.ACTIVATION]
        order = [b for b in np.argsort(-activation, kind="stable") if state.marks[row, st.PRESENT, b]]
        return Explanation(
            threshold=float(state.row_values[row, st.THRESHOLD]),
            deciding=float(state.row_values[row, st.DECIDING]),
            total=float(state.row_values[row, st.TOTAL]),
            plan=tuple(self.names[b] for b in state.plan[row, :length]) if known else None,
            plan_index=int(state.plan_marks[row, st.PLAN_INDEX]),
            readings={
                sensor.name: float(value) for sensor, value in zip(model.sensors, state.readings[row], strict=True)
            },
            behaviours=tuple(self._behaviour(int(b)) for b in order),
            goals=tuple(self._goal(g) for g in range(len(model.goals))),
        )

    def _behaviour(self, b: int) -> BehaviourAccount:
        values, marks = self.state.values[self.row, :, b], self.state.marks[self.row, :, b]
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
        if not self.explained:
            return ""
        by = int(marks[st.BY])
        return st.WORDS[int(marks[st.REASON])].format(by=self.names[by] if by >= 0 else None)

    def _goal(self, g: int) -> GoalAccount:
        packed, goal = self.model.packed.record, self.model.goals[g]
        roots = packed.goal_node[packed.goal_first[g] : packed.goal_first[g + 1]]
        return GoalAccount(
            name=goal.name,
            enabled=bool(self.state.goal_enabled[self.row, g]),
            satisfaction=float(self.state.goal_satisfaction[self.row, g]),
            wishes=self._wishes(len(self.names) + g),
            conditions=tuple(self._tree(tree, int(root)) for tree, root in zip(goal.conditions, roots, strict=True)),
        )

    def _wishes(self, owner: int) -> tuple[tuple[str, float], ...]:
        packed = self.model.packed.record
        kept, wishes = self.state.wish_kept[self.row], self.state.wishes[self.row]
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
            reading = self.state.readings[self.row, self.model.sensor_index[tree.sensor]]
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
    scratch = scratch_for(model.packed.record, DECIDE_ONLY, 0)
    evaluate_conditions(np.ascontiguousarray(readings[None]), model.packed.handle, scratch.handle)
    return scratch.record.node_satisfaction


def header(explanation: Explanation) -> Iterator[str]:
    """Yield threshold and plan; the step that is due stands in brackets."""
    yield (
        f"threshold {explanation.threshold:.4g} (this step decided by {explanation.deciding:.4g}), "
        f"total activation before {explanation.total:.4g}"
    )
    if explanation.plan is None:
        yield "no plan"
        return
    steps = [f"[{name}]" if k == explanation.plan_index else name for k, name in enumerate(explanation.plan)]
    yield f"plan: {' > '.join(steps) or 'nothing to do'}"


def table(behaviours: Sequence[BehaviourAccount]) -> list[str]:
    """Return a line for each behaviour, with the terms that the step added to its activation; * marks what runs."""
    rows = [["", "behaviour", "active", *TERM_TITLES.values()], *map(_cells, behaviours)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [" ".join(_aligned(row, widths)).rstrip() for row in rows]


def condition_tree(explanation: Explanation) -> Iterator[str]:
    """Yield behaviours and goals with their wishes and conditions; * marks what runs."""
    for account in explanation.behaviours:
        mark, ready = "* " if account.running else "", "ready" if account.ready else "not ready"
        yield f"{mark}{account.name}: {account.why} ({ready}, satisfied {account.satisfaction:.3g}{_wishes(account)})"
        yield from _branches(account.conditions, "")
    for goal in explanation.goals:
        off = "" if goal.enabled else " (off)"
        yield f"goal {goal.name}{off}: satisfied {goal.satisfaction:.3g}{_wishes(goal)}"
        yield from _branches(goal.conditions, "")


def _cells(account: BehaviourAccount) -> list[str]:
    numbers = [account.activation, *(account.components[name] for name in TERM_TITLES)]
    return ["*" if account.running else "", account.name, *(f"{number:.2f}" for number in numbers)]


def _aligned(row: list[str], widths: list[int]) -> list[str]:
    """Pad cells to a width: marks and names to the left, numbers to the right."""
    return [text.ljust(w) if k < 2 else text.rjust(w) for k, (text, w) in enumerate(zip(row, widths, strict=True))]


def _wishes(account: BehaviourAccount | GoalAccount) -> str:
    wished = [f"{sensor} {wish:+.3g}" for sensor, wish in account.wishes if wish != 0.0]
    return f", wishes {', '.join(wished)}" if wished else ""


def _branches(accounts: Sequence[ConditionAccount], indent: str) -> Iterator[str]:
    for k, account in enumerate(accounts):
        last = k == len(accounts) - 1
        yield f"{indent}{'└─' if last else '├─'} {account.label}: {account.satisfaction:.3g}"
        yield from _branches(account.parts, indent + ("   " if last else "│  "))
