"""The knowledge store: expert knowledge and learned rewards in one SQLite file (`docs/knowledge.md`)."""

from selector.store.contents import Key as Key
from selector.store.contents import StoredKnowledge as StoredKnowledge
from selector.store.contents import StoreError as StoreError
from selector.store.exact_sums import Moments as Moments
from selector.store.exact_sums import RewardSums as RewardSums
from selector.store.knowledge_store import KnowledgeStore as KnowledgeStore
