"""Throughput of PPO on the full stack: robot decisions for each CPU-hour, and the time of each part.

    python -m benchmarks.learning

64 worlds of 5 robots, a decision a second, PPO of Stable-Baselines3 with one set of parameters, one torch thread; CPU
time of whole rollouts and updates, alternating with the batch alone under random options. Needs the extra `train`.
Exit code 1 below REQUIRED decisions an hour.
"""

import sys
from statistics import median
from time import process_time
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO

from benchmarks.shared.parts import Stopwatch, borders_of
from benchmarks.shared.record import record
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.sb3 import RobotVecEnv

REQUIRED = 20e6  # robot decisions for each CPU-hour
WORLDS = 64
STEPS = 64  # decisions of each robot in a rollout
ROUNDS = 5
PPO_SETTINGS: dict[str, Any] = {
    "n_steps": STEPS,
    "batch_size": 2048,
    "n_epochs": 4,
    "policy_kwargs": {"net_arch": [64, 64]},
    "device": "cpu",
    "seed": 1,
}


def watched(model: PPO, envs: RobotVecEnv) -> Stopwatch:
    """Return a stopwatch of CPU time on the parts of the stack."""
    (batch,) = envs.batches
    watch = Stopwatch(process_time)
    watch.watch(model, "train", "SB3: update")
    watch.watch(model, "collect_rollouts", "SB3: rollout")
    watch.watch(envs, "step_wait", "border")
    watch.watch(batch, "step", "batch: observation, reward, progress")
    watch.watch(batch, "_start_episode", "batch: new episodes")
    watch.watch(batch.worlds, "hold", "selector")
    for owner, method, part in borders_of(batch.worlds):
        watch.watch(owner, method, part)
    return watch


def batch_alone(batch: Batch, actions: np.ndarray) -> float:
    """Return decisions for each CPU second of the batch alone, under options drawn beforehand."""
    begin = process_time()
    for options in actions:
        batch.step(options)
    return batch.rows * len(actions) / (process_time() - begin)


def main() -> int:
    """Print and record the figures."""
    torch.set_num_threads(1)
    envs = RobotVecEnv(WORLDS)
    model = PPO("MlpPolicy", envs, **PPO_SETTINGS)
    decisions = STEPS * envs.num_envs
    model.learn(decisions)  # loads compiled code, and missions are under way
    alone = Batch(worlds=WORLDS)
    alone.reset(list(range(WORLDS)))
    actions = np.random.default_rng(1).integers(0, 3, (STEPS, alone.rows))
    rates: dict[str, list[float]] = {"PPO": [], "batch alone": []}
    for _ in range(ROUNDS):
        begin = process_time()
        model.learn(decisions, reset_num_timesteps=False)
        rates["PPO"].append(decisions / (process_time() - begin))
        rates["batch alone"].append(batch_alone(alone, actions))
    watch = watched(model, envs)
    begin = process_time()
    model.learn(2 * decisions, reset_num_timesteps=False)
    total = process_time() - begin
    hourly = {name: 3600.0 * median(each) for name, each in rates.items()}
    for name, rate in hourly.items():
        print(f"{name:14}{rate / 1e6:8.1f} million robot decisions for each CPU-hour ({rate / 3600:.0f} a second)")
    print(f"required      {REQUIRED / 1e6:8.1f}  {'reached' if hourly['PPO'] >= REQUIRED else 'MISSED'}")
    shares = {name: seconds / total for name, seconds in watch.seconds.items()}
    shares["other"] = 1.0 - sum(shares.values())
    for name, share in sorted(shares.items(), key=lambda item: -item[1]):
        print(f"  {name:40}{share:6.1%}{1e6 * share * total / (2 * decisions):8.1f} us a decision")
    record("learning", {"decisions per CPU-hour": hourly, "share of the time of PPO": shares})
    return 0 if hourly["PPO"] >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
