"""Networks of an actor and a critic that see different parts of an observation."""

from __future__ import annotations

from typing import Any

import torch
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import MlpExtractor


class TeamPolicy(ActorCriticPolicy):
    """An actor that sees the first `own` components of an observation, and a critic that sees all of them.

    This is the agent-specific global state of MAPPO (Yu et al. 2022, doi:10.48550/arXiv.2103.01955).
    """

    def __init__(self, *args: Any, own: int, **settings: Any) -> None:  # noqa: ANN401  (those of the base class)
        self._own = own
        super().__init__(*args, **settings)

    def _build_mlp_extractor(self) -> None:
        self.mlp_extractor = TeamLayers(self._own, self.features_dim, self.net_arch, self.activation_fn, self.device)


class TeamLayers(MlpExtractor):
    """Hidden layers of an actor, which get the first `own` features, and of a critic, which get all."""

    def __init__(self, own: int, *layers: Any) -> None:  # noqa: ANN401  (arguments of the base class)
        super().__init__(*layers)
        actor = MlpExtractor(own, *layers[1:])
        self._own, self.policy_net, self.latent_dim_pi = own, actor.policy_net, actor.latent_dim_pi

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """Return the last hidden values of the actor."""
        return super().forward_actor(features[:, : self._own])
