"""Training by PPO of Stable-Baselines3, with one network for all robots of all worlds.

Each checkpoint resets all worlds and seeds all generators; see `train.learning.training`.
"""

from __future__ import annotations

import io
import pickle
import warnings
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.logger import configure
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from clean_swarm_env.deciders.decided_goal import named_goal
from clean_swarm_env.deciders.decider import DeciderMaker
from clean_swarm_env.deciders.strategies import PolicyDecider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.joined import each_option
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.sb3 import RobotVecEnv
from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import JOINT
from selector.strategies.policy_file import TrainedPolicy, save_policy
from selector.strategies.probing import Probing
from selforg.arrays import Flags
from selforg.registry import unknown
from train.learning.config import CreditConfig
from train.learning.credit import Credit
from train.learning.ppo.networks import RobotPolicy, exported
from train.learning.ppo.rollouts import MomentsOfRobots, RobotPPO, RobotRollouts
from train.learning.ppo.worlds import SelectorEnv
from train.learning.training import Checkpoint, Training

POLICY_FOLDER, TENSORBOARD_FOLDER = "policy", "tensorboard"
DAMAGE = (
    RuntimeError,
    ValueError,
    OverflowError,
    KeyError,
    TypeError,
    AttributeError,
    EOFError,
    OSError,
    pickle.UnpicklingError,
)
"""What torch raises for a checkpoint that is damaged or of another shape; it depends on the damaged part."""
LAST_RATE = 0.1
"""Share of the learning rate that is left at the end."""


class PpoTraining(Training):
    """One training of a policy; checkpoints have everything that Stable-Baselines3 needs to continue."""

    CHECKPOINT, alike = "checkpoint.pt", False

    def _make(self) -> None:
        torch.set_num_threads(1)
        assert self.config.ppo is not None
        self.settings = settings = self.config.ppo
        self.robots = RobotVecEnv(batches=self.curriculum.batches, threads=self.job.request.machine.threads)
        self.normal = VecNormalize(self.seen_by_critic(), gamma=settings.discount)
        self._seen = self.normal.obs_rms = MomentsOfRobots(self._working, self.normal.observation_space.shape or ())
        self._paid = self.normal.ret_rms = MomentsOfRobots(lambda: self.model.rollout_buffer.deciding)
        goals = [named_goal(tuple(self.robots.options), name) for name in self.decides]
        holds = {goal: settings.holds.get(goal, 1) for goal in goals}
        self.envs = SelectorEnv(self.normal, self.robots, holds)
        with warnings.catch_warnings():  # the last part of the rows is smaller, as teams differ
            warnings.filterwarnings("ignore", "You have specified a mini-batch size")
            self.model = self._model()
        self.model.set_logger(configure(str(self.job.folder.path / TENSORBOARD_FOLDER), ["tensorboard"]))
        self._best: dict[str, Any] = {}
        memory, period = self.job.memory, self.curriculum.batches[0].decision_period
        learns = memory is not None and memory.learns
        rows = self.robots.num_envs
        self._credits = {goal: Credit(CreditConfig(), period, rows) for goal in self.envs.options if learns}

    @property
    def decides(self) -> Sequence[str]:
        """The goals whose options are learned, each by outputs of its own."""
        usual = self.config.goal or named_goal(tuple(self.curriculum.batches[0].options), None)
        return usual.split(JOINT)

    def seen_by_critic(self) -> VecEnv:
        """Return the robots; a subclass may let more follow their observations, which the critic alone sees."""
        return self.robots

    def policy(self, **training: Any) -> TrainedPolicy:  # noqa: ANN401
        """Return the present network as a policy for export."""
        observation = self.curriculum.batches[0].observer.config
        terms = tuple(term.name for term in observation.terms or ())
        usual = observation == ObservationConfig.model_validate({"terms": terms})
        return exported(
            self.model,
            self.normal,
            self.curriculum.batches[0].observer.names,
            self.envs.options,
            definitions={goal: self.curriculum.definitions[goal] for goal in self.envs.options},
            holds=self.settings.holds,
            probing=Probing(sampled=self.settings.plays == "sampled"),
            terms=terms if usual else (),
            observation={} if usual else observation.model_dump(mode="json"),
            training=training,
        )

    def export(self, command: str) -> Path:
        """Write the best policy so far and return its directory."""
        last, path = self._learned(), self.job.folder.path / POLICY_FOLDER
        self._apply(self._best or last)
        save_policy(path, self.policy(**self.about(command)))
        self._apply(last)
        return path

    def _learn(self) -> dict[str, Any]:
        model, config = self.model, self.config
        set_random_seed(_derived(self.job.request.seed, self.checkpoint))
        done = self.checkpoint / config.checkpoints
        rate = self.settings.learning_rate * (1.0 - (1.0 - LAST_RATE) * done)
        model.learning_rate, model.lr_schedule = rate, lambda _: rate
        model._last_obs = None  # makes PPO reset all worlds
        self.curriculum.set_scenarios(self.checkpoint)
        model.learn(config.decisions, callback=lambda *_: self._follow(), reset_num_timesteps=model.num_timesteps == 0)
        return {}

    def _follow(self) -> bool:
        """Note rewards, and missions that have ended; PPO calls this after each step and continues if it is True."""
        deciding = self.model.rollout_buffer.deciding
        self.model.num_timesteps -= int((~deciding).sum())
        rewards = self.normal.get_original_reward().astype(np.float64)
        for column, (goal, credit) in enumerate(self._credits.items()):
            rows = np.flatnonzero(self.envs.anew[:, column] & deciding)
            credit.decide(rows, self.envs.taken[rows, column])
            self._record(goal, self.envs.options[goal], credit.pay(rewards, self.envs.over))
        self._note(self.model.num_timesteps, [end.result.excess_s for end in self.robots.finished])
        return True

    def _working(self) -> Flags:
        """Return which rows (R,) have a robot at work."""
        return self.robots.joined.working

    def _effective(self) -> Flags:
        """Return which options (R, G) that were chosen in the last period count, see `PpoConfig.running`."""
        goals = self.envs.options
        acted = [np.stack([self._acted(batch, goal) for goal in goals], axis=1) for batch in self.curriculum.batches]
        return np.concatenate(acted) & self.envs.chosen

    def _acted(self, batch: Batch, goal: str) -> Flags:
        """Return whether the behaviour of a goal ran (rows of a batch,); where it does not matter, all are True."""
        if goal in self.settings.running and goal in batch.options:
            return batch.progress.acted[:, list(batch.options).index(goal)]
        return np.ones(batch.rows, dtype=np.bool_)

    def _model(self) -> RobotPPO:
        settings, layers = self.settings, list(self.settings.hidden)
        outputs = each_option(self.envs.options)
        for wanted in settings.start.items():
            if wanted not in outputs:
                raise DocumentError(f"ppo: start: {unknown('option', wanted[1], [name for _, name in outputs])}")
        start = {outputs.index(wanted): settings.lead for wanted in settings.start.items()}
        set_random_seed(_derived(self.job.request.seed, -1))  # the argument of PPO would also seed the worlds
        return RobotPPO(
            RobotPolicy,
            self.envs,
            rollout_buffer_class=RobotRollouts,
            rollout_buffer_kwargs={
                "deciding": self._working,
                "effective": self._effective,
                "parts": lambda: self.model.policy.action_dist.parts,
                "counts": self.envs.counts,
            },
            n_steps=settings.steps,
            batch_size=settings.minibatch,
            n_epochs=settings.epochs,
            learning_rate=settings.learning_rate,
            gamma=settings.discount,
            ent_coef=settings.entropy,
            policy_kwargs={
                "own": self.curriculum.batches[0].observer.width,
                "net_arch": {"pi": layers, "vf": layers},
                "counts": self.envs.counts,
                "start": start,
            },
            device="cpu",
        )

    def _decider_maker(self) -> DeciderMaker:
        return partial(PolicyDecider, self.policy())

    def _learned(self) -> dict[str, Any]:
        """Return copies of everything that the exported policy consists of."""
        state = {name: tensor.clone() for name, tensor in self.model.policy.state_dict().items()}
        return {"policy": state, "observations": _moments(self._seen)}

    def _apply(self, learned: dict[str, Any]) -> None:
        self.model.policy.load_state_dict(learned["policy"])
        _put(learned["observations"], self._seen)

    def _save(self) -> None:
        self.model.logger.dump(self.model.num_timesteps)
        content = {
            **self._learned(),
            "optimizer": self.model.policy.optimizer.state_dict(),
            "returns": _moments(self._paid),
            "updates": self.model._n_updates,
            "best": self._best,
            "history": self.history,
        }
        stream = io.BytesIO()
        torch.save(content, stream)
        self.job.folder.write(self.CHECKPOINT, stream.getvalue())

    def _loaded(self) -> Mapping[str, Any]:
        where = shown(self.checkpoint_file)
        try:
            content: dict[str, Any] = torch.load(self.checkpoint_file, weights_only=True)
            for name, weights in content["policy"].items():
                if not torch.isfinite(weights).all():
                    raise ValueError(f"{name}: expected finite numbers")
            found = validated(Checkpoint, {"history": content["history"]}, where)
            self._apply(content)
            self.model.policy.optimizer.load_state_dict(content["optimizer"])
            _put(content["returns"], self._paid)
            self.model.num_timesteps = found.history[-1].decisions
            self.model._n_updates, self._best = int(content["updates"]), content["best"]
        except DAMAGE as error:
            raise DocumentError(f"{where}: cannot be continued ({error})") from error
        return content


def _derived(seed: int, checkpoint: int) -> int:
    """Return the seed of the random numbers of learning after a checkpoint."""
    return int(np.random.SeedSequence([seed, checkpoint + 1, 2]).generate_state(1, np.uint32)[0])


def _moments(statistics: RunningMeanStd) -> dict[str, Any]:
    mean, variance = torch.tensor(statistics.mean), torch.tensor(statistics.var)
    return {"mean": mean, "variance": variance, "count": statistics.count}


def _put(moments: dict[str, Any], statistics: RunningMeanStd) -> None:
    statistics.mean, statistics.var = moments["mean"].numpy().copy(), moments["variance"].numpy().copy()
    statistics.count = moments["count"]
