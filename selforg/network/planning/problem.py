"""A planning problem: facts and numbers, actions that change them, goals over them.

A problem is frozen data and knows no behaviour network: behaviours become actions (effects on facts set them,
effects on numbers change them), goals become conditions. The state it is asked for is two arrays,
`facts` (F,) bool and `numbers` (K,) float in the order of the names given here.

Expressions are small trees: `FactIs` and `NumberIs` are the leaves, `AllOf`, `AnyOf` and `Not` the branches. An empty
`AllOf` always holds, an empty `AnyOf` never does.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

Relation: TypeAlias = Literal[">=", "<=", ">", "<"]


@dataclass(frozen=True)
class FactIs:
    """Fact number `fact` has the value `wanted`."""

    fact: int
    wanted: bool = True


@dataclass(frozen=True)
class NumberIs:
    """Number `number` stands in `relation` to `value`, in the unit of its sensor."""

    number: int
    relation: Relation
    value: float


@dataclass(frozen=True)
class AllOf:
    """Every part holds."""

    parts: "tuple[Expression, ...]"


@dataclass(frozen=True)
class AnyOf:
    """At least one part holds."""

    parts: "tuple[Expression, ...]"


@dataclass(frozen=True)
class Not:
    """The part does not hold."""

    part: "Expression"


Expression: TypeAlias = FactIs | NumberIs | AllOf | AnyOf | Not


@dataclass(frozen=True)
class SetFact:
    """Afterwards fact number `fact` has this value."""

    fact: int
    value: bool = True


@dataclass(frozen=True)
class ChangeNumber:
    """Afterwards number `number` is larger by `change` (smaller if negative)."""

    number: int
    change: float


PlanEffect: TypeAlias = SetFact | ChangeNumber


@dataclass(frozen=True)
class PlanningAction:
    """One step a plan may take: allowed where all preconditions hold; all effects happen at once; `cost` >= 0."""

    name: str
    preconditions: tuple[Expression, ...]
    effects: tuple[PlanEffect, ...]
    cost: float = 1.0


@dataclass(frozen=True)
class PlanningGoal:
    """A condition that should hold when the plan ends; a larger `priority` is given up later."""

    name: str
    condition: Expression
    priority: int = 0


@dataclass(frozen=True)
class PlanningProblem:
    """Names of the facts (F) and numbers (K), the actions (B) and goals (G) over them, checked when built.

    Raises:
        ValueError: a name given twice, an index without a name, a value that is not finite, a negative cost, or one
            action that sets a fact both ways.

    """

    facts: tuple[str, ...]
    numbers: tuple[str, ...]
    actions: tuple[PlanningAction, ...]
    goals: tuple[PlanningGoal, ...]

    def __post_init__(self) -> None:
        """Refuse a problem that no planner could read."""
        _check_unique("fact", self.facts)
        _check_unique("number", self.numbers)
        _check_unique("action", [action.name for action in self.actions])
        _check_unique("goal", [goal.name for goal in self.goals])
        for action in self.actions:
            self._check_action(action)
        for goal in self.goals:
            for leaf in atoms(goal.condition):
                self._check_leaf(leaf, f"goal '{goal.name}'")

    def _check_action(self, action: PlanningAction) -> None:
        where = f"action '{action.name}'"
        if not (math.isfinite(action.cost) and action.cost >= 0.0):
            raise ValueError(f"{where}: cost must be finite and >= 0, got {action.cost}")
        for leaf in atoms(AllOf(action.preconditions)):
            self._check_leaf(leaf, where)
        values: dict[int, bool] = {}
        for effect in action.effects:
            self._check_effect(effect, where)
            if isinstance(effect, SetFact) and values.setdefault(effect.fact, effect.value) != effect.value:
                raise ValueError(f"{where}: sets fact '{self.facts[effect.fact]}' to true and to false")

    def _check_effect(self, effect: PlanEffect, where: str) -> None:
        if isinstance(effect, SetFact):
            _check_index("fact", effect.fact, self.facts, where)
            return
        _check_index("number", effect.number, self.numbers, where)
        if not math.isfinite(effect.change):
            name = self.numbers[effect.number]
            raise ValueError(f"{where}: change of '{name}' must be finite, got {effect.change}")

    def _check_leaf(self, leaf: FactIs | NumberIs, where: str) -> None:
        if isinstance(leaf, FactIs):
            _check_index("fact", leaf.fact, self.facts, where)
            return
        _check_index("number", leaf.number, self.numbers, where)
        name = self.numbers[leaf.number]
        if leaf.relation not in get_args(Relation):
            raise ValueError(
                f"{where}: relation on '{name}' must be one of {get_args(Relation)}, got {leaf.relation!r}"
            )
        if not math.isfinite(leaf.value):
            raise ValueError(f"{where}: bound on '{name}' must be finite, got {leaf.value}")


def atoms(expression: Expression) -> Iterator[FactIs | NumberIs]:
    """Yield the leaves of an expression from left to right."""
    match expression:
        case FactIs() | NumberIs():
            yield expression
        case Not(part):
            yield from atoms(part)
        case AllOf(parts) | AnyOf(parts):
            for part in parts:
                yield from atoms(part)


def constants(problem: PlanningProblem) -> Iterator[tuple[int, float]]:
    """Yield (number, value) for every change and every bound of a problem."""
    for action in problem.actions:
        yield from ((e.number, e.change) for e in action.effects if isinstance(e, ChangeNumber))
    trees = [AllOf(action.preconditions) for action in problem.actions]
    for tree in (*trees, *(goal.condition for goal in problem.goals)):
        yield from ((leaf.number, leaf.value) for leaf in atoms(tree) if isinstance(leaf, NumberIs))


def _check_unique(kind: str, names: Sequence[str]) -> None:
    for position, name in enumerate(names):
        if name in names[:position]:
            raise ValueError(f"{kind} '{name}' is declared twice")


def _check_index(kind: str, index: int, names: Sequence[str], where: str) -> None:
    if not 0 <= index < len(names):
        raise ValueError(f"{where}: {kind} index must be in 0..{len(names) - 1}, got {index}")
