"""A store keeps what it is given, to the last bit, and refuses what it cannot keep without changing anything."""

import os
from contextlib import suppress
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from selector.knowledge import knowledge_from, load_knowledge
from selector.store import Key, KnowledgeStore, Moments, RewardSums, StoredKnowledge, StoreError
from selector.store.contents import stored
from selector.store.exact_sums import COUNT_LIMIT
from tests.selector.store import strategies as some

NOW = datetime(2026, 11, 21, tzinfo=UTC)
few = settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture
def store(tmp_path):
    return KnowledgeStore(tmp_path / "k.sqlite")


def options(*given):
    return knowledge_from({"goals": {"G": [{"score": 1.0} | option for option in given]}}, "mine")


def test_totals_are_over_all_sources(store):
    batch = RewardSums("G", ["a", "b"])
    batch.record(np.array([0, 0, 1]), np.array([1.0, 3.0, -2.0]))
    store.add(batch, source="run-1")
    store.add(some.sums_of([5.0]), some.sums_of([9.0], "H"), source="run-2")
    store.add(some.sums_of([1.5], option="b"), source="run-2", context="far")
    assert {key: (sums.count, sums.mean, sums.variance) for key, sums in store.contents().totals().items()} == {
        ("G", "a", ""): (3, 3.0, 8.0 / 3.0),
        ("G", "b", ""): (1, -2.0, 0.0),
        ("G", "b", "far"): (1, 1.5, 0.0),
        ("H", "a", ""): (1, 9.0, 0.0),
    }


@few
@given(st.lists(some.rewards, min_size=1, max_size=5), st.randoms(use_true_random=False))
def test_the_order_of_updates_changes_no_bit(store, rewards, random):
    store.forget("run")
    for reward in random.sample(rewards, len(rewards)):
        store.add(some.sums_of([reward]), source="run")
    assert store.contents().learned[Key("G", "a", "", "run")].moments == some.moments_of(rewards)


def test_two_batches_of_a_goal_and_an_update_say_when_they_came(store):
    before = datetime.now(UTC)
    store.add(some.sums_of([1.0]), some.sums_of([2.0]), source="run")
    (first,) = store.contents().learned.values()
    store.add(some.sums_of([4.0]), source="run")
    (second,) = store.contents().learned.values()
    assert second.moments == some.moments_of([1.0, 2.0, 4.0])
    assert before <= first.updated < second.updated <= datetime.now(UTC)


@few
@given(some.contents)
def test_contents_come_back_as_they_went_in(tmp_path, contents):
    store = KnowledgeStore(tmp_path / f"{len(list(tmp_path.iterdir()))}.sqlite")
    for _ in range(2):  # what is there already counts once
        store.absorb(contents)
        assert store.contents() == contents


def test_expert_knowledge_is_kept_as_it_was_read(store):
    knowledge = load_knowledge("cleaning")
    changed = knowledge.with_scores({"AvoidCollision": {"RepulsionGradient-view1.5": 7.0}})
    store.introduce(knowledge)
    assert store.contents().knowledge("").table == knowledge.table
    store.introduce(changed)
    assert store.contents().knowledge("").table == knowledge.table
    store.absorb(stored(changed))
    assert store.contents().knowledge("").scores("AvoidCollision").tolist() == [1.0, 0.0, 7.0]


def test_scores_are_those_of_a_context(store):
    store.add(some.sums_of([1.0, 3.0]), source="run-1", context="far")
    store.add(some.sums_of([8.0]), source="run-2", context="far")
    store.add(some.sums_of([100.0]), some.sums_of([1.0], option="b"), source="run-1")
    known = options({"configuration": "A", "name": "a"}, {"configuration": "A", "name": "c"})
    (score,) = store.contents().scores(known, "far")["G"].items()
    assert (score[0], score[1].count, score[1].mean) == ("a", 3, 4.0)
    assert store.contents().scores(known, "nowhere") == {}


@pytest.mark.parametrize("other", [{"configuration": "B", "name": "A"}, {"configuration": "A", "parameters": {"v": 2}}])
def test_a_name_that_means_something_else_is_refused_and_nothing_changes(store, other):
    store.introduce(options({"configuration": "A"}))
    before, given = store.contents(), options({"configuration": "New"}, other)
    for use in (
        lambda: store.introduce(given),
        lambda: store.absorb(stored(given)),
        lambda: before.scores(given, ""),
    ):
        with pytest.raises(StoreError, match=r"goals\.G\.A: means A {} here and .* there; give one of them another"):
            use()
    assert store.contents() == before


def test_other_rewards_of_the_same_source_are_refused_and_nothing_changes(store, tmp_path):
    other = KnowledgeStore(tmp_path / "other.sqlite")
    store.add(some.sums_of([1.0, 2.0]), source="run")
    other.add(some.sums_of([1.0]), some.sums_of([1.0], "F"), source="run")
    before = store.contents()
    with pytest.raises(StoreError, match=r"goals\.G\.a: holds other rewards of the source 'run' already; reset it"):
        store.absorb(other.contents())
    assert store.contents() == before


def test_large_sums_are_exact_to_the_last_bit(store):
    count = COUNT_LIMIT - 1
    largest = Moments(count, -count * 2**44 + 1, count * 2**88 - 2**45 + 1)
    key, sums = Key("G", "a", "", "run"), some.sums_of([-(2.0**20)])
    store.absorb(StoredKnowledge({key: some.entry_of(key, largest, NOW)}))
    store.add(sums, source="run")
    full = largest + sums.moments["a"]
    assert store.contents().learned[key].moments == full
    with pytest.raises(StoreError, match=r"expected a count from 1 to 68719476736, got 68719476737"):
        store.add(sums, some.sums_of([1.0], option="b"), source="run")
    assert {key: entry.moments for key, entry in store.contents().learned.items()} == {key: full}


def test_what_one_source_told_is_forgotten(store):
    learned = {Key(g, o, c, s) for g in "GH" for o in "ab" for c in ("", "far") for s in "xy"}
    store.introduce(knowledge_from({"goals": {"G": [{"configuration": "a", "score": 1}]}}))
    store.absorb(StoredKnowledge({key: some.entry_of(key, Moments(1, 5, 25), NOW) for key in learned}))
    assert store.forget("x") == 8
    assert set(store.contents().entries) == {key for key in learned if key.source == "y"} | {Key("G", "a")}
    assert store.forget("nobody") == 0
    with pytest.raises(StoreError, match="expected the name of a source"):
        store.forget("")


@pytest.mark.parametrize("name", ["", "a\0b", "two\nlines", "x" * 121])
@pytest.mark.parametrize("what", ["goal", "option", "source", "context"])
def test_names_that_no_store_takes_are_refused_and_nothing_changes(store, what, name):
    given = {"goal": "G", "option": "a", "source": "run", "context": "far"} | {what: name}
    sums = some.sums_of([1.0], given.pop("goal"), given.pop("option"))
    if (what, name) == ("context", ""):
        store.add(sums, **given)
        return
    with pytest.raises(StoreError, match=rf"{what}: expected ") as error:
        store.add(some.sums_of([1.0]), sums, **given)
    assert "\n" not in str(error.value)
    assert store.contents() == StoredKnowledge()


def test_the_longest_names_fit_and_half_a_character_is_one_line(store):
    name = "𐀀" * 120
    store.add(some.sums_of([1.0], name, name), source=name, context=name)
    assert store.contents().totals()[name, name, name].count == 1
    with pytest.raises(StoreError, match=r"k\.sqlite: .*surrogates not allowed$"):
        store.add(some.sums_of([1.0]), source="\ud800")


@pytest.mark.parametrize("value", [{1: 2}, {1, 2}, (1,), float("nan")])
def test_parameters_that_cannot_be_kept_are_refused(store, value):
    with pytest.raises(StoreError, match=r"mine: goals\.G\.A: expert: parameters: expected text, numbers, lists and"):
        store.introduce(options({"configuration": "A", "parameters": {"x": value}}))


def test_a_forked_process_goes_on_with_a_store(store):
    store.add(some.sums_of([1.0]), source="run")
    child = os.fork()
    if child == 0:
        with suppress(BaseException):
            store.add(some.sums_of([2.0]), source="run")
        os._exit(0)
    os.waitpid(child, 0)
    store.add(some.sums_of([4.0]), source="run")
    assert store.contents().learned[Key("G", "a", "", "run")].moments == some.moments_of([1.0, 2.0, 4.0])
