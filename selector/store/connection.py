"""Connections to the database of a store, SQLite or PostgreSQL, and the schema of the store in it."""

import logging
import os
import re
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from urllib.parse import quote

from sqlalchemy import URL, Connection, Engine, create_engine, event, insert, inspect, make_url, select, text
from sqlalchemy.exc import ArgumentError

from selector.documents.errors import shown
from selector.store.errors import StoreError
from selector.store.tables import meta, metadata

SCHEMA = 2
"""Version of the tables."""
BUSY_S = 60.0
"""Time for which a writer waits for other writers of an SQLite file [s]."""
LOCK = 0x636C65616E
"""Advisory lock of PostgreSQL that a writer holds until its transaction ends; SQLite has one writer at a time, too."""
DATABASES = ("sqlite", "postgresql")
"""Supported databases."""
OF_POSTGRES = "+pg8000"
"""The driver of PostgreSQL, as a URL may name it; Python has one of SQLite."""
FORMS = "sqlite:///PATH or postgresql://USER@HOST/DATABASE"
OWNER_ONLY = 0o600
"""Mode of a new SQLite file: others may neither read nor write it."""


def parsed(url: str) -> URL:
    """Return the URL of a store; a plain path is an SQLite file, and that of PostgreSQL names the driver.

    No error shows more of a URL than its scheme, unless it is known where its password stands.
    """
    if not url.isprintable():
        raise StoreError("store: expected a URL or a path of printable characters")
    scheme, separator, _ = url.partition("://")
    backend = scheme.removesuffix(OF_POSTGRES)
    if not separator:
        return URL.create("sqlite", database=str(_path(url)))
    if backend not in DATABASES:
        raise StoreError(f"store: unknown database {backend!r} (known: {', '.join(DATABASES)})")
    try:
        parts = make_url(url)
    except (ArgumentError, ValueError):
        raise StoreError(f"store: {scheme}://...: not a URL (expected {FORMS})") from None
    more = (parts.username, parts.password, parts.host, parts.port, parts.query)
    if backend == "sqlite" and (not parts.database or parts.database == ":memory:" or any(more)):
        raise StoreError(f"store: {_public(parts)}: expected sqlite:///PATH, with a file to keep, and nothing else")
    return parts if backend == "sqlite" else parts.set(drivername=backend + OF_POSTGRES)


def _path(given: str) -> Path:
    if not given:
        raise StoreError("store: expected a URL or a path, got nothing")
    if re.match(rf"({'|'.join(DATABASES)})(\+\w*)?:", given):
        raise StoreError(f"store: expected {FORMS}, got something else")
    try:
        return Path(given).expanduser()
    except RuntimeError as error:
        raise StoreError(f"store: {given}: unknown home directory") from error


def name_of(url: URL) -> str:
    """Return the name of a store in messages: its path, or its URL without the password."""
    if url.get_backend_name() == "sqlite":
        return shown(Path(str(url.database)))
    return _public(url.set(drivername="postgresql"))


def public_url(url: str) -> str:
    """Return the URL of a store for commands and files that others may see: without password and values of options."""
    parts = parsed(url)
    return _public(make_url(url)) if parts.password or parts.query else url


def _public(url: URL) -> str:
    return url.set(query=dict.fromkeys(url.query, "...")).render_as_string(hide_password=True)


def engine_of(url: URL, *, create: bool) -> Engine:
    """Return the engine of a database; unless `create`, an SQLite file must exist."""
    if url.get_backend_name() == "sqlite":
        return _sqlite(url, Path(str(url.database)), create)
    # A lost connection is an error of ours: without a handler, Python would print SQLAlchemy's traceback of it, too.
    logging.getLogger("sqlalchemy").addHandler(logging.NullHandler())
    try:
        return create_engine(url, pool_pre_ping=True, pool_size=1)
    except ImportError as error:
        advice = "pip install 'clean-swarm[postgres]'"
        raise StoreError(f"store: the driver of PostgreSQL is not installed ({advice})") from error


def _sqlite(url: URL, path: Path, create: bool) -> Engine:
    where = shown(path)
    if path.is_dir():
        raise StoreError(f"{where}: expected a file, got a directory")
    if not path.exists():
        if not create:
            raise StoreError(f"{where}: no such knowledge store")
        if not path.parent.is_dir():
            raise StoreError(f"{where}: no such directory as {shown(path.parent)}")
        with suppress(OSError):  # SQLite says below that it cannot be made
            os.close(os.open(path, os.O_CREAT | os.O_RDWR, OWNER_ONLY))
    if _on_read_only_medium(path):
        url = url.set(database=f"file:{quote(str(path.absolute()))}", query={"immutable": "1", "uri": "true"})
    # One connection stays open: closing the last one empties the write-ahead log, which takes longer than an update.
    engine = create_engine(url, connect_args={"timeout": BUSY_S}, pool_size=1)

    @event.listens_for(engine, "connect")
    def _connected(connection: sqlite3.Connection, _: object) -> None:
        connection.isolation_level = None  # transactions begin by the event below
        connection.execute("PRAGMA synchronous=FULL")  # a commit survives a loss of power

    @event.listens_for(engine, "begin")
    def _begun(connection: Connection) -> None:
        # A transaction that reads before it writes would fail if another one wrote in between.
        writes = connection.get_execution_options().get("writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def _on_read_only_medium(path: Path) -> bool:
    """Return whether a file is read-only; SQLite then needs a flag, because it cannot lock the file."""
    wal = path.with_name(f"{path.name}-wal")
    return path.exists() and not wal.exists() and not os.access(path.parent, os.W_OK) and not os.access(path, os.W_OK)


def prepare(engine: Engine, where: str, *, create: bool) -> None:
    """Check that a database is a store of a known version; with `create`, make a missing one."""
    with engine.connect() as connection:
        _check_file(connection, where)
        exists = _has_store(connection, where)
    if not exists and not create:
        raise StoreError(f"{where}: is no knowledge store")
    if not exists:
        with writing(engine) as connection:
            if not _has_store(connection, where):  # another process may have been quicker
                metadata.create_all(connection)
                connection.execute(insert(meta), {"key": "schema", "value": str(SCHEMA)})
    with engine.connect() as connection:
        _check_version(connection, where)
    if create and engine.dialect.name == "sqlite":
        _use_wal(engine)


@contextmanager
def writing(engine: Engine) -> Iterator[Connection]:
    """Yield a connection in a transaction, of which there is one at a time."""
    with engine.connect().execution_options(writes=True) as connection, connection.begin():
        if connection.dialect.name == "postgresql":
            connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": LOCK})
        yield connection


def _check_file(connection: Connection, where: str) -> None:
    if connection.dialect.name == "sqlite":
        found = connection.exec_driver_sql("PRAGMA quick_check(1)").scalar()
        if found != "ok":
            raise StoreError(f"{where}: the file is corrupt ({' '.join(str(found).split())})")


def _has_store(connection: Connection, where: str) -> bool:
    names = set(inspect(connection).get_table_names())
    if meta.name in names:
        if lost := sorted(metadata.tables.keys() - names):
            raise StoreError(f"{where}: is corrupt: no such table: {', '.join(lost)}")
        return True
    if names and connection.dialect.name == "sqlite":
        raise StoreError(f"{where}: is a database of something else (tables: {', '.join(sorted(names))})")
    return False


def _check_version(connection: Connection, where: str) -> None:
    version = str(connection.execute(select(meta.c.value).where(meta.c.key == "schema")).scalar())
    if not version.isdecimal() or int(version) < 1:
        raise StoreError(f"{where}: is corrupt: its table {meta.name} does not name its kind")
    if int(version) > SCHEMA:
        raise StoreError(f"{where}: comes from a newer version (schema {version}, known up to {SCHEMA}); update")
    if int(version) < SCHEMA:
        raise StoreError(
            f"{where}: comes from an older version (schema {version}); export it there and import the file"
        )


def _use_wal(engine: Engine) -> None:
    """Use a write-ahead log, so that readers need not wait for a writer; skipped while another process has the file."""
    with suppress(sqlite3.OperationalError), closing(engine.raw_connection()) as connection:
        connection.cursor().execute("PRAGMA journal_mode=WAL")
