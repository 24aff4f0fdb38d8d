"""MaskablePPO of sb3-contrib, with an option that can serve only without cargo.

pip install -c constraints.txt stable-baselines3==2.9.2 sb3-contrib==2.9.2 '.[train]'
python examples/sb3_maskable_ppo.py --steps 200000
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:sb3_maskable_ppo.zip --scenarios 10
"""

import argparse

from sb3_contrib import MaskablePPO
from stable_baselines3.common.vec_env import VecMonitor

from clean_swarm_env.sb3 import RobotVecEnv

SERVES = {"RepulsionFernandez-view2.0": ["patrol", "approach"]}


def main() -> None:
    """Train and save `sb3_maskable_ppo.zip`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=200_000)
    steps = parser.parse_args().steps
    envs = VecMonitor(RobotVecEnv(worlds=16, family="table1-starts", action={"serves": SERVES}))
    model = MaskablePPO("MlpPolicy", envs, n_steps=64, batch_size=1024, gamma=0.98, seed=1, device="cpu", verbose=1)
    model.learn(steps)
    model.save("sb3_maskable_ppo.zip")


if __name__ == "__main__":
    main()
