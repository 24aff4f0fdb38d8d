"""PPO of RLlib with masks and an open team: robots join and are gone, all share one policy.

pip install -c constraints.txt 'ray[rllib]==2.60.0' torch .
python examples/rllib_ppo.py --iterations 20
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:rllib_ppo.pt --scenarios 10
"""

import argparse

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module import MultiRLModuleSpec, RLModuleSpec
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule
from ray.tune.registry import register_env
from robot_policy import save
from torch import Tensor, nn

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import AllRobots, MaskedObservations

EVENTS = [{"at": 30.0, "do": "fail", "robots": [1]}, {"at": 60.0, "do": "join", "robots": 2}]
MISSION = {"base": "table1", "time_limit": 200.0, "events": EVENTS}
SERVES = {"RepulsionFernandez-view2.0": ["patrol", "approach"]}


def make(_: object = None) -> ParallelPettingZooEnv:
    """Return the environment with masks in its observations."""
    swarm = clean_swarm_v0.parallel_env(MISSION, knowledge="avoidance", action={"serves": SERVES})
    return ParallelPettingZooEnv(MaskedObservations(AllRobots(swarm), key="observations"))


def options_of(network: nn.Module, seen: Tensor) -> Tensor:
    """Return the logits of the options from observations without masks."""
    logits: Tensor = network.pi(network.encoder({"obs": seen})["encoder_out"]["actor"])
    return logits


def main() -> None:
    """Train and print the mean return of each iteration."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--iterations", type=int, default=20)
    iterations = parser.parse_args().iterations
    register_env("clean_swarm", make)
    module = RLModuleSpec(module_class=ActionMaskingTorchRLModule, model_config={"fcnet_hiddens": [64, 64]})
    config = (
        PPOConfig()
        .environment("clean_swarm")
        .env_runners(num_env_runners=0)
        .training(train_batch_size=1000, minibatch_size=250, num_epochs=4, gamma=0.98)
        .multi_agent(policies={"robot"}, policy_mapping_fn=lambda *_, **__: "robot")
        .rl_module(rl_module_spec=MultiRLModuleSpec(rl_module_specs={"robot": module}))
    )
    algorithm = config.build_algo()
    for _ in range(iterations):
        result = algorithm.train()["env_runners"]
        print(f"return of a team {result.get('episode_return_mean', float('nan')):.2f}")
    width = make().par_env.observation_space("robot_0")["observations"].shape[0] - 1
    save(algorithm.get_module("robot"), width, "rllib_ppo.pt", options_of)
    algorithm.stop()


if __name__ == "__main__":
    main()
