"""Rows that no store writes are refused by whatever reads or adds, as they are on reading all."""

import sqlite3
from contextlib import closing

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from selector.knowledge import Knowledge, Option
from selector.store import KnowledgeStore, RewardSums, StoreError
from selector.store.stored_knowledge import stored
from selector.store.tables import expert, learned, meta

KNOWLEDGE = Knowledge({"G": (Option(configuration="A", score=1.0, name="a"),)}, "here")
VALUES = (
    st.integers(-(2**63), 2**63 - 1)
    | st.floats(allow_nan=False)
    | st.text(st.characters(codec="utf-8"), max_size=6)
    | st.binary(max_size=6)
    | st.sampled_from([0, 1, 1.5, "1", b"1", "", "{}", "{", "[1]", '{"a": NaN}', "[" * 3000, "x" * 200])
)
COLUMNS = [(table.name, column.name) for table in (expert, learned, meta) for column in table.c]


def rewards():
    batch = RewardSums("G", ["a"])
    batch.record(np.array([0]), np.array([1.0]))
    return batch


def made(path):
    store = KnowledgeStore(str(path))
    store.put(KNOWLEDGE, source="me", updated=1)
    store.add(rewards(), source="run", updated=1)
    store.close()


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(column=st.sampled_from(COLUMNS), value=VALUES)
def test_what_reading_refuses_no_import_takes(tmp_path_factory, column, value):
    path = tmp_path_factory.mktemp("store") / "k.sqlite"
    made(path)
    with closing(sqlite3.connect(path)) as connection, connection:
        try:
            connection.execute(f"UPDATE {column[0]} SET {column[1]} = ?", (value,))
        except sqlite3.IntegrityError:  # a constraint of the table keeps this damage away
            return
    before = dump(path)
    uses = {
        "list": lambda store: store.contents(),
        "import": lambda store: store.absorb(stored(KNOWLEDGE, "me", 1)),
        "introduce": lambda store: store.introduce(KNOWLEDGE, source="me"),
    }
    refused = {name: why(path, use) for name, use in uses.items()}
    if refused["list"]:
        assert refused == dict.fromkeys(uses, refused["list"])
        assert dump(path) == before
    for use in (
        lambda store: store.add(rewards(), source="run"),
        lambda store: KnowledgeStore(str(path.with_name("other.sqlite"))).absorb(store.contents()),
    ):
        why(path, use)  # done, or refused in one line


def why(path, use):
    """Return why a use of the store is refused; empty if it is not."""
    message = ""
    try:
        with closing(KnowledgeStore(str(path))) as store:
            use(store)
    except StoreError as error:
        message = str(error)
    assert "\n" not in message
    return message


def dump(path):
    with closing(sqlite3.connect(path)) as connection:
        return [connection.execute(f"SELECT * FROM {t.name}").fetchall() for t in (expert, learned, meta)]


@pytest.mark.parametrize("table", [expert, learned])
def test_a_missing_table_is_noticed_on_opening(tmp_path, table):
    made(tmp_path / "k.sqlite")
    with closing(sqlite3.connect(tmp_path / "k.sqlite")) as connection, connection:
        connection.execute(f"DROP TABLE {table.name}")
    for create in (False, True):
        with pytest.raises(StoreError, match=f"is corrupt: no such table: {table.name}"):
            KnowledgeStore(str(tmp_path / "k.sqlite"), create=create)


def test_an_update_does_not_hide_a_damaged_row(tmp_path):
    made(tmp_path / "k.sqlite")
    with closing(sqlite3.connect(tmp_path / "k.sqlite")) as connection, connection:
        connection.execute(f"UPDATE {learned.name} SET squares = '3'")
    with closing(KnowledgeStore(str(tmp_path / "k.sqlite"))) as store:
        with pytest.raises(StoreError, match=r"is corrupt: .* do not belong to 1 rewards"):
            store.add(rewards(), source="run")
        with pytest.raises(StoreError, match=r"is corrupt: .* do not belong to 1 rewards"):
            store.put(KNOWLEDGE, source="me")
