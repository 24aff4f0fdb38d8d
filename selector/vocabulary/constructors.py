"""Classes in documents: the keys of a component or a mechanism are the parameters of its constructor.

What a document may hold for a parameter follows from its annotation. Some annotations stand for something else that
the document declares; there, a document holds its name (`Reference`).
"""

import dataclasses
from collections.abc import Iterable, Mapping
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, create_model

from selector.documents import fields
from selector.documents.errors import DocumentError, validated
from selforg import parameters as declared
from selforg.components import DecisionSource, GoalSource, MovementSource, Remembered
from selforg.components.actions import Call
from selforg.mechanisms import DecisionMechanism, MovementMechanism, Pheromone
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.spreading import Carried
from selforg.parameters import REQUIRED, parameters_of
from selforg.registry import unknown

FROM_HOST = ("buffer", "directions", "generators")
"""Parameters of mechanisms that the host gives and no document."""
RECORDS = (Carried, Pheromone)
"""Dataclasses that stand in a document as mappings."""
_Real = Annotated[float, Field(strict=True)]
_WORDS: dict[object, object] = {
    float: _Real,
    declared.Finite: fields.Number,
    declared.AtLeastZero: fields.NonNegative,
    declared.UpToOne: fields.Share,
    int: Annotated[int, Field(strict=True)],
    bool: fields.Flag,
    str: Annotated[str, Field(strict=True)],
    Iterable[str]: tuple[str, ...],
    npt.ArrayLike: _Real | str,  # a number, or what each robot knows under a name
}
"""Annotation of a parameter -> what a document may hold for it."""


@dataclasses.dataclass(frozen=True)
class Reference:
    """What the name that a parameter holds refers to.

    Attributes:
        what: "mechanism", "target", "knowledge" or "call".
        annotation: of the parameter, which says as what the component takes it.
        mechanism: class of which a mechanism has to be.

    """

    what: str
    annotation: Any
    mechanism: type[Mechanism] = Mechanism

    @property
    def expected(self) -> str:
        """What an error expects of a mechanism."""
        kinds: dict[type[Mechanism], str] = {
            MovementMechanism: "a movement mechanism",
            DecisionMechanism: "a decision mechanism",
        }
        return kinds.get(self.mechanism, f"a {self.mechanism.__name__}")


_REFERENCES = {
    MovementSource: Reference("mechanism", MovementSource, MovementMechanism),
    DecisionSource: Reference("mechanism", DecisionSource, DecisionMechanism),
    GoalSource: Reference("target", GoalSource),
    Remembered: Reference("knowledge", Remembered),
    Call: Reference("call", Call),
}


@cache
def references_of(cls: type) -> dict[str, Reference]:
    """Return the parameters of a class that hold names, with what they refer to."""
    found = {name: _reference(parameter.annotation) for name, parameter in parameters_of(cls).items()}
    return {name: reference for name, reference in found.items() if reference is not None}


@cache
def model_of(cls: type) -> type[BaseModel]:
    """Return the model of what a document may hold for a class."""
    return _closed(cls.__name__, {name: p for name, p in parameters_of(cls).items() if name not in FROM_HOST})


def checked_parameters(cls: type, given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return `given` as the keyword arguments of a class; `where` starts the line of an error.

    Raises:
        DocumentError: a parameter that the class does not take, one it needs and lacks, one of a wrong type.

    """
    model = model_of(cls)
    for name in given:
        if name not in model.model_fields:
            raise DocumentError(f"{where}: {unknown('parameter', name, sorted(model.model_fields))}")
    try:
        return arguments_of(validated(model, dict(given), where))
    except DocumentError:
        raise
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error


def arguments_of(checked: BaseModel) -> dict[str, Any]:
    """Return what was given for a class as its keyword arguments; references are still names."""
    return {name: _argument(getattr(checked, name)) for name in checked.model_fields_set}


def _reference(annotation: Any) -> Reference | None:  # noqa: ANN401  (a type)
    """Return what a parameter of this type refers to, None if it holds a value."""
    for part in (annotation, *(get_args(annotation) if get_origin(annotation) in (Union, UnionType) else ())):
        for known, reference in _REFERENCES.items():
            if part == known:
                return reference
        if isinstance(part, type) and issubclass(part, Mechanism):
            return Reference("mechanism", part, part)
    return None


def _closed(name: str, parameters: Mapping[str, tuple[Any, Any]]) -> type[BaseModel]:
    form: dict[str, Any] = {
        field: (_word(annotation), ... if default is REQUIRED else default)
        for field, (annotation, default) in parameters.items()
    }
    return create_model(name, __config__=ConfigDict(extra="forbid", arbitrary_types_allowed=True), **form)


def _word(annotation: Any) -> object:  # noqa: ANN401  (a type)
    """Return the type by which a document's value for `annotation` is checked."""
    if _reference(annotation) is not None:
        return fields.Name
    for known, word in _WORDS.items():
        if annotation == known:
            return word
    if annotation in RECORDS:
        return _record_model(annotation)
    if get_origin(annotation) in (Union, UnionType):
        return Union[tuple(_word(part) for part in get_args(annotation))]  # noqa: UP007  (parts are known at run time)
    if annotation is NoneType:
        return NoneType
    raise TypeError(
        f"a document cannot hold a parameter of type {annotation}; add it to selector.vocabulary.constructors"
    )


@cache
def _record_model(record: Any) -> type[BaseModel]:  # noqa: ANN401  (a dataclass)
    return _closed(record.__name__, parameters_of(record))


def _argument(value: object) -> object:
    """Return a checked value as the constructor takes it."""
    for record in RECORDS:
        if isinstance(value, _record_model(record)):
            return record(**value.model_dump())
    return value
