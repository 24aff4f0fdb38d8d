"""Document models of conditions, behaviours and goals.

Their keys are the parameters of the classes in `selforg.network`, so that a model reads the same in YAML and in Python.
The key `type` names the class; a condition without `type` is a `Condition`. `optional: true` makes a precondition
optional:

    preconditions:
      - {sensor: rep_bool, activator: {type: Boolean}}
      - {sensor: rep_len, activator: {type: Linear, zero: 0.0, full: 1.5}, optional: true}
      - {type: Negation, of: {sensor: at_home, activator: {type: Boolean}}}
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    model_validator,
)

from selector.documents.fields import Closed, Flag, Name, Positive, Share
from selector.documents.plain import must_know
from selector.vocabulary.components import ComponentSpec
from selforg.network.model import behaviours, conditions
from selforg.network.model.activators import ACTIVATORS, Activator

MOST_CONDITIONS = 2_000
"""Conditions of a network, those of a name counted wherever it stands; the cleaning robot has 20."""
Priority = Annotated[int, Field(strict=True, ge=-1_000_000, le=1_000_000)]
"""An order; a network has no million of behaviours or goals."""


class ActivatorSpec(ComponentSpec[Activator]):
    """A registered activator."""

    registry = ACTIVATORS

    @model_validator(mode="after")
    def _can_be_built(self) -> Self:
        self.build()
        return self

    def build(self) -> Activator:
        """Return the activator; ValueError for parameters that do not go together."""
        return self.component(**self.given)


class _OptionalSpec(Closed):
    """A condition, which is optional or mandatory as a precondition."""

    optional: Flag = False
    """Whether a precondition only adds its wishes, and counts neither for readiness nor for activation."""


class ConditionSpec(_OptionalSpec):
    """The reading of a sensor, rated by an activator."""

    type: Literal["Condition"] = "Condition"
    sensor: Name
    """Name of the sensor."""
    activator: ActivatorSpec
    """The activator, which turns the reading into satisfaction and wish."""


class NegationSpec(_OptionalSpec):
    """The opposite of a condition."""

    type: Literal["Negation"]
    of: "AnyCondition"
    """The condition that is negated."""


class CombinationSpec(_OptionalSpec):
    """All of several conditions, the product of their satisfactions; or one of them, the largest satisfaction."""

    type: Literal["Conjunction", "Disjunction"]
    of: Annotated[tuple["AnyCondition", ...], Field(min_length=1)]
    """The conditions."""


@dataclass
class NamedConditions:
    """The context in which a network is validated: names that may be given in place of conditions.

    Attributes:
        conditions: content of the document, by name.
        number: conditions so far, those of a name counted wherever it stands.

    """

    conditions: Mapping[str, Any]
    number: int = 0

    def resolved(self, given: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
        """Return what is given, or the condition of which the name is given."""
        self.number += 1
        while isinstance(given, str) and self.number <= MOST_CONDITIONS:
            must_know("condition", given, sorted(self.conditions))
            given = self.conditions[given]
            self.number += 1
        if self.number > MOST_CONDITIONS:
            raise ValueError(f"expected at most {MOST_CONDITIONS} conditions in all, got more")
        return given


def _resolved(given: Any, info: ValidationInfo) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return what a name stands for, and name the type of a condition that names none."""
    content = info.context.resolved(given) if info.context else given
    unnamed = isinstance(content, Mapping) and "type" not in content
    return {"type": "Condition", **content} if unnamed else content


AnyCondition: TypeAlias = Annotated[
    Annotated[ConditionSpec | NegationSpec | CombinationSpec, Field(discriminator="type")], BeforeValidator(_resolved)
]


class EffectSpec(Closed):
    """The expected effect of a behaviour on a sensor."""

    sensor: Name
    """Name of the sensor."""
    change: Annotated[float, Field(strict=True, ge=-1.0, le=1.0)]
    """Signed change on the scale of the wishes [-]."""


class BehaviourSpec(Closed):
    """A behaviour: when it can run, and its effects."""

    preconditions: tuple[AnyCondition, ...] = ()
    """Conditions; the behaviour is ready while the product of the mandatory ones reaches `ready_threshold`."""
    effects: tuple[EffectSpec, ...] = ()
    """Expected changes of sensors."""
    ready_threshold: Share = 0.8
    """Satisfaction from which the behaviour can start [-]."""
    priority: Priority = 0
    """Priority over other behaviours that influence the same sensor [-]."""
    interruptable: Flag = True
    """Whether the behaviour may be stopped before it ends by itself."""
    timeout: Annotated[int, Field(strict=True, ge=0, le=10**9)] | None = None
    """Steps after which the behaviour is stopped [steps]; no limit by default."""
    cost: Positive = 1.0
    """Cost of the behaviour in a plan [-]."""
    planner_independent: Flag = False
    """Whether the planner leaves the behaviour out."""

    @model_validator(mode="after")
    def _can_start(self) -> Self:
        """Refuse mandatory preconditions that want one fact to be both true and false: nobody can ever act so."""
        wanted: dict[str, bool] = {}
        for spec in self.preconditions:
            plain, turned = (spec.of, True) if isinstance(spec, NegationSpec) else (spec, False)
            if spec.optional or not isinstance(plain, ConditionSpec) or plain.activator.type != "Boolean":
                continue
            given = plain.activator.given
            desired = given.get("desired", True) is not turned
            if (
                wanted.setdefault(plain.sensor, desired) is not desired
                and self.ready_threshold
                and not given.get("low")
            ):
                expected = "conditions that can be true together"
                raise ValueError(f"preconditions: expected {expected}, got {plain.sensor!r} both true and false")
        return self

    def build(self, name: str) -> behaviours.Behaviour:
        """Return the behaviour under a name."""
        return behaviours.Behaviour(
            name,
            tuple(precondition(spec) for spec in self.preconditions),
            tuple(behaviours.Effect(effect.sensor, effect.change) for effect in self.effects),
            ready_threshold=self.ready_threshold,
            priority=self.priority,
            interruptable=self.interruptable,
            timeout=self.timeout,
            cost=self.cost,
            planner_independent=self.planner_independent,
        )


class GoalSpec(Closed):
    """A goal of a robot."""

    conditions: Annotated[tuple[AnyCondition, ...], Field(min_length=1)]
    """Conditions that must all be true."""
    priority: Priority = 0
    """Goals of lower priority are given up first [-]."""
    permanent: Flag = True
    """Whether the goal stays enabled when it is satisfied."""
    satisfaction_threshold: Share = 1.0
    """Satisfaction from which the goal counts as reached [-]."""

    def build(self, name: str) -> behaviours.Goal:
        """Return the goal under a name."""
        trees = tuple(tree_of(spec) for spec in self.conditions)
        return behaviours.Goal(name, trees, self.priority, self.permanent, self.satisfaction_threshold)


def tree_of(spec: AnyCondition) -> conditions.Tree:
    """Return the condition of a specification."""
    match spec:
        case ConditionSpec():
            return conditions.Condition(spec.sensor, spec.activator.build())
        case NegationSpec():
            return conditions.Negation(tree_of(spec.of))
        case CombinationSpec():
            combine = conditions.Conjunction if spec.type == "Conjunction" else conditions.Disjunction
            return combine(*map(tree_of, spec.of))


def precondition(spec: AnyCondition) -> conditions.Tree | conditions.Optional:
    """Return the precondition of a specification."""
    return conditions.Optional(tree_of(spec)) if spec.optional else tree_of(spec)


def plain_conditions(spec: AnyCondition) -> Iterator[ConditionSpec]:
    """Yield the conditions of a tree from left to right."""
    match spec:
        case ConditionSpec():
            yield spec
        case NegationSpec():
            yield from plain_conditions(spec.of)
        case CombinationSpec():
            for part in spec.of:
                yield from plain_conditions(part)
