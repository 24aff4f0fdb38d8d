"""Which knowledge store a command uses: the one named, or the user's own."""

import os
from pathlib import Path

import platformdirs

from selector.store import KnowledgeStore, StoreError

VARIABLE = "CLEAN_SWARM_STORE"
"""Environment variable that names the store unless `--store` does."""


def default_path() -> Path:
    """Return the store in the user's data directory."""
    return platformdirs.user_data_path("clean-swarm", appauthor=False) / "knowledge.sqlite"


def opened(url: str | None, *, create: bool) -> KnowledgeStore:
    """Return the store of a URL, else of the environment, else the user's own, whose directory is made if need be."""
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
