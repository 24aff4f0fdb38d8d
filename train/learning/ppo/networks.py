"""Networks of actors and critics that see different parts of an observation and draw vectors, too; their export."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Box
from stable_baselines3 import PPO
from stable_baselines3.common.distributions import DiagGaussianDistribution, MultiCategoricalDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.torch_layers import MlpExtractor
from stable_baselines3.common.vec_env import VecNormalize

from selector.strategies.policy_file import PolicySpec, TrainedPolicy

UNABLE = -1e9
"""Output of an option that cannot be taken."""


class RobotPolicy(ActorCriticPolicy):
    """An actor that sees the first `own` components of an observation, and a critic that sees all of them.

    If there are more, this is the agent-specific global state of MAPPO (Yu et al. 2022, doi:10.48550/arXiv.2103.01955).
    The last components say which options can be taken. Actions are an option of each goal, a vector, or both.

    Args:
        own: F, components that the actor sees.
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
        if self._counts:
            options = OptionOfEachGoal(list(self._counts))
            both = isinstance(self.action_space, Box)
            self.action_dist = OptionsAndVector(options) if both else options
        super()._build(lr_schedule)
        with torch.no_grad():
            for option, output in self._start.items():
                self.action_net.linear.bias[option] += output

    def _build_mlp_extractor(self) -> None:
        super()._build_mlp_extractor()
        layers = (self.net_arch, self.activation_fn, self.device)
        self.mlp_extractor = ActorLayers(self._own, sum(self._counts), self.features_dim, *layers)


class ActorLayers(MlpExtractor):
    """Hidden layers of an actor, which get the first `own` features, and of a critic, which get all.

    Behind the last hidden values of the actor are the last `options` features, which say what can be taken.
    """

    def __init__(self, own: int, options: int, features: int, *layers: Any) -> None:  # noqa: ANN401
        super().__init__(features, *layers)
        actor = MlpExtractor(own, *layers)
        self._own, self._masks = own, features - options
        self.policy_net, self.latent_dim_pi = actor.policy_net, actor.latent_dim_pi + options

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """Return the last hidden values of the actor, and what can be taken."""
        hidden = super().forward_actor(features[:, : self._own])
        return torch.hstack((hidden, features[:, self._masks :]))


class MaskedLayer(torch.nn.Module):
    """A linear layer whose first outputs are those of options; they are UNABLE where an option cannot be taken.

    Its inputs end with a flag for each option.
    """

    def __init__(self, inputs: int, options: int, further: int = 0) -> None:
        super().__init__()
        self._options, self.linear = options, torch.nn.Linear(inputs - options, options + further)

    def forward(self, inputs: torch.Tensor) -> torch.Tensor:
        """Return the outputs."""
        hidden, able = inputs[:, : -self._options], inputs[:, -self._options :]
        outputs = self.linear(hidden)
        options = torch.where(able > 0.0, outputs[:, : self._options], UNABLE)
        return torch.hstack((options, outputs[:, self._options :]))


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


class OptionsAndVector(DiagGaussianDistribution):
    """The numbers of an option of each goal and a vector of two, drawn independently, in a row (R, G + 2)."""

    def __init__(self, options: OptionOfEachGoal) -> None:
        super().__init__(2)
        self._options = options

    @property
    def parts(self) -> torch.Tensor:
        """See `OptionOfEachGoal`."""
        return self._options.parts

    def proba_distribution_net(self, latent_dim: int, log_std_init: float = 0.0) -> tuple[Any, Any]:
        """Return the last layer, whose outputs are those of the options and then the vector, and the deviations."""
        _, deviation = super().proba_distribution_net(latent_dim, log_std_init)
        return MaskedLayer(latent_dim, sum(self._options.action_dims), 2), deviation

    def proba_distribution(self, outputs: torch.Tensor, log_std: torch.Tensor) -> OptionsAndVector:
        """Take the outputs (R, O + 2) of the last layer."""
        self._options.proba_distribution(outputs[:, :-2])
        super().proba_distribution(outputs[:, -2:], log_std)
        return self

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Return the logarithms (R,) of the probability densities of actions (R, G + 2)."""
        return self._options.log_prob(actions[:, :-2]) + super().log_prob(actions[:, -2:])

    def entropy(self) -> torch.Tensor:
        """Return the entropies (R,)."""
        return self._options.entropy() + super().entropy()

    def sample(self) -> torch.Tensor:
        """Return drawn actions (R, G + 2)."""
        return torch.column_stack((self._options.sample(), super().sample()))

    def mode(self) -> torch.Tensor:
        """Return the likeliest actions (R, G + 2)."""
        return torch.column_stack((self._options.mode(), super().mode()))


def exported(
    model: PPO,
    normal: VecNormalize,
    observations: tuple[str, ...],
    goals: dict[str, tuple[str, ...]],
    **about: Any,  # noqa: ANN401
) -> TrainedPolicy:
    """Return the network of `model` as a policy; `about` is the rest of its specification.

    The policy sees the components `observations`, which come first in what `normal` gives.
    """
    statistics = normal.obs_rms
    assert isinstance(statistics, RunningMeanStd)
    own, options = len(observations), sum(map(len, goals.values()))
    state = {name: np.array(tensor.detach().numpy(), dtype=np.float32) for name, tensor in _layers(model, options)}
    spec = PolicySpec(
        goals=goals,
        vector="vector.bias" in state,
        observations=observations,
        hidden=tuple(array.shape[0] for name, array in state.items() if name.startswith("hidden.") and array.ndim == 1),
        activation="tanh",
        mean=tuple(float(value) for value in statistics.mean[:own]),
        variance=tuple(float(value) for value in statistics.var[:own]),
        epsilon=float(normal.epsilon),
        clip=float(normal.clip_obs),
        **about,
    )
    return TrainedPolicy(spec, state)


def _layers(model: PPO, options: int) -> list[tuple[str, Any]]:
    """Return the arrays of the layers of the policy, with their names in a policy file.

    The first `options` outputs are those of the options, the others those of a vector.
    """
    state = model.policy.state_dict()
    path, last = "mlp_extractor.policy_net.", "action_net.linear." if options else "action_net."
    weights = [name for name in state if name.startswith(path) and name.endswith("weight")]
    layers = []
    for k, name in enumerate(weights):
        layers += [(f"hidden.{k}.weight", state[name]), (f"hidden.{k}.bias", state[name.replace("weight", "bias")])]
    for part in ("weight", "bias"):
        outputs = state[f"{last}{part}"]
        heads = {"options": outputs[:options], "vector": outputs[options:]}
        layers += [(f"{name}.{part}", each) for name, each in heads.items() if len(each)]
    return layers
