"""Plays sequences of messages into a buffer, with all mechanisms looking on.

`python -m tests.selforg.gradients.fuzz [SEQUENCES]` is a soak: it plays 10^5 random sequences by default, and stops at
the first crash or movement that is not finite, with the smallest sequence that Hypothesis finds.
"""

import sys

import numpy as np
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from selforg.components.sources import GoalSource
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, MovementMechanism
from selforg.space import Euclidean, Torus
from tests.soaking import report, rounds

FIELDS = (
    "position", "heading", "attraction", "diffusion", "goal_radius", "evaporation_factor", "evaporation_period",
    "stamp", "clock", "source", "payload", "channel",
)  # fmt: skip
MOVEMENTS = [n for n in MECHANISMS.names() if issubclass(MECHANISMS.find(n), MovementMechanism)]
RULES = ("max", "min", "average", "new", "newparent", "newframe")

EACH = 100
"""Sequences of a round of the soak, which has a seed of its own."""

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
SEQUENCES = st.sampled_from(RULES), st.booleans(), st.booleans(), st.lists(steps, max_size=12)
"""Rule of aggregation, whether the space is a torus, whether seconds are whole, and the messages."""


def parts_of(name, buffer):
    """Return the arguments of a mechanism that are made of others."""
    return {key: one(buffer) for key, one in MECHANISMS.find(name).example.items() if callable(one)}


def play(rule, torus, whole_seconds, sequence):
    """Play (message, pause [s], pose) steps; return why messages were refused, and all movements (M, 2)."""
    space = Torus(11.0, 7.0) if torus else Euclidean(2)
    poses = OwnPoses(space, 1)
    settings = BufferSettings(aggregation={"DEFAULT": rule}, whole_seconds=whole_seconds)
    buffer = SoBuffer(settings, space, poses)
    looking = [MECHANISMS.find(name)(buffer, **parts_of(name, buffer)) for name in MOVEMENTS]
    queries, now, refused, vectors = Queries(buffer), 0.0, [], [np.zeros(2)]
    for message, pause, pose in sequence:
        now += pause  # negative too: clocks do run backwards
        try:
            buffer.receive(Gradient(**{"channel": "f", "position": (1.0, 1.0), "stamp": now, **message}), now, row=0)
        except ValueError as error:
            refused.append(str(error))
        poses.update(np.array([pose]), np.array([pause]), now)
        vectors += [mechanism.move(now)[0][0].copy() for mechanism in looking]
        queries.gradients(0, now, Filter(view_distance=np.inf))
        for choice in ("nearest_attractive", "farthest_attractive", "most_reach_attractive", "strongest"):
            GoalSource(buffer, choice).ask(now, np.arange(1))
    return refused, np.array(vectors)


def check(rule, torus, whole_seconds, sequence):
    """AssertionError unless all messages are stored or refused by the name of a field, and movements are finite."""
    refused, vectors = play(rule, torus, whole_seconds, sequence)
    assert all(any(name in reason for name in FIELDS) for reason in refused)
    assert np.isfinite(vectors).all()


def main(sequences="100_000"):
    """Run the soak; the first sequence that fails raises its error, the smallest that Hypothesis finds."""
    tried, slow = 0, [HealthCheck.too_slow]
    limits = settings(max_examples=EACH, deadline=None, database=None, suppress_health_check=slow)
    for number in rounds(-(-int(sequences) // EACH)):
        seed(number)(limits(given(*SEQUENCES)(check)))()
        tried += EACH
    report(tried, tried)


if __name__ == "__main__":
    main(*sys.argv[1:])
