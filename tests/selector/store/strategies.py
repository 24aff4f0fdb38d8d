"""What stores may hold, as hypothesis strategies."""

from datetime import UTC

import numpy as np
from hypothesis import strategies as st

from selector.store import Key, StoredKnowledge
from selector.store.contents import Entry
from selector.store.exact_sums import NO_REWARDS, REWARD_LIMIT, RewardSums

rewards = st.floats(-REWARD_LIMIT, REWARD_LIMIT)
short = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), min_size=1, max_size=8)
names = short | st.sampled_from(["1e-9", "no", "null", "12", "1.5", "-", "a b", "2026-11-21", "'", '"', "#", "{}", "é"])
times = st.datetimes(timezones=st.just(UTC))
json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**20), 10**20)
    | st.floats(allow_nan=False, allow_infinity=False)
    | names,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=6,
)


def sums_of(values, goal="G", option="a"):
    sums = RewardSums(goal, [option])
    sums.record(np.zeros(len(values), dtype=np.int64), np.array(values))
    return sums


def moments_of(values):
    return sums_of(values).moments.get("a", NO_REWARDS)


def entry_of(key, moments, updated):
    sums = {"count": moments.count, "total": str(moments.total), "squares": str(moments.squares)}
    return Entry(**key._asdict(), **sums, updated=updated)


moments = st.lists(rewards, min_size=1, max_size=5).map(moments_of)
learned = st.builds(entry_of, st.builds(Key, names, names, st.just("") | names, names), moments, times)
opinions = st.fixed_dictionaries(
    {
        "position": st.integers(0, 9),
        "configuration": names,
        "score": st.floats(-1e9, 1e9),
        "parameters": st.dictionaries(names, json_values, max_size=3),
    }
)
rated = st.builds(Entry, goal=names, option=names, expert=opinions, updated=times)
contents = st.lists(learned | rated, max_size=6).map(lambda few: StoredKnowledge({entry.key: entry for entry in few}))
"""StoredKnowledge of a store."""
