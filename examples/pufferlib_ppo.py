"""PPO of PufferLib: each robot is an agent, and the trainer reads the batch's own array of observations.

pip install -c constraints.txt gym==0.26.2 psutil==7.2.2 pyro-ppl==1.9.2 rich-argparse==1.8.0 torch setuptools .
NO_OCEAN=1 pip install --no-deps --no-build-isolation pufferlib==3.0.0  # docs/environment.md#pufferlib
python examples/pufferlib_ppo.py --updates 40
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:pufferlib_ppo.pt --scenarios 10
"""

import argparse
import sys

import numpy as np
import pufferlib
import torch
from ppo_one_file import CLIP, DISCOUNT, ENTROPY, EPOCHS, MINIBATCH, RATE, STEPS, TRACE, network
from pufferlib.pufferl import PuffeRL, load_config
from torch import nn

from clean_swarm_env.borders.spaces import action_space, observation_space
from clean_swarm_env.learning.batch import Batch

SAME = {"update_epochs": EPOCHS, "minibatch_size": MINIBATCH, "bptt_horizon": STEPS, "gamma": DISCOUNT}
SAME |= {"gae_lambda": TRACE, "clip_coef": CLIP, "ent_coef": ENTROPY, "learning_rate": RATE, "max_grad_norm": 0.5}
PLAIN = {"optimizer": "adam", "adam_beta1": 0.9, "adam_eps": 1e-8, "anneal_lr": False, "vf_coef": 1.0}
PLAIN |= {"prio_alpha": 0.0, "device": "cpu", "env": "robots"}  # all parts of a rollout are equally likely


class Robots(pufferlib.PufferEnv):
    """The rows of a batch as agents."""

    def __init__(self, batch: Batch) -> None:
        self.batch, self.num_agents = batch, batch.rows
        self.single_observation_space = observation_space(batch)
        self.single_action_space = action_space(batch)
        super().__init__()
        self.observations = batch.observations

    def reset(self, seed: int = 0) -> tuple[object, ...]:
        """Begin an episode in every world."""
        return self.batch.reset(seed), []

    def step(self, actions: np.ndarray) -> tuple[object, ...]:
        """Run one decision period; the trainer knows one kind of end."""
        step = self.batch.step(actions)
        self.rewards[:], self.masks[:] = step.rewards, self.batch.took_part
        self.terminals[:] = np.repeat(step.terminated | step.truncated, self.batch.robots)
        told = [{"excess_s": end.result.excess_s} for end in self.batch.finished]
        return self.observations, self.rewards, self.terminals, self.truncations, told


class ActorCritic(nn.ModuleDict):
    """What PufferLib's trainer calls: logits (R, O) of the options, and values (R, 1)."""

    def forward(self, seen: torch.Tensor, state: object = None) -> tuple[torch.Tensor, torch.Tensor]:  # noqa: D102
        return self["actor"](seen), self["critic"](seen)

    forward_eval = forward


def main() -> None:
    """Train and save the actor as TorchScript; PufferLib leaves its own files in `experiments`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--updates", type=int, default=40)
    parser.add_argument("--worlds", type=int, default=16)
    given = parser.parse_args()
    sys.argv[1:] = []  # load_config reads them, too
    torch.manual_seed(1)
    robots = Robots(Batch(worlds=given.worlds, family="table1-starts"))
    width, options = robots.observations.shape[1], int(robots.single_action_space.n)
    policy = ActorCritic({"actor": network(width, options), "critic": network(width, 1)})
    settings = SAME | PLAIN | {"total_timesteps": given.updates * STEPS * robots.num_agents}
    trainer = PuffeRL(load_config("default")["train"] | settings, robots, policy)
    for _ in range(given.updates):
        trainer.evaluate()
        trainer.train()
    trainer.utilization.stop()
    torch.jit.script(policy["actor"]).save("pufferlib_ppo.pt")


if __name__ == "__main__":
    main()
