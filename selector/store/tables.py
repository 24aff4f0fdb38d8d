"""The tables of a store: their rows are the entries of an exported store; all SQL is here and in `connection`."""

import json
from collections.abc import Collection
from typing import Any

from sqlalchemy import (
    BigInteger,
    Column,
    Connection,
    Float,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    delete,
    select,
)
from sqlalchemy.dialects import postgresql, sqlite

from selector.documents.fields import MOST_STORED
from selector.documents.reading import json_value
from selector.store.document import FORMAT, as_document, from_document
from selector.store.stored_knowledge import StoredKnowledge

metadata = MetaData()
meta = Table(
    "clean_swarm_meta",
    metadata,
    Column("key", String(MOST_STORED), primary_key=True),
    Column("value", Text, nullable=False),
)
expert = Table(
    "clean_swarm_expert",
    metadata,
    Column("goal", String(MOST_STORED), primary_key=True),
    Column("name", String(MOST_STORED), primary_key=True),
    Column("position", Integer, nullable=False),
    Column("configuration", Text, nullable=False),
    Column("score", Float(53), nullable=False),
    Column("parameters", Text, nullable=False),  # as JSON
    Column("source", String(MOST_STORED), nullable=False),
    Column("updated", Text, nullable=False),
)
learned = Table(
    "clean_swarm_learned",
    metadata,
    Column("goal", String(MOST_STORED), primary_key=True),
    Column("option", String(MOST_STORED), primary_key=True),
    Column("context", String(MOST_STORED), primary_key=True),
    Column("source", String(MOST_STORED), primary_key=True),
    Column("count", BigInteger, nullable=False),
    Column("total", Text, nullable=False),  # whole numbers of up to 124 bits, as text
    Column("squares", Text, nullable=False),
    Column("updated", Text, nullable=False),
)


def read(connection: Connection, where: str) -> StoredKnowledge:
    """Return everything in a store; DocumentError, which begins with `where`, for rows that no store writes."""
    options: dict[str, list[dict[str, Any]]] = {}
    for row in connection.execute(select(expert)):
        entry = dict(row._mapping)
        goal = entry.pop("goal")
        entry["parameters"] = json_value(str(row.parameters), f"{where}: expert.{goal}.{row.name}.parameters")
        options.setdefault(goal, []).append(entry)
    entries = [dict(row._mapping) for row in connection.execute(select(learned))]
    return from_document({**FORMAT, "expert": options, "learned": entries}, where)


def read_learned(connection: Connection, where: str, goals: Collection[str], source: str) -> StoredKnowledge:
    """Return the learned entries of some goals from one source; errors are those of `read`."""
    rows = connection.execute(select(learned).where(learned.c.goal.in_(goals), learned.c.source == source))
    return from_document({**FORMAT, "expert": {}, "learned": [dict(row._mapping) for row in rows]}, where)


def write(connection: Connection, contents: StoredKnowledge) -> None:
    """Write contents over the rows of the same keys; DocumentError for contents that no store takes."""
    document = as_document(contents)
    options = [
        entry | {"goal": goal, "parameters": json.dumps(entry["parameters"], sort_keys=True)}
        for goal, entries in document["expert"].items()
        for entry in entries
    ]
    for table, rows in ((expert, options), (learned, document["learned"])):
        inserting = (postgresql if connection.dialect.name == "postgresql" else sqlite).insert(table)
        changed = {column.name: inserting.excluded[column.name] for column in table.c if not column.primary_key}
        if rows:
            keys = list(table.primary_key)
            connection.execute(inserting.on_conflict_do_update(index_elements=keys, set_=changed), rows)


def delete_rows(connection: Connection, table: Table, chosen: dict[str, str]) -> int:
    """Delete the rows in which the columns `chosen` have these values; return the number of rows."""
    statement = delete(table).where(*(table.c[column] == value for column, value in chosen.items()))
    return connection.execute(statement).rowcount
