"""PPO of Stable-Baselines3 on 16 worlds; the policy is then compared with fixed options.

pip install '.[train]'
python examples/sb3_ppo.py --steps 200000
clean-swarm evaluate --family table1 --strategy fixed --strategy policy:sb3_ppo.zip --scenarios 10
"""

import argparse

from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from clean_swarm_env.sb3 import RobotVecEnv


def main() -> None:
    """Train and save `sb3_ppo.zip`, and the normalisation beside it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=200_000)
    steps = parser.parse_args().steps
    figures = ("duration_s", "garbage_done", "mission_collision_events", "completed")
    envs = VecNormalize(VecMonitor(RobotVecEnv(worlds=16, family="table1"), info_keywords=figures))
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=1024, gamma=0.98, seed=1, device="cpu", verbose=1)
    model.learn(steps)
    model.save("sb3_ppo.zip")
    envs.save("sb3_ppo.pkl")


if __name__ == "__main__":
    main()
