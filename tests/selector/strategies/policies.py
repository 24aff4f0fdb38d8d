"""Policies for tests: untrained networks of the right form."""

import numpy as np

from selector.knowledge import Definition, library_options
from selector.strategies.policy_file import PolicySpec, TrainedPolicy, save_policy


def untrained(goal, options, observations, *, goals=None, hidden=(5, 4), activation="tanh", seed=0, **changes):
    """Return a policy with random weights, of one goal or of several `goals`."""
    generator = np.random.default_rng(seed)
    count = len(observations)
    goals = goals or ({goal: options} if options else {})
    spec = PolicySpec(
        goals=goals,
        definitions=definitions_of(goals),
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


def definitions_of(goals):
    """Return what the library says of options, of several goals joined by `+` as well, or that they stand for A."""
    found = {}
    for joint, options in goals.items():
        for k, goal in enumerate(joint.split("+")):
            known = {option.name: option for option in library_options(goal)}
            for name in (option.split("+")[k] for option in options):
                found.setdefault(goal, {})[name] = known.get(name, Definition(configuration="A"))
    return found


def exported(directory, goal, options, observations, **changes):
    """Write a policy with random weights and return it."""
    policy = untrained(goal, options, observations, **changes)
    save_policy(directory, policy)
    return policy
