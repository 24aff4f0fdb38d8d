"""Plays sequences of messages into a buffer, with all mechanisms looking on.

`python -m tests.selforg.gradients.fuzz` is a soak: it plays 10^5 random sequences of messages by default, stops at the
first crash or movement that is not finite, naming the seed of the sequence.
"""

import argparse
import sys

import numpy as np

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


def parts_of(name, buffer):
    """Return the arguments of a mechanism that are made of others."""
    return {key: one(buffer) for key, one in MECHANISMS.find(name).example.items() if callable(one)}


def play(rule, torus, whole_seconds, sequence, movements=MOVEMENTS):
    """Play (message, pause [s], pose) steps; return why messages were refused, and all movements (M, 2)."""
    space = Torus(11.0, 7.0) if torus else Euclidean(2)
    poses = OwnPoses(space, 1)
    settings = BufferSettings(aggregation={"DEFAULT": rule}, whole_seconds=whole_seconds)
    buffer = SoBuffer(settings, space, poses)
    looking = [MECHANISMS.create(name, buffer, **parts_of(name, buffer)) for name in movements]
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
            queries.chosen(choice, 0, now)
    return refused, np.array(vectors)


def random_sequence(rng):
    """Return steps in the manner of the hypothesis test, drawn faster."""
    odd = np.array([np.nan, np.inf, -np.inf, -1.0, 0.0, 1e-300, 1e300, 1e9, 1e10])

    def number(low, high):
        return float(rng.choice(odd)) if rng.random() < 0.08 else float(rng.uniform(low, high))

    steps = []
    for _ in range(rng.integers(1, 12)):
        message = {
            "channel": str(rng.choice(["f", "g", "robot", ""])), "position": (number(-5, 15), number(-5, 15)),
            "source": str(rng.choice(["a", "b", ""])), "attraction": int(rng.integers(-1, 2)),
            "diffusion": number(0, 5), "goal_radius": number(0, 1), "evaporation_factor": number(0, 1),
            "evaporation_period": number(0, 3), "moving": bool(rng.random() < 0.3),
            "heading": (number(-1, 1), number(-1, 1)),
        }  # fmt: skip
        if rng.random() < 0.3:
            message["stamp"] = number(-5, 20)
        steps.append((message, float(rng.uniform(-0.5, 2.0)), tuple(rng.uniform(-20, 20, 2))))
    return steps


def main():
    """Run the soak; return 1 at the first movement that is not finite."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sequences", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    tried, survived = 0, 0
    for index in rounds(options.sequences):
        rng = np.random.default_rng((options.seed, index))
        sequence, some = random_sequence(rng), rng.choice(MOVEMENTS, 4, replace=False).tolist()
        vectors = play(RULES[index % 6], bool(index & 1), bool(index & 2), sequence, some)[1]
        tried, survived = tried + 1, survived + bool(np.isfinite(vectors).all())
        if survived < tried:
            print(f"a movement is not finite: seed {options.seed}, sequence {index}, mechanisms {some}")
            break
    report(tried, survived)
    return int(survived < tried)


if __name__ == "__main__":
    sys.exit(main())
