"""Parameters of mechanisms, checked against what the constructor of each class takes."""

import dataclasses
import inspect
from collections.abc import Iterable, Mapping
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, create_model

from selector.documents.errors import DocumentError, validated
from selector.documents.fields import Flag
from selforg.mechanisms import Pheromone
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.spreading import Carried
from selforg.registry import unknown

FROM_HOST = ("buffer", "directions", "generators")
"""Parameters that the host gives and no document."""
RECORDS = (Carried, Pheromone)
"""Dataclasses that stand in a document as mappings."""
_Real = Annotated[float, Field(strict=True)]
_WORDS: dict[object, object] = {
    float: _Real,
    int: Annotated[int, Field(strict=True)],
    bool: Flag,
    str: Annotated[str, Field(strict=True)],
    Iterable[str]: tuple[str, ...],
    npt.ArrayLike: _Real | str,  # a number, or what each robot knows under a name
}
"""Annotation of a parameter -> what a document may hold for it."""


def checked_parameters(mechanism: type[Mechanism], parameters: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return `parameters` as the keyword arguments of a mechanism; `where` starts the line of an error.

    Raises:
        DocumentError: a parameter that the mechanism does not take, one it needs and lacks, one of a wrong type.

    """
    model = _model_of(mechanism)
    for name in parameters:
        if name not in model.model_fields:
            raise DocumentError(f"{where}: {unknown('parameter', name, sorted(model.model_fields))}")
    given = validated(model, dict(parameters), where)
    try:
        return {name: _argument(getattr(given, name)) for name in given.model_fields_set}
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error


def takes(mechanism: type[Mechanism], name: str) -> bool:
    """Tell whether the constructor of a mechanism takes a parameter."""
    return name in _annotations(mechanism)


@cache
def _model_of(mechanism: type[Mechanism]) -> type[BaseModel]:
    fields = {name: form for name, form in _annotations(mechanism).items() if name not in FROM_HOST}
    return _closed(mechanism.__name__, fields)


@cache
def _annotations(mechanism: type[Mechanism]) -> dict[str, tuple[object, object]]:
    """Return parameter -> (annotation, default) of a constructor, those of its unpacked options too."""
    found: dict[str, tuple[object, object]] = {}
    for name, parameter in inspect.signature(mechanism.__init__, eval_str=True).parameters.items():
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            (options,) = get_args(parameter.annotation)
            found |= {option: (hint, None) for option, hint in get_type_hints(options).items() if option not in found}
        elif name != "self":
            found[name] = parameter.annotation, parameter.default
    return found


def _closed(name: str, fields: Mapping[str, tuple[object, object]]) -> type[BaseModel]:
    declared: dict[str, Any] = {
        field: (_word(annotation), ... if default is inspect.Parameter.empty else default)
        for field, (annotation, default) in fields.items()
    }
    return create_model(name, __config__=ConfigDict(extra="forbid", arbitrary_types_allowed=True), **declared)


def _word(annotation: object) -> object:
    """Return the type by which a document's value for `annotation` is checked."""
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
        f"a document cannot hold a parameter of type {annotation}; add it to selector.vocabulary.mechanisms"
    )


@cache
def _record_model(record: Any) -> type[BaseModel]:  # noqa: ANN401  (a dataclass)
    fields = {f.name: (f.type, inspect.Parameter.empty if f.default is dataclasses.MISSING else f.default)
              for f in dataclasses.fields(record)}  # fmt: skip
    return _closed(record.__name__, fields)


def _argument(value: object) -> object:
    """Return a checked value as the mechanism takes it."""
    for record in RECORDS:
        if isinstance(value, _record_model(record)):
            return record(**value.model_dump())
    return value
