"""PPO of Stable-Baselines3 on 16 worlds, with options or, end to end, with movement vectors as actions.

pip install -c constraints.txt stable-baselines3==2.9.2 '.[train]'
python examples/sb3_ppo.py --steps 200000
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:sb3_ppo.zip --scenarios 10
python examples/sb3_ppo.py --velocity --family crowded
clean-swarm evaluate crowded --strategy fixed:ORCA --strategy policy:sb3_ppo.zip --scenarios 10

Episodes are cut after `--limit` seconds: until the first one ends, `ep_rew_mean` is nan.
"""

import argparse

from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from clean_swarm_env.sb3 import RobotVecEnv

OWN_WORK = {"own_picked": 1.0, "own_recycled": 1.0, "own_dumped": 1.0, "collision": -0.2}
"""By the cost of missions alone robots that drive learn to stand still."""


def main() -> None:
    """Train and save `sb3_ppo.zip`, and the normalisation beside it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--family", default="table1-starts")
    parser.add_argument("--limit", type=float, default=300.0)
    parser.add_argument("--velocity", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    driven = {"action": {"mode": "velocity"}, "reward": OWN_WORK} if given.velocity else {}
    figures = ("duration_s", "garbage_done", "mission_collision_events", "completed")
    robots = RobotVecEnv(worlds=16, family=given.family, time_limit=given.limit, **driven)
    envs = VecNormalize(VecMonitor(robots, info_keywords=figures))
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=1024, gamma=0.98, seed=given.seed, device="cpu", verbose=1)
    model.learn(given.steps, log_interval=10)
    model.save("sb3_ppo.zip")
    envs.save("sb3_ppo.pkl")
    reward = sum(info["r"] for info in model.ep_info_buffer) / max(len(model.ep_info_buffer), 1)
    print(
        f"sb3_ppo.zip, and sb3_ppo.pkl with the scale of what it sees; mean reward of the last episodes: {reward:.2f}"
    )


if __name__ == "__main__":
    main()
