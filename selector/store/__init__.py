"""The knowledge store: expert knowledge and what was learned of it, in a database (`docs/knowledge.md`)."""

from selector.store.batch import Batch as Batch
from selector.store.errors import StoreError as StoreError
from selector.store.exact_sums import Moments as Moments
from selector.store.records import Contents as Contents
from selector.store.records import Key as Key
from selector.store.store import Estimates as Estimates
from selector.store.store import KnowledgeStore as KnowledgeStore
