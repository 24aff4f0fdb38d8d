"""SAC of Stable-Baselines3 with movement vectors as actions.

pip install -c constraints.txt stable-baselines3==2.9.2 '.[train]'
python examples/sb3_sac.py --steps 100000
clean-swarm evaluate table1-starts --strategy fixed --strategy velocity:sb3_sac.zip --scenarios 10
"""

import argparse

from stable_baselines3 import SAC
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

from clean_swarm_env.sb3 import RobotVecEnv

MISSION = {"base": "table1", "task": {"garbage": {"count": 4}}, "time_limit": 100.0}


def make(worlds: int) -> VecMonitor:
    """Return the robots of many worlds, each driven by a vector and paid for its own part of the work."""
    own = {"own_picked": 0.5, "own_recycled": 0.5}
    return VecMonitor(RobotVecEnv(worlds=worlds, mission=MISSION, action={"mode": "velocity"}, reward=own))


def main() -> None:
    """Train, print the mean return of ten robots, and save the model."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=100_000)
    steps = parser.parse_args().steps
    model = SAC("MlpPolicy", make(4), learning_starts=400, gradient_steps=1, gamma=0.98, seed=1, device="cpu")
    model.learn(steps)
    mean, spread = evaluate_policy(model, make(2), n_eval_episodes=10)
    model.save("sb3_sac.zip")
    print(f"return of a robot: {mean:.2f} +- {spread:.2f}")


if __name__ == "__main__":
    main()
