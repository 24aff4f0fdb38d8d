"""Values of YAML from the events of its parser, within limits: PyYAML's own constructors recurse and count nothing."""

from dataclasses import dataclass, field
from typing import Any, NoReturn

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


@dataclass
class _Open:
    """A list or a mapping whose end has not been read.

    Attributes:
        content: what it holds so far.
        anchor: name by which aliases refer to it; None without one.
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
            self._refuse(event, TOO_DEEP)

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
        if not event.implicit[0]:  # a text in quotes is never a number
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
            self._refuse(event, TOO_DEEP)
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
