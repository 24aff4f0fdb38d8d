"""The knowledge store: expert knowledge and what was learned of it, in a database (`docs/knowledge.md`)."""

from selector.store.batch import Batch as Batch
from selector.store.contents import Contents as Contents
from selector.store.contents import Key as Key
from selector.store.errors import StoreError as StoreError
from selector.store.moments import Moments as Moments
from selector.store.store import Estimates as Estimates
from selector.store.store import KnowledgeStore as KnowledgeStore
