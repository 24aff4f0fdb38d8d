"""The knowledge store: atomic updates of expert options and learned entries."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Connection, Engine, Pool
from sqlalchemy.exc import ArgumentError

from selector.documents.trust import check_trust
from selector.knowledge import Knowledge
from selector.store import connection as connecting
from selector.store import tables
from selector.store.document import as_document
from selector.store.errors import StoreError, reported
from selector.store.exact_sums import RewardSums
from selector.store.stored_knowledge import NO_KNOWLEDGE, Key, LearnedEntry, StoredKnowledge, microseconds, stored


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
            batches: sums of rewards.
            source: source of the rewards: the name of a run that no other run has, in this store or another one.
            updated: time of the update [us since 1970, UTC]; now unless given.

        Raises:
            StoreError: the store cannot be written, or does not accept a name.

        """
        now = microseconds() if updated is None else updated
        given: dict[Key, LearnedEntry] = {}
        for batch in batches:
            for (option, context), moments in batch.moments.items():
                key, entry = Key(batch.goal, option, context, source), LearnedEntry(moments, now)
                given[key] = given[key].plus(entry) if key in given else entry
        with self._writing(StoredKnowledge(learned=given)) as connection:
            held = tables.read_learned(connection, self._corrupt, {batch.goal for batch in batches}, source).learned
            learned = {key: held[key].plus(entry) if key in held else entry for key, entry in given.items()}
            tables.write(connection, StoredKnowledge(learned=learned))

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
        with self._writing(given) as connection:
            held = tables.read(connection, self._corrupt)
            held.check_same(knowledge)
            new = {key: rated for key, rated in given.expert.items() if key not in held.expert}
            tables.write(connection, StoredKnowledge(new))

    def knowledge(self) -> Knowledge:
        """Return the expert knowledge in the store."""
        return self.contents().knowledge(self.name)

    def contents(self) -> StoredKnowledge:
        """Return everything in the store, as of one moment."""
        with self._reading() as connection:
            return tables.read(connection, self._corrupt)

    def absorb(self, contents: StoredKnowledge) -> None:
        """Add `contents`, those of another store for instance, to the store; what it holds already stays as it is.

        Raises:
            StoreError: the store cannot be written, or holds an option or a source of the same name that differs.

        """
        with self._writing(contents) as connection:
            held = tables.read(connection, self._corrupt)
            tables.write(connection, held.merged(contents).only(contents))

    def reset(self, *, expert: bool = False, **chosen: str) -> tuple[int, int]:
        """Delete the learned entries of the given `goal`, `option`, `context` and `source`; of all that are not given.

        With `expert`, the expert options of the goal, option and source are deleted too.

        Returns:
            The number of learned entries and of expert options deleted.

        """
        if wrong := set(chosen) - set(Key._fields):
            raise TypeError(f"unknown selection: {', '.join(sorted(wrong))}")
        columns = {"goal": "goal", "option": "name", "source": "source"}
        of_expert = {columns[what]: name for what, name in chosen.items() if what in columns}
        with self._writing() as connection:
            entries = tables.delete_rows(connection, tables.learned, chosen)
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
    def _writing(self, given: StoredKnowledge = NO_KNOWLEDGE) -> Iterator[Connection]:
        """Yield a connection in a transaction that adds what is `given`; StoreError if no store takes that."""
        with reported(self.name):
            as_document(given)  # raises, before the database sees any of it
            with connecting.writing(self._engine) as connection:
                yield connection

    @property
    def _corrupt(self) -> str:
        """The beginning of errors about rows that no store writes."""
        return f"{self.name}: is corrupt"


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
