"""Training of a strategy in many worlds, by the rewards that follow its choices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from selector.documents.arrays import Arrays, check_same_names, load_arrays, save_arrays
from selector.documents.errors import shown, validated, within
from selector.knowledge import learned_from
from selector.store import RewardSums
from selector.strategies.learned_file import save_strategy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from train.deciders.decider import DeciderMaker, columns_of
from train.deciders.strategies import StrategyDecider
from train.learning.lessons import Paid, RewardLearning
from train.learning.training import Checkpoint, Training, TrainingJob, expert_knowledge

STRATEGY = "strategy.safetensors"


class BanditTraining(Training):
    """One training of a strategy.

    Args:
        job: the work, and its directory with what a knowledge store knew of the options.

    """

    CHECKPOINT = "checkpoint.safetensors"

    def __init__(self, job: TrainingJob) -> None:
        super().__init__(job)
        assert job.config.bandit is not None
        self.settings = job.config.bandit
        whole = self.goal.problem
        columns_of(whole, self.settings.context, "context")
        expert = expert_knowledge(self.curriculum.batches[0].mission, job.directories)
        known = expert.with_learned(learned_from(job.folder.learned, "manifest: learned"))
        self.problem = Problem.of(known, whole.goal, self.settings.context)
        self._learning = RewardLearning(job.config, self.curriculum, self.goal)
        self.strategy = self._built(self.settings.strategy, self.problem, self._learning.teams)
        self._decisions = 0
        self._best = self.strategy.learned()
        self._record = RewardSums(self.problem.goal, self.problem.options)
        if self.checkpoint_file.is_file():
            self._load()

    @property
    def decisions(self) -> int:
        """Decisions made so far."""
        return self._decisions

    def export(self, command: str) -> Path:
        """Write the best strategy so far and return the file."""
        last, path = self.strategy.learned(), self.job.folder.path / STRATEGY
        self.strategy.load_learned(self._best)
        one = self._built(self.settings.learned, self.problem, np.zeros(1, dtype=np.int64))
        one.load_learned({name: array[:1] for name, array in self._best.items()})
        save_strategy(path, one)
        self.strategy.load_learned(last)
        return path

    def _learn(self) -> dict[str, Any]:
        seeds = np.random.SeedSequence([self.job.seed, self.checkpoint, 2])
        self.strategy.reseed(np.arange(self.strategy.rows), row_keys(seeds, self.strategy.rows))
        costs: list[float] = []
        for paid, decisions, ended in self._learning.lessons(self.strategy, self.checkpoint):
            self._decisions += decisions
            self.job.update(completed=self._decisions)
            costs += ended
            if len(paid.rows):
                self._learn_from(paid)
        return {"missions": len(costs), "training_excess_s": float(np.mean(costs)) if costs else None}

    def _learn_from(self, paid: Paid) -> None:
        """Update the strategy by decisions whose rewards are complete."""
        self.strategy.update(paid.options, paid.rewards, paid.contexts, paid.rows, paid.chances)
        memory = self.job.memory
        if memory is not None and memory.learns:
            self._record.record(paid.options, paid.rewards)

    def _decider_maker(self) -> DeciderMaker:
        learned = self.strategy.learned()

        def decider(problem: Problem, teams: Ints) -> StrategyDecider:
            own = StrategyDecider(self.settings.learned, problem, teams, features=self.settings.context)
            own.strategy.load_learned({name: array[:1] for name, array in learned.items()})
            return own

        return decider

    def _built(self, spec: StrategySpec, problem: Problem, teams: Ints) -> DecisionStrategy:
        keys = row_keys(np.random.SeedSequence([self.job.seed, 3]), len(teams))
        return spec.build(problem, keys, teams)

    def _keep_best(self) -> None:
        self._best = self.strategy.learned()

    def _save(self, figures: dict[str, Any]) -> None:
        arrays = {f"now.{name}": array for name, array in self.strategy.learned().items()}
        arrays |= {f"best.{name}": array for name, array in self._best.items()}
        save_arrays(self.checkpoint_file, arrays, {"history": self.history.entries})
        if self.job.memory is not None and self._record.count:
            self.job.memory.give_sums(self._record)
        self._record = RewardSums(self.problem.goal, self.problem.options)

    def _load(self) -> None:
        arrays, content = load_arrays(self.checkpoint_file)
        where = shown(self.checkpoint_file)
        found = validated(Checkpoint, content, where)
        parts: dict[str, Arrays] = {"now": {}, "best": {}}
        for name, array in arrays.items():
            kind, _, own = name.partition(".")
            parts.setdefault(kind, {})[own] = array
        check_same_names(where, "arrays", ("best", "now"), tuple(sorted(parts)))
        for kind in ("best", "now"):
            with within(f"{where}: {kind}"):
                self.strategy.load_learned(parts[kind])
        self._best, self._decisions = parts["best"], found.decisions
        self._go_on(found)
