"""MAPPO with TorchRL: robots share an actor, one critic sees the global state and values each robot.

pip install -c constraints.txt torchrl==0.14.1 .
python examples/torchrl_mappo.py --frames 60000
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:torchrl_mappo.pt --scenarios 10
"""

import argparse

import torch
from robot_policy import save
from tensordict.nn import TensorDictModule
from torchrl.collectors import Collector
from torchrl.envs import PettingZooWrapper
from torchrl.modules import MLP, MaskedCategorical, ProbabilisticActor
from torchrl.objectives import ClipPPOLoss

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import AllRobots

EPOCHS, PARTS = 4, 4
KEYS = {"action": ("robot", "action"), "reward": ("robot", "reward"), "done": ("robot", "done")}
SERVES = {"RepulsionFernandez-view2.0": ["patrol", "approach"]}


def make() -> PettingZooWrapper:
    """Return missions of 100 s with masks, a global state, and all robots in every step."""
    mission = {"base": "table1", "task": {"garbage": {"count": 4}}, "time_limit": 100.0}
    env = AllRobots(clean_swarm_v0.parallel_env(mission, knowledge="avoidance", action={"serves": SERVES}))
    return PettingZooWrapper(
        env, use_mask=False, return_state=True, categorical_actions=True, done_on_any=False, seed=1
    )


def main() -> None:
    """Train and print the mean reward of each batch."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=60_000)
    parser.add_argument("--batch", type=int, default=1000)
    given = parser.parse_args()
    torch.manual_seed(1)
    env = make()
    robots, width = env.observation_spec["robot", "observation"].shape
    options = int(env.full_action_spec["robot", "action"].space.n)
    seen, mask = ("robot", "observation"), ("robot", "action_mask")
    body = MLP(width, options, depth=2, num_cells=64)  # of each robot: all share the parameters
    logits = TensorDictModule(body, in_keys=[seen], out_keys=[("robot", "logits")])
    actor = ProbabilisticActor(
        logits,
        spec=env.full_action_spec["robot", "action"],
        in_keys={"logits": ("robot", "logits"), "mask": mask},
        out_keys=[KEYS["action"]],
        distribution_class=MaskedCategorical,
        return_log_prob=True,
    )
    value = ("robot", "state_value")
    whole = MLP(env.observation_spec["state"].shape[0], robots, num_cells=[128, 128])
    each = torch.nn.Sequential(whole, torch.nn.Unflatten(-1, (robots, 1)))
    critic = TensorDictModule(each, in_keys=["state"], out_keys=[value])
    loss = ClipPPOLoss(actor, critic, normalize_advantage=True)
    loss.set_keys(**KEYS, terminated=("robot", "terminated"), value=value)
    loss.make_value_estimator(gamma=0.98, lmbda=0.95)
    optimiser = torch.optim.Adam(loss.parameters(), lr=3e-4)
    for batch in Collector(env, actor, frames_per_batch=given.batch, total_frames=given.frames):
        with torch.no_grad():
            weights = loss.critic_network_params
            loss.value_estimator(batch, params=weights, target_params=loss.target_critic_network_params)
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(batch)).chunk(PARTS):
                losses = loss(batch[rows])
                optimiser.zero_grad()
                (losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]).backward()
                optimiser.step()
        print(f"mean reward of a decision {batch['next', 'robot', 'reward'].mean():.4f}")
    save(body, width - 1, "torchrl_mappo.pt")


if __name__ == "__main__":
    main()
