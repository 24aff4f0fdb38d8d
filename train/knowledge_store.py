"""The knowledge store of a command, and the files that a user names for import."""

import os
from collections.abc import Sequence
from pathlib import Path

import platformdirs

from selector.documents.errors import DocumentError
from selector.knowledge import load_knowledge
from selector.store import KnowledgeStore, StoredKnowledge, StoreError, document
from selector.store.stored_knowledge import stored

VARIABLE = "CLEAN_SWARM_STORE"
"""Environment variable with the URL of the store, used without `--store`."""


def default_path() -> Path:
    """Return the path of the store in the user's data directory."""
    return platformdirs.user_data_path("clean-swarm", appauthor=False) / "knowledge.sqlite"


def opened(url: str | None, *, create: bool) -> KnowledgeStore:
    """Return the store of a URL if given, else that of the environment variable, else that in the data directory.

    With `create`, a missing store is made, and for the data directory also the directory.
    """
    named = url or os.environ.get(VARIABLE)
    if named:
        return KnowledgeStore(named, create=create)
    path = default_path()
    if create:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"{path.parent}: cannot be made ({error.strerror})") from error
    return KnowledgeStore(str(path), create=create)


def contents_named(given: str, source: str, directories: Sequence[Path] = ()) -> StoredKnowledge:
    """Return the contents of a file, which is expert knowledge or an exported store, or the expert knowledge of a name.

    Args:
        given: path of the file, or name of expert knowledge.
        source: source of expert knowledge.
        directories: searched for expert knowledge before the shipped directory.

    """
    path = Path(given)
    if path.is_file():
        return document.read(path, source)
    if path.suffix or path.name != given:
        raise DocumentError(f"{given}: no such file")
    return stored(load_knowledge(given, directories), source)


def amount(contents: StoredKnowledge) -> str:
    """Return the numbers of expert options and updates in words."""
    updates = sum(entry.moments.count for entry in contents.learned.values())
    return f"{counted(len(contents.expert), 'expert option')}, {counted(updates, 'update')}"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun."""
    return f"{number} {one if number == 1 else many or one + 's'}"
