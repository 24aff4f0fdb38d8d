"""What a store holds as a document, YAML or JSON: exact, so that importing it elsewhere gives the same store."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AwareDatetime, Field, PlainSerializer, StringConstraints

from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, Name
from selector.documents.reading import as_yaml, read_mapping
from selector.knowledge import Option, knowledge_from
from selector.store.exact_sums import Moments
from selector.store.stored_knowledge import Key, LearnedEntry, Rated, StoredKnowledge, stored

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MICROSECOND = timedelta(microseconds=1)

Whole = Annotated[str, StringConstraints(strict=True, pattern=r"^-?[0-9]{1,40}$")]
"""A whole number as text: other programs would round it to a float."""
Time = Annotated[AwareDatetime, PlainSerializer(lambda time: time.isoformat(timespec="microseconds"))]


class _Expert(Option):
    """An option as an expert gave it."""

    position: Annotated[int, Field(strict=True, ge=0, lt=2**31)]
    """Place among the options of its goal."""
    source: Name
    """Who gave it."""
    updated: Time
    """When it was given (ISO 8601)."""


class _Learned(Closed):
    """What was learned of one option of one goal in one context from one source."""

    goal: Name
    """The goal that the option serves."""
    option: Name
    """Name of the option."""
    context: Annotated[str, Field(strict=True)]
    """Key of the context; empty for none."""
    source: Name
    """Who learned it."""
    updated: Time
    """Time of the last update (ISO 8601)."""
    count: Annotated[int, Field(strict=True)]
    """Number of rewards."""
    total: Whole
    """Sum of the rewards in units of 2^-24."""
    squares: Whole
    """Sum of their squares in units of 2^-48."""


class _Document(Closed):
    """What an exported store holds."""

    format: Literal["clean-swarm knowledge store"]
    """What this file is."""
    version: Literal[1]
    """Version of this format."""
    expert: dict[Name, tuple[_Expert, ...]]
    """Options by goal."""
    learned: tuple[_Learned, ...]
    """What was learned."""


def as_document(contents: StoredKnowledge) -> dict[str, Any]:
    """Return the contents of a store as plain data, in an order that depends on nothing else."""
    expert: dict[str, list[_Expert]] = {}
    for (goal, _), rated in sorted(contents.expert.items(), key=lambda item: (item[0][0], item[1].position, item[0])):
        found = _Expert(
            **rated.option.model_dump(),
            position=rated.position,
            source=rated.source,
            updated=EPOCH + rated.updated * MICROSECOND,
        )
        expert.setdefault(goal, []).append(found)
    learned = [
        _Learned(
            **key._asdict(),
            updated=EPOCH + entry.updated * MICROSECOND,
            count=entry.moments.count,
            total=str(entry.moments.total),
            squares=str(entry.moments.squares),
        )
        for key, entry in sorted(contents.learned.items(), key=lambda item: item[0])
    ]
    whole = {goal: tuple(options) for goal, options in expert.items()}
    document = _Document(format="clean-swarm knowledge store", version=1, expert=whole, learned=tuple(learned))
    return document.model_dump(mode="json")


def from_document(content: object, where: str) -> StoredKnowledge:
    """Return the contents that a document holds; `where` stands in error messages."""
    document = validated(_Document, content, where)
    expert: dict[tuple[str, str], Rated] = {}
    for goal, options in document.expert.items():
        for given in options:
            if (goal, given.name) in expert:
                raise DocumentError(f"{where}: expert.{goal}: option {given.name!r} is given twice")
            option = Option(**given.model_dump(include=set(Option.model_fields)))
            expert[goal, given.name] = Rated(option, given.position, given.source, _microseconds(given.updated))
    learned: dict[Key, LearnedEntry] = {}
    for k, entry in enumerate(document.learned):
        key = Key(entry.goal, entry.option, entry.context, entry.source)
        if key in learned:
            raise DocumentError(f"{where}: learned.{k}: the entry of {', '.join(key)} is given twice")
        moments = Moments(entry.count, int(entry.total), int(entry.squares))
        if why := moments.impossible():
            raise DocumentError(f"{where}: learned.{k}: {why}")
        learned[key] = LearnedEntry(moments, _microseconds(entry.updated))
    return StoredKnowledge(expert, learned)


def _microseconds(time: datetime) -> int:
    return (time - EPOCH) // MICROSECOND


def document_text(contents: StoredKnowledge, *, as_json: bool) -> str:
    """Return the contents of a store as the text of a file."""
    document = as_document(contents)
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n" if as_json else as_yaml(document)


def read(path: Path, source: str) -> StoredKnowledge:
    """Return what a file holds: an exported store, or expert knowledge, which gets `source` and the time of now."""
    where = shown(path)
    content = _read_json(path) if path.suffix == ".json" else read_mapping(path)
    if "format" in content:
        return from_document(content, where)
    return stored(knowledge_from(content, where), source)


def _read_json(path: Path) -> dict[str, Any]:
    where = shown(path)
    try:
        content = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=_unique)
    except (OSError, UnicodeDecodeError) as error:
        raise DocumentError(f"{where}: cannot be read ({error})") from error
    except json.JSONDecodeError as error:
        raise DocumentError(f"{where}: line {error.lineno}: {error.msg}") from error
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error
    if not isinstance(content, dict):
        raise DocumentError(f"{where}: expected a mapping of keys, got {type(content).__name__}")
    return content


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"key {next(name for name in names if names.count(name) > 1)!r} twice")
    return mapping
