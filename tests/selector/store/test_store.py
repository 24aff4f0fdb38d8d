"""A store keeps what it is given: on SQLite and on PostgreSQL, in whichever order, alone or merged."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from selector.knowledge import knowledge_from, load_knowledge
from selector.store import Key, KnowledgeStore, Moments, RewardSums, StoredKnowledge, StoreError
from selector.store.exact_sums import COUNT_LIMIT
from selector.store.stored_knowledge import LearnedEntry, stored
from tests.selector.store import strategies as some

few = settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
one = LearnedEntry(Moments(1, 5, 25), 7)


@pytest.fixture
def lent(new_store):
    """Lend some empty stores to an example; the next one gets the same, emptied."""
    stores = []

    @contextmanager
    def lend(number: int) -> Iterator[list[KnowledgeStore]]:
        while len(stores) < number:
            stores.append(new_store())
        yield stores[:number]
        for store in stores:
            store.reset(expert=True)

    return lend


def batch(goal, rewards, options=("a", "b"), context=""):
    made = RewardSums(goal, options)
    made.record(np.array([options.index(name) for name, _ in rewards]), np.array([r for _, r in rewards]), context)
    return made


def test_totals_are_over_all_sources(new_store):
    store = new_store()
    store.add(batch("G", [("a", 1.0), ("a", 3.0), ("b", -2.0)]), source="run-1")
    store.add(
        batch("G", [("a", 5.0)]), batch("H", [("a", 9.0)]), batch("G", [("b", 1.5)], context="far"), source="run-2"
    )
    assert {key: (sums.count, sums.mean, sums.variance) for key, sums in store.contents().totals().items()} == {
        ("G", "a", ""): (3, 3.0, 8.0 / 3.0),
        ("G", "b", ""): (1, -2.0, 0.0),
        ("G", "b", "far"): (1, 1.5, 0.0),
        ("H", "a", ""): (1, 9.0, 0.0),
    }


def test_an_entry_says_when_it_was_updated_last_and_by_whom(new_store):
    store = new_store()
    for updated, source in [(30, "x"), (20, "x"), (50, "y")]:
        store.add(batch("G", [("a", 1.0)]), source=source, updated=updated)
    learned = store.contents().learned
    assert {key: (entry.moments.count, entry.updated) for key, entry in learned.items()} == {
        Key("G", "a", "", "x"): (2, 30),
        Key("G", "a", "", "y"): (1, 50),
    }


def test_expert_knowledge_is_kept_as_it_was_read(new_store):
    store, knowledge = new_store(), load_knowledge("cleaning")
    store.put(knowledge, source="expert", updated=1)
    assert store.knowledge().table == knowledge.table
    store.put(knowledge.with_scores({"AvoidCollision": {"RepulsionGradient": 7.0}}), source="me", updated=3)
    store.put(knowledge, source="someone late", updated=2)
    assert store.knowledge().scores("AvoidCollision").tolist() == [1.0, 0.0, 7.0]
    assert store.contents().expert["AvoidCollision", "RepulsionGradient"].source == "me"


def test_a_name_that_means_something_else_is_refused_and_nothing_changes(new_store):
    store = new_store()
    store.put(knowledge_from({"goals": {"G": [{"configuration": "A", "score": 1.0}]}}), source="expert")
    before = store.contents()
    for other in ({"configuration": "B", "name": "A"}, {"configuration": "A", "parameters": {"view": 2}}):
        given = knowledge_from({"goals": {"F": [{"configuration": "New", "score": 1}], "G": [other | {"score": 2.0}]}})
        with pytest.raises(
            StoreError, match=r"goals\.G\.A: means A {} here and .* there; give one of them another name"
        ):
            store.put(given, source="expert")
    assert store.contents() == before


@few
@given(some.overlapping)
def test_contents_come_back_as_they_went_in(lent, contents):
    with lent(1) as (store,):
        store.absorb(contents)
        assert store.contents() == contents


@few
@given(some.overlapping, some.overlapping)
def test_merging_stores_is_merging_contents_in_either_order(lent, first, second):
    with lent(4) as (a, b, c, d):
        for store, held in ((a, first), (b, second), (c, second), (d, first)):
            store.absorb(held)
        a.absorb(b.contents())
        assert b.contents() == second
        c.absorb(d.contents())
        assert a.contents() == c.contents() == first.merged(second)


@few
@given(some.updates(), some.updates(), some.updates())
def test_merged_stores_equal_one_store_of_all_updates(lent, first, second, third):
    with lent(4) as (a, b, c, whole):
        for store, source, updates in ((a, "a", first), (b, "b", second), (c, "c", third)):
            for update in updates:  # one at a time
                store.add(some.batch_of([update]), source=source, updated=1)
            whole.add(some.batch_of(updates[::-1]), source=source, updated=1)
        a.absorb(b.contents())
        c.absorb(a.contents())
        assert c.contents() == whole.contents()


@given(some.overlapping, some.overlapping, some.overlapping)
def test_merging_contents_commutes_and_associates(a, b, c):
    assert a.merged(b) == b.merged(a)
    assert a.merged(b).merged(c) == a.merged(b.merged(c))
    assert a.merged(StoredKnowledge()) == a.merged(a) == a


def test_large_sums_are_exact_to_the_last_bit(new_store):
    count = COUNT_LIMIT - 1
    largest = LearnedEntry(Moments(count, -count * 2**44 + 1, count * 2**88 - 2**45 + 1), 1)
    key, sums = Key("G", "a", "", "run"), batch("G", [("a", -(2.0**20))])
    store = new_store()
    store.absorb(StoredKnowledge(learned={key: largest}))
    store.add(sums, source="run", updated=1)
    full = {key: LearnedEntry(largest.moments + sums.moments["a", ""], 1)}
    assert store.contents().learned == full
    with pytest.raises(StoreError, match=r"expected a count from 1 to 68719476736, got 68719476737"):
        store.add(sums, batch("G", [("b", 1.0)]), source="run")
    assert store.contents().learned == full


def test_reset_forgets_what_is_chosen(new_store):
    store = new_store()
    learned = {Key(g, o, c, s): one for g in "GH" for o in "ab" for c in ("", "far") for s in "xy"}
    expert = stored(knowledge_from({"goals": {g: [{"configuration": o, "score": 1} for o in "ab"] for g in "GH"}}))
    store.absorb(StoredKnowledge(expert.expert, learned))
    assert store.reset(goal="G", option="a", context="", source="x") == (1, 0)
    assert set(store.contents().learned) == set(learned) - {Key("G", "a", "", "x")}
    assert store.reset(goal="H", option="b", expert=True) == (4, 1)
    assert set(store.contents().expert) == set(expert.expert) - {("H", "b")}
    assert store.reset(goal="nowhere") == (0, 0)
    assert store.reset() == (11, 0)
    assert store.reset(expert=True) == (0, 3)
    assert store.contents() == StoredKnowledge()
    with pytest.raises(TypeError, match="unknown selection: gaol"):
        store.reset(gaol="G")


@pytest.mark.parametrize("name", ["", "a\0b", "two\nlines", "x" * 121, "\ud800"])
def test_names_that_no_store_takes_are_refused_and_nothing_changes(new_store, name):
    store = new_store()
    good, where = batch("G", [("a", 1.0)]), []
    for what, call in {
        "goal": lambda: store.add(good, batch(name, [("a", 1.0)]), source="run"),
        "option": lambda: store.add(good, batch("G", [(name, 1.0)], options=(name,)), source="run"),
        "source": lambda: store.add(good, source=name),
        "context": lambda: store.add(good, batch("G", [("a", 1.0)], context=name), source="run"),
    }.items():
        if (what, name) != ("context", ""):
            with pytest.raises(StoreError, match=rf"{what}: expected "):
                call()
            where.append(what)
    assert len(where) >= 3
    assert store.contents() == StoredKnowledge()


def test_the_longest_names_fit(new_store):
    store, name = new_store(), "𐀀" * 120
    store.add(batch(name, [(name, 1.0)], options=(name,), context=name), source=name)
    assert store.contents().totals()[name, name, name].count == 1


def test_parameters_that_cannot_be_kept_are_refused(new_store):
    for parameters in ({"x": {1: 2}}, {"x": {1, 2}}, {"x": (1,)}):
        given = knowledge_from({"goals": {"G": [{"configuration": "A", "score": 1, "parameters": parameters}]}})
        with pytest.raises(StoreError, match=r"A\.parameters: expected text, numbers, lists and mappings by text"):
            new_store().put(given, source="expert")


def test_a_forked_process_goes_on_with_a_connection_of_its_own(new_store):
    store = new_store()
    store.add(batch("G", [("a", 1.0)]), source="run")
    child = os.fork()
    if child == 0:
        try:
            store.add(batch("G", [("a", 2.0)]), source="run")
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    store.add(batch("G", [("a", 4.0)]), source="run")
    assert store.contents().learned[Key("G", "a", "", "run")].moments == some.moments_of([1.0, 2.0, 4.0])


def test_more_contexts_than_a_query_can_name(new_store):
    store, contexts = new_store(), [f"cell {k}" for k in range(40_000)]
    made = RewardSums("G", ["a"])
    made.record(np.zeros(len(contexts), dtype=int), np.ones(len(contexts)), contexts)
    for _ in range(2):
        store.add(made, source="run")
    found = store.contents().totals()
    assert [found["G", "a", context].count for context in contexts] == [2] * len(contexts)


@pytest.mark.parametrize("updated", [-1, 10**18])
def test_times_that_no_date_has_are_refused(new_store, updated):
    store = new_store()
    with pytest.raises(StoreError, match=r"updated: expected "):
        store.add(batch("G", [("a", 1.0)]), source="run", updated=updated)
    assert store.contents() == StoredKnowledge()
