"""Document models of components: mechanisms, targets, sensors and actions.

Types are names of registered classes; parameters are those of their constructors. A component refers to a mechanism, a
target or a piece of knowledge by the name that this has in the document.
"""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Generic, Literal, Self, TypeAlias, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Field,
    ValidationError,
    field_validator,
    model_validator,
)

from selector.documents.errors import of_part
from selector.documents.fields import Closed, Flag, Name, NonNegative
from selector.documents.imported import NameOrImport as ClassName
from selector.documents.imported import registered
from selector.vocabulary.constructors import Reference, arguments_of, model_of, references_of
from selforg.components import ACTIONS, SENSORS, Action, SensorComponent
from selforg.gradients.queries import CHOICES
from selforg.mechanisms import MECHANISMS
from selforg.registry import Registry

Component = TypeVar("Component")
ClassOf: TypeAlias = type[Component]

DEFAULT_BUFFER = "gradients"
"""Name of the buffer of components that name none."""


class MechanismSpec(Closed):
    """A registered mechanism with its parameters."""

    type: Annotated[ClassName, AfterValidator(lambda name: registered(name, MECHANISMS))]
    """Name of the mechanism's class, or `module:Class`."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer that the mechanism reads and spreads to."""
    hold: NonNegative = 0.0
    """Time for which the vector of a movement mechanism is kept before the mechanism is asked again [s]."""
    hold_exponent: Annotated[float, Field(strict=True, ge=0.0, le=10.0)] = 0.0
    """Exponent, above 1, of the power law by which times from `hold` on are drawn; 0: always `hold` [-]."""
    longest_hold: NonNegative = 3600.0
    """Longest time that is drawn [s]."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Keyword arguments of the mechanism."""


class TargetSpec(Closed):
    """A query: how it chooses one gradient of a buffer."""

    rule: Literal[tuple(CHOICES)] = "nearest_attractive"  # type: ignore[valid-type]
    """Rule by which one of the gradients in view is chosen."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer."""
    channels: tuple[Name, ...] = ()
    """Channels to look at; empty: all channels."""
    static: Flag = True
    """Whether static gradients count."""
    moving: Flag = True
    """Whether moving gradients count."""
    view_distance: NonNegative | None = None
    """How far beyond their reach gradients are seen [m]; the setting of the buffer unless given."""


class ComponentSpec(Closed, Generic[Component], extra="allow"):
    """A component: the name of its class, and the arguments of the constructor as further keys."""

    registry: ClassVar[Registry[Any]]
    """The registry of the class."""

    type: ClassName
    """Name of the class, or `module:Class`."""

    @field_validator("type")
    @classmethod
    def _registered(cls, name: str) -> str:
        return registered(name, cls.registry)

    @model_validator(mode="after")
    def _fits_its_class(self) -> Self:
        try:
            self._form.model_validate(self.model_extra)
        except ValidationError as error:
            raise of_part(self.type, error) from error
        return self

    @property
    def component(self) -> ClassOf[Component]:
        """The class."""
        return self.registry.find(self.type)

    @property
    def _form(self) -> ClassOf[BaseModel]:
        cls: Any = self.component
        return model_of(cls)

    @property
    def given(self) -> dict[str, Any]:
        """Keyword arguments of the class that the document gives; references are names."""
        return arguments_of(self._form.model_validate(self.model_extra))

    def references(self) -> Iterator[tuple[str, Reference, str]]:
        """Yield each parameter that is a reference, the kind of reference, and the name in the document."""
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
