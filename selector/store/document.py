"""The contents of a store as a document in YAML or JSON; an import of the document gives an equal store."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AwareDatetime, Field, PlainSerializer, StringConstraints, model_validator

from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, Context, Label
from selector.documents.reading import as_yaml, read_json, read_mapping
from selector.knowledge import Option, believed, knowledge_from
from selector.store.errors import StoreError
from selector.store.exact_sums import Moments
from selector.store.stored_knowledge import Key, LearnedEntry, Rated, StoredKnowledge, definition, stored
from selforg.registry import unknown

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MICROSECOND = timedelta(microseconds=1)
FORMAT = {"format": "clean-swarm knowledge store", "version": 1}
"""What an exported store says that it is."""

Whole = Annotated[str, StringConstraints(strict=True, pattern=r"^-?[0-9]{1,40}$")]
"""A whole number as text, because other programs would round a number of that size to a float."""
Time = Annotated[AwareDatetime, Field(ge=EPOCH), PlainSerializer(lambda time: time.isoformat(timespec="microseconds"))]


class _Expert(Option):
    """An option by an expert."""

    position: Annotated[int, Field(strict=True, ge=0, lt=2**31)]
    """Place among the options of its goal."""
    source: Label
    """Source of the option."""
    updated: Time
    """Time at which it was given (ISO 8601)."""


class _Learned(Closed):
    """Sums of the rewards of one option of one goal in one context from one source."""

    goal: Label
    """The goal that the option serves."""
    option: Label
    """Name of the option."""
    context: Context
    """Key of the context; empty for none."""
    source: Label
    """Source of the rewards."""
    updated: Time
    """Time of the last update (ISO 8601)."""
    count: Annotated[int, Field(strict=True)]
    """Number of rewards."""
    total: Whole
    """Sum of the rewards in units of 2^-24."""
    squares: Whole
    """Sum of their squares in units of 2^-48."""

    @property
    def moments(self) -> Moments:
        """The sums as numbers."""
        return Moments(self.count, int(self.total), int(self.squares))

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if why := self.moments.impossible():
            raise ValueError(why)
        return self


class _Document(Closed):
    """An exported store."""

    format: Literal["clean-swarm knowledge store"]
    """Kind of the file."""
    version: Literal[1]
    """Version of this format."""
    expert: dict[Label, tuple[_Expert, ...]]
    """Options by goal."""
    learned: tuple[_Learned, ...]
    """Learned entries."""


def as_document(contents: StoredKnowledge) -> dict[str, Any]:
    """Return contents as plain data, in an order that depends on the contents only.

    Raises:
        DocumentError: no store takes such contents: bad names, impossible sums or times, bad parameters.

    """
    expert: dict[str, list[dict[str, Any]]] = {}
    for goal, options in contents.options_by_goal().items():
        for rated in options:
            definition(rated.option)  # raises
            about = {"position": rated.position, "source": rated.source, "updated": _time(rated.updated)}
            expert.setdefault(goal, []).append(rated.option.model_dump() | about)
    learned = []
    for key, entry in sorted(contents.learned.items(), key=lambda item: item[0]):
        moments = {"count": entry.moments.count} | {n: str(getattr(entry.moments, n)) for n in ("total", "squares")}
        learned.append(key._asdict() | {"updated": _time(entry.updated)} | moments)
    document = validated(_Document, {**FORMAT, "expert": expert, "learned": learned}, "store")
    return document.model_dump(mode="json")


def from_document(content: object, where: str) -> StoredKnowledge:
    """Return the contents of a store from a document; errors begin with `where`."""
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
        learned[key] = LearnedEntry(entry.moments, _microseconds(entry.updated))
    return StoredKnowledge(expert, learned)


def _time(updated: int) -> datetime:
    """Return the date of a time [us since 1970, UTC]."""
    try:
        return EPOCH + updated * MICROSECOND
    except OverflowError as error:
        raise DocumentError(f"updated: expected a time from 1970 to 9999 [us], got {updated}") from error


def _microseconds(time: datetime) -> int:
    return (time - EPOCH) // MICROSECOND


def document_text(contents: StoredKnowledge, *, as_json: bool) -> str:
    """Return the contents of a store as the text of a file."""
    document = as_document(contents)
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n" if as_json else as_yaml(document)


def knowledge_text(contents: StoredKnowledge, context: str, where: str) -> str:
    """Return expert knowledge as the text of a file, with the scores learned in a context of a store at `where`.

    Raises:
        StoreError: nothing was learned in this context.

    """
    contexts = sorted({key.context for key in contents.learned})
    if context not in contexts:
        raise StoreError(f"{where}: {unknown('context', context, contexts)}")
    knowledge = contents.knowledge(where)
    learned = contents.scores(knowledge, context)
    goals = {}
    for goal in knowledge.goals:
        scores = believed(knowledge.scores(goal), knowledge.with_learned(learned).rewards(goal)).tolist()
        options = zip(knowledge.options(goal), scores, strict=True)
        goals[goal] = [option.model_dump() | {"score": score} for option, score in options]
    rewards = {goal: {name: one.model_dump() for name, one in known.items()} for goal, known in learned.items()}
    return as_yaml({"description": f"Scores learned in the context {context!r}.", "goals": goals, "learned": rewards})


def read(path: Path, source: str) -> StoredKnowledge:
    """Return the contents of a file: an exported store, or expert knowledge with `source` and the present time."""
    where = shown(path)
    content = read_json(path) if path.suffix == ".json" else read_mapping(path)
    if "format" in content:
        return from_document(content, where)
    knowledge = knowledge_from(content, where)
    if knowledge.situations:
        raise StoreError(f"{where}: situations: expected none for a store, which keeps one score for each option")
    return stored(knowledge, source)
