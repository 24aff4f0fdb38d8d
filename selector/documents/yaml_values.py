"""Values of YAML from the events of its parser, within limits, by the core schema of YAML 1.2.2, section 10.3.2.

`Off` is text, `1e-9` a number. PyYAML's own constructors know YAML 1.1, recurse, count nothing, and answer odd values
with exceptions of many kinds (docs/decisions/0065-one-reader.md).
"""

import math
import re
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, NoReturn

import yaml

from selector.documents.plain import DocumentError, short

MOST_NODES = 50_000
"""Values of a YAML document, those of an alias counted wherever it stands; the largest shipped one has a thousand."""
MOST_EVENTS = 2 * MOST_NODES + 4
"""Events of the parser for that number of values: two for each, two of the stream, two of the document."""
MOST_DEPTH = 50
"""Values around a value; the shipped documents need 10."""
MOST_DIGITS = 40
"""Digits of a whole number; no field of a document holds a longer one."""
TOO_DEEP = f"expected values in at most {MOST_DEPTH} others, got more"

NULL = re.compile(r"~|null|Null|NULL|")
TRUTH = re.compile(r"true|True|TRUE|false|False|FALSE")
WHOLE = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_PARSER: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def yaml_value(text: str, where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value of a YAML text; DocumentError, which begins with `where`, for one that cannot be used."""
    try:
        events = list(islice(yaml.parse(text, Loader=_PARSER), MOST_EVENTS))
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        what = (
            TOO_DEEP if "nesting" in str(error.problem) else error.problem
        )  # PyYAML has a bound of its own since 6.0.4
        raise DocumentError(f"{where}: line {line}: {what}") from error
    except (yaml.YAMLError, UnicodeError) as error:
        raise DocumentError(f"{where}: {' '.join(str(error).split())}") from error
    builder = _Builder(events, where)
    first = 2  # after the beginnings of the stream and of the document
    if len(events) == first:
        return None
    value, end = builder.value(first, ())
    if not isinstance(events[end + 1], yaml.StreamEndEvent):
        builder.refuse(events[end + 1], (), "expected one document, got several")
    return value


@dataclass
class _Builder:
    """Builds values from events; it recurses at most MOST_DEPTH times. An alias is built again from its events."""

    events: list[yaml.Event]
    where: str
    anchors: dict[str, int] = field(default_factory=dict)
    """Anchor -> index of the first event of its latest value, once that is complete."""
    meant: dict[int, int | None] = field(default_factory=dict)
    """Index of an alias -> that of the first event of its value; a later value may have the same anchor."""
    complete: int = 0
    """Number of events that belong to complete values."""
    nodes: int = 0

    def value(self, index: int, keys: tuple[str, ...]) -> tuple[Any, int]:
        """Return the value, below `keys`, whose first event has an index, and the index of the event that follows."""
        event: Any = self.events[index]
        self.nodes += 1
        if self.nodes > MOST_NODES:
            self.refuse(event, keys, f"expected at most {MOST_NODES} values, with those of aliases, got more")
        if isinstance(event, yaml.AliasEvent):
            anchor = str(event.anchor)
            meant = self.meant.setdefault(index, self.anchors.get(anchor))
            if meant is None:
                self.refuse(event, keys, f"expected an alias of a whole value above, got *{anchor[:40]}")
            return self.value(meant, keys)[0], index + 1
        if event.tag:
            self.refuse(event, keys, f"expected a value without a tag, got {event.tag[:40]}")
        if index >= self.complete:  # not again within an alias
            self.anchors.pop(event.anchor, None)
        scalar = isinstance(event, yaml.ScalarEvent)
        value, end = (self._scalar(event, keys), index + 1) if scalar else self._collection(index, keys)
        if end > self.complete:
            self.complete = end
            if event.anchor:
                self.anchors[event.anchor] = index
        return value, end

    def _collection(self, index: int, keys: tuple[str, ...]) -> tuple[Any, int]:
        """Return the list or the mapping that begins with an event, and the index of the event that follows."""
        if len(keys) >= MOST_DEPTH:
            self.refuse(self.events[index], keys, TOO_DEEP)
        mapping, made = isinstance(self.events[index], yaml.MappingStartEvent), dict[Any, Any]()
        index += 1
        while isinstance(event := self.events[index], yaml.NodeEvent):
            key: Any = len(made)
            if mapping:
                key, index = self.value(index, keys)
                if not isinstance(key, str):
                    self.refuse(event, keys, f"expected text as a key, got {short(key)}")
                if key in made:
                    self.refuse(event, keys, f"key {short(key)} twice")
            made[key], index = self.value(index, (*keys, str(key)))
        return made if mapping else list(made.values()), index + 1

    def _scalar(self, event: yaml.ScalarEvent, keys: tuple[str, ...]) -> object:
        text: str = event.value
        try:
            text.encode()  # fails for half a character
            return value_of(text) if event.implicit[0] else text  # a text in quotes is never a number
        except ValueError as error:
            return self.refuse(event, keys, str(error))

    def refuse(self, event: yaml.Event, keys: tuple[str, ...], what: str) -> NoReturn:
        """Raise the error of an event, with its line and the keys around it."""
        place = ".".join(keys[:8])
        line = event.start_mark.line + 1 if event.start_mark else 1
        raise DocumentError(f"{self.where}: line {line}: {f'{place[:100]}: ' if place else ''}{what}")


def value_of(text: str) -> str | int | float | bool | None:
    """Return the value of a plain scalar; ValueError for a number that cannot be used."""
    if NULL.fullmatch(text):
        return None
    if TRUTH.fullmatch(text):
        return text.lower() == "true"
    if WHOLE.fullmatch(text):
        if len(text) > MOST_DIGITS:
            raise ValueError(f"expected a whole number of at most {MOST_DIGITS} digits, got {len(text)} of them")
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if not REAL.fullmatch(text):
        return text
    named = text[-1].isalpha()  # infinity
    number = float(text.replace(".", "", 1) if named else text)
    if math.isnan(number) or (math.isinf(number) and not named):
        raise ValueError(f"expected a number, got {text[:MOST_DIGITS]}")
    return number
