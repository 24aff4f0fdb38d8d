"""The origins of the updates in a store: its own identity, and those of the stores that were merged into it.

Two stores that both hold updates of one origin cannot be merged, because these updates would count twice. A store whose
learned entries were all deleted gets a new identity, because no other store holds its future updates.
"""

import uuid
from collections.abc import Iterable
from typing import NamedTuple

from sqlalchemy import Connection, delete, insert, select, update

from selector.store.tables import meta

IDENTITY = "identity"
"""Key in the table of the store's properties."""
MERGED = "merged "
"""Beginning of the keys of merged stores; the rest of each key is an identity."""


class Origins(NamedTuple):
    """Origins of the updates of a store."""

    own: str
    """Identity of the store."""
    merged: frozenset[str]
    """Identities of all stores whose updates it holds, merged directly or by way of other stores."""

    @property
    def every(self) -> frozenset[str]:
        """Both together."""
        return self.merged | {self.own}

    def why_not(self, other: "Origins") -> str:
        """Return why the updates of `other` cannot be added, empty if they can."""
        if other.own == self.own:
            return "is the same store or a copy of it: updates would count twice"
        if other.own in self.merged:
            return "was merged into it before: updates would count twice (after a merge, `reset` the store merged)"
        if self.every & other.every:
            return "has updates that are in it already: they would count twice"
        return ""


def new_identity() -> str:
    """Return an identity that no other store has."""
    return uuid.uuid4().hex


def read_origins(connection: Connection) -> Origins:
    """Return the origins of a store."""
    keys = {row.key: row.value for row in connection.execute(select(meta))}
    merged = frozenset(key.removeprefix(MERGED) for key in keys if key.startswith(MERGED))
    return Origins(str(keys.get(IDENTITY, "")), merged)


def note_merged(connection: Connection, identities: Iterable[str], now: int) -> None:
    """Record that updates of other stores were merged in at `now` [us since 1970, UTC]."""
    rows = [{"key": f"{MERGED}{identity}", "value": str(now)} for identity in sorted(identities)]
    connection.execute(insert(meta), rows)


def begin_anew(connection: Connection) -> None:
    """Give a store whose updates were all deleted a new identity."""
    connection.execute(delete(meta).where(meta.c.key.startswith(MERGED, autoescape=True)))
    connection.execute(update(meta).where(meta.c.key == IDENTITY).values(value=new_identity()))
