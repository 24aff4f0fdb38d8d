"""Document models of classes: the keys of a component or a mechanism are the parameters of its constructor.

The annotation of a parameter decides which values a document may give. Where the annotation is a component, the
document gives the name of one that it declares (`Reference`).
"""

import dataclasses
import math
from collections.abc import Iterable, Mapping
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import numpy.typing as npt
from pydantic import AfterValidator, BaseModel, Field, create_model

from selector.documents import fields
from selector.documents.errors import validated, within
from selforg import parameters as declared
from selforg.components import DecisionSource, GoalSource, MovementSource, Remembered, SharedFact
from selforg.components.actions import Call
from selforg.mechanisms import DecisionMechanism, MovementMechanism, Pheromone, SteeringMechanism
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.spreading import Carried
from selforg.mechanisms.weighted_sum import MovementWeights
from selforg.parameters import REQUIRED, parameters_of

FROM_HOST = ("buffer", "directions", "generators", "surroundings")
"""Parameters that the host gives; a document cannot."""
RECORDS = (Carried, Pheromone)
"""Dataclasses, which a document gives as mappings."""


def _bounded(number: float) -> float:
    if not (math.isinf(number) or abs(number) <= fields.LARGEST_NUMBER):
        raise ValueError(f"expected a number within {fields.LARGEST_NUMBER:g}, or infinity, got {number:g}")
    return number


_Real = Annotated[float, Field(strict=True), AfterValidator(_bounded)]
"""Some parameters may be infinite, such as a range; each class says which."""
_FIELDS: dict[object, object] = {
    float: _Real,
    declared.Finite: fields.Number,
    declared.AtLeastZero: fields.NonNegative,
    declared.UpToOne: fields.Share,
    int: Annotated[int, Field(strict=True, ge=-(10**9), le=10**9)],
    bool: fields.Flag,
    str: Annotated[str, Field(strict=True)],
    Iterable[str]: tuple[str, ...],
    npt.ArrayLike: _Real | str,  # a number, or the name of what each robot knows
    MovementWeights: dict[fields.Name, fields.Number],  # by the names of mechanisms
}
"""Annotation of a parameter -> type of the values that a document may give."""


class _Form(fields.Closed, arbitrary_types_allowed=True):
    """Base of the document models of classes."""


@dataclasses.dataclass(frozen=True)
class Reference:
    """What a parameter refers to by a name.

    Attributes:
        what: "mechanism", "target", "knowledge", "fact" or "call".
        annotation: type of the parameter, which is what the component gets.
        mechanism: class that a mechanism must have.

    """

    what: str
    annotation: Any
    mechanism: type[Mechanism] = Mechanism

    @property
    def expected(self) -> str:
        """The expected kind of mechanism, for errors."""
        kinds: dict[type[Mechanism], str] = {
            MovementMechanism: "a movement mechanism",
            DecisionMechanism: "a decision mechanism",
            SteeringMechanism: "a steering mechanism",
        }
        return kinds.get(self.mechanism, f"a {self.mechanism.__name__}")


_REFERENCES = {
    MovementSource: Reference("mechanism", MovementSource, MovementMechanism),
    DecisionSource: Reference("mechanism", DecisionSource, DecisionMechanism),
    GoalSource: Reference("target", GoalSource),
    Remembered: Reference("knowledge", Remembered),
    SharedFact: Reference("fact", SharedFact),
    Call: Reference("call", Call),
}


@cache
def references_of(cls: type) -> dict[str, Reference]:
    """Return the parameters of a class that are references, with their targets."""
    found = {name: _reference(parameter.annotation) for name, parameter in parameters_of(cls).items()}
    return {name: reference for name, reference in found.items() if reference is not None}


@cache
def model_of(cls: type) -> type[BaseModel]:
    """Return the document model of a class."""
    form: dict[str, Any] = {
        name: (_field(one.annotation), ... if one.default is REQUIRED else one.default)
        for name, one in parameters_of(cls).items()
        if name not in FROM_HOST
    }
    return create_model(cls.__name__, __base__=_Form, **form)


def checked_parameters(cls: type, given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return `given` as the keyword arguments of a class; errors begin with `where`.

    Raises:
        DocumentError: a parameter is unknown, missing, or has a value of another type.

    """
    checked = validated(model_of(cls), dict(given), where)
    with within(where):
        return arguments_of(checked)


def arguments_of(checked: BaseModel) -> dict[str, Any]:
    """Return the values given for a class as its keyword arguments; references are still names."""
    records = {model_of(record): record for record in RECORDS}
    given = {name: getattr(checked, name) for name in checked.model_fields_set}
    return {name: records[type(v)](**v.model_dump()) if type(v) in records else v for name, v in given.items()}


def _reference(annotation: Any) -> Reference | None:  # noqa: ANN401  (a type)
    """Return what a parameter of this type refers to, None if it holds a value."""
    for part in (annotation, *(get_args(annotation) if get_origin(annotation) in (Union, UnionType) else ())):
        if part in _REFERENCES:
            return _REFERENCES[part]
        if isinstance(part, type) and issubclass(part, Mechanism):
            return Reference("mechanism", part, part)
    return None


def _field(annotation: Any) -> object:  # noqa: ANN401  (a type)
    """Return the type of the values that a document may give for `annotation`."""
    if _reference(annotation) is not None:
        return fields.Name
    if annotation in _FIELDS:
        return _FIELDS[annotation]
    if annotation in RECORDS:
        return model_of(annotation)
    if get_origin(annotation) in (Union, UnionType):
        return Union[tuple(_field(part) for part in get_args(annotation))]  # noqa: UP007  (parts are known at run time)
    if annotation is NoneType:
        return NoneType
    raise TypeError(
        f"a document cannot have a parameter of type {annotation}; add it to selector.vocabulary.constructors"
    )
