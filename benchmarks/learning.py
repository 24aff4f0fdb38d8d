"""Throughput of PPO on the full stack: robot decisions for each CPU-hour, and the time of each part.

    python -m benchmarks.learning

64 worlds of 5 robots, a decision a second, PPO of Stable-Baselines3 with one set of parameters, one torch thread; CPU
time of whole rollouts and updates, alternating with the batch alone under random options. Needs the extra `train`.
Exit code 1 below REQUIRED decisions an hour.

Then `train ppo`, `examples/ppo_one_file.py` and, where it is installed, PufferLib's PPO (`examples/pufferlib_ppo.py`)
by turns on as many worlds of `table1`, with networks, minibatches and epochs of one size. Last, decisions of robots at
work that have an effect, learned from alone and among all rows (docs/decisions/0215-decisions-that-count.md).
"""

import os
import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO

from benchmarks.shared.measuring import by_turns
from benchmarks.shared.parts import Stopwatch
from benchmarks.shared.record import record
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.sb3 import RobotVecEnv
from selforg.arrays import Flags
from train.learning.config import TrainingConfig
from train.learning.ppo.training import PpoTraining
from train.learning.training import TrainingJob
from train.request import Request
from train.running.run_folder import RunFolder

REQUIRED = 20e6  # robot decisions for each CPU-hour
WORLDS = 64
STEPS = 64  # decisions of each robot in a rollout
MINIBATCH, EPOCHS = 2048, 4
ROUNDS = 5
PPO_SETTINGS: dict[str, Any] = {
    "n_steps": STEPS,
    "batch_size": MINIBATCH,
    "n_epochs": EPOCHS,
    "policy_kwargs": {"net_arch": [64, 64]},
    "device": "cpu",
    "seed": 1,
}
EXAMPLES = Path(__file__).parents[1] / "examples"
EXPLORING: dict[str, Any] = {
    "goal": "ExplorationPatrol",
    "observation": {"terms": ["situation", "target", "idle", "finds", "crowd"]},
    "reward": {
        "cost": 0.0,
        "own_picked": 0.5,
        "own_recycled": 0.5,
        "own_dumped": 1.0,
        "collision": -0.4,
        "shared": 0.3,
    },
}
"""As in `configs/training/exploring-ppo.yaml`."""


def watched(model: PPO, envs: RobotVecEnv) -> Stopwatch:
    """Return a stopwatch of CPU time on the parts of the stack."""
    (batch,) = envs.batches
    watch = Stopwatch(process_time)
    watch.watch(model, "train", "SB3: update")
    watch.watch(model, "collect_rollouts", "SB3: rollout")
    watch.watch(envs, "step_wait", "border")
    watch.watch(batch, "step", "batch: observation, reward")
    watch.watch(batch, "_start_episode", "batch: new episodes")
    watch.watch(batch.worlds, "hold", "selector")
    watch.watch(batch.worlds, "run", "ticks and counts")
    return watch


def batch_alone(batch: Batch, actions: np.ndarray) -> float:
    """Return decisions for each CPU second of the batch alone, under options drawn beforehand."""
    begin = process_time()
    for options in actions:
        batch.step(options)
    return batch.rows * len(actions) / (process_time() - begin)


class CountingTraining(PpoTraining):
    """`train ppo` that counts the decisions of robots at work that had an effect; it may learn from all rows."""

    all_rows, effective = False, 0

    def _working(self) -> Flags:
        working = super()._working()
        return np.ones_like(working) if self.all_rows else working

    def _effective(self) -> Flags:
        effective = super()._effective()
        took_part = np.concatenate([batch.took_part for batch in self.curriculum.batches])
        self.effective += int((effective.any(axis=1) & took_part).sum())
        return np.ones_like(effective) if self.all_rows else effective


class AllRowsTraining(CountingTraining):
    """The same, which learns from rows without a robot and from decisions without effect, too."""

    all_rows = True


def training(
    kind: type[CountingTraining], family: str, name: str, running: tuple[str, ...] = (), **config: Any
) -> Callable[[], float]:
    """Return a contestant that gives the decisions for each CPU second in a rollout and an update: those that count."""
    ppo = {"steps": STEPS, "minibatch": MINIBATCH, "epochs": EPOCHS, "hidden": [64, 64], "running": running}
    about = {"name": name, "description": name, "tasks": [{"family": family, "worlds": WORLDS}], "decisions": 1}
    whole = TrainingConfig.model_validate({**about, "checkpoints": 1, "ppo": ppo, **config})
    own = kind(TrainingJob(whole, Request(name, seed=1), RunFolder(Path(name), {"identity": {}}, resume=False)))
    own.curriculum.set_scenarios(0)

    def learn() -> float:
        own.effective, begin = 0, process_time()
        own.model.learn(1, callback=lambda *_: own._note(), reset_num_timesteps=False)
        return own.effective / (process_time() - begin)

    return learn


def ppo_one_file() -> float:
    """Return the decisions for each CPU second of the example, which prints a line after each update."""
    example, printed = import_module("ppo_one_file"), list[float]()
    vars(example).update(MINIBATCH=MINIBATCH, print=lambda *_: printed.append(process_time()))
    sys.argv[1:] = ["--updates", "3", "--worlds", str(WORLDS)]
    example.main()
    return 2 * STEPS * Batch(worlds=WORLDS, family="table1-starts").rows / (printed[-1] - printed[0])


def pufferlib_ppo() -> Callable[[], float]:
    """Return the same contestant for PufferLib's trainer, without its table on the screen."""
    with warnings.catch_warnings():  # it makes errors of warnings
        example, pufferl = import_module("pufferlib_ppo"), import_module("pufferlib.pufferl")
    robots = example.Robots(Batch(worlds=WORLDS, family="table1-starts"))
    width, options = robots.observations.shape[1], int(robots.single_action_space.n)
    policy = example.ActorCritic({"actor": example.network(width, options), "critic": example.network(width, 1)})
    sys.argv[1:] = []  # load_config reads them
    settings = pufferl.load_config("default")["train"] | example.SAME | example.PLAIN
    pufferl.PuffeRL.print_dashboard = lambda *_, **__: None
    trainer = pufferl.PuffeRL(settings | {"minibatch_size": MINIBATCH, "total_timesteps": 10**9}, robots, policy)
    trainer.utilization.stop()

    def learn() -> float:
        begin = process_time()
        trainer.evaluate()
        trainer.train()
        return STEPS * robots.num_agents / (process_time() - begin)

    return learn


def beside_others() -> dict[str, dict[str, float]]:
    """Return decisions for each CPU-hour beside those of other learners, and effective ones; prints them."""
    contestants = {"train ppo": training(CountingTraining, "table1-starts", "table"), "ppo_one_file": ppo_one_file}
    if find_spec("pufferlib") is None:
        print("PufferLib is not installed: left out")
    else:
        contestants["PufferLib"] = pufferlib_ppo()
    ways = {"count": CountingTraining, "all rows": AllRowsTraining}
    rows = {
        f"learned from {name}": training(kind, "clustered", name, ("ExplorationPatrol",), **EXPLORING)
        for name, kind in ways.items()
    }
    figures = {"beside others": by_turns(contestants, ROUNDS), "effective decisions": by_turns(rows, ROUNDS)}
    return {
        f"{what} per CPU-hour": {name: 3600.0 * median(each) for name, each in rates.items()}
        for what, rates in figures.items()
    }


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
    sys.path.append(str(EXAMPLES))
    with TemporaryDirectory() as folder:
        os.chdir(folder)  # PufferLib and the example leave files
        others = beside_others()
        os.chdir(EXAMPLES)
    for what, figures in others.items():
        print(what)
        for name, rate in figures.items():
            print(f"  {name:24}{rate / 1e6:8.1f} million")
    record("learning", {"decisions per CPU-hour": hourly, "share of the time of PPO": shares, **others})
    return 0 if hourly["PPO"] >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
