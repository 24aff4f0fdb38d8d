"""The knowledge store of a command: what a run begins with and gives back, and files that a user names for import."""

import os
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import platformdirs

from selector.documents.errors import DocumentError
from selector.documents.fields import MOST_STORED
from selector.documents.plain import short
from selector.knowledge import Knowledge, LearnedScores, load_knowledge
from selector.store import RewardSums, StoredKnowledge, StoreError, document
from selector.store.stored_knowledge import stored

if TYPE_CHECKING:
    from selector.store import KnowledgeStore

VARIABLE = "CLEAN_SWARM_STORE"
"""Environment variable with the URL of the store, used without `--store`."""


@dataclass(frozen=True)
class StoreRequest:
    """The request of the user for a run with a knowledge store."""

    url: str | None = None
    """URL or path of the store; none unless given."""
    learn: bool = False
    """Whether the run gives back its rewards."""

    def __post_init__(self) -> None:
        if self.learn and self.url is None:
            raise DocumentError("--learn: expected --store URL, the knowledge store to give to")
        if self.url:  # a missing package is told before anything is compiled
            from selector.store import KnowledgeStore  # noqa: F401

    def memory(self, knowledge: Knowledge, context: str, source: str) -> "Memory | None":
        """Return the memory of a run; None without a store."""
        if not self.url:
            return None
        return Memory(opened(self.url, create=self.learn), knowledge, context, source if self.learn else "")


NO_STORE = StoreRequest()
"""The request without a store."""


class Memory:
    """The rewards that a run takes from a knowledge store, and those that it gives back.

    Args:
        store: the store.
        knowledge: expert knowledge with the options of the run.
        context: under which the store keeps rewards of such runs.
        source: under which it keeps the rewards of this run; empty if the run gives nothing back.

    Attributes:
        knowledge: the expert knowledge, with what the store knew at the beginning.

    Raises:
        StoreError: the store cannot be used, or knows an option with another configuration or other parameters.

    """

    def __init__(self, store: "KnowledgeStore", knowledge: Knowledge, context: str, source: str) -> None:
        self._store, self._expert, self.context, self.source = store, knowledge, context, source
        if source:
            if len(context) > MOST_STORED:
                raise StoreError(f"context: expected up to {MOST_STORED} characters, got {short(context)}")
            store.introduce(knowledge, source=source)
        self.knowledge = self.now()

    @property
    def learns(self) -> bool:
        """Whether the run gives back its rewards."""
        return bool(self.source)

    def held(self, options: Collection[str] = ()) -> int:
        """Return how many rewards of this source the store holds in this context; of some `options` only if given."""
        own = {k: entry for k, entry in self._store.contents().learned.items() if k[2:] == (self.context, self.source)}
        return sum(entry.moments.count for key, entry in own.items() if not options or key.option in options)

    def check_new(self, options: Collection[str] = ()) -> None:
        """Raise StoreError if the store holds what this run would learn (of `options`), which would count twice."""
        if self.learns and self.held(options):
            advice = "take another --seed, continue with --resume, or `clean-swarm learn knowledge reset --source` it"
            raise StoreError(f"{self._store.name}: holds what {self.source!r} learned already; {advice}")

    def now(self) -> Knowledge:
        """Return the expert knowledge with the present rewards of the store."""
        return self._expert.with_learned(self._store.contents().scores(self._expert, self.context))

    def give(self, rewards: Iterable[tuple[str, str, float]]) -> None:
        """Add `rewards` to the store, as goal, option and reward [-], all of them at once."""
        sums: dict[str, RewardSums] = {}
        for goal, option, reward in rewards:
            names = [one.name for one in self._expert.options(goal)]
            known = sums.setdefault(goal, RewardSums(goal, names))
            known.record(np.array([names.index(option)]), np.array([reward]), self.context)
        self.give_sums(*sums.values())

    def give_sums(self, *sums: RewardSums) -> None:
        """Add sums of rewards to the store, all of them at once."""
        self._store.add(*sums, source=self.source)

    def close(self) -> None:
        """Close the store."""
        self._store.close()


def as_plain(learned: LearnedScores) -> dict[str, dict[str, dict[str, float]]]:
    """Return the learned rewards of options as plain data, for a manifest."""
    return {goal: {name: one.model_dump() for name, one in scores.items()} for goal, scores in learned.items()}


def default_path() -> Path:
    """Return the path of the store in the user's data directory."""
    return platformdirs.user_data_path("clean-swarm", appauthor=False) / "knowledge.sqlite"


def opened(url: str | None, *, create: bool) -> "KnowledgeStore":
    """Return the store of a URL if given, else that of the environment variable, else that in the data directory.

    With `create`, a missing store is made, and for the data directory also the directory.
    """
    from selector.store import KnowledgeStore  # imports SQLAlchemy, of the extra "store"

    named = store_url(url)
    if create and named == str(default_path()):
        try:
            default_path().parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"{default_path().parent}: cannot be made ({error.strerror})") from error
    return KnowledgeStore(named, create=create)


def store_url(url: str | None) -> str:
    """Return a URL if given, else that in the environment variable, else the path in the data directory."""
    return url or os.environ.get(VARIABLE) or str(default_path())


def contents_named(given: str, source: str, directories: Sequence[Path] = ()) -> StoredKnowledge:
    """Return the contents of a file, which is expert knowledge or an exported store, or the expert knowledge of a name.

    Args:
        given: path of the file, or name of expert knowledge.
        source: source of expert knowledge.
        directories: searched for expert knowledge before the shipped directory.

    """
    path = Path(given)
    if path.is_file():
        return document.read(path, source)
    if path.suffix or path.name != given:
        raise DocumentError(f"{given}: no such file")
    return stored(load_knowledge(given, directories), source)


def amount(contents: StoredKnowledge) -> str:
    """Return the numbers of expert options and updates in words."""
    updates = sum(entry.moments.count for entry in contents.learned.values())
    return f"{counted(len(contents.expert), 'expert option')}, {counted(updates, 'update')}"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun."""
    return f"{number} {one if number == 1 else many or one + 's'}"
