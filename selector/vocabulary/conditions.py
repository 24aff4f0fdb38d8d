"""The words in which YAML declares conditions, behaviours and goals.

They are the names and parameters of the classes in `selforg.network`, so that a model reads the same in YAML and in
Python. What has kinds names its kind by `type`; a condition without `type` is a plain `Condition`, and `optional: true`
makes a precondition optional:

    preconditions:
      - {sensor: rep_bool, activator: {type: Boolean}}
      - {sensor: rep_len, activator: {type: Linear, zero: 0.0, full: 1.5}, optional: true}
      - {type: Negation, of: {sensor: at_home, activator: {type: Boolean}}}
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, model_validator

from selector.documents.fields import Closed, Flag, Name, Positive, Share
from selector.vocabulary.components import ComponentSpec
from selforg.network.model import behaviours, conditions
from selforg.network.model.activators import ACTIVATORS, Activator


class ActivatorSpec(ComponentSpec[Activator]):
    """A registered activator."""

    registry = ACTIVATORS

    @model_validator(mode="after")
    def _can_be_built(self) -> Self:
        self.build()
        return self

    def build(self) -> Activator:
        """Return the activator this declares; ValueError for parameters that do not go together."""
        return self.component(**self.given)


class ConditionSpec(Closed):
    """A sensor's reading seen through an activator."""

    type: Literal["Condition"] = "Condition"
    sensor: Name
    """Name of the sensor."""
    activator: ActivatorSpec
    """How its reading becomes satisfaction and wish."""
    optional: Flag = False
    """As a precondition: adds its wish, but counts neither for readiness nor for activation."""


class NegationSpec(Closed):
    """The opposite of a condition."""

    type: Literal["Negation"]
    of: "AnyCondition"
    """The condition turned round."""
    optional: Flag = False
    """As a precondition: adds its wishes only."""


class ConjunctionSpec(Closed):
    """All conditions together: the product of their satisfactions."""

    type: Literal["Conjunction"]
    of: Annotated[tuple["AnyCondition", ...], Field(min_length=1)]
    """The conditions."""
    optional: Flag = False
    """As a precondition: adds its wishes only."""


class DisjunctionSpec(Closed):
    """One of several conditions: the largest of their satisfactions."""

    type: Literal["Disjunction"]
    of: Annotated[tuple["AnyCondition", ...], Field(min_length=1)]
    """The conditions."""
    optional: Flag = False
    """As a precondition: adds its wishes only."""


def _kind(value: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
    return value.get("type", "Condition") if isinstance(value, dict) else getattr(value, "type", "Condition")


AnyCondition: TypeAlias = Annotated[
    Annotated[ConditionSpec, Tag("Condition")]
    | Annotated[NegationSpec, Tag("Negation")]
    | Annotated[ConjunctionSpec, Tag("Conjunction")]
    | Annotated[DisjunctionSpec, Tag("Disjunction")],
    Discriminator(_kind),
]


class EffectSpec(Closed):
    """What a behaviour is expected to do to a sensor."""

    sensor: Name
    """Name of the sensor."""
    change: Annotated[float, Field(strict=True, ge=-1.0, le=1.0)]
    """Signed change on the scale of the wishes [-]."""


class BehaviourSpec(Closed):
    """What a robot can do, when, and to what effect."""

    preconditions: tuple[AnyCondition, ...] = ()
    """Ready while the product of the mandatory ones reaches `ready_threshold`."""
    effects: tuple[EffectSpec, ...] = ()
    """Expected changes of sensors."""
    ready_threshold: Share = 0.8
    """Satisfaction from which the behaviour can start [-]."""
    priority: Annotated[int, Field(strict=True)] = 0
    """Who stays when two influence the same sensor [-]."""
    interruptable: Flag = True
    """Whether it may be stopped before it ends itself."""
    timeout: Annotated[int, Field(strict=True, ge=0)] | None = None
    """Steps after which it is stopped [steps]; none by default."""
    cost: Positive = 1.0
    """Cost for the planner [-]."""
    planner_independent: Flag = False
    """Whether it is left out of planning."""

    def build(self, name: str) -> behaviours.Behaviour:
        """Return the behaviour this declares."""
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
    """What a robot wants."""

    conditions: Annotated[tuple[AnyCondition, ...], Field(min_length=1)]
    """All of them shall hold."""
    priority: Annotated[int, Field(strict=True)] = 0
    """Goals of lower priority are given up first [-]."""
    permanent: Flag = True
    """Whether it stays on when it is satisfied."""

    def build(self, name: str) -> behaviours.Goal:
        """Return the goal this declares."""
        trees = tuple(tree_of(spec) for spec in self.conditions)
        return behaviours.Goal(name, trees, priority=self.priority, permanent=self.permanent)


def tree_of(spec: AnyCondition) -> conditions.Tree:
    """Return the condition that a specification declares."""
    match spec:
        case ConditionSpec():
            return conditions.Condition(spec.sensor, spec.activator.build())
        case NegationSpec():
            return conditions.Negation(tree_of(spec.of))
        case ConjunctionSpec():
            return conditions.Conjunction(*(tree_of(part) for part in spec.of))
        case DisjunctionSpec():
            return conditions.Disjunction(*(tree_of(part) for part in spec.of))


def precondition(spec: AnyCondition) -> conditions.Tree | conditions.Optional:
    """Return the precondition that a specification declares."""
    return conditions.Optional(tree_of(spec)) if spec.optional else tree_of(spec)


def plain_conditions(spec: AnyCondition) -> Iterator[ConditionSpec]:
    """Yield the conditions of a tree from left to right."""
    match spec:
        case ConditionSpec():
            yield spec
        case NegationSpec():
            yield from plain_conditions(spec.of)
        case ConjunctionSpec() | DisjunctionSpec():
            for part in spec.of:
                yield from plain_conditions(part)
