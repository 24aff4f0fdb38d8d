"""The one reader of documents: YAML and JSON within limits, with errors of one line; YAML that is read back unchanged.

A document may be hostile: aliases that multiply, values that hold themselves, thousands of brackets, odd numbers. A
value is refused before anything is made of it, in well under a second.
"""

import json
import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from selector.documents.plain import DocumentError, short, shown
from selector.documents.yaml_values import MOST_DEPTH, REAL, TOO_DEEP, WHOLE, value_of, yaml_value

DOCUMENT_BYTES = 32 * 2**20
"""Size of a document; a thousand start configurations of a hundred robots take a quarter of it."""
MOST_JSON_NODES = 500_000
"""Values of a JSON document, which has no aliases and is written by programs."""


class _Dumper(yaml.SafeDumper):
    """A writer of YAML that is read back unchanged: a text that looks like a number of the core schema is quoted."""


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    """Return a text, in quotes if it has line ends or other characters that YAML folds."""
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=None if text.isprintable() else '"')


_Dumper.add_representer(str, _text)
_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", REAL, list("-+.0123456789"))
_Dumper.add_implicit_resolver("tag:yaml.org,2002:int", WHOLE, list("-+0123456789"))


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file; raises DocumentError."""
    return _mapping(yaml_value(read_text(path), shown(path)), shown(path))


def read_json(path: Path) -> dict[str, Any]:
    """Return the mapping in a JSON file; raises DocumentError."""
    return _mapping(json_value(read_text(path), shown(path)), shown(path))


def json_lines(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield where a line of a file is and its JSON value, line by line; nothing without the file."""
    for number, line in enumerate(read_text(path).splitlines() if path.exists() else (), start=1):
        where = f"{shown(path)}: line {number}"
        yield where, json_value(line, where)


def as_yaml(content: object) -> str:
    """Return plain data as YAML text, which `read_mapping` reads back unchanged."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def read_value(text: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value of a piece of YAML from the command line; raises DocumentError."""
    try:
        return yaml_value(text, "value")
    except DocumentError as error:
        raise DocumentError(f"expected a value, got {short(text)} ({error})") from error


def read_text(path: Path) -> str:
    """Return the text of a file; DocumentError for one that cannot be read, is not UTF-8 or is too long."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError as error:
        raise DocumentError(f"{shown(path)}: expected text in UTF-8, got another byte at {error.start}") from error


def read_bytes(path: Path) -> bytes:
    """Return the content of a file; DocumentError for one that cannot be read or is too long."""
    try:
        with path.open("rb") as file:
            content = file.read(DOCUMENT_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DocumentError(f"{shown(path)}: cannot be read ({why})") from error
    if len(content) > DOCUMENT_BYTES:
        raise DocumentError(f"{shown(path)}: expected at most {DOCUMENT_BYTES} bytes, got more")
    return content


def json_value(text: str, where: str) -> Any:  # noqa: ANN401  (whatever JSON holds)
    """Return the value of a JSON text; DocumentError, which begins with `where`, for one that cannot be used."""
    if text.count(",") + text.count("[") + text.count("{") > MOST_JSON_NODES:
        raise DocumentError(f"{where}: expected at most {MOST_JSON_NODES} values, got more")
    try:
        content = json.loads(text, object_pairs_hook=_unique, parse_int=value_of)
    except json.JSONDecodeError as error:
        found = short(text[error.pos : error.pos + 20]) if text[error.pos :].strip() else "the end"
        raise DocumentError(f"{where}: line {error.lineno}: expected JSON, got {found}") from error
    except RecursionError as error:
        raise DocumentError(f"{where}: {TOO_DEEP}") from error
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error
    _check(content, where, ())
    return content


def _mapping(content: object, where: str) -> dict[str, Any]:
    if not isinstance(content, dict):
        raise DocumentError(f"{where}: expected a mapping of keys, got {type(content).__name__}")
    return content


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the mapping of `pairs`; ValueError for a key that is given twice."""
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        times = Counter(name for name, _ in pairs)
        raise ValueError(f"key {short(times.most_common(1)[0][0])} twice")
    return mapping


def _check(value: object, where: str, keys: tuple[str, ...]) -> None:
    """Raise DocumentError for values of JSON that YAML does not have either, and for those that are nested too deep."""
    if isinstance(value, float) and not math.isfinite(value):
        raise DocumentError(f"{where}: {'.'.join(keys[:8])[:100]}: expected a finite number, got {value}")
    if len(keys) > MOST_DEPTH:
        raise DocumentError(f"{where}: {'.'.join(keys[:8])[:100]}: {TOO_DEEP}")
    if isinstance(value, dict | list):
        for key, below in value.items() if isinstance(value, dict) else enumerate(value):
            if isinstance(below, dict | list | float):
                _check(below, where, (*keys, str(key)))
