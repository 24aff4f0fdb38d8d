"""Errors of a store, as one line for the user."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from selector.documents.errors import DocumentError


class StoreError(DocumentError):
    """A store cannot be opened, read or written; nothing was changed."""


@contextmanager
def reported(where: str) -> Iterator[None]:
    """Turn errors of a database, and of what it holds, into a StoreError; `where` is the name of the store."""
    from sqlalchemy.exc import DBAPIError  # of the extra "store"

    try:
        yield
    except DocumentError as error:
        raise StoreError(str(error)) from error
    except DBAPIError as error:
        raise StoreError(f"{where}: {_text_of(error)}") from error
    except UnicodeDecodeError as error:  # sqlite3 cannot decode the message about a damaged schema
        raise StoreError(f"{where}: the file is corrupt: {error.reason}") from error
    except UnicodeEncodeError as error:  # half a character in a name
        raise StoreError(f"{where}: expected text, got another character ({error.reason})") from error


def _text_of(error: Any) -> str:  # noqa: ANN401  (of SQLAlchemy, which may be missing)
    """Return the message of the database in one line."""
    first = error.orig.args[0] if error.orig is not None and error.orig.args else error
    if isinstance(first, dict):  # pg8000 passes the fields of PostgreSQL's error
        first = first.get("M", first)
    return " ".join(str(first).split())
