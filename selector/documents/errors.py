"""Errors in documents, as one line each: file, key, what was expected and what was given."""

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from selector.documents.plain import DocumentError as DocumentError
from selector.documents.plain import short
from selector.documents.trust import reading_files
from selforg.registry import unknown

M = TypeVar("M", bound=BaseModel)
IMPOSSIBLE = "impossible"
"""Type of errors whose key is not known to pydantic but stands in their context."""


def validated(model: type[M], content: object, where: str, *, own: bool = False) -> M:
    """Return `content` as a model; the first mistake becomes one line `where: key: what is wrong`.

    The content may name code only if it is the caller's `own`: not from a file, or checked when the file was read.

    Raises:
        DocumentError: the model refuses the content.

    """
    try:
        with nullcontext() if own else reading_files(where):
            return model.model_validate(content)
    except ValidationError as error:
        raise DocumentError(one_line(error, where, model)) from error


def impossible(key: str, expected: str, given: object) -> PydanticCustomError:
    """Return the error of a value that does not fit the values around it, at the dotted `key` below the model."""
    message = "expected {expected}, got {given}"
    return PydanticCustomError(IMPOSSIBLE, message, {"key": key, "expected": expected, "given": str(given)})


def of_part(part: str, error: ValidationError, model: type[BaseModel]) -> PydanticCustomError:
    """Return the error of one part of a model for the validator of the whole to raise; its key begins with `part`."""
    key, what = _first_mistake(error, model)
    return PydanticCustomError(IMPOSSIBLE, "{what}", {"key": f"{part}.{key}", "what": what})


def one_line(error: ValidationError, where: str, model: type[BaseModel]) -> str:
    """Return `where: key: what is wrong` for the first mistake of `error`, raised when validating `model`."""
    key, what = _first_mistake(error, model)
    return f"{where}: {f'{key}: ' if key else ''}{what}"


@contextmanager
def within(where: str) -> Iterator[None]:
    """Let every DocumentError begin with `where`, the file or the key that led to the mistake."""
    try:
        yield
    except DocumentError as error:
        raise DocumentError(f"{where}: {error}") from error


def shown(path: Path) -> str:
    """Return `path` as a user in the working directory would write it."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative


def _first_mistake(error: ValidationError, model: type[BaseModel]) -> tuple[str, str]:
    """Return the dotted key of the first mistake, and its text."""
    details = error.errors(include_url=False)
    # A misspelt key gives two errors, an unknown key and a missing one; the unknown key shows the mistake.
    first = next((d for d in details if d["type"] == "extra_forbidden"), details[0])
    below = (first["ctx"]["key"],) if first["type"] == IMPOSSIBLE else ()
    path = (str(part) for part in (*first["loc"], *below))
    return ".".join(part for part in path if not part.startswith("function-")), _what(first, model)  # one of a union


def _what(details: ErrorDetails, model: type[BaseModel]) -> str:
    """Return the mistake without the key."""
    kind = details["type"]
    if kind == "extra_forbidden":
        known = _known_keys(model, details["loc"][:-1])
        return unknown("key", str(details["loc"][-1]), known) if known else "unknown key"
    if kind == "missing":
        return "missing key" if isinstance(details["loc"][-1], str) else "missing value"
    if kind == "value_error":  # raised by a validator of the model, with a text of its own
        return str(details["ctx"]["error"])
    message = re.sub(r"^(Input should be|\w+ should have)", "expected", details["msg"]).removesuffix(
        " after validation, not 0"
    )
    if kind == IMPOSSIBLE:
        return message
    return f"{message}, got {short(details['input'])}"


def _known_keys(model: type[BaseModel], location: Sequence[int | str]) -> list[str]:
    """Return the keys of the model at `location` below `model`; empty if the annotations do not say which it is."""
    here: object = model
    for part in location:
        here = _below(here, part)
    found = _model_in(here)
    return sorted(found.model_fields) if found is not None else []


def _below(annotation: object, part: int | str) -> object:
    """Return the type of one key or index of a value; None if the type of the value does not say it."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation.model_fields[part].annotation if part in annotation.model_fields else None
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is dict:
        return arguments[1]
    if origin is tuple and isinstance(part, int):
        return arguments[0 if Ellipsis in arguments else part]
    return next((found for one in arguments if (found := _below(one, part)) is not None), None)


def _model_in(annotation: object) -> type[BaseModel] | None:
    """Return the model that an annotation is or contains; None if there is none."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _model_in(part)) is not None), None)
