"""What stores may hold, as hypothesis strategies."""

import numpy as np
from hypothesis import strategies as st

from selector.knowledge import Option
from selector.store.exact_sums import NO_REWARDS, REWARD_LIMIT, RewardSums
from selector.store.stored_knowledge import Key, LearnedEntry, Rated, StoredKnowledge

rewards = st.floats(-REWARD_LIMIT, REWARD_LIMIT)
short = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), min_size=1, max_size=8)
names = short | st.sampled_from(["1e-9", "no", "null", "12", "1.5", "-", "a b", "2026-11-21", "'", '"', "#", "{}", "é"])
times = st.integers(0, 4 * 10**15)


def moments_of(values):
    sums = RewardSums("G", ["a"])
    sums.record(np.zeros(len(values), dtype=np.int64), np.array(values))
    return sums.moments.get(("a", ""), NO_REWARDS)


moments = st.lists(rewards, min_size=1, max_size=5).map(moments_of)
keys = st.builds(Key, names, names, st.just("") | names, names)
scores = st.floats(-1e9, 1e9)
json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**20), 10**20)
    | st.floats(allow_nan=False, allow_infinity=False)
    | names,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=6,
)
options = st.builds(
    Option,
    configuration=names,
    name=names,
    score=scores,
    parameters=st.dictionaries(names, json_values, max_size=3),
)


@st.composite
def rated_table(draw, of=names):
    """Expert options by goal and name; what a name of `few` means is always the same."""
    table = {}
    for goal, name in draw(st.sets(st.tuples(of, of), max_size=4)):
        option = draw(options).model_copy(update={"name": name})
        if of is not names:
            option = option.model_copy(update={"configuration": f"of {name}", "parameters": {"goal": goal}})
        table[goal, name] = Rated(option, draw(st.integers(0, 9)), draw(names), draw(times))
    return table


def contents():
    """StoredKnowledge of a store."""
    return st.builds(
        StoredKnowledge, rated_table(), st.dictionaries(keys, st.builds(LearnedEntry, moments, times), max_size=5)
    )


def learned_so_far(keys_and_counts):
    """Learned entries by key: the first rewards of a source, which gives each option rewards of its own."""
    entries = {}
    for (option, source), count in keys_and_counts.items():
        rewards = np.random.default_rng([ord(option), ord(source)]).uniform(-1e6, 1e6, count).tolist()
        entries[Key("a", option, "", source)] = LearnedEntry(moments_of(rewards), count)
    return entries


letters = st.sampled_from("ab")
overlapping = st.builds(
    StoredKnowledge,
    rated_table(letters),
    st.dictionaries(st.tuples(letters, letters), st.integers(1, 5), max_size=4).map(learned_so_far),
)
"""Contents of stores that have much in common, of sources that some of them have heard for longer than others."""


@st.composite
def updates(draw, most=12):
    """Single updates: option, context and reward."""
    one = st.tuples(st.integers(0, 1), st.sampled_from(["", "far"]), rewards)
    return draw(st.lists(one, max_size=most))


def batch_of(some):
    batch = RewardSums("Avoid", ["near", "far"])
    for option, context, reward in some:
        batch.record(np.array([option]), np.array([reward]), context)
    return batch
