"""Networks of actors and critics that see different parts of an observation, and draw options and vectors."""

from __future__ import annotations

from typing import Any

import torch
from stable_baselines3.common.distributions import CategoricalDistribution, DiagGaussianDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import MlpExtractor


class RobotPolicy(ActorCriticPolicy):
    """An actor that sees the first `own` components of an observation, and a critic that sees all of them.

    If there are more, this is the agent-specific global state of MAPPO (Yu et al. 2022, doi:10.48550/arXiv.2103.01955).
    Actions are those of the action space, or one of `options` options together with a vector.
    """

    def __init__(self, *args: Any, own: int, options: int, **settings: Any) -> None:  # noqa: ANN401  (of the base class)
        self._own, self._options = own, options
        super().__init__(*args, **settings)

    def _build(self, lr_schedule: Any) -> None:  # noqa: ANN401
        if self._options:
            self.action_dist = OptionAndVector(self._options)
        super()._build(lr_schedule)

    def _build_mlp_extractor(self) -> None:
        super()._build_mlp_extractor()
        if self._own < self.features_dim:
            layers = (self.net_arch, self.activation_fn, self.device)
            self.mlp_extractor = TeamLayers(self._own, self.features_dim, *layers)


class TeamLayers(MlpExtractor):
    """Hidden layers of an actor, which get the first `own` features, and of a critic, which get all."""

    def __init__(self, own: int, *layers: Any) -> None:  # noqa: ANN401  (arguments of the base class)
        super().__init__(*layers)
        actor = MlpExtractor(own, *layers[1:])
        self._own, self.policy_net, self.latent_dim_pi = own, actor.policy_net, actor.latent_dim_pi

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """Return the last hidden values of the actor."""
        return super().forward_actor(features[:, : self._own])


class OptionAndVector(DiagGaussianDistribution):
    """The number of an option and a vector of two, drawn independently, in a row (R, 3)."""

    def __init__(self, options: int) -> None:
        super().__init__(2)
        self._option = CategoricalDistribution(options)

    def proba_distribution_net(self, latent_dim: int, log_std_init: float = 0.0) -> tuple[Any, Any]:
        """Return the last layer, whose outputs are those of the options and then the vector, and the deviations."""
        _, deviation = super().proba_distribution_net(latent_dim, log_std_init)
        return torch.nn.Linear(latent_dim, self._option.action_dim + 2), deviation

    def proba_distribution(self, outputs: torch.Tensor, log_std: torch.Tensor) -> OptionAndVector:
        """Take the outputs (R, O + 2) of the last layer."""
        self._option.proba_distribution(outputs[:, :-2])
        super().proba_distribution(outputs[:, -2:], log_std)
        return self

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Return the logarithms (R,) of the probability densities of actions (R, 3)."""
        return self._option.log_prob(actions[:, 0]) + super().log_prob(actions[:, 1:])

    def entropy(self) -> torch.Tensor:
        """Return the entropies (R,)."""
        return self._option.entropy() + super().entropy()

    def sample(self) -> torch.Tensor:
        """Return drawn actions (R, 3)."""
        return torch.column_stack((self._option.sample(), super().sample()))

    def mode(self) -> torch.Tensor:
        """Return the likeliest actions (R, 3)."""
        return torch.column_stack((self._option.mode(), super().mode()))
