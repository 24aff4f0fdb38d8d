"""Values of YAML from the events of its parser, within limits: PyYAML's own constructors count nothing.

The reasons: docs/decisions/0065-one-reader.md.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn, cast

import yaml

from selector.documents.core_schema import value_of
from selector.documents.errors import DocumentError
from selector.documents.plain import short

MOST_NODES = 100_000
"""Values of a YAML document, those of an alias counted wherever it stands; the largest shipped one has a thousand."""
MOST_DEPTH = 50
"""Values around a value; the shipped documents need 10."""

TOO_DEEP = f"expected values in at most {MOST_DEPTH} others, got more"
_PARSER: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def yaml_value(text: str, where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value of a YAML text; DocumentError, which begins with `where`, for one that cannot be used."""
    builder, whole = _Builder(yaml.parse(text, Loader=_PARSER), where), list[Any]()
    try:
        for event in builder.events:
            if isinstance(event, yaml.NodeEvent):
                whole.append(builder.value(event, ())[0])
            elif isinstance(event, yaml.DocumentStartEvent) and whole:
                builder.refuse(event, (), "expected one document, got several")
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise DocumentError(f"{where}: line {line}: {error.problem}") from error
    except (yaml.YAMLError, UnicodeError) as error:
        raise DocumentError(f"{where}: {' '.join(str(error).split())}") from error
    return whole[0] if whole else None


@dataclass
class _Builder:
    """Builds values from the events of the parser; it recurses at most MOST_DEPTH times."""

    events: Iterator[yaml.Event]
    where: str
    known: dict[str | None, tuple[Any, int, int] | None] = field(default_factory=dict)
    """Anchor -> value, its number of nodes, and how deep it is; None while the value is not complete."""
    nodes: int = 0

    def value(self, event: yaml.NodeEvent, keys: tuple[str, ...]) -> tuple[Any, int]:
        """Return the value that begins with an event, below `keys`, and how deep values are nested in it."""
        before, anchor = self.nodes, event.anchor
        self.nodes += 1
        if tag := getattr(event, "tag", None):
            self.refuse(event, keys, f"expected a value without a tag, got {tag[:40]}")
        if isinstance(event, yaml.ScalarEvent):
            value, depth = self._scalar(event, keys), 0
        elif isinstance(event, yaml.CollectionStartEvent):
            self.known[anchor] = None
            value, depth = self._collection(event, keys)
        else:
            value, more, depth = self._named(event, str(anchor), keys)
            self.nodes += more - 1
        if self.nodes > MOST_NODES:
            self.refuse(event, keys, f"expected at most {MOST_NODES} values, with those of aliases, got more")
        if len(keys) + depth > MOST_DEPTH:
            self.refuse(event, keys, TOO_DEEP)
        if not isinstance(event, yaml.AliasEvent):
            self.known[anchor] = value, self.nodes - before, depth
        return value, depth

    def _collection(self, event: yaml.Event, keys: tuple[str, ...]) -> tuple[Any, int]:
        """Return the list or the mapping that begins with an event, and how deep it is."""
        mapping, made, depth = isinstance(event, yaml.MappingStartEvent), dict[Any, Any](), 1
        if len(keys) >= MOST_DEPTH:
            self.refuse(event, keys, TOO_DEEP)
        while isinstance(following := next(self.events), yaml.NodeEvent):
            key: Any = len(made)
            if mapping:
                key, _ = self.value(following, keys)
                if not isinstance(key, str):
                    self.refuse(following, keys, f"expected text as a key, got {short(key)}")
                if key in made:
                    self.refuse(following, keys, f"key {short(key)} twice")
                following = cast("yaml.NodeEvent", next(self.events))
            made[key], below = self.value(following, (*keys, str(key)))
            depth = max(depth, below + 1)
        return made if mapping else list(made.values()), depth

    def _named(self, event: yaml.NodeEvent, anchor: str, keys: tuple[str, ...]) -> tuple[Any, int, int]:
        """Return the value of an alias, its number of nodes, and how deep it is."""
        if anchor not in self.known:
            self.refuse(event, keys, f"expected an alias of something above, got *{anchor[:40]}")
        known = self.known[anchor]
        return known or self.refuse(event, keys, f"expected a value, got *{anchor[:40]}, which holds itself")

    def _scalar(self, event: yaml.ScalarEvent, keys: tuple[str, ...]) -> object:
        text: str = event.value
        if not text.isascii() and any("\ud800" <= character <= "\udfff" for character in text):
            self.refuse(event, keys, "expected text, got half a character (a lone surrogate)")
        if not event.implicit[0]:  # a text in quotes is never a number
            return text
        try:
            return value_of(text)
        except ValueError as error:
            return self.refuse(event, keys, str(error))

    def refuse(self, event: yaml.Event, keys: tuple[str, ...], what: str) -> NoReturn:
        """Raise the error of an event, with its line and the keys around it."""
        place = ".".join(keys[:8])
        line = event.start_mark.line + 1 if event.start_mark else 1
        raise DocumentError(f"{self.where}: line {line}: {f'{place[:100]}: ' if place else ''}{what}")
