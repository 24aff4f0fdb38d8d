"""The words in which YAML declares components: mechanisms, targets, sensors and actions.

Their types are the names of registered classes, their parameters those of the constructors. What refers to a
mechanism, a target or a piece of knowledge does so by its name in the document.
"""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Generic, Literal, Self, TypeAlias, TypeVar

from pydantic import BaseModel, BeforeValidator, Field, ValidationError, model_validator

from selector.documents.errors import of_part
from selector.documents.fields import Closed, Flag, Name, NonNegative
from selector.vocabulary.constructors import Reference, arguments_of, model_of, references_of
from selforg.components import ACTIONS, SENSORS, Action, SensorComponent
from selforg.gradients.queries import CHOICES
from selforg.registry import Registry, unknown

Component = TypeVar("Component")
ClassOf: TypeAlias = type[Component]

DEFAULT_BUFFER = "gradients"
"""Name of the buffer that is meant where none is named."""


class MechanismSpec(Closed):
    """A registered mechanism with its parameters."""

    type: Name
    """Name of the mechanism's class."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer that it looks into and spreads to."""
    hold: NonNegative = 0.0
    """Of a movement mechanism: time for which a movement is kept before it is asked again [s]."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Keyword arguments of the mechanism."""


class TargetSpec(Closed):
    """The gradient that a query chooses."""

    rule: Literal[tuple(CHOICES)] = "nearest_attractive"  # type: ignore[valid-type]
    """How one of those in view is chosen."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer."""
    channels: tuple[Name, ...] = ()
    """Channels to look at; all without any."""
    static: Flag = True
    """Whether static gradients count."""
    moving: Flag = True
    """Whether moving gradients count."""
    view_distance: NonNegative | None = None
    """How far beyond their reach gradients are seen [m]; as the buffer says unless given."""


class ComponentSpec(Closed, Generic[Component], extra="allow"):
    """A component: the name of its class, and beside it the arguments of the constructor."""

    registry: ClassVar[Registry[Any]]
    """Where the class is found."""

    type: Name
    """Name of the class."""

    @model_validator(mode="after")
    def _fits_its_class(self) -> Self:
        if self.type not in self.registry:
            raise ValueError(unknown(self.registry.kind, self.type, self.registry.names()))
        model = self._form
        try:
            model.model_validate(self.model_extra)
        except ValidationError as error:
            raise of_part(self.type, error, model) from error
        return self

    @property
    def component(self) -> ClassOf[Component]:
        """The class."""
        found: ClassOf[Component] = self.registry.find(self.type)
        return found

    @property
    def _form(self) -> ClassOf[BaseModel]:
        cls: Any = self.component
        return model_of(cls)

    @property
    def given(self) -> dict[str, Any]:
        """What the document gives, as the keyword arguments of the class; references are names."""
        return arguments_of(self._form.model_validate(self.model_extra))

    def references(self) -> Iterator[tuple[str, Reference, str]]:
        """Yield parameter, what it refers to, and the name that it holds."""
        cls: Any = self.component
        given = self.given
        for parameter, reference in references_of(cls).items():
            if given.get(parameter) is not None:
                yield parameter, reference, given[parameter]


class SensorSpec(ComponentSpec[SensorComponent]):
    """A registered sensor."""

    registry = SENSORS


class ActionSpec(ComponentSpec[Action]):
    """A registered action."""

    registry = ACTIONS


def _listed(given: object) -> object:
    return [given] if isinstance(given, dict) else given


ActionSpecs: TypeAlias = Annotated[tuple[ActionSpec, ...], BeforeValidator(_listed), Field(min_length=1)]
"""One action or a list of them."""
