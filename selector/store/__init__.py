"""The knowledge store: expert knowledge and learned rewards in a database (`docs/knowledge.md`).

What opens a database needs SQLAlchemy, which the extra `store` has, and is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from selector.store.errors import StoreError as StoreError
from selector.store.exact_sums import Moments as Moments
from selector.store.exact_sums import RewardSums as RewardSums
from selector.store.stored_knowledge import Key as Key
from selector.store.stored_knowledge import StoredKnowledge as StoredKnowledge

if TYPE_CHECKING:
    from selector.store.connection import public_url as public_url
    from selector.store.knowledge_store import KnowledgeStore as KnowledgeStore

IN_DATABASE = {"KnowledgeStore": "knowledge_store", "public_url": "connection"}
"""Name that needs SQLAlchemy -> module of this package that defines it."""


def __getattr__(name: str) -> Any:  # noqa: ANN401  (a public name; type checkers see the imports above)
    """Import a name that needs SQLAlchemy; StoreError if that is not installed."""
    if name not in IN_DATABASE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        return getattr(import_module(f"{__name__}.{IN_DATABASE[name]}"), name)
    except ModuleNotFoundError as error:
        raise StoreError(f"store: {error.name} is not installed: pip install 'clean-swarm[store]'") from error
