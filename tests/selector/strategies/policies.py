"""Policies for tests: untrained networks of the right form."""

import numpy as np

from selector.strategies.policy_file import PolicySpec, TrainedPolicy, save_policy


def untrained(goal, options, observations, *, goals=None, hidden=(5, 4), activation="tanh", seed=0, **changes):
    """Return a policy with random weights, of one goal or of several `goals`."""
    generator = np.random.default_rng(seed)
    count = len(observations)
    spec = PolicySpec(
        goals=goals or ({goal: options} if options else {}),
        observations=observations,
        hidden=hidden,
        activation=activation,
        mean=tuple(generator.normal(size=count).tolist()),
        variance=tuple(generator.uniform(0.5, 2.0, size=count).tolist()),
        **changes,
    )
    weights = {}
    for name, inputs, outputs in spec.layers():
        weights[f"{name}.weight"] = generator.normal(size=(outputs, inputs)).astype(np.float32)
        weights[f"{name}.bias"] = generator.normal(size=outputs).astype(np.float32)
    return TrainedPolicy(spec, weights)


def exported(directory, goal, options, observations, **changes):
    """Write a policy with random weights and return it."""
    policy = untrained(goal, options, observations, **changes)
    save_policy(directory, policy)
    return policy
