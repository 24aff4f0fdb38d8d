"""Export of a network of Stable-Baselines3 as a policy, with the statistics of normalisation."""

from __future__ import annotations

from typing import Any

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecNormalize

from selector.strategies.policy_file import PolicySpec, TrainedPolicy
from selector.strategies.problem import Problem


def exported(model: PPO, normal: VecNormalize, problem: Problem, training: dict[str, Any]) -> TrainedPolicy:
    """Return the network of `model` as a policy for a problem; `training` describes the training.

    The policy sees the features of the problem, which come first in what `normal` gives.
    """
    statistics = normal.obs_rms
    assert isinstance(statistics, RunningMeanStd)
    own = len(problem.features)
    options = () if model.action_space.shape == (2,) else problem.options
    state = {name: np.array(tensor.detach().numpy(), dtype=np.float32) for name, tensor in _layers(model, len(options))}
    hidden = tuple(array.shape[0] for name, array in state.items() if name.startswith("hidden.") and array.ndim == 1)
    spec = PolicySpec(
        goal=problem.goal,
        options=options,
        vector="vector.bias" in state,
        observations=problem.features,
        hidden=hidden,
        activation="tanh",
        mean=tuple(float(value) for value in statistics.mean[:own]),
        variance=tuple(float(value) for value in statistics.var[:own]),
        epsilon=float(normal.epsilon),
        clip=float(normal.clip_obs),
        training=training,
    )
    return TrainedPolicy(spec, state)


def _layers(model: PPO, options: int) -> list[tuple[str, Any]]:
    """Return the arrays of the layers of the policy, with their names in a policy file.

    The first `options` outputs are those of the options, the others those of a vector.
    """
    state = model.policy.state_dict()
    path = "mlp_extractor.policy_net."
    names = [name for name in state if name.startswith(path) and name.endswith("weight")]
    weights = sorted((int(name.removeprefix(path).split(".")[0]), name) for name in names)
    layers = []
    for k, (_, name) in enumerate(weights):
        layers += [(f"hidden.{k}.weight", state[name]), (f"hidden.{k}.bias", state[name.replace("weight", "bias")])]
    for part in ("weight", "bias"):
        outputs = state[f"action_net.{part}"]
        heads = {"options": outputs[:options], "vector": outputs[options:]}
        layers += [(f"{name}.{part}", each) for name, each in heads.items() if len(each)]
    return layers
