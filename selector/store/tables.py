"""The tables of a store and the statements on them; all SQL is in this file and in `connection`.

A sum has two columns, `value = high * 2^62 + low` with 0 <= low < 2^62, because its 124 bits do not fit into one. One
statement adds to both and carries, so that equal sums give equal rows in any order of adding.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from sqlalchemy import (
    BigInteger,
    CheckConstraint,
    Column,
    Connection,
    Float,
    Integer,
    MetaData,
    Row,
    Select,
    String,
    Table,
    Text,
    case,
    delete,
    select,
)
from sqlalchemy.dialects import postgresql, sqlite

from selector.documents.errors import validated
from selector.documents.plain import short
from selector.documents.reading import json_value
from selector.knowledge import Option
from selector.store.errors import FULL
from selector.store.exact_sums import COUNT_LIMIT, Moments
from selector.store.stored_knowledge import NAME_LIMIT, Key, LearnedEntry, Rated, definition

LOW_BITS = 62
LOW_MASK = (1 << LOW_BITS) - 1
MOST_NAMED = 500
"""Most contexts that a query names: databases limit the number, and for more contexts reading all is faster."""
SUMS = ("total", "squares")

metadata = MetaData()
meta = Table(
    "clean_swarm_meta",
    metadata,
    Column("key", String(NAME_LIMIT), primary_key=True),
    Column("value", Text, nullable=False),
)
expert = Table(
    "clean_swarm_expert",
    metadata,
    Column("goal", String(NAME_LIMIT), primary_key=True),
    Column("name", String(NAME_LIMIT), primary_key=True),
    Column("position", Integer, nullable=False),
    Column("configuration", Text, nullable=False),
    Column("score", Float(53), nullable=False),
    Column("parameters", Text, nullable=False),
    Column("source", String(NAME_LIMIT), nullable=False),
    Column("updated", BigInteger, nullable=False),
)
learned = Table(
    "clean_swarm_learned",
    metadata,
    Column("goal", String(NAME_LIMIT), primary_key=True),
    Column("option", String(NAME_LIMIT), primary_key=True),
    Column("context", String(NAME_LIMIT), primary_key=True),
    Column("source", String(NAME_LIMIT), primary_key=True),
    Column("updates", BigInteger, nullable=False),
    *(Column(f"{sum_}_{part}", BigInteger, nullable=False) for sum_ in SUMS for part in ("high", "low")),
    Column("updated", BigInteger, nullable=False),
    CheckConstraint(f"updates BETWEEN 1 AND {COUNT_LIMIT}", name=FULL),
)


def add_learned(connection: Connection, entries: Iterable[tuple[Key, LearnedEntry]]) -> None:
    """Add `entries` to those of the same keys; missing entries are created. No key may be given twice."""
    rows = [
        {
            **key._asdict(),
            "updates": entry.moments.count,
            "total_high": entry.moments.total >> LOW_BITS,  # rounds down, so that low is never negative
            "total_low": entry.moments.total & LOW_MASK,
            "squares_high": entry.moments.squares >> LOW_BITS,
            "squares_low": entry.moments.squares & LOW_MASK,
            "updated": entry.updated,
        }
        for key, entry in sorted(entries)  # all writers lock rows in this order: no deadlock
    ]
    if rows:
        connection.execute(_adding(connection.dialect.name), rows)


def _adding(dialect: str) -> postgresql.Insert | sqlite.Insert:
    inserting = _insert(dialect, learned)
    old, new = learned.c, inserting.excluded
    changes: dict[str, Any] = {
        "updates": old.updates + new.updates,
        "updated": case((new.updated > old.updated, new.updated), else_=old.updated),
    }
    for name in SUMS:
        low = old[f"{name}_low"] + new[f"{name}_low"]  # below 2^63
        carry = case((low > LOW_MASK, 1), else_=0)
        changes[f"{name}_low"] = low.bitwise_and(LOW_MASK)
        changes[f"{name}_high"] = old[f"{name}_high"] + new[f"{name}_high"] + carry
    return inserting.on_conflict_do_update(index_elements=list(learned.primary_key), set_=changes)


def _insert(dialect: str, table: Table) -> postgresql.Insert | sqlite.Insert:
    return postgresql.insert(table) if dialect == "postgresql" else sqlite.insert(table)


def put_expert(connection: Connection, options: Iterable[tuple[tuple[str, str], Rated]]) -> None:
    """Write expert options; they replace those of the same goal and name."""
    rows = []
    for (goal, name), rated in options:
        configuration, parameters = definition(rated.option)
        row = {"goal": goal, "name": name, "configuration": configuration, "parameters": parameters}
        rest = {"score": rated.option.score, "position": rated.position, "source": rated.source}
        rows.append(row | rest | {"updated": rated.updated})
    if rows:
        inserting = _insert(connection.dialect.name, expert)
        changed = {column.name: inserting.excluded[column.name] for column in expert.c if not column.primary_key}
        connection.execute(inserting.on_conflict_do_update(index_elements=list(expert.primary_key), set_=changed), rows)


def read_expert(connection: Connection) -> dict[tuple[str, str], Rated]:
    """Return all expert options by goal and name."""
    return {(row.goal, row.name): _rated(row) for row in _rows(connection, expert, select(expert))}


def _rated(row: Row[Any]) -> Rated:
    where = f"{expert.name}: {row.goal}.{row.name}"
    given = {"configuration": row.configuration, "score": row.score, "name": row.name}
    parameters = json_value(row.parameters, f"{where}.parameters")
    return Rated(validated(Option, given | {"parameters": parameters}, where), row.position, row.source, row.updated)


def read_learned(
    connection: Connection, goal: str | None = None, contexts: Sequence[str] | None = None
) -> dict[Key, LearnedEntry]:
    """Return learned entries by key: all, or those of one goal and of at least the given contexts."""
    query = select(learned)
    if goal is not None:
        query = query.where(learned.c.goal == goal)
    if contexts is not None and len(contexts) <= MOST_NAMED:
        query = query.where(learned.c.context.in_(list(contexts)))
    rows = _rows(connection, learned, query)
    return {Key(row.goal, row.option, row.context, row.source): _entry(row) for row in rows}


def any_learned(connection: Connection) -> bool:
    """Return whether there is any learned entry."""
    return connection.execute(select(learned.c.goal).limit(1)).first() is not None


def _entry(row: Row[Any]) -> LearnedEntry:
    total, squares = (row.total_high << LOW_BITS) + row.total_low, (row.squares_high << LOW_BITS) + row.squares_low
    moments = Moments(row.updates, total, squares)
    if why := moments.impossible():
        raise ValueError(why)
    return LearnedEntry(moments, row.updated)


def _rows(connection: Connection, table: Table, query: Select[Any]) -> Iterator[Row[Any]]:
    """Yield the rows of a table; ValueError for a value of another type than its column, which SQLite would keep."""
    types = [(column.name, column.type.python_type) for column in table.c]
    for row in connection.execute(query):
        for (name, expected), value in zip(types, row, strict=True):
            if type(value) is not expected:
                raise ValueError(f"{table.name}.{name}: expected {expected.__name__}, got {short(value)}")
        yield row


def delete_rows(connection: Connection, table: Table, chosen: dict[str, str]) -> int:
    """Delete the rows in which the columns `chosen` have these values; return the number of rows."""
    statement = delete(table).where(*(table.c[column] == value for column, value in chosen.items()))
    return connection.execute(statement).rowcount
