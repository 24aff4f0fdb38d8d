"""No update counts twice: what is merged once, again, by two ways, at the same time, as a copy."""

import shutil
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from selector.knowledge import knowledge_from, load_knowledge
from selector.store import KnowledgeStore, RewardSums, StoreError


def learned_from(store, reward):
    """Let a store learn one reward of option `a`."""
    made = RewardSums("G", ["a"])
    made.record(np.zeros(1, dtype=np.int64), np.array([reward]))
    store.add(made, source="run", updated=1)


def test_a_store_is_not_merged_into_itself_or_its_copy(new_url):
    url = new_url()
    store, again = KnowledgeStore(url), KnowledgeStore(url)
    learned_from(store, 1.0)
    with pytest.raises(StoreError, match="is the same store or a copy of it: updates would count twice"):
        store.merge(again)
    assert store.estimates("G", ["a"]).count.tolist() == [[1]]
    store.close()
    again.close()


def test_a_store_is_merged_once_and_again_after_it_was_reset(new_store):
    a, b = new_store(), new_store()
    learned_from(b, 1.0)
    a.merge(b)
    learned_from(b, 2.0)
    before = a.contents()
    with pytest.raises(
        StoreError, match=r"was merged into it before: updates would count twice \(after a merge, `reset`"
    ):
        a.merge(b)
    assert a.contents() == before
    b.reset(goal="G")  # all that it learned
    learned_from(b, 4.0)
    assert a.merge(b) == b.contents()
    assert a.estimates("G", ["a"]).mean.tolist() == [[2.5]]
    a.reset(source="other")  # of which there is nothing
    with pytest.raises(StoreError, match="was merged into it before"):
        a.merge(b)
    a.reset()
    a.merge(b)
    assert a.contents() == b.contents()


def test_updates_that_come_by_two_ways_are_refused(new_store):
    a, b, c = new_store(), new_store(), new_store()
    for store in (a, b, c):
        learned_from(store, 1.0)
    b.merge(a)
    c.merge(a)
    for into, other in ((b, c), (c, b), (a, b), (a, c)):
        before = into.contents()
        with pytest.raises(StoreError, match="has updates that are in it already: they would count twice"):
            into.merge(other)
        assert into.contents() == before
    d = new_store()
    d.merge(c)
    with pytest.raises(StoreError, match="has updates that are in it already"):
        b.merge(d)


def test_expert_options_merge_as_often_as_one_likes(new_store):
    a, b = new_store(), new_store()
    b.put(load_knowledge("cleaning"), source="expert", updated=1)
    learned_from(a, 1.0)
    for _ in range(2):
        a.merge(b)
    learned_from(b, 2.0)  # what it learns later was never taken in
    a.merge(b)
    assert a.estimates("G", ["a"]).count.tolist() == [[2]]
    assert a.contents().expert == b.contents().expert


def test_a_merge_that_fails_can_be_repeated(new_store):
    a, b = new_store(), new_store()
    learned_from(a, 3.0)
    learned_from(b, 1.0)
    for store, parameters in ((a, {"reach": 1.0}), (b, {"reach": 2.0})):
        options = [{"configuration": "A", "score": 1, "parameters": parameters}]
        store.put(knowledge_from({"goals": {"G": options}}), source="expert")
    with pytest.raises(StoreError, match="give one of them another name"):
        a.merge(b)
    assert a.estimates("G", ["a"]).count.tolist() == [[1]]
    a.reset(expert=True, source="expert")
    a.merge(b)
    assert a.estimates("G", ["a"]).count.tolist() == [[2]]


def test_of_merges_at_the_same_time_one_succeeds(new_url, new_store):
    url, other, start = new_url(), new_store(), threading.Barrier(4)
    learned_from(other, 1.0)
    KnowledgeStore(url).close()

    def merge(_):
        store = KnowledgeStore(url)
        start.wait()
        try:
            store.merge(other)
        except StoreError as error:
            return str(error)
        finally:
            store.close()
        return ""

    with ThreadPoolExecutor(4) as threads:
        answers = sorted(threads.map(merge, range(4)))
    assert answers[0] == ""
    assert all("was merged into it before" in answer for answer in answers[1:])
    assert KnowledgeStore(url).estimates("G", ["a"]).count.tolist() == [[1]]


def test_a_copy_of_a_merged_store_is_refused(tmp_path):
    original, copy = (tmp_path / name for name in ("original.sqlite", "copy.sqlite"))
    store, into = KnowledgeStore(str(original)), KnowledgeStore(str(tmp_path / "into.sqlite"))
    learned_from(store, 1.0)
    store.close()
    shutil.copy(original, copy)
    into.merge(KnowledgeStore(str(original)))
    with pytest.raises(StoreError, match=r"into\.sqlite: .*copy\.sqlite was merged into it before"):
        into.merge(KnowledgeStore(str(copy)))
    assert into.estimates("G", ["a"]).count.tolist() == [[1]]
