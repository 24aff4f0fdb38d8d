"""What cannot be opened, read or written says so in one line, and nothing has changed."""

import os
import resource
import shutil
import sqlite3
import stat
import tempfile
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import pytest

from selector.store import KnowledgeStore, StoredKnowledge, StoreError
from selector.store.knowledge_store import SCHEMA, TABLE
from tests.selector.store.strategies import sums_of

NOBODY = 65534


@pytest.fixture
def path(tmp_path):
    """A store that holds one update."""
    KnowledgeStore(tmp_path / "k.sqlite").add(sums_of([1.0]), source="run")
    return tmp_path / "k.sqlite"


def refused(path, message, *, create=True):
    with pytest.raises(StoreError, match=message) as error:
        KnowledgeStore(path, create=create)
    assert "\n" not in str(error.value)


def change(path, statement):
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(statement)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("", "store: expected the path of a file, got ''"),
        ("two\nlines", r"store: expected the path of a file, got 'two\\nlines'"),
        ("sqlite:///k.sqlite", "store: expected the path of a file, got 'sqlite:///k.sqlite'"),
        ("nowhere/k.sqlite", r"nowhere/k\.sqlite: no such directory as nowhere"),
        ("~nobody-here/k.sqlite", r"~nobody-here/k\.sqlite: no such directory"),
        (".", r"\.: expected a file, got a directory"),
        ("x" * 300, "x: (File name too long|unable to open)"),
    ],
)
def test_paths_that_name_no_store(monkeypatch, tmp_path, given, message):
    monkeypatch.chdir(tmp_path)
    refused(given, message)
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_exist_is_made_only_on_demand(tmp_path):
    refused(tmp_path / "k.sqlite", r"k\.sqlite: no such knowledge store", create=False)
    (tmp_path / "empty").touch()
    refused(tmp_path / "empty", "empty: is no knowledge store", create=False)
    assert [(p.name, p.stat().st_size) for p in tmp_path.iterdir()] == [("empty", 0)]
    assert KnowledgeStore(tmp_path / "empty").contents() == StoredKnowledge()


def test_only_its_owner_reads_and_writes_a_new_store(path):
    assert [(one.name, stat.S_IMODE(one.stat().st_mode)) for one in path.parent.iterdir()] == [("k.sqlite", 0o600)]
    KnowledgeStore(path).forget("nobody")
    path.chmod(0o664)
    assert KnowledgeStore(path, create=False).forget("nobody") == 0
    assert stat.S_IMODE(path.stat().st_mode) == 0o664


def test_a_store_that_is_taken_away_is_not_made_again(path):
    store = KnowledgeStore(path)
    path.unlink()
    with pytest.raises(StoreError, match=r"k\.sqlite: unable to open database file"):
        store.add(sums_of([1.0]), source="run")
    assert not path.exists()


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        (f"PRAGMA user_version = {SCHEMA + 1}", rf"comes from another version \(expected {SCHEMA}, got {SCHEMA + 1}\)"),
        (f"PRAGMA user_version = {SCHEMA - 1}", rf"comes from another version \(expected {SCHEMA}, got {SCHEMA - 1}\)"),
        ("PRAGMA application_id = 0", rf"is a database of something else \(tables: {TABLE}\)"),
    ],
)
def test_other_databases_and_versions_are_left_alone(path, statement, message):
    change(path, statement)
    before = path.read_bytes()
    for create in (False, True):
        refused(path, message, create=create)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        (f"UPDATE {TABLE} SET total = 'x'", r"is corrupt: entries\.0\.total: .* got 'x'"),
        (f"UPDATE {TABLE} SET squares = '3'", r"is corrupt: entries\.0: sum .* do not belong to 1 rewards"),
        (f"UPDATE {TABLE} SET updated = 'now'", r"is corrupt: entries\.0\.updated: expected"),
        (f"UPDATE {TABLE} SET expert = '{{'", r"is corrupt: G\.a\.expert: line 1: expected JSON"),
        (f"ALTER TABLE {TABLE} DROP COLUMN total", "no such column: total"),
        (f"DROP TABLE {TABLE}", f"no such table: {TABLE}"),
    ],
)
def test_rows_and_tables_that_no_store_has_are_reported(path, statement, message):
    change(path, statement)
    store = KnowledgeStore(path)
    for use in (store.contents, lambda: store.add(sums_of([1.0]), source="run")):
        with pytest.raises(StoreError, match=rf"k\.sqlite: .*{message}") as error:
            use()
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"goals:\n  G: []\n", b"SQLite format 3\0" + bytes(80), bytes(5000)])
def test_files_that_are_no_database_are_left_alone(tmp_path, content):
    path = tmp_path / "k.sqlite"
    path.write_bytes(content)
    refused(path, r"k\.sqlite: (file is not a database|the file is corrupt|.*malformed)")
    assert path.read_bytes() == content


def test_a_damaged_file_is_reported_or_read_but_never_breaks_the_program(path, tmp_path):
    whole, random = path.read_bytes(), np.random.default_rng(1)
    messages, damaged = [], tmp_path / "damaged.sqlite"
    for k in range(150):
        content = bytearray(whole)
        if k % 3:
            for place in random.integers(0, len(whole), 40):
                content[place] = random.integers(256)
        else:
            del content[random.integers(1, len(whole)) :]
        damaged.write_bytes(content)
        try:
            store = KnowledgeStore(damaged)
            store.contents()
            store.add(sums_of([1.0]), source="run")
        except StoreError as error:
            messages.append(str(error))
    assert len(messages) > 100
    assert [message for message in messages if "\n" in message] == []


def test_a_full_disk_is_one_line_and_nothing_is_half_written(path):
    store, limits = KnowledgeStore(path), resource.getrlimit(resource.RLIMIT_FSIZE)
    before = store.contents()
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 4096, limits[1]))
    try:
        with pytest.raises(StoreError, match=r"k\.sqlite: (disk I/O error|database or disk is full)"):
            store.add(*(sums_of([1.0], f"goal {k}") for k in range(500)), source="run")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert store.contents() == before
    store.add(sums_of([2.0]), source="run")
    assert store.contents().totals()["G", "a", ""].count == 2


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
        store = KnowledgeStore(copy)
        for change_it in (lambda: store.add(sums_of([1.0]), source="run"), lambda: store.forget("run")):
            with pytest.raises(StoreError, match=r"k\.sqlite: attempt to write a readonly database"):
                change_it()
        assert store.contents().totals()["G", "a", ""].count == 1
        assert copy.read_bytes() == before
        assert [p.name for p in copy.parent.iterdir()] == [copy.name]


def test_a_store_that_cannot_be_made_is_reported(path):
    with read_only(path, directory=True) as copy:
        refused(copy.with_name("new.sqlite"), r"new\.sqlite: unable to open database file")
