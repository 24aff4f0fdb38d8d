"""Document model of a mechanism configuration, whose components realise one way to serve a goal.

Mechanisms, targets, sensors, behaviours and goals have names, by which they refer to each other; the files in
`configs/mechanisms` are examples. `parameters` lists the values that an option may override; `$name` in place of a
value stands for the parameter of that name.
"""

from collections.abc import Iterable
from typing import Self

from pydantic import model_validator

from selector.configurations.acting_network import ActingBehaviourSpec, ActingNetworkSpec, must_know
from selector.documents.fields import Closed, NonNegative
from selector.vocabulary.components import SensorSpec
from selector.vocabulary.conditions import AnyCondition, GoalSpec, plain_conditions
from selforg.network.model.activators import BOOLEAN_RULE
from selforg.network.model.behaviours import Interface


class PoseSpec(Closed):
    """The radii of a robot's own pose gradient; those of the host unless given."""

    diffusion: NonNegative | None = None
    """Diffusion [m]."""
    goal_radius: NonNegative | None = None
    """Goal radius [m]."""


class ConfigurationSpec(ActingNetworkSpec[SensorSpec, ActingBehaviourSpec, GoalSpec]):
    """The components of one configuration, after every `$name` was replaced."""

    pose: PoseSpec = PoseSpec()
    """What a robot spreads of itself while it holds the configuration."""

    @model_validator(mode="after")
    def _conditions_fit(self) -> Self:
        for name, behaviour in self.behaviours.items():
            self._check_conditions(behaviour.preconditions, f"behaviours.{name}.preconditions")
            for effect in behaviour.effects:
                must_know("sensor", effect.sensor, self.sensors, f"behaviours.{name}.effects")
        for name, goal in self.goals.items():
            self._check_conditions(goal.conditions, f"goals.{name}.conditions")
        return self

    def _check_conditions(self, trees: Iterable[AnyCondition], where: str) -> None:
        for spec in (plain for tree in trees for plain in plain_conditions(tree)):
            must_know("sensor", spec.sensor, self.sensors, where)
            kind = self.kind_of(self.sensors[spec.sensor])
            if (kind == "fact") is not (spec.activator.component.kind == BOOLEAN_RULE):
                expected = "a Boolean activator on a fact, any other on a number"
                given = f"{spec.activator.type} on the {kind} {spec.sensor!r}"
                raise ValueError(f"{where}: expected {expected}, got {given}")

    def interfaces(self) -> tuple[Interface, ...]:
        """Return the preconditions and effects of each behaviour, which the network around the configuration sees."""
        return tuple(Interface(tuple(b.preconditions), tuple(b.effects)) for b in self.network_behaviours())
