"""No update counts twice: what is merged once, again, by two ways, at the same time, as a copy or a document."""

import shutil
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from selector.knowledge import knowledge_from
from selector.store import Key, KnowledgeStore, RewardSums, StoreError
from selector.store.document import as_document, from_document


def learn(store, reward, source):
    """Let a store learn one reward of option `a`."""
    made = RewardSums("G", ["a"])
    made.record(np.zeros(1, dtype=np.int64), np.array([reward]))
    store.add(made, source=source, updated=1)


def known(store):
    """Return count and mean of the rewards of option `a`."""
    found = store.contents().totals()["G", "a", ""]
    return found.count, found.mean


def test_what_a_store_holds_already_counts_once(new_store):
    a, b = new_store(), new_store()
    learn(a, 3.0, "one")
    learn(b, 1.0, "two")
    for _ in range(2):
        a.absorb(b.contents())
        a.absorb(a.contents())
        a.absorb(from_document(as_document(a.contents()), "exported"))
    assert known(a) == (2, 2.0)
    learn(b, 2.0, "two")
    a.absorb(b.contents())
    assert known(a) == (3, 2.0)
    assert a.contents().learned[Key("G", "a", "", "two")] == b.contents().learned[Key("G", "a", "", "two")]


def test_updates_that_come_by_two_ways_count_once(new_store):
    a, b, c = new_store(), new_store(), new_store()
    for store, source in ((a, "one"), (b, "two"), (c, "three")):
        learn(store, 1.0, source)
    early = a.contents()
    learn(a, 4.0, "one")
    b.absorb(a.contents())
    c.absorb(early)
    for into, other in ((b, c), (c, b), (a, b)):
        into.absorb(other.contents())
    assert known(a) == known(b) == known(c) == (4, 1.75)


def test_other_rewards_of_the_same_source_are_refused_and_nothing_changes(new_store):
    a, b = new_store(), new_store()
    for reward in (1.0, 2.0):
        learn(a, reward, "run")
    learn(b, 1000.0, "run")
    before = a.contents()
    for into, other in ((a, b), (b, a)):
        with pytest.raises(StoreError, match=r"G: a: source 'run' holds 2 rewards here that do not begin with the 1"):
            into.absorb(other.contents())
    assert a.contents() == before


def test_a_merge_that_fails_can_be_repeated(new_store):
    a, b = new_store(), new_store()
    learn(a, 3.0, "one")
    learn(b, 1.0, "two")
    for store, parameters in ((a, {"reach": 1.0}), (b, {"reach": 2.0})):
        options = [{"configuration": "A", "score": 1, "parameters": parameters}]
        store.put(knowledge_from({"goals": {"G": options}}), source="expert")
    with pytest.raises(StoreError, match="give one of them another name"):
        a.absorb(b.contents())
    assert known(a) == (1, 3.0)
    a.reset(expert=True, source="expert")
    a.absorb(b.contents())
    assert known(a) == (2, 2.0)


def test_merges_at_the_same_time_count_once(new_url, new_store):
    url, other, start = new_url(), new_store(), threading.Barrier(4)
    learn(other, 1.0, "run")
    KnowledgeStore(url).close()

    def merge(_):
        store = KnowledgeStore(url)
        start.wait()
        store.absorb(other.contents())
        store.close()

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(merge, range(4)))
    assert known(KnowledgeStore(url)) == (1, 1.0)


def test_a_copy_of_a_store_counts_once_and_goes_on(tmp_path):
    original, copy = (tmp_path / name for name in ("original.sqlite", "copy.sqlite"))
    store = KnowledgeStore(str(original))
    learn(store, 1.0, "run")
    store.close()
    shutil.copy(original, copy)
    learn(KnowledgeStore(str(copy)), 3.0, "run")
    store.absorb(KnowledgeStore(str(copy)).contents())
    assert known(store) == (2, 2.0)
