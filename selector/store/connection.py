"""A database named by URL: SQLite files and PostgreSQL, the store's schema in them and its version."""

import os
import sqlite3
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sqlalchemy import URL, Connection, Engine, create_engine, event, insert, inspect, make_url, select, text
from sqlalchemy.exc import ArgumentError, NoSuchModuleError

from selector.documents.errors import shown
from selector.store.errors import StoreError
from selector.store.lineage import IDENTITY, new_identity
from selector.store.tables import learned, meta, metadata

SCHEMA = 1
"""Version of the tables that this program writes."""
BUSY_S = 60.0
"""How long a writer waits for the other writers of an SQLite file [s]."""
LOCK = 0x636C65616E
"""Advisory lock of PostgreSQL under which the schema and the expert options change."""
DRIVERS = {"sqlite": "pysqlite", "postgresql": "pg8000"}
"""Databases known, and the driver of each that comes with the project."""


def parsed(url: str) -> URL:
    """Return the URL of a store; a plain path is an SQLite file, a database without driver gets ours."""
    if "://" not in url:
        if not url:
            raise StoreError("store: expected a URL or a path, got nothing")
        return URL.create("sqlite+pysqlite", database=str(Path(url).expanduser()))
    scheme = url.partition("://")[0]
    backend, _, driver = scheme.partition("+")
    if backend not in DRIVERS:
        raise StoreError(f"store: unknown database {backend!r} (known: {', '.join(DRIVERS)})")
    try:
        parts = make_url(url)
    except (ArgumentError, ValueError) as error:
        raise StoreError(f"store: {scheme}://...: not a URL ({' '.join(str(error).split())})") from error
    if backend == "sqlite" and (not parts.database or parts.database == ":memory:" or parts.host):
        raise StoreError(f"store: {url}: expected sqlite:///PATH, with a file to keep")
    return parts.set(drivername=f"{backend}+{driver or DRIVERS[backend]}")


def name_of(url: URL) -> str:
    """Return how messages name a store: its path, or its URL without the password."""
    if url.get_backend_name() == "sqlite":
        return shown(Path(str(url.database)))
    return url.set(drivername="postgresql").render_as_string(hide_password=True)


def engine_of(url: URL, *, create: bool) -> Engine:
    """Return what connects to a database; of a file that is not to be created it is checked that it exists."""
    if url.get_backend_name() == "sqlite":
        _check_driver(url)
        return _sqlite(url, Path(str(url.database)), create)
    _check_driver(url)
    return create_engine(url, pool_pre_ping=True, pool_size=1)


def _check_driver(url: URL) -> None:
    backend, driver = url.get_backend_name(), url.get_driver_name()
    ours = DRIVERS[backend]
    try:
        url.get_dialect().import_dbapi()
    except NoSuchModuleError as error:
        raise StoreError(f"store: unknown driver {driver!r} for {backend} (leave it out for {ours})") from error
    except ImportError as error:
        advice = "pip install 'clean-swarm[postgres]'" if driver == ours else f"leave it out for {ours}"
        raise StoreError(f"store: the driver {driver!r} for {backend} is not installed ({advice})") from error


def _sqlite(url: URL, path: Path, create: bool) -> Engine:
    where = shown(path)
    if path.is_dir():
        raise StoreError(f"{where}: expected a file, got a directory")
    if not path.exists():
        if not create:
            raise StoreError(f"{where}: no such knowledge store")
        if not path.parent.is_dir():
            raise StoreError(f"{where}: no such directory as {shown(path.parent)}")
    arguments: dict[str, Any] = {"timeout": BUSY_S}
    if _on_read_only_medium(path):
        url = url.set(database=f"file:{quote(str(path.absolute()))}", query={"immutable": "1", "uri": "true"})
    # one connection stays open: closing the last one empties the write-ahead log, which takes longer than an update
    engine = create_engine(url, connect_args=arguments, pool_size=1)

    @event.listens_for(engine, "connect")
    def _connected(connection: sqlite3.Connection, _: object) -> None:
        connection.isolation_level = None  # SQLAlchemy begins transactions by the event below
        connection.execute("PRAGMA synchronous=FULL")  # a commit survives a power cut too; one fsync an episode

    @event.listens_for(engine, "begin")
    def _begun(connection: Connection) -> None:
        # a transaction that reads before it writes would fail if another one writes in between
        writes = connection.get_execution_options().get("writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def _on_read_only_medium(path: Path) -> bool:
    """Tell whether nobody can be writing: SQLite reads such a file only if told so, since it cannot lock it."""
    wal = path.with_name(f"{path.name}-wal")
    return path.exists() and not wal.exists() and not os.access(path.parent, os.W_OK) and not os.access(path, os.W_OK)


def prepare(engine: Engine, where: str, *, create: bool) -> None:
    """Check that a database holds a store of this version; if need be make one."""
    with engine.connect() as connection:
        _check_file(connection, where)
        exists = _has_store(connection, where)
    if not exists and not create:
        raise StoreError(f"{where}: holds no knowledge store")
    if not exists:
        with engine.connect().execution_options(writes=True) as connection, connection.begin():
            lock(connection)
            if not _has_store(connection, where):  # another process may have been quicker
                metadata.create_all(connection)
                about = {"schema": str(SCHEMA), IDENTITY: new_identity()}
                connection.execute(insert(meta), [{"key": key, "value": value} for key, value in about.items()])
    with engine.connect() as connection:
        _check_version(connection, where)
    if create and engine.dialect.name == "sqlite":
        _use_wal(engine)


def lock(connection: Connection, *, everything: bool = False) -> None:
    """Let no other process change schema or expert options, or anything, until this transaction ends."""
    if connection.dialect.name != "postgresql":  # SQLite has one writer at a time anyway
        return
    connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": LOCK})
    if everything:  # rows are deleted in any order: an update of some of them could wait for us and we for it
        connection.execute(text(f"LOCK TABLE {learned.name} IN SHARE ROW EXCLUSIVE MODE"))


def _check_file(connection: Connection, where: str) -> None:
    if connection.dialect.name == "sqlite":
        found = connection.exec_driver_sql("PRAGMA quick_check(1)").scalar()
        if found != "ok":
            raise StoreError(f"{where}: the file is corrupt ({' '.join(str(found).split())})")


def _has_store(connection: Connection, where: str) -> bool:
    names = set(inspect(connection).get_table_names())
    if meta.name in names:
        return True
    if names and connection.dialect.name == "sqlite":
        raise StoreError(f"{where}: is a database of something else (tables: {', '.join(sorted(names))})")
    return False


def _check_version(connection: Connection, where: str) -> None:
    about = {row.key: row.value for row in connection.execute(select(meta))}
    version = about.get("schema", "")
    if not str(version).isdecimal() or int(version) < 1 or IDENTITY not in about:
        raise StoreError(f"{where}: is corrupt: its table {meta.name} does not say what it holds")
    if int(version) > SCHEMA:
        raise StoreError(f"{where}: comes from a newer version (schema {version}, known up to {SCHEMA}); update")


def _use_wal(engine: Engine) -> None:
    """Let readers go on while one process writes; where others are at work now, the next to open the file does it."""
    connection = engine.raw_connection()
    try:
        cursor = connection.cursor()
        cursor.execute("PRAGMA journal_mode=WAL")
        cursor.close()
    except sqlite3.OperationalError:
        return
    finally:
        connection.close()
