"""The contents of a store, and the document in YAML or JSON as which they are exported and imported."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import AwareDatetime, Field, StringConstraints, model_validator

from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, Context, Label, Number
from selector.documents.plain import must_know
from selector.documents.reading import as_yaml, read_json, read_mapping
from selector.knowledge import Definition, Knowledge, LearnedScore, LearnedScores, Option, believed, knowledge_from
from selector.store.exact_sums import NO_REWARDS, Moments

FORMAT = {"format": "clean-swarm knowledge store", "version": 1}
"""What an exported store says that it is."""

Whole = Annotated[str, StringConstraints(strict=True, pattern=r"^-?[0-9]{1,40}$")]
"""A whole number as text: SQLite keeps 64 bits, and other programs would round such a number to a float."""


class StoreError(DocumentError):
    """A store cannot be opened, read or written; nothing was changed."""


class Key(NamedTuple):
    """The key of an entry; it is that of the expert if context and source are empty."""

    goal: str
    option: str
    context: str = ""
    source: str = ""


class Expert(Definition):
    """What an expert says of an option."""

    position: Annotated[int, Field(strict=True, ge=0, lt=2**31)]
    """Place among the options of its goal; the first of equals is taken."""
    score: Number
    """How well the option serves the goal [-]."""

    @model_validator(mode="after")
    def _kept_as_json(self) -> Self:
        try:
            same = json.loads(json.dumps(self.parameters)) == self.parameters
        except (TypeError, ValueError):
            same = False
        if not same:
            raise ValueError("parameters: expected text, numbers, lists and mappings by text")
        return self


class Entry(Closed):
    """What an expert says of an option, or the sums of the rewards that it brought one source in one context."""

    goal: Label
    """The goal that the option serves."""
    option: Label
    """Name of the option."""
    context: Context = ""
    """Key of the context; empty for none."""
    source: Context = ""
    """Source of the rewards: a run; empty for the expert."""
    expert: Expert | None = None
    """What the expert says."""
    count: Annotated[int, Field(strict=True)] = 0
    """Number of rewards."""
    total: Whole = "0"
    """Sum of the rewards in units of 2^-24."""
    squares: Whole = "0"
    """Sum of their squares in units of 2^-48."""
    updated: AwareDatetime
    """Time of the last update (ISO 8601)."""

    @property
    def key(self) -> Key:
        """The key of the entry."""
        return Key(self.goal, self.option, self.context, self.source)

    @property
    def moments(self) -> Moments:
        """The sums as numbers."""
        return Moments(self.count, int(self.total), int(self.squares))

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if (self.expert is None) is (self.source == ""):
            raise ValueError("source: expected one for rewards, and none for what an expert says")
        if self.expert is not None and (self.context or self.moments != NO_REWARDS):
            raise ValueError("expert: expected neither context nor rewards")
        if self.source and (why := self.moments.impossible()):
            raise ValueError(why)
        return self


class _Document(Closed):
    """An exported store."""

    format: Literal["clean-swarm knowledge store"]
    """Kind of the file."""
    version: Literal[1]
    """Version of this format."""
    entries: tuple[Entry, ...]
    """What the store holds."""


@dataclass(frozen=True)
class StoredKnowledge:
    """The entries of a store by key."""

    entries: Mapping[Key, Entry] = field(default_factory=dict)

    @property
    def expert(self) -> dict[tuple[str, str], Expert]:
        """What the expert says, by goal and option."""
        return {key[:2]: entry.expert for key, entry in self.entries.items() if entry.expert is not None}

    @property
    def learned(self) -> dict[Key, Entry]:
        """The entries with rewards."""
        return {key: entry for key, entry in self.entries.items() if entry.source}

    def totals(self) -> dict[tuple[str, str, str], Moments]:
        """Return the sums over all sources, by goal, option and context."""
        sums: dict[tuple[str, str, str], Moments] = {}
        for key, entry in self.learned.items():
            sums[key[:3]] = sums.get(key[:3], NO_REWARDS) + entry.moments
        return sums

    def scores(self, knowledge: Knowledge, context: str) -> LearnedScores:
        """Return what was learned in a context of the options of expert knowledge, over all sources.

        Raises:
            StoreError: an option has another configuration or other parameters here.

        """
        self.check_fits(stored(knowledge), f"{knowledge.source}: ")
        sums = self.totals()
        found: LearnedScores = {}
        for goal in knowledge.goals:
            for option in knowledge.options(goal):
                if moments := sums.get((goal, option.name, context)):
                    score = LearnedScore(count=moments.count, mean=moments.mean, variance=moments.variance)
                    found.setdefault(goal, {})[option.name] = score
        return found

    def check_fits(self, other: "StoredKnowledge", where: str = "") -> None:
        """Raise StoreError, which begins with `where`, if an option means something else in `other`, or rewards differ.

        The rewards of one source must be the same, so that none counts twice.
        """
        for key, given in other.entries.items():
            held, name = self.entries.get(key, given), f"{where}goals.{key.goal}.{key.option}"
            if held.expert and given.expert and not held.expert.same(given.expert):
                means = f"means {held.expert.meaning} here and {given.expert.meaning} there"
                raise StoreError(f"{name}: {means}; give one of them another name")
            if held.moments != given.moments:
                raise StoreError(f"{name}: holds other rewards of the source {key.source!r} already; reset it first")

    def knowledge(self, source: str) -> Knowledge:
        """Return the expert options as expert knowledge; `source` is named in its errors."""
        table: dict[str, tuple[Option, ...]] = {}
        ordered = sorted(self.expert.items(), key=lambda item: (item[0][0], item[1].position, item[0][1]))
        for (goal, name), expert in ordered:
            option = Option(name=name, **expert.model_dump(exclude={"position"}))
            table[goal] = (*table.get(goal, ()), option)
        return Knowledge(table, source)


def stored(knowledge: Knowledge) -> StoredKnowledge:
    """Return expert knowledge as the contents of a store.

    Raises:
        DocumentError: no store takes the name or the parameters of an option.

    """
    now, entries = datetime.now(UTC), []
    for goal in knowledge.goals:
        for position, option in enumerate(knowledge.options(goal)):
            expert = option.model_dump(exclude={"name"}) | {"position": position}
            content = {"goal": goal, "option": option.name, "expert": expert, "updated": now}
            entries.append(validated(Entry, content, f"{knowledge.source}: goals.{goal}.{option.name}", own=True))
    return StoredKnowledge({entry.key: entry for entry in entries})


def learned_entry(key: Key, moments: Moments) -> Entry:
    """Return the entry of rewards under a key as of now; DocumentError for a name or sums that no store takes."""
    sums = {"count": moments.count, "total": str(moments.total), "squares": str(moments.squares)}
    return validated(Entry, {**key._asdict(), **sums, "updated": datetime.now(UTC)}, "store")


def from_document(content: object, where: str) -> StoredKnowledge:
    """Return the contents of a store from a document; errors begin with `where`."""
    entries: dict[Key, Entry] = {}
    for k, entry in enumerate(validated(_Document, content, where).entries):
        if entry.key in entries:
            raise DocumentError(f"{where}: entries.{k}: the entry of {', '.join(entry.key)} is given twice")
        entries[entry.key] = entry
    return StoredKnowledge(entries)


def as_rows(entries: Iterable[Entry]) -> list[dict[str, Any]]:
    """Return entries as plain data, in the order of their keys."""
    return [entry.model_dump(mode="json") for entry in sorted(entries, key=lambda entry: entry.key)]


def document_text(contents: StoredKnowledge, *, as_json: bool) -> str:
    """Return the contents of a store as the text of a file."""
    document = {**FORMAT, "entries": as_rows(contents.entries.values())}
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n" if as_json else as_yaml(document)


def knowledge_text(contents: StoredKnowledge, context: str, where: str) -> str:
    """Return expert knowledge as the text of a file, with the scores learned in a context of a store at `where`.

    Raises:
        DocumentError: nothing was learned in this context.

    """
    contexts = sorted({key.context for key in contents.learned})
    must_know("context", context, contexts, where)
    knowledge = contents.knowledge(where)
    learned = contents.scores(knowledge, context)
    goals = {}
    for goal in knowledge.goals:
        scores = believed(knowledge.scores(goal), knowledge.with_learned(learned).rewards(goal)).tolist()
        options = zip(knowledge.options(goal), scores, strict=True)
        goals[goal] = [option.model_dump() | {"score": score} for option, score in options]
    rewards = {goal: {name: one.model_dump() for name, one in known.items()} for goal, known in learned.items()}
    return as_yaml({"description": f"Scores learned in the context {context!r}.", "goals": goals, "learned": rewards})


def read(path: Path) -> StoredKnowledge:
    """Return the contents of a file: an exported store, or expert knowledge."""
    where = shown(path)
    content = read_json(path) if path.suffix == ".json" else read_mapping(path)
    if "format" in content:
        return from_document(content, where)
    return stored(knowledge_from(content, where))
