"""The knowledge store: atomic updates of learned entries, and estimates as arrays."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from sqlalchemy import Connection, Engine, Pool
from sqlalchemy.exc import ArgumentError

from selector.documents.trust import check_trust
from selector.knowledge import Knowledge
from selector.store import connection as connecting
from selector.store import tables
from selector.store.errors import StoreError, reported
from selector.store.exact_sums import NO_REWARDS, Moments, RewardSums
from selector.store.lineage import Origins, begin_anew, note_merged, read_origins
from selector.store.stored_knowledge import Key, LearnedEntry, StoredKnowledge, check, check_names, microseconds, stored
from selforg.arrays import Flags, Floats, Ints


@dataclass(frozen=True)
class Estimates:
    """Estimates of the rewards of O options in C contexts, over all sources.

    Attributes:
        count: (C, O) number of rewards.
        mean: (C, O) their mean [-]; 0 without rewards.
        variance: (C, O) their mean squared deviation from the mean; 0 without rewards.
        known: (C, O) whether there was a reward.

    """

    count: Ints
    mean: Floats
    variance: Floats
    known: Flags


class KnowledgeStore:
    """Expert knowledge and learned entries in a database that many processes may use at the same time.

    Every change is one transaction, which happens completely or not at all, also if the process is killed.

    Args:
        url: `sqlite:///PATH`, a plain path, or `postgresql://USER@HOST/DATABASE`.
        create: whether to make a missing store; else a missing store is an error.

    Raises:
        StoreError: the database cannot be reached, or holds no store of a known version.

    """

    def __init__(self, url: str, *, create: bool = True) -> None:
        parts = connecting.parsed(url)
        self.name = connecting.name_of(parts)
        """Name of the store in messages."""
        if parts.get_backend_name() != "sqlite":
            check_trust(url, f"connect to {self.name}", "store: ")
        with _opening(self.name):
            self._own_engine = connecting.engine_of(parts, create=create)
        self._process = os.getpid()
        self._of_parent: list[Pool] = []
        try:
            with _opening(self.name):
                connecting.prepare(self._engine, self.name, create=create)
        except StoreError:
            self.close()
            raise

    def close(self) -> None:
        """Close all connections; the store opens new ones if it is used again."""
        self._engine.dispose()

    def add(self, *batches: RewardSums, source: str, updated: int | None = None) -> None:
        """Add the updates of an episode: all of them or, with an error, none.

        Args:
            batches: sums of rewards, one for each goal.
            source: source of the rewards, for instance the name of a run.
            updated: time of the update [us since 1970, UTC]; now unless given.

        Raises:
            StoreError: the store cannot be written, or does not accept a name.

        """
        now = microseconds() if updated is None else updated
        learned: dict[Key, LearnedEntry] = {}
        for batch in batches:
            for (option, context), moments in batch.moments.items():
                key = Key(batch.goal, option, context, source)
                entry = LearnedEntry(moments, now)
                learned[key] = learned[key].merged(entry) if key in learned else entry
        contents = StoredKnowledge(learned=learned)
        check(contents)
        with self._writing() as connection, self._sound():
            for batch in batches:  # an update makes no damaged row look whole
                tables.read_learned(connection, batch.goal, [context for _, context in batch.moments])
            tables.add_learned(connection, learned.items())

    def estimates(self, goal: str, options: Sequence[str], contexts: Sequence[str] = ("",)) -> Estimates:
        """Return the estimates of `options` (O,) for a goal in `contexts` (C,)."""
        if isinstance(contexts, str):
            raise ValueError(f"contexts: expected a sequence of contexts, got the text {contexts!r}")
        with self._reading() as connection, self._sound():
            learned = tables.read_learned(connection, goal, contexts)
        sums: dict[tuple[str, str], Moments] = {}
        for key, entry in learned.items():
            sums[key.context, key.option] = sums.get((key.context, key.option), NO_REWARDS) + entry.moments
        cells = [[sums.get((context, option), NO_REWARDS) for option in options] for context in contexts]
        shape = (len(contexts), len(options))
        count = np.array([[m.count for m in row] for row in cells], dtype=np.int64).reshape(shape)
        mean = np.array([[m.mean if m.count else 0.0 for m in row] for row in cells]).reshape(shape)
        variance = np.array([[m.variance if m.count else 0.0 for m in row] for row in cells]).reshape(shape)
        return Estimates(count, mean, variance, count > 0)

    def put(self, knowledge: Knowledge, *, source: str, updated: int | None = None) -> None:
        """Add expert knowledge; a later score replaces an earlier one.

        Raises:
            StoreError: the store knows an option with another configuration or other parameters.

        """
        self.absorb(stored(knowledge, source, updated))

    def introduce(self, knowledge: Knowledge, *, source: str) -> None:
        """Add the options of expert knowledge that the store does not hold; the others keep their scores.

        Raises:
            StoreError: the store knows an option with another configuration or other parameters.

        """
        given = stored(knowledge, source)
        check(given)
        with self._writing() as connection:
            connecting.lock(connection)
            held, _ = self._held(connection)
            held.check_same(knowledge)
            new = {key: rated for key, rated in given.expert.items() if key not in held.expert}
            tables.put_expert(connection, new.items())

    def knowledge(self) -> Knowledge:
        """Return the expert knowledge in the store."""
        return self.contents().knowledge(self.name)

    def contents(self) -> StoredKnowledge:
        """Return everything in the store, as of one moment."""
        return self._whole()[0]

    def _whole(self) -> tuple[StoredKnowledge, Origins]:
        """Return everything in the store, and the origins of its updates, as of one moment."""
        with self._reading() as connection:
            return self._held(connection)

    def absorb(self, contents: StoredKnowledge) -> None:
        """Add `contents` to the store."""
        check(contents)
        with self._writing() as connection:
            if contents.expert:
                connecting.lock(connection)
            self._add(connection, contents)

    def merge(self, other: "KnowledgeStore") -> StoredKnowledge:
        """Add everything in another store, and return what was added.

        Raises:
            StoreError: updates would count twice, because the other store is this one or a copy, was merged into this
                one before and not reset since, or because both hold updates of a third store.

        """
        contents, origins = other._whole()
        with self._writing() as connection:
            connecting.lock(connection)
            if contents.learned:
                if why := self._held(connection)[1].why_not(origins):
                    raise StoreError(f"{self.name}: {other.name} {why}")
                note_merged(connection, origins.every, microseconds())
            self._add(connection, contents)
        return contents

    def reset(self, *, expert: bool = False, **chosen: str) -> tuple[int, int]:
        """Delete the learned entries of the given `goal`, `option`, `context` and `source`; of all that are not given.

        With `expert`, the expert options of the goal, option and source are deleted too. A store without learned
        entries can be merged again with any other store.

        Returns:
            The number of learned entries and of expert options deleted.

        """
        if wrong := set(chosen) - set(Key._fields):
            raise TypeError(f"unknown selection: {', '.join(sorted(wrong))}")
        for what, name in chosen.items():
            check_names(what, [name])
        columns = {"goal": "goal", "option": "name", "source": "source"}
        with self._writing() as connection:
            connecting.lock(connection, everything=True)
            entries = tables.delete_rows(connection, tables.learned, chosen)
            if not tables.any_learned(connection):
                begin_anew(connection)
            of_expert = {columns[what]: name for what, name in chosen.items() if what in columns}
            return entries, tables.delete_rows(connection, tables.expert, of_expert) if expert else 0

    @property
    def _engine(self) -> Engine:
        """The engine; a forked process gets a new one, because it must not use or close connections of its parent."""
        if self._process != os.getpid():
            self._of_parent.append(self._own_engine.pool)
            self._own_engine.dispose(close=False)
            self._process = os.getpid()
        return self._own_engine

    @contextmanager
    def _reading(self) -> Iterator[Connection]:
        with reported(self.name), self._engine.connect() as connection:
            if connection.dialect.name == "postgresql":
                connection = connection.execution_options(isolation_level="REPEATABLE READ")  # as of one moment
            yield connection

    @contextmanager
    def _writing(self) -> Iterator[Connection]:
        with (
            reported(self.name),
            self._engine.connect().execution_options(writes=True) as connection,
            connection.begin(),
        ):
            yield connection

    @contextmanager
    def _sound(self) -> Iterator[None]:
        """Report rows that no store writes."""
        try:
            yield
        except (TypeError, ValueError) as error:  # also StoreError, by `check`
            raise StoreError(f"{self.name}: is corrupt: {' '.join(str(error).split())}") from error

    def _held(self, connection: Connection) -> tuple[StoredKnowledge, Origins]:
        """Return everything in the store, and the origins of its updates; StoreError for damaged rows."""
        with self._sound():
            held = StoredKnowledge(tables.read_expert(connection), tables.read_learned(connection))
            check(held)
            return held, read_origins(connection)

    def _add(self, connection: Connection, contents: StoredKnowledge) -> None:
        """Add contents; the caller keeps others from changing expert options of the store meanwhile."""
        held, _ = self._held(connection)
        together = held.merged(StoredKnowledge(contents.expert)).expert
        tables.put_expert(connection, (item for item in together.items() if item[0] in contents.expert))
        tables.add_learned(connection, contents.learned.items())


@contextmanager
def _opening(where: str) -> Iterator[None]:
    """Turn errors of a database, its driver or the system about a URL into a StoreError that begins with `where`."""
    try:
        with reported(where):
            yield
    except StoreError:
        raise
    except (ArgumentError, OSError, TypeError, ValueError) as error:  # options and names that a driver does not take
        why = error.strerror if isinstance(error, OSError) and error.strerror else " ".join(str(error).split())
        raise StoreError(f"{where}: cannot be opened ({why})") from error
