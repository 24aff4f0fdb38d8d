"""PPO in one file, in the manner of CleanRL: every robot of every world is a row, all rows share one network.

pip install -c constraints.txt '.[train]'
python examples/ppo_one_file.py --updates 40
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:ppo_one_file.pt --scenarios 10
"""

import argparse

import numpy as np
import torch
from torch import nn

from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv

STEPS, EPOCHS, MINIBATCH = 64, 4, 1024
DISCOUNT, TRACE, CLIP, ENTROPY, RATE = 0.98, 0.95, 0.2, 0.01, 3e-4


def network(inputs: int, outputs: int) -> nn.Sequential:
    """Return two hidden layers of 64."""
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs))


def main() -> None:
    """Train and save the policy as TorchScript."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--updates", type=int, default=40)
    parser.add_argument("--worlds", type=int, default=16)
    given = parser.parse_args()
    torch.manual_seed(1)
    envs = RobotVectorEnv(given.worlds, family="table1-starts")
    width, options = envs.single_observation_space.shape[0], int(envs.single_action_space.n)
    actor, critic = network(width, options), network(width, 1)
    weights = [*actor.parameters(), *critic.parameters()]
    optimiser = torch.optim.Adam(weights, lr=RATE)
    seen = torch.from_numpy(envs.reset(seed=1)[0])
    for update in range(given.updates):
        kept = []
        for _ in range(STEPS):
            with torch.no_grad():
                choice = torch.distributions.Categorical(logits=actor(seen))
                action = choice.sample()
                following, reward, terminated, truncated, infos = envs.step(action.numpy())
                value, after = critic(seen)[:, 0], torch.from_numpy(following)
                for row in np.flatnonzero(truncated):  # time was over, not the task: the rest has the value of the end
                    last = torch.from_numpy(infos["final_obs"][row])
                    reward[row] += DISCOUNT * float(critic(last[None])[0, 0])
            over = torch.from_numpy(terminated | truncated).float()
            kept.append((seen, action, choice.log_prob(action), torch.from_numpy(reward).float(), over, value))
            seen = after
        observations, actions, chances, rewards, overs, values = (torch.stack(part) for part in zip(*kept, strict=True))
        with torch.no_grad():
            ahead, advantage, advantages = critic(seen)[:, 0], torch.zeros_like(values[0]), torch.zeros_like(values)
            for t in reversed(range(STEPS)):
                error = rewards[t] + DISCOUNT * (1 - overs[t]) * ahead - values[t]
                advantage = error + DISCOUNT * TRACE * (1 - overs[t]) * advantage
                advantages[t], ahead = advantage, values[t]
        flat = [part.flatten(0, 1) for part in (observations, actions, chances, advantages, advantages + values)]
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(flat[0])).split(MINIBATCH):
                obs, act, chance, adv, target = (part[rows] for part in flat)
                choice = torch.distributions.Categorical(logits=actor(obs))
                ratio, adv = (choice.log_prob(act) - chance).exp(), (adv - adv.mean()) / (adv.std() + 1e-8)
                gain = torch.min(ratio * adv, ratio.clamp(1 - CLIP, 1 + CLIP) * adv).mean()
                loss = 0.5 * (critic(obs)[:, 0] - target).square().mean() - gain - ENTROPY * choice.entropy().mean()
                optimiser.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(weights, 0.5)
                optimiser.step()
        print(f"update {update + 1}: reward of a decision {rewards.mean():.4f}")
    torch.jit.script(actor).save("ppo_one_file.pt")


if __name__ == "__main__":
    main()
