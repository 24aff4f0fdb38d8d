"""Errors of a store, as one line for the user."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import DBAPIError

from selector.documents.errors import DocumentError
from selector.store.exact_sums import COUNT_LIMIT

FULL = "clean_swarm_learned_updates"
"""Name of the constraint on the number of updates, which the error of a database contains when it is violated."""


class StoreError(DocumentError):
    """A store cannot be opened, read or written; nothing was changed."""


@contextmanager
def reported(where: str) -> Iterator[None]:
    """Turn errors of a database into a StoreError that begins with the name of the store."""
    try:
        yield
    except StoreError:
        raise
    except DBAPIError as error:
        text = _text_of(error)
        if FULL in text:
            text = f"an entry would have more than {COUNT_LIMIT} updates; nothing was added"
        raise StoreError(f"{where}: {text}") from error
    except UnicodeDecodeError as error:  # sqlite3 cannot decode the message about a damaged schema
        raise StoreError(f"{where}: the file is corrupt: {error.reason}") from error


def _text_of(error: DBAPIError) -> str:
    """Return the message of the database in one line."""
    first = error.orig.args[0] if error.orig is not None and error.orig.args else error
    if isinstance(first, dict):  # pg8000 passes the fields of PostgreSQL's error
        first = first.get("M", first)
    return " ".join(str(first).split())
