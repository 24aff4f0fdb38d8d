"""What cannot be opened, read or written says so in one line, and nothing has changed."""

import os
import shutil
import sqlite3
import tempfile
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import pytest

from selector.store import KnowledgeStore, RewardSums, StoredKnowledge, StoreError

BATCH = RewardSums("G", ["a"])
BATCH.record(np.array([0]), np.array([1.0]))
NOBODY = 65534


@pytest.fixture
def path(tmp_path):
    """A store that holds one update and is closed."""
    store = KnowledgeStore(str(tmp_path / "k.sqlite"))
    store.add(BATCH, source="run")
    store.close()
    return tmp_path / "k.sqlite"


def refused(url, message, *, create=True):
    with pytest.raises(StoreError, match=message) as error:
        KnowledgeStore(str(url), create=create)
    assert "\n" not in str(error.value)


def change(path, statement):
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(statement)


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("", "store: expected a URL or a path, got nothing"),
        ("mysql://me@host/db", r"store: unknown database 'mysql' \(known: sqlite, postgresql\)"),
        ("http://host/db", "store: unknown database 'http'"),
        ("sqlite+duck:///x.db", r"store: unknown database 'sqlite\+duck' \(known: sqlite, postgresql\)"),
        ("postgresql://me@host:port/db", r"store: postgresql://\.\.\.: not a URL"),
        ("sqlite://", r"store: sqlite://: expected sqlite:///PATH, with a file to keep"),
        ("sqlite:///:memory:", "expected sqlite:///PATH, with a file to keep"),
        ("sqlite://host/x.db", "expected sqlite:///PATH, with a file to keep"),
        ("nowhere/k.sqlite", r"nowhere/k\.sqlite: no such directory as nowhere"),
        ("postgresql://me:secret@127.0.0.1:1/db", r"^postgresql://me:\*\*\*@127\.0\.0\.1:1/db: .*connection"),
    ],
)
def test_urls_that_name_no_store(monkeypatch, tmp_path, url, message):
    monkeypatch.chdir(tmp_path)
    refused(url, message)
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_exist_is_made_only_on_demand(tmp_path):
    refused(tmp_path / "k.sqlite", r"k\.sqlite: no such knowledge store", create=False)
    refused(tmp_path, "expected a file, got a directory")
    (tmp_path / "empty").touch()
    refused(tmp_path / "empty", "empty: is no knowledge store", create=False)
    assert [(p.name, p.stat().st_size) for p in tmp_path.iterdir()] == [("empty", 0)]
    assert KnowledgeStore(str(tmp_path / "empty")).contents() == StoredKnowledge()


def test_a_path_and_its_url_name_the_same_store(path):
    found = [KnowledgeStore(url, create=False).contents() for url in (str(path), f"sqlite:///{path}")]
    assert found[0] == found[1] != StoredKnowledge()


def test_a_store_from_an_older_version_is_left_alone(path):
    change(path, "UPDATE clean_swarm_meta SET value = '1' WHERE key = 'schema'")
    refused(path, r"comes from an older version \(schema 1\); export it there and import the file")


def test_a_store_from_a_newer_version_is_left_alone(path):
    change(path, "UPDATE clean_swarm_meta SET value = '3' WHERE key = 'schema'")
    before = path.read_bytes()
    for create in (False, True):
        refused(path, r"comes from a newer version \(schema 3, known up to 2\); update", create=create)
    assert path.read_bytes() == before


def test_a_database_of_something_else_is_left_alone(tmp_path):
    path = tmp_path / "other.sqlite"
    change(path, "CREATE TABLE bookmarks (url TEXT)")
    before = path.read_bytes()
    refused(path, r"is a database of something else \(tables: bookmarks\)")
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("DELETE FROM clean_swarm_meta", "is corrupt: its table clean_swarm_meta does not name its kind"),
        ("UPDATE clean_swarm_meta SET value = 'x' WHERE key = 'schema'", "is corrupt: its table clean_swarm_meta"),
        (
            "UPDATE clean_swarm_learned SET total = 'x'",
            r"is corrupt: learned\.0\.total: .* got 'x'",
        ),
        ("UPDATE clean_swarm_learned SET squares = '3'", "is corrupt: learned.0: sum .* do not belong to 1 rewards"),
        (
            "UPDATE clean_swarm_learned SET updated = '1969-12-31T23:59:59+00:00'",
            "is corrupt: learned.0.updated: expected",
        ),
        ("DROP TABLE clean_swarm_learned", "no such table: clean_swarm_learned"),
        (
            "INSERT INTO clean_swarm_expert VALUES ('G', 'a', 0, 'A', 1.0, '{', 'me', '2026-11-21T10:00:00+00:00')",
            r"is corrupt: expert\.G\.a\.parameters: line 1: expected JSON",
        ),
        ("INSERT INTO clean_swarm_expert VALUES ('G', 'a', 0, 'A', 'high', '{}', 'me', 0)", "is corrupt: .*score"),
    ],
)
def test_tables_that_no_store_has_are_reported(path, statement, message):
    change(path, statement)
    with pytest.raises(StoreError, match=rf"k\.sqlite: .*{message}") as error:
        KnowledgeStore(str(path)).contents()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"goals:\n  G: []\n", b"SQLite format 3\0" + bytes(80), bytes(5000)])
def test_files_that_are_no_database_are_left_alone(tmp_path, content):
    path = tmp_path / "k.sqlite"
    path.write_bytes(content)
    refused(path, r"k\.sqlite: (file is not a database|the file is corrupt|.*malformed)")
    assert path.read_bytes() == content


def test_a_damaged_file_is_reported_or_read_but_never_breaks_the_program(path, tmp_path):
    whole, random = path.read_bytes(), np.random.default_rng(1)
    messages = []
    for k in range(150):
        damaged = bytearray(whole)
        if k % 3:
            for place in random.integers(0, len(whole), 40):
                damaged[place] = random.integers(256)
        else:
            del damaged[random.integers(1, len(whole)) :]
        copy = tmp_path / f"damaged-{k}.sqlite"
        copy.write_bytes(damaged)
        try:
            store = KnowledgeStore(str(copy))
            store.add(BATCH, source="run")
            store.contents()
            store.close()
        except StoreError as error:
            messages.append(str(error))
    assert len(messages) > 100
    assert [message for message in messages if "\n" in message] == []


@contextmanager
def read_only(path, *, directory):
    """Give a copy of a store that this process cannot write, in a directory that it can or cannot write."""
    home = Path(tempfile.mkdtemp(prefix="clean-swarm-read-only-"))
    copy = home / path.name
    shutil.copy(path, copy)
    copy.chmod(0o444)
    home.chmod(0o555 if directory else 0o777)
    root = os.geteuid() == 0
    if root:  # root may write anything: be nobody for a while
        os.setresuid(NOBODY, NOBODY, 0)
    try:
        yield copy
    finally:
        if root:
            os.setresuid(0, 0, 0)
        home.chmod(0o755)
        shutil.rmtree(home)


@pytest.mark.parametrize("directory", [False, True])
def test_a_read_only_store_is_read_and_says_that_it_cannot_be_written(path, directory):
    before = path.read_bytes()
    with read_only(path, directory=directory) as copy:
        store = KnowledgeStore(str(copy))
        for change_it in (lambda: store.add(BATCH, source="run"), store.reset):
            with pytest.raises(StoreError, match=r"k\.sqlite: attempt to write a readonly database"):
                change_it()
        assert store.contents().totals()["G", "a", ""].count == 1
        store.close()
        assert copy.read_bytes() == before
        assert [p.name for p in copy.parent.iterdir() if not p.name.endswith(("-shm", "-wal"))] == [copy.name]


def test_a_store_that_cannot_be_made_is_reported(path):
    with read_only(path, directory=True) as copy:
        refused(copy.with_name("new.sqlite"), r"new\.sqlite: unable to open database file")


def test_postgres_says_what_is_wrong(postgres):
    for url, message in {
        f"{postgres}_none": r'database "postgres_none" does not exist',
        postgres.replace("tester@", "stranger:secret@"): r'stranger:\*\*\*@.*role "stranger" does not exist',
    }.items():
        refused(url, message)
    refused(postgres, "postgres: is no knowledge store", create=False)


def test_a_postgres_store_from_a_newer_version_is_left_alone(postgres):
    from sqlalchemy import create_engine, text

    store = KnowledgeStore(postgres)
    store.add(BATCH, source="run")
    engine = create_engine(postgres.replace("postgresql:", "postgresql+pg8000:"))
    try:
        with engine.begin() as connection:
            connection.execute(text("UPDATE clean_swarm_meta SET value = '9' WHERE key = 'schema'"))
        refused(postgres, r"comes from a newer version \(schema 9, known up to 2\); update")
        assert store.contents() != StoredKnowledge()
    finally:
        with engine.begin() as connection:
            connection.execute(text("DROP TABLE clean_swarm_meta, clean_swarm_learned, clean_swarm_expert"))
        engine.dispose()
        store.close()
