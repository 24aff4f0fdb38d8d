"""The knowledge store: one table in one SQLite file, changed by one transaction at a time."""

import json
import os
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from selector.documents.errors import DocumentError, shown
from selector.documents.plain import short
from selector.documents.reading import json_value
from selector.knowledge import Knowledge
from selector.store.contents import (
    FORMAT,
    Entry,
    Key,
    StoredKnowledge,
    StoreError,
    as_rows,
    from_document,
    learned_entry,
    stored,
)
from selector.store.exact_sums import NO_REWARDS, Moments, RewardSums

APPLICATION, SCHEMA = 0x436C5377, 1
"""Kind of the file in its header (`application_id`, "ClSw"), and version of its table (`user_version`)."""
BUSY_S = 60.0
"""Time for which a writer waits for the others [s]."""
OWNER_ONLY = 0o600
"""Mode of a new file: others may neither read nor write it."""
TABLE = "clean_swarm_knowledge"
COLUMN_NAMES = tuple(Entry.model_fields)
"""Names of the columns, which are the fields of an entry."""
MAKE_STORE = (
    f"""CREATE TABLE {TABLE} (
        goal TEXT NOT NULL, option TEXT NOT NULL, context TEXT NOT NULL, source TEXT NOT NULL, expert TEXT NOT NULL,
        count INTEGER NOT NULL, total TEXT NOT NULL, squares TEXT NOT NULL, updated TEXT NOT NULL,
        PRIMARY KEY (goal, option, context, source))""",
    f"PRAGMA application_id = {APPLICATION}",
    f"PRAGMA user_version = {SCHEMA}",
)
"""Statements that make a store of an empty database; `expert` is JSON, `total` and `squares` are whole numbers."""
SELECT_ENTRIES = f"SELECT {', '.join(COLUMN_NAMES)} FROM {TABLE}"
PUT_ENTRY = f"""INSERT INTO {TABLE}
    VALUES (:goal, :option, :context, :source, :expert, :count, :total, :squares, :updated)
    ON CONFLICT (goal, option, context, source) DO UPDATE SET expert = excluded.expert, count = excluded.count,
    total = excluded.total, squares = excluded.squares, updated = excluded.updated"""


class KnowledgeStore:
    """Expert knowledge and learned rewards in a file that several processes may use at the same time.

    Every change is one transaction, which happens completely or not at all, also if the process is killed. Nothing
    stays open in between, so there is nothing to close, and a forked process may go on with the store.

    Args:
        path: of the file.
        create: whether to make a missing store; else a missing store is an error.

    Raises:
        StoreError: the file cannot be read, or is no store of this version.

    """

    def __init__(self, path: str | Path, *, create: bool = True) -> None:
        if not str(path) or not str(path).isprintable() or "://" in str(path):
            raise StoreError(f"store: expected the path of a file, got {short(str(path))}")
        place = Path(os.path.expanduser(path))
        self.name = shown(place)
        """Name of the store in messages."""
        self._uri = f"{place.absolute().as_uri()}?mode=rw"
        with self._reported():
            self._check_place(place, create=create)
        with self._transaction() as connection:
            is_there = self._is_store(connection)
        if not is_there and not create:
            raise StoreError(f"{self.name}: is no knowledge store")
        if not is_there:
            with self._transaction("IMMEDIATE") as connection:
                # another process may have been quicker
                for statement in () if self._is_store(connection) else MAKE_STORE:
                    connection.execute(statement)

    def add(self, *batches: RewardSums, source: str, context: str = "") -> None:
        """Add the rewards of an episode: all of them or, with an error, none.

        Args:
            batches: sums of rewards.
            source: source of the rewards: the name of a run that no other run has.
            context: in which they were earned.

        Raises:
            StoreError: the store cannot be written, or does not accept a name.

        """
        sums: dict[Key, Moments] = {}
        for batch in batches:
            for option, moments in batch.moments.items():
                key = Key(batch.goal, option, context, source)
                sums[key] = sums.get(key, NO_REWARDS) + moments
        with self._transaction("IMMEDIATE") as connection:
            held = self._read(connection, {"context": context, "source": source}).entries
            before = {key: held[key].moments if key in held else NO_REWARDS for key in sums}
            _write(connection, [learned_entry(key, before[key] + moments) for key, moments in sums.items()])

    def introduce(self, knowledge: Knowledge) -> None:
        """Add the options of expert knowledge that the store does not hold; the others keep their scores.

        Raises:
            StoreError: the store knows an option with another configuration or other parameters.

        """
        with self._transaction("IMMEDIATE") as connection:
            held, given = self._read(connection), stored(knowledge)
            held.check_fits(given, f"{knowledge.source}: ")
            _write(connection, [entry for key, entry in given.entries.items() if key not in held.entries])

    def absorb(self, contents: StoredKnowledge) -> None:
        """Add `contents`, those of another store for instance, to the store; a later score replaces an earlier one.

        Raises:
            StoreError: the store cannot be written, or holds an option or a source of the same name that differs.

        """
        with self._transaction("IMMEDIATE") as connection:
            self._read(connection).check_fits(contents)
            _write(connection, contents.entries.values())

    def contents(self) -> StoredKnowledge:
        """Return everything in the store, as of one moment."""
        with self._transaction() as connection:
            return self._read(connection)

    def forget(self, source: str) -> int:
        """Delete what was learned from a source, and return the number of entries; experts' options stay."""
        if not source:
            raise StoreError(f"{self.name}: expected the name of a source, got ''")
        with self._transaction("IMMEDIATE") as connection:
            return connection.execute(f"DELETE FROM {TABLE} WHERE source = ?", (source,)).rowcount

    @contextmanager
    def _transaction(self, kind: str = "") -> Iterator[sqlite3.Connection]:
        """Yield a connection in a transaction, which an error undoes."""
        with (
            self._reported(),
            closing(sqlite3.connect(self._uri, timeout=BUSY_S, isolation_level=None, uri=True)) as connection,
        ):
            connection.execute("PRAGMA synchronous=FULL")  # a commit survives a loss of power
            connection.execute(f"BEGIN {kind}")
            with connection:
                yield connection

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Turn errors of the database, of the system and of what the store holds into a StoreError of one line."""
        try:
            yield
        except DocumentError as error:
            raise StoreError(str(error)) from error
        except (sqlite3.Error, OSError, UnicodeError) as error:  # sqlite3 cannot decode all texts of a damaged file
            why = error.strerror if isinstance(error, OSError) else " ".join(str(error).split())
            raise StoreError(f"{self.name}: {why}") from error

    def _check_place(self, place: Path, *, create: bool) -> None:
        """Check that there is a file, and make an empty one if there is none and one may be made."""
        if place.is_dir():
            raise StoreError(f"{self.name}: expected a file, got a directory")
        if not place.exists():
            if not create:
                raise StoreError(f"{self.name}: no such knowledge store")
            if not place.parent.is_dir():
                raise StoreError(f"{self.name}: no such directory as {shown(place.parent)}")
            with suppress(OSError):  # SQLite says that it cannot be made
                os.close(os.open(place, os.O_CREAT | os.O_RDWR, OWNER_ONLY))

    def _is_store(self, connection: sqlite3.Connection) -> bool:
        """Return whether a database is a store; StoreError unless it is empty then, or if it is of another version."""
        found, kind, version = (
            connection.execute(f"PRAGMA {what}").fetchone()[0]
            for what in ("quick_check(1)", "application_id", "user_version")
        )
        if found != "ok":
            raise StoreError(f"{self.name}: the file is corrupt ({' '.join(str(found).split())})")
        names = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        tables = ", ".join(sorted(str(name) for (name,) in names))
        if kind == APPLICATION and version != SCHEMA:
            raise StoreError(f"{self.name}: comes from another version (expected {SCHEMA}, got {version})")
        if kind != APPLICATION and tables:
            raise StoreError(f"{self.name}: is a database of something else (tables: {tables})")
        return bool(kind == APPLICATION)

    def _read(self, connection: sqlite3.Connection, chosen: dict[str, str] | None = None) -> StoredKnowledge:
        """Return the entries, those with the values of the `chosen` columns; DocumentError for rows no store writes."""
        where = "".join(f" {'AND' if k else 'WHERE'} {name} = :{name}" for k, name in enumerate(chosen or {}))
        found = connection.execute(SELECT_ENTRIES + where, chosen or {})
        rows = [dict(zip(COLUMN_NAMES, row, strict=True)) for row in found]
        name = f"{self.name}: is corrupt"
        for row in rows:
            row["expert"] = json_value(str(row["expert"]), f"{name}: {row['goal']}.{row['option']}.expert")
        return from_document({**FORMAT, "entries": rows}, name)


def _write(connection: sqlite3.Connection, entries: Iterable[Entry]) -> None:
    """Write entries over the rows of the same keys."""
    rows: list[dict[str, Any]] = as_rows(entries)
    connection.executemany(PUT_ENTRY, [row | {"expert": json.dumps(row["expert"], sort_keys=True)} for row in rows])
