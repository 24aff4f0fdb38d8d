"""Errors in documents, as one line each: file, key, what was expected and what was given."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from typing import TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from selector.documents.plain import DocumentError as DocumentError
from selector.documents.plain import short
from selector.documents.plain import shown as shown
from selector.documents.trust import reading_files
from selforg.registry import unknown

M = TypeVar("M", bound=BaseModel)
IMPOSSIBLE = "impossible"
"""Type of errors whose key is not known to pydantic but stands in their context."""
UNKNOWN_KEY = "unknown_key"
"""Type of the errors of keys that a model does not have; it stands in their context, too."""


def validated(model: type[M], content: object, where: str, *, own: bool = False, context: object = None) -> M:
    """Return `content` as a model; the first mistake becomes one line `where: key: what is wrong`.

    The content may name code only if it is the caller's `own`: not from a file, or checked when the file was read.
    Validators of the model get the `context`.

    Raises:
        DocumentError: the model refuses the content.

    """
    try:
        with nullcontext() if own else reading_files(where):
            return model.model_validate(content, context=context)
    except ValidationError as error:
        raise DocumentError(one_line(error, where)) from error


def impossible(key: str, expected: str, given: object) -> PydanticCustomError:
    """Return the error of a value that does not fit the values around it, at the dotted `key` below the model."""
    message = "expected {expected}, got {given}"
    return PydanticCustomError(IMPOSSIBLE, message, {"key": key, "expected": expected, "given": str(given)})


def check_unique(key: str, names: Sequence[str], what: str = "names") -> None:
    """Raise the error of the first name that is there twice, at the dotted `key` below the model."""
    for name in names:
        if names.count(name) > 1:
            raise impossible(key, f"unique {what}", f"{name!r} twice")


def unknown_key(key: str, known: Iterable[str]) -> PydanticCustomError:
    """Return the error of a key that is not among the `known` ones of a model."""
    return PydanticCustomError(UNKNOWN_KEY, "{what}", {"key": key, "what": unknown("key", key, sorted(known))})


def of_part(part: str, error: ValidationError) -> PydanticCustomError:
    """Return the error of one part of a model for the validator of the whole to raise; its key begins with `part`."""
    key, what = _first_mistake(error)
    return PydanticCustomError(IMPOSSIBLE, "{what}", {"key": f"{part}.{key}", "what": what})


def one_line(error: ValidationError, where: str) -> str:
    """Return `where: key: what is wrong` for the first mistake of `error`."""
    key, what = _first_mistake(error)
    return f"{where}: {f'{key}: ' if key else ''}{what}"


@contextmanager
def within(where: str) -> Iterator[None]:
    """Let every mistake be a DocumentError that begins with `where`, the file or the key that led to it."""
    try:
        yield
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error


def _first_mistake(error: ValidationError) -> tuple[str, str]:
    """Return the dotted key of the first mistake, and its text."""
    details = error.errors(include_url=False)
    # A misspelt key gives two errors, an unknown key and a missing one; the unknown key shows the mistake.
    first = next((one for one in details if one["type"] == UNKNOWN_KEY), details[0])
    below = (first["ctx"]["key"],) if first["type"] in (IMPOSSIBLE, UNKNOWN_KEY) else ()
    path = (str(part) for part in (*first["loc"], *below))
    return ".".join(part for part in path if not part.startswith("function-")), _what(first)  # one of a union


def _what(details: ErrorDetails) -> str:
    """Return the mistake without the key."""
    kind = details["type"]
    if kind == "missing":
        return "missing key" if isinstance(details["loc"][-1], str) else "missing value"
    if kind == "value_error":  # raised by a validator of the model, with a text of its own
        return str(details["ctx"]["error"])
    message = re.sub(r"^(Input should be|\w+ should have)", "expected", details["msg"]).removesuffix(
        " after validation, not 0"
    )
    if kind in (IMPOSSIBLE, UNKNOWN_KEY):
        return message
    return f"{message}, got {short(details['input'])}"
