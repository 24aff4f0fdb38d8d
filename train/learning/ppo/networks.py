"""Networks of actors that take an option of each goal, and of critics; their export."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.distributions import MultiCategoricalDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.torch_layers import MlpExtractor
from stable_baselines3.common.vec_env import VecNormalize

from selector.strategies.policy_file import PolicySpec, TrainedPolicy

UNABLE = -1e9
"""Output of an option that cannot be taken."""


class RobotPolicy(ActorCriticPolicy):
    """An actor and a critic of robots whose actions are an option of each goal.

    The actor sees the first `own` components of what they see, the critic all. The last ones say which options can be
    taken: the actor uses them behind its hidden layers.

    Args:
        own: F, components of a robot's observation.
        counts: (G,) number of options of each goal.
        start: number of an option, counted over all goals -> its output at the beginning.
        args, settings: see the base class.

    """

    def __init__(
        self,
        *args: Any,  # noqa: ANN401  (of the base class)
        own: int,
        counts: tuple[int, ...],
        start: Mapping[int, float] = MappingProxyType({}),
        **settings: Any,  # noqa: ANN401
    ) -> None:
        self._own, self._counts, self._start = own, counts, start
        super().__init__(*args, **settings)

    def _build(self, lr_schedule: Any) -> None:  # noqa: ANN401
        self.action_dist = OptionOfEachGoal(list(self._counts))
        super()._build(lr_schedule)
        with torch.no_grad():
            for option, output in self._start.items():
                self.action_net.linear.bias[option] += output

    def _build_mlp_extractor(self) -> None:
        super()._build_mlp_extractor()
        layers = (self.net_arch, self.activation_fn, self.device)
        self.mlp_extractor = ActorLayers(self._own, sum(self._counts), self.features_dim, *layers)


class ActorLayers(MlpExtractor):
    """Hidden layers of an actor, which gets the first `own` features, and of a critic, which gets all.

    The last `options` features, which say what can be taken, are behind the last hidden values of the actor.
    """

    def __init__(self, own: int, options: int, features: int, *layers: Any) -> None:  # noqa: ANN401
        super().__init__(features, *layers)
        self._own, self._masks = own, features - options
        actor = MlpExtractor(own, *layers)
        self.policy_net, self.latent_dim_pi = actor.policy_net, actor.latent_dim_pi + options

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """Return the last hidden values of the actor, and what can be taken."""
        hidden = super().forward_actor(features[:, : self._own])
        return torch.hstack((hidden, features[:, self._masks :]))


class MaskedLayer(torch.nn.Module):
    """A linear layer whose outputs are those of options; they are UNABLE where an option cannot be taken.

    Its inputs end with a flag for each option.
    """

    def __init__(self, inputs: int, options: int) -> None:
        super().__init__()
        self._options, self.linear = options, torch.nn.Linear(inputs - options, options)

    def forward(self, inputs: torch.Tensor) -> torch.Tensor:
        """Return the outputs."""
        hidden, able = inputs[:, : -self._options], inputs[:, -self._options :]
        return torch.where(able > 0.0, self.linear(hidden), UNABLE)


class OptionOfEachGoal(MultiCategoricalDistribution):
    """The numbers (R, G) of an option of each goal, drawn independently.

    Attributes:
        parts: (R, G) logarithms of probabilities of the actions that were asked for last.

    """

    parts: torch.Tensor

    def proba_distribution_net(self, latent_dim: int) -> torch.nn.Module:
        """Return the last layer."""
        return MaskedLayer(latent_dim, sum(self.action_dims))

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Return the logarithms (R,) of the probabilities of actions (R, G)."""
        drawn = zip(self.distribution, actions.unbind(dim=1), strict=True)
        self.parts = torch.stack([option.log_prob(number) for option, number in drawn], dim=1)
        return self.parts.sum(dim=1)


def exported(
    model: PPO,
    normal: VecNormalize,
    observations: tuple[str, ...],
    goals: dict[str, tuple[str, ...]],
    **about: Any,  # noqa: ANN401
) -> TrainedPolicy:
    """Return the network of `model` as a policy; `about` is the rest of its specification.

    The policy sees the components `observations`, the first of those that `normal` gives.
    """
    statistics = normal.obs_rms
    assert isinstance(statistics, RunningMeanStd)
    state = {name: np.array(tensor.detach().numpy(), dtype=np.float32) for name, tensor in actor_layers(model)}
    spec = PolicySpec(
        goals=goals,
        observations=observations,
        hidden=tuple(array.shape[0] for name, array in state.items() if name.startswith("hidden.") and array.ndim == 1),
        activation="tanh",
        mean=tuple(float(value) for value in statistics.mean[: len(observations)]),
        variance=tuple(float(value) for value in statistics.var[: len(observations)]),
        epsilon=float(normal.epsilon),
        clip=float(normal.clip_obs),
        **about,
    )
    return TrainedPolicy(spec, state)


def actor_layers(model: PPO) -> list[tuple[str, Any]]:
    """Return the arrays of the layers of the policy, with their names in a policy file."""
    state, path = model.policy.state_dict(), "mlp_extractor.policy_net."
    weights = [name for name in state if name.startswith(path) and name.endswith("weight")]
    parts = ("weight", "bias")
    last = [(f"options.{part}", state[f"action_net.linear.{part}"]) for part in parts]
    named = [(f"hidden.{k}", name) for k, name in enumerate(weights)]
    return [(f"{layer}.{part}", state[name.replace("weight", part)]) for layer, name in named for part in parts] + last
