"""One line for whatever is wrong with a configuration: file, key, what was expected and what was given."""

import re
from collections.abc import Sequence
from typing import get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from selector.documents.errors import MAX_SHOWN, DocumentError
from selforg.registry import unknown

ConfigurationError = DocumentError
"""A configuration, a file or a name that cannot be used: the one error of all configuration files."""


def one_line(error: ValidationError, file: str, model: type[BaseModel]) -> str:
    """Return `file: key: what is wrong` for the first mistake of `error`, raised when validating `model`."""
    details = error.errors(include_url=False)
    # an unknown key often makes another one missing: it is the one to name
    first = next((d for d in details if d["type"] == "extra_forbidden"), details[0])
    key = ".".join([*(str(part) for part in first["loc"]), *_key_of_context(first)])
    return f"{file}: {f'{key}: ' if key else ''}{_what(first, model)}"


def _key_of_context(details: ErrorDetails) -> list[str]:
    return [str(details["ctx"]["key"])] if details["type"] == "impossible" else []


def _what(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, given = details["type"], details["input"]
    if kind == "extra_forbidden":
        known = _known_keys(model, details["loc"][:-1])
        return unknown("key", str(details["loc"][-1]), known) if known else "unknown key"
    if kind == "missing":
        return "missing key" if isinstance(details["loc"][-1], str) else "missing value"
    if kind == "json_invalid":
        return f"expected JSON: {details['ctx']['error']}"
    if kind == "value_error":  # raised by a model that knows best what is wrong
        return str(details["ctx"]["error"])
    message = re.sub(r"^(Input should be|\w+ should have)", "expected", details["msg"]).removesuffix(
        " after validation, not 0"
    )
    if kind == "impossible":
        return message
    return f"{message}, got {_shown(given)}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= MAX_SHOWN else text[:MAX_SHOWN] + "..."


def _known_keys(model: type[BaseModel], location: Sequence[int | str]) -> list[str]:
    """Return the keys of the model that lies at `location` below `model`; empty if the types do not tell."""
    here: type[BaseModel] | None = model
    for part in location:
        if isinstance(part, int):
            continue
        if here is None or part not in here.model_fields:
            return []
        here = _model_in(here.model_fields[part].annotation)
    return sorted(here.model_fields) if here is not None else []


def _model_in(annotation: object) -> type[BaseModel] | None:
    """Return the model that an annotation is, or that its tuple or union holds; None without any."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _model_in(part)) is not None), None)
