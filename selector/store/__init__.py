"""The knowledge store: expert knowledge and learned rewards in a database (`docs/knowledge.md`)."""

from selector.store.errors import StoreError as StoreError
from selector.store.exact_sums import Moments as Moments
from selector.store.exact_sums import RewardSums as RewardSums
from selector.store.knowledge_store import KnowledgeStore as KnowledgeStore
from selector.store.stored_knowledge import Key as Key
from selector.store.stored_knowledge import StoredKnowledge as StoredKnowledge
