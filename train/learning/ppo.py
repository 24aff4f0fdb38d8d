"""Training by PPO of Stable-Baselines3, with one set of parameters for all robots of all worlds.

Between two checkpoints everything follows from the checkpoint's number, the seed and the state saved there: all worlds
begin anew and all generators are seeded anew. So a training that was killed and resumed comes to the same bits.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.logger import configure
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecNormalize

from clean_swarm_env.borders.stable_baselines3 import RobotVecEnv
from selector.documents.arrays import write_whole
from selector.strategies.policy_file import TrainedPolicy, save_policy
from train.learning.checkpoints import TrainingDirectory
from train.learning.config import PpoConfig, TrainingConfig
from train.learning.curriculum import Curriculum
from train.learning.policy_export import exported
from train.learning.validation import Progress, measured
from train.running.trials import PolicyPilot

CHECKPOINT, POLICY, TENSORBOARD = "checkpoint.pt", "policy", "tensorboard"
LAST_RATE = 0.1
"""Share of the learning rate that is left at the end."""


class PpoTraining:
    """One training, checkpoint by checkpoint.

    Args:
        config: the training.
        seed: of everything random in it.
        directory: where it keeps everything; it goes on from the checkpoint there.
        told: is told after each update how many decisions have been made.

    """

    def __init__(
        self, config: TrainingConfig, seed: int, directory: TrainingDirectory, told: Callable[[int], None],
        directories: tuple[Path, ...] = (),
    ) -> None:  # fmt: skip
        assert config.ppo is not None
        torch.set_num_threads(1)
        self.config, self.settings, self.seed, self.directory = config, config.ppo, seed, directory
        self._directories, self._told = directories, told
        self.curriculum = Curriculum(config, seed, directories)
        self.progress, self.checkpoint = Progress(), 0
        self._costs: list[float] = []
        self._envs = RobotVecEnv(batches=self.curriculum.batches)
        self.normal = VecNormalize(self._envs, gamma=self.settings.discount)
        self.model = _model(self.settings, self.normal, seed)
        self.model.set_logger(configure(str(directory.path / TENSORBOARD), ["tensorboard"]))
        self._best: dict[str, Any] = {}
        if directory.begun:
            self._load(torch.load(directory.checkpoint, weights_only=True))

    @property
    def finished(self) -> bool:
        """Whether all checkpoints are done, or nothing has become better for long."""
        patient = self.progress.since < self.config.validation.patience
        return self.checkpoint >= self.config.checkpoints or not patient

    @property
    def decisions(self) -> int:
        """Decisions made so far."""
        return int(self.model.num_timesteps)

    def advance(self) -> None:
        """Learn up to the next checkpoint, measure what was learned, and save everything."""
        model, config = self.model, self.config
        set_random_seed(_derived(self.seed, self.checkpoint))
        done = self.checkpoint / config.checkpoints
        rate = self.settings.learning_rate * (1.0 - (1.0 - LAST_RATE) * done)
        model.learning_rate, model.lr_schedule = rate, lambda _: rate
        model._last_obs = None  # all worlds begin anew
        self.curriculum.begin(self.checkpoint)
        self._costs.clear()
        model.learn(config.decisions, callback=lambda *_: self._note(), reset_num_timesteps=model.num_timesteps == 0)
        self.checkpoint += 1
        figures = self._measured()
        entry = {"checkpoint": self.checkpoint, "decisions": model.num_timesteps, "training_cost_s": _mean(self._costs)}
        if self.progress.note(entry, figures):
            self._best = self._weights()
        for name, value in {**entry, **figures}.items():
            if value is not None:
                model.logger.record(f"validation/{name}", value)
        model.logger.dump(model.num_timesteps)
        self._save()

    def policy(self, **training: Any) -> TrainedPolicy:  # noqa: ANN401
        """Return what the network is now, as it is exported."""
        batch = self.curriculum.batches[0]
        goal = batch.worlds.coordinator.model.goal
        return exported(self.model, self.normal, goal, batch.options[goal], batch.observer.names, training)

    def export(self, command: str) -> Path:
        """Write the best policy so far to the directory and return where."""
        last = self._weights()
        self._take(self._best or last)
        entry = min(self.progress.history, key=lambda line: line["score"] or np.inf, default={})
        training = {"command": command, "seed": self.seed, "configuration": self.config.model_dump(mode="json")}
        policy = self.policy(**training, figures=entry)
        self._take(last)
        save_policy(self.directory.path / POLICY, policy)
        return self.directory.path / POLICY

    def _note(self) -> bool:
        self._costs += [end.result.cost_s for end in self._envs.finished]
        self._told(self.model.num_timesteps)
        return True

    def _measured(self) -> dict[str, float]:
        if self.checkpoint % self.config.validation.every and self.checkpoint < self.config.checkpoints:
            return {}
        policy = self.policy()
        return measured(
            self.curriculum.validation, lambda problem, _: PolicyPilot(policy, problem), self.config.observation,
            self._directories,
        )  # fmt: skip

    def _weights(self) -> dict[str, Any]:
        """Return copies of all that the exported policy is made of."""
        statistics = self.normal.obs_rms
        assert isinstance(statistics, RunningMeanStd)
        state = {name: tensor.clone() for name, tensor in self.model.policy.state_dict().items()}
        return {"policy": state, "observations": _moments(statistics)}

    def _take(self, weights: dict[str, Any]) -> None:
        self.model.policy.load_state_dict(weights["policy"])
        self.normal.obs_rms = _statistics(weights["observations"])

    def _save(self) -> None:
        content = {
            **self._weights(),
            "optimizer": self.model.policy.optimizer.state_dict(),
            "returns": _moments(self.normal.ret_rms),
            "checkpoint": self.checkpoint,
            "decisions": self.model.num_timesteps,
            "updates": self.model._n_updates,
            "best": self._best,
            "progress": vars(self.progress),
        }
        stream = io.BytesIO()
        torch.save(content, stream)
        write_whole(self.directory.checkpoint, stream.getvalue())
        self.directory.write_history(self.progress.history)

    def _load(self, content: dict[str, Any]) -> None:
        self._take(content)
        self.model.policy.optimizer.load_state_dict(content["optimizer"])
        self.normal.ret_rms = _statistics(content["returns"])
        self.checkpoint, self.model.num_timesteps = content["checkpoint"], content["decisions"]
        self.model._n_updates, self._best = content["updates"], content["best"]
        self.progress = Progress(**content["progress"])
        self.directory.write_history(self.progress.history)


def _model(settings: PpoConfig, env: VecNormalize, seed: int) -> PPO:
    layers = list(settings.hidden)
    set_random_seed(_derived(seed, -1))  # PPO's own argument would seed the worlds too, which follow the curriculum
    return PPO(
        "MlpPolicy", env, n_steps=settings.steps, batch_size=settings.minibatch, n_epochs=settings.epochs,
        learning_rate=settings.learning_rate, gamma=settings.discount, gae_lambda=settings.trace,
        clip_range=settings.clip, ent_coef=settings.entropy, vf_coef=settings.value, max_grad_norm=settings.gradient,
        policy_kwargs={"net_arch": {"pi": layers, "vf": layers}}, device="cpu",
    )  # fmt: skip


def _derived(seed: int, checkpoint: int) -> int:
    """Return the seed of what is random in learning from a checkpoint on."""
    return int(np.random.SeedSequence([seed, checkpoint + 1, 2]).generate_state(1, np.uint32)[0])


def _mean(values: list[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _moments(statistics: RunningMeanStd) -> dict[str, Any]:
    return {
        "mean": torch.tensor(statistics.mean), "variance": torch.tensor(statistics.var), "count": statistics.count,
    }  # fmt: skip


def _statistics(moments: dict[str, Any]) -> RunningMeanStd:
    statistics = RunningMeanStd(shape=tuple(moments["mean"].shape))
    statistics.mean, statistics.var = moments["mean"].numpy(), moments["variance"].numpy()
    statistics.count = moments["count"]
    return statistics
