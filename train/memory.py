"""The knowledge store of a command: what a run begins with, and what it gives back."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import platformdirs

from selector.documents.errors import DocumentError
from selector.documents.fields import MOST_STORED
from selector.documents.plain import short
from selector.knowledge import Knowledge, LearnedScores
from selector.store import KnowledgeStore, RewardSums, StoreError

VARIABLE = "CLEAN_SWARM_STORE"
"""Environment variable with the path of the store, used without `--store`."""


@dataclass(frozen=True)
class StoreRequest:
    """The request of the user for a run with a knowledge store."""

    path: str | None = None
    """Path of the store; none unless given."""
    learn: bool = False
    """Whether the run gives back its rewards."""

    def __post_init__(self) -> None:
        if self.learn and self.path is None:
            raise DocumentError("--learn: expected --store FILE, the knowledge store to give to")

    def memory(self, knowledge: Knowledge, context: str, source: str) -> "Memory | None":
        """Return the memory of a run; None without a store."""
        if not self.path:
            return None
        return Memory(opened(self.path, create=self.learn), knowledge, context, source if self.learn else "")


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
        knowledge: the expert knowledge, with what the store knew at the beginning (docs/decisions/0062-snapshots.md).
        learns: whether the run gives back its rewards.

    Raises:
        StoreError: the store cannot be used, or knows an option with another configuration or other parameters.

    """

    def __init__(self, store: KnowledgeStore, knowledge: Knowledge, context: str, source: str) -> None:
        self._store, self._expert, self.context, self.source = store, knowledge, context, source
        self.learns = bool(source)
        if self.learns:
            for name, text in (("context", context), ("source", source)):
                if len(text) > MOST_STORED:
                    raise StoreError(f"{name}: expected up to {MOST_STORED} characters, got {short(text)}")
            store.introduce(knowledge)
        self.knowledge = self.now()

    def held(self) -> int:
        """Return how many rewards of this source the store holds in this context."""
        learned = self._store.contents().learned
        own = (self.context, self.source)
        return sum(entry.count for key, entry in learned.items() if (key.context, key.source) == own)

    def check_new(self) -> None:
        """Raise StoreError if the store holds what this run would learn, which would count twice."""
        if self.learns and self.held():
            advice = "take another --seed, continue with --resume, or `clean-swarm knowledge reset --source` it"
            raise StoreError(f"{self._store.name}: holds what {self.source!r} learned already; {advice}")

    def now(self) -> Knowledge:
        """Return the expert knowledge with the present rewards of the store."""
        return self._expert.with_learned(self._store.contents().scores(self._expert, self.context))

    def give(self, goal: str, option: str, reward: float) -> None:
        """Add a reward [-] of an option to the store."""
        names = [one.name for one in self._expert.options(goal)]
        sums = RewardSums(goal, names)
        sums.record(np.array([names.index(option)]), np.array([reward]))
        self.give_sums(sums)

    def give_sums(self, *sums: RewardSums) -> None:
        """Add sums of rewards to the store, all of them at once."""
        self._store.add(*sums, source=self.source, context=self.context)


def as_plain(learned: LearnedScores) -> dict[str, dict[str, dict[str, float]]]:
    """Return the learned rewards of options as plain data, for a manifest."""
    return {goal: {name: one.model_dump() for name, one in scores.items()} for goal, scores in learned.items()}


def default_path() -> Path:
    """Return the path of the store in the user's data directory."""
    return platformdirs.user_data_path("clean-swarm", appauthor=False) / "knowledge.sqlite"


def opened(path: str | None, *, create: bool) -> KnowledgeStore:
    """Return the store of a path if given, else that of the environment variable, else that in the data directory.

    With `create`, a missing store is made, and for the data directory also the directory.
    """
    named = path or os.environ.get(VARIABLE) or str(default_path())
    if create and named == str(default_path()):
        try:
            default_path().parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"{default_path().parent}: cannot be made ({error.strerror})") from error
    return KnowledgeStore(named, create=create)
