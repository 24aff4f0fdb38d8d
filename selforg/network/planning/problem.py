"""A planning problem: facts and numbers, actions that change them, goals over them.

A problem is frozen data and knows no behaviour network: behaviours become actions (effects on facts set them,
effects on numbers change them), goals become conditions. The state it is asked for is two arrays,
`facts` (F,) bool and `numbers` (K,) float in the order of the names given here.

Expressions are small trees: `FactIs` and `NumberIs` are the leaves, `AllOf`, `AnyOf` and `Not` the branches. An empty
`AllOf` always holds, an empty `AnyOf` never does.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

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
    """Names of the facts (F) and numbers (K), the actions (B) and goals (G) over them; each name once in its kind."""

    facts: tuple[str, ...]
    numbers: tuple[str, ...]
    actions: tuple[PlanningAction, ...]
    goals: tuple[PlanningGoal, ...]
