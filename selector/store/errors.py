"""What is wrong with a store, as one line for the user."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import DBAPIError

from selector.documents.errors import DocumentError
from selector.store.exact_sums import COUNT_LIMIT

FULL = "clean_swarm_learned_updates"
"""Name of the constraint on the number of updates; databases name it when it is violated."""


class StoreError(DocumentError):
    """A store that cannot be opened, read or written; nothing was changed."""


@contextmanager
def reported(where: str) -> Iterator[None]:
    """Turn what a database says, or impossible values in it, into a StoreError that begins with the store's name."""
    try:
        yield
    except StoreError:
        raise
    except DBAPIError as error:
        said = said_by(error)
        if FULL in said:
            said = f"an entry would hold more than {COUNT_LIMIT} updates; nothing was added"
        raise StoreError(f"{where}: {said}") from error
    except UnicodeDecodeError as error:  # sqlite3 fails to decode what SQLite says of a damaged schema
        raise StoreError(f"{where}: the file is corrupt: {error.reason}") from error


def said_by(error: DBAPIError) -> str:
    """Return the database's own message, in one line."""
    first = error.orig.args[0] if error.orig is not None and error.orig.args else error
    if isinstance(first, dict):  # pg8000 gives the fields of PostgreSQL's error message
        first = first.get("M", first)
    return " ".join(str(first).split())
