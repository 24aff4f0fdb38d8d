"""Training of a strategy by the rewards that follow its choices, or by what whole missions cost, in many worlds.

Between two checkpoints everything follows from the checkpoint's number, the seed and the state saved there, as in the
training by PPO.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from selector.documents.arrays import load_arrays, save_arrays
from selector.store import KnowledgeStore, RewardSums
from selector.strategies.learned_file import save_strategy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from train.learning.by_missions import MissionLearning
from train.learning.by_rewards import RewardLearning
from train.learning.checkpoints import TrainingDirectory
from train.learning.config import TrainingConfig
from train.learning.credit import Paid
from train.learning.curriculum import Curriculum
from train.learning.protocol import Learning, columns_of
from train.learning.validation import Progress, measured
from train.running.trials import StrategyPilot, problem_of

CHECKPOINT, STRATEGY = "checkpoint.safetensors", "strategy.safetensors"

Ints = NDArray[np.int64]


class BanditTraining:
    """One training, checkpoint by checkpoint; the arguments are those of `PpoTraining`."""

    def __init__(
        self, config: TrainingConfig, seed: int, directory: TrainingDirectory, told: Callable[[int], None],
        directories: tuple[Path, ...] = (), store: KnowledgeStore | None = None,
    ) -> None:  # fmt: skip
        assert config.bandit is not None
        self.config, self.settings, self.seed, self.directory = config, config.bandit, seed, directory
        self._directories, self._told, self._store = directories, told, store
        self.curriculum = Curriculum(config, seed, directories)
        whole = problem_of(self.curriculum.batches[0])
        columns_of(whole, self.settings.context, "context")
        self.problem = Problem(whole.goal, whole.options, whole.scores, self.settings.context)
        self._learning: Learning = (
            MissionLearning(config, self.curriculum, directories) if self.settings.comparison is not None
            else RewardLearning(config, self.curriculum)
        )  # fmt: skip
        self.strategy = self._built(self.settings.strategy, self.problem, self._learning.teams)
        self.progress, self.checkpoint, self.decisions = Progress(), 0, 0
        self._best = self.strategy.learned()
        self._record = RewardSums(self.problem.goal, self.problem.options)
        if directory.begun:
            self._load()

    @property
    def finished(self) -> bool:
        """Whether all checkpoints are done, or nothing has become better for long."""
        patient = self.progress.since < self.config.validation.patience
        return self.checkpoint >= self.config.checkpoints or not patient

    def advance(self) -> None:
        """Learn up to the next checkpoint, measure what was learned, and save everything."""
        seeds = np.random.SeedSequence([self.seed, self.checkpoint, 2])
        self.strategy.reseed(np.arange(self.strategy.rows), row_keys(seeds, self.strategy.rows))
        costs = self._learning.learn(self.strategy, self.checkpoint, self._take)
        self.checkpoint += 1
        entry = {
            "checkpoint": self.checkpoint, "decisions": self.decisions, "missions": len(costs),
            "training_cost_s": float(np.mean(costs)) if costs else None,
        }  # fmt: skip
        if self.progress.note(entry, self._measured()):
            self._best = self.strategy.learned()
        self._save()
        if self._store is not None and self._record.count:
            self._store.add(self._record, source=f"{self.config.name}-seed{self.seed}")
        self._record = RewardSums(self.problem.goal, self.problem.options)

    def export(self, command: str) -> Path:
        """Write what the strategy had learned when it was best and return the file; `command` is in the manifest."""
        last, path = self.strategy.learned(), self.directory.path / STRATEGY
        self.strategy.load_learned(self._best)
        one = self._built(self.settings.learned, self.problem, np.zeros(1, dtype=np.int64))
        one.load_learned({name: array[:1] for name, array in self._best.items()})
        save_strategy(path, one)
        self.strategy.load_learned(last)
        return path

    def _take(self, paid: Paid, decisions: int) -> None:
        """Let the strategy learn from decisions whose rewards are complete, and count those that have been made."""
        self.decisions += decisions
        self._told(self.decisions)
        if not len(paid.rows):
            return
        self.strategy.update(paid.options, paid.rewards, paid.contexts, paid.rows, paid.chances)
        if self._store is not None:
            self._record.record(paid.options, paid.rewards, self.strategy.context_keys(paid.contexts))

    def _measured(self) -> dict[str, float]:
        if self.checkpoint % self.config.validation.every and self.checkpoint < self.config.checkpoints:
            return {}
        learned = self.strategy.learned()

        def pilot(problem: Problem, teams: Ints) -> StrategyPilot:
            known = Problem(problem.goal, problem.options, problem.scores, self.settings.context)
            own = self._built(self.settings.learned, known, teams)
            own.load_learned({name: array[:1] for name, array in learned.items()})
            return StrategyPilot(own, columns_of(problem, self.settings.context, "context"))

        return measured(self.curriculum.validation, pilot, self.config.observation, self._directories)

    def _built(self, spec: StrategySpec, problem: Problem, teams: Ints) -> DecisionStrategy:
        return spec.build(problem, row_keys(np.random.SeedSequence([self.seed, 3]), len(teams)), teams)

    def _save(self) -> None:
        arrays = {f"now.{name}": array for name, array in self.strategy.learned().items()}
        arrays |= {f"best.{name}": array for name, array in self._best.items()}
        description = {
            "checkpoint": self.checkpoint, "decisions": self.decisions, "history": self.progress.history,
            "best": self.progress.best if np.isfinite(self.progress.best) else None, "since": self.progress.since,
        }  # fmt: skip
        save_arrays(self.directory.checkpoint, arrays, description)
        self.directory.write_history(self.progress.history)

    def _load(self) -> None:
        arrays, told = load_arrays(self.directory.checkpoint)
        parts: dict[str, dict[str, NDArray[Any]]] = {"now": {}, "best": {}}
        for name, array in arrays.items():
            kind, _, own = name.partition(".")
            parts[kind][own] = array
        self.strategy.load_learned(parts["now"])
        self._best = parts["best"]
        self.checkpoint, self.decisions = told["checkpoint"], told["decisions"]
        best = float("inf") if told["best"] is None else told["best"]
        self.progress = Progress(told["history"], best, told["since"])
        self.directory.write_history(self.progress.history)
