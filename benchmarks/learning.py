"""Throughput of PPO on the full stack: robot decisions for each CPU-hour, and who takes the time.

    python -m benchmarks.learning

64 worlds of 5 robots, a decision a second, PPO of Stable-Baselines3 with one set of parameters, one torch thread; CPU
time of whole rollouts and updates, alternating with the batch alone under random options. Needs the extra `train`.
Exit code 1 below REQUIRED decisions an hour.
"""

import sys
from collections.abc import Callable
from statistics import median
from time import process_time
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO

from benchmarks.record import record
from clean_swarm_env.borders.stable_baselines3 import RobotVecEnv
from clean_swarm_env.learning.batch import Batch

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


class Clock:
    """CPU seconds inside some methods, which may call each other: of each without those inside it."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._inside: list[float] = []

    def watch(self, owner: object, method: str, name: str) -> None:
        """Count what `owner.method` takes under `name` from now on."""
        call: Callable[..., Any] = getattr(owner, method)
        self.seconds.setdefault(name, 0.0)

        def timed(*arguments: object, **named: object) -> object:
            self._inside.append(0.0)
            begin = process_time()
            result = call(*arguments, **named)
            whole = process_time() - begin
            self.seconds[name] += whole - self._inside.pop()
            if self._inside:
                self._inside[-1] += whole
            return result

        setattr(owner, method, timed)


def watched(model: PPO, envs: RobotVecEnv) -> Clock:
    """Return a clock on the parts of the stack."""
    (batch,) = envs.batches
    clock, worlds = Clock(), batch.worlds
    clock.watch(model, "train", "SB3: update")
    clock.watch(model, "collect_rollouts", "SB3: rollout")
    clock.watch(envs, "step_wait", "border")
    clock.watch(batch, "step", "batch: observation, reward, progress")
    clock.watch(batch, "_begin", "batch: new episodes")
    clock.watch(worlds, "tick", "tick: sensors, cargo, poses")
    clock.watch(worlds.network, "step", "network")
    for name in ("poses", "pheromones", "items"):
        for method in ("update", "store_static", "extinguish"):
            if hasattr(getattr(worlds, name), method):
                clock.watch(getattr(worlds, name), method, "buffer")
    for mechanism in (worlds.minds.patrol, worlds.minds.to_garbage):
        clock.watch(mechanism, "move_into", "mechanisms and coordinators")
    clock.watch(worlds.minds.patrol, "deposit", "buffer")
    for coordinator in worlds.coordinators:
        for method in ("sense", "act", "leave", "hold"):
            clock.watch(coordinator, method, "mechanisms and coordinators")
    clock.watch(worlds, "_move", "physics, drives and collisions")
    return clock


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
    clock = watched(model, envs)
    begin = process_time()
    model.learn(2 * decisions, reset_num_timesteps=False)
    total = process_time() - begin
    hourly = {name: 3600.0 * median(each) for name, each in rates.items()}
    for name, rate in hourly.items():
        print(f"{name:14}{rate / 1e6:8.1f} million robot decisions for each CPU-hour ({rate / 3600:.0f} a second)")
    print(f"required      {REQUIRED / 1e6:8.1f}  {'reached' if hourly['PPO'] >= REQUIRED else 'MISSED'}")
    shares = {name: seconds / total for name, seconds in clock.seconds.items()}
    shares["other"] = 1.0 - sum(shares.values())
    for name, share in sorted(shares.items(), key=lambda item: -item[1]):
        print(f"  {name:40}{share:6.1%}{1e6 * share * total / (2 * decisions):8.1f} us a decision")
    record("learning", {"decisions per CPU-hour": hourly, "share of the time of PPO": shares})
    return 0 if hourly["PPO"] >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
