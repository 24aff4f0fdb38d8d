"""Random messages, possible and impossible: stored by the rules or refused with the field's name, never a crash."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.selforg.gradients.fuzz import FIELDS, play

any_float = st.one_of(st.floats(), st.sampled_from([0.0, 0.5, 1.0, -1.0, 2.0, 1e8, 1e-7]))
payloads = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3) | st.dates(),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)
messages = st.fixed_dictionaries(
    {},
    optional={
        "channel": st.text(max_size=3),
        "position": st.tuples(any_float, any_float),
        "source": st.one_of(st.integers(-1, 5), st.text(max_size=3)),
        "heading": st.one_of(st.just(()), st.tuples(any_float, any_float)),
        "attraction": st.sampled_from([-1, 0, 1, 2, 0.5]),
        "diffusion": any_float,
        "goal_radius": any_float,
        "evaporation_factor": any_float,
        "evaporation_period": any_float,
        "stamp": any_float,
        "clock": st.one_of(st.none(), any_float),
        "moving": st.booleans(),
        "payload": st.dictionaries(st.text(max_size=3), payloads, max_size=2),
    },
)
steps = st.tuples(messages, st.floats(-1.0, 3.0), st.tuples(st.floats(-20, 20), st.floats(-20, 20)))


@settings(max_examples=300)
@given(st.sampled_from(["max", "min", "average", "new", "newparent", "newframe"]), st.booleans(), st.booleans(),
       st.lists(steps, max_size=12))  # fmt: skip
@example("max", False, False, [({}, 0.0, (0.0, 0.0)), ({}, 5e-324, (0.0, 1.0))])  # a metre in next to no time
def test_any_sequence_is_stored_or_refused_by_name(rule, torus, whole_seconds, sequence):
    refused, vectors = play(rule, torus, whole_seconds, sequence)
    assert all(any(name in reason for name in FIELDS) for reason in refused)
    assert np.isfinite(vectors).all()
