"""Networks of actors and critics that see different parts of an observation and draw vectors, too; their export."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.distributions import CategoricalDistribution, DiagGaussianDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.torch_layers import MlpExtractor
from stable_baselines3.common.vec_env import VecNormalize

from selector.strategies.policy_file import PolicySpec, TrainedPolicy
from selector.strategies.problem import Problem


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
    weights = [name for name in state if name.startswith(path) and name.endswith("weight")]
    layers = []
    for k, name in enumerate(weights):
        layers += [(f"hidden.{k}.weight", state[name]), (f"hidden.{k}.bias", state[name.replace("weight", "bias")])]
    for part in ("weight", "bias"):
        outputs = state[f"action_net.{part}"]
        heads = {"options": outputs[:options], "vector": outputs[options:]}
        layers += [(f"{name}.{part}", each) for name, each in heads.items() if len(each)]
    return layers
