"""Parameters of a document: values that an option overrides, and `$name`, which the document has in their place."""

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from selector.documents.errors import DocumentError
from selector.documents.plain import must_know, short

Content: TypeAlias = dict[str, Any]
REFERENCE = "$"


def resolved(content: Content, parameters: Mapping[str, Any]) -> Content:
    """Return a document's content with its parameters overridden by `parameters` and every `$name` replaced.

    Raises:
        DocumentError: the document does not declare one of `parameters`, or one that a `$name` refers to.

    """
    values = laid_over(declared_parameters(content), parameters, "parameters")
    return {key: _filled(value, values, key) for key, value in content.items() if key != "parameters"}


def declared_parameters(content: Content) -> Content:
    """Return the parameters that a document declares, with their own values."""
    declared = content.get("parameters", {})
    if not isinstance(declared, dict):
        raise DocumentError(f"parameters: expected a mapping, got {short(declared)}")
    return declared


def check_parameters_used(content: Content) -> None:
    """Raise DocumentError for a declared parameter to which nothing in the document refers."""
    used = set(_references([value for key, value in content.items() if key != "parameters"]))
    for name in declared_parameters(content):
        if name not in used:
            raise DocumentError(f"parameters.{name}: nothing in the configuration uses {REFERENCE}{name}")


def laid_over(base: Mapping[str, Any], changes: Mapping[str, Any], where: str) -> Content:
    """Return `base` overridden by `changes`, mappings key by key; a key that `base` lacks is an error."""
    merged = dict(base)
    for key, value in changes.items():
        must_know("parameter", key, sorted(base), where)
        below = base[key]
        if isinstance(below, Mapping) is not isinstance(value, Mapping):
            expected = "a mapping" if isinstance(below, Mapping) else "a value"
            raise DocumentError(f"{where}.{key}: expected {expected}, got {short(value)}")
        merged[key] = laid_over(below, value, f"{where}.{key}") if isinstance(below, Mapping) else value
    return merged


def _filled(value: Any, values: Mapping[str, Any], where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return a value with every `$name` in it replaced by the parameter of that name."""
    if isinstance(value, dict):
        return {key: _filled(below, values, f"{where}.{key}") for key, below in value.items()}
    if isinstance(value, list):
        return [_filled(below, values, f"{where}.{index}") for index, below in enumerate(value)]
    for name in _references(value):
        must_know("parameter", name, sorted(values), where)
        return values[name]
    return value


def _references(value: Any) -> Iterator[str]:  # noqa: ANN401  (whatever YAML holds)
    """Yield the names of the parameters that a value refers to."""
    if isinstance(value, str) and value.startswith(REFERENCE):
        yield value.removeprefix(REFERENCE)
    elif isinstance(value, dict | list):
        for below in value.values() if isinstance(value, dict) else value:
            yield from _references(below)
