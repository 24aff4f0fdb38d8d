"""The one reader of documents: YAML and JSON within limits, with errors of one line; YAML that is read back unchanged.

A document may be hostile: aliases that multiply, values that hold themselves, thousands of brackets, odd numbers. A
value is refused before anything is made of it, in well under a second.
"""

import json
import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import yaml

from selector.documents.core_schema import REAL, WHOLE, value_of
from selector.documents.errors import DocumentError, shown
from selector.documents.plain import short

DOCUMENT_BYTES = 32 * 2**20
"""Size of a document; a thousand start configurations of a hundred robots take a quarter of it."""
MOST_NODES = 100_000
"""Values of a YAML document, those of an alias counted wherever it stands; the largest shipped one has a thousand."""
MOST_JSON_NODES = 500_000
"""Values of a JSON document, which has no aliases and is written by programs."""
MOST_DEPTH = 50
"""Values around a value; the shipped documents need 10."""

_PARSER: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Dumper(yaml.SafeDumper):
    """A writer of YAML that is read back unchanged: a text that looks like a number of the core schema is quoted."""


_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", REAL, list("-+.0123456789"))
_Dumper.add_implicit_resolver("tag:yaml.org,2002:int", WHOLE, list("-+0123456789"))


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file; raises DocumentError."""
    return _mapping(_of_yaml(read_text(path), shown(path)), shown(path))


def read_json(path: Path) -> dict[str, Any]:
    """Return the mapping in a JSON file; raises DocumentError."""
    return _mapping(json_value(read_text(path), shown(path)), shown(path))


def as_yaml(content: object) -> str:
    """Return plain data as YAML text, which `read_mapping` reads back unchanged."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def read_value(text: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value of a piece of YAML from the command line; raises DocumentError."""
    try:
        return _of_yaml(text, "value")
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
        raise DocumentError(f"{where}: line {error.lineno}: {error.msg}; expected JSON") from error
    except RecursionError as error:
        raise DocumentError(f"{where}: {_DEEP}") from error
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error
    _check(content, where, ())
    return content


_DEEP = f"expected values in at most {MOST_DEPTH} others, got more"


@dataclass
class _Open:
    """A list or a mapping whose end has not been read.

    Attributes:
        content: what it holds so far.
        anchor: by which aliases refer to it; None: none.
        before: nodes counted before it.
        key: of a mapping, the key whose value comes next; None: a key comes next.
        depth: how deep values are nested in it, itself counted.

    """

    content: dict[str, Any] | list[Any]
    anchor: str | None
    before: int
    key: str | None = None
    depth: int = 1


@dataclass
class _Known:
    """A value with an anchor, its number of nodes, and how deep it is."""

    value: Any
    nodes: int
    depth: int


@dataclass
class _Builder:
    """Builds the value of a document from the events of the parser."""

    where: str
    open: list[_Open] = field(default_factory=list)
    known: dict[str, _Known] = field(default_factory=dict)
    nodes: int = 0
    whole: list[Any] = field(default_factory=list)
    """The value of the document, when it is complete."""

    def take(self, event: yaml.Event) -> None:
        """Take the next event."""
        if isinstance(event, yaml.NodeEvent):
            self.nodes += 1
            if tag := getattr(event, "tag", None):
                self._refuse(event, f"expected a value without a tag, got {tag[:40]}")
        if isinstance(event, yaml.AliasEvent):
            self._alias(event)
        elif isinstance(event, yaml.ScalarEvent):
            value = self._scalar(event)
            if event.anchor is not None:
                self.known[event.anchor] = _Known(value, 1, 0)
            self._add(event, value, 0)
        elif isinstance(event, yaml.CollectionStartEvent):
            self.open.append(_Open({} if isinstance(event, yaml.MappingStartEvent) else [], event.anchor, self.nodes))
            self.known.pop(str(event.anchor), None)  # until it is complete, no alias may refer to it or to an older one
        elif isinstance(event, yaml.CollectionEndEvent):
            done = self.open.pop()
            if done.anchor is not None:
                self.known[done.anchor] = _Known(done.content, self.nodes - done.before + 1, done.depth)
            self._add(event, done.content, done.depth)
        elif isinstance(event, yaml.DocumentStartEvent) and self.whole:
            self._refuse(event, "expected one document, got several")
        if self.nodes > MOST_NODES:
            self._refuse(event, f"expected at most {MOST_NODES} values, with those of aliases, got more")
        if len(self.open) > MOST_DEPTH:
            self._refuse(event, _DEEP)

    def _alias(self, event: yaml.AliasEvent) -> None:
        anchor = str(event.anchor)
        if any(one.anchor == anchor for one in self.open):
            self._refuse(event, f"expected a value, got *{anchor[:40]}, which holds itself")
        if anchor not in self.known:
            self._refuse(event, f"expected an alias of something above, got *{anchor[:40]}")
        known = self.known[anchor]
        self.nodes += known.nodes - 1
        self._add(event, known.value, known.depth)

    def _scalar(self, event: yaml.ScalarEvent) -> object:
        text: str = event.value
        if not text.isascii() and any("\ud800" <= character <= "\udfff" for character in text):
            self._refuse(event, "expected text, got half a character (a lone surrogate)")
        if not event.implicit[0]:  # it stands in quotes
            return text
        try:
            return value_of(text)
        except ValueError as error:
            return self._refuse(event, str(error))

    def _add(self, event: yaml.Event, value: object, depth: int) -> None:
        """Put a complete value into what it stands in."""
        if not self.open:
            self.whole.append(value)
            return
        around = self.open[-1]
        around.depth = max(around.depth, depth + 1)
        if len(self.open) + depth > MOST_DEPTH:
            self._refuse(event, _DEEP)
        if isinstance(around.content, list):
            around.content.append(value)
        elif around.key is None:
            if not isinstance(value, str):
                self._refuse(event, f"expected text as a key, got {short(value)}")
            if value in around.content:
                self._refuse(event, f"key {short(value)} twice")
            around.key = value
            around.content[value] = None
        else:
            around.content[around.key], around.key = value, None

    def _refuse(self, event: yaml.Event, what: str) -> NoReturn:
        """Raise the error of an event, with its line and the keys around it."""
        keys = [str(len(one.content)) if isinstance(one.content, list) else one.key for one in self.open]
        place = ".".join(key for key in keys[:8] if key is not None)
        line = event.start_mark.line + 1 if event.start_mark else 1
        raise DocumentError(f"{self.where}: line {line}: {f'{place[:100]}: ' if place else ''}{what}")


def _of_yaml(text: str, where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    builder = _Builder(where)
    try:
        for event in yaml.parse(text, Loader=_PARSER):
            builder.take(event)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise DocumentError(f"{where}: line {line}: {error.problem}") from error
    except (yaml.YAMLError, UnicodeError) as error:
        raise DocumentError(f"{where}: {' '.join(str(error).split())}") from error
    return builder.whole[0] if builder.whole else None


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
        raise DocumentError(f"{where}: {'.'.join(keys[:8])[:100]}: {_DEEP}")
    if isinstance(value, dict | list):
        for key, below in value.items() if isinstance(value, dict) else enumerate(value):
            if isinstance(below, dict | list | float):
                _check(below, where, (*keys, str(key)))
