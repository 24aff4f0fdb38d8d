"""Training of a strategy in many worlds, by the rewards that follow its choices.

Rows decide when their situation changes, or after some time. A decision is credited with the discounted rewards within
a horizon; see `CreditConfig`.

Shapes: R rows, which are the robots of all worlds.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.learning.joined import Joined
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
from train.learning.lessons import Credit, Paid
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
        self._columns = columns_of(whole, self.settings.context, "context")
        self._watched = columns_of(whole, self.settings.credit.until, "until")
        self._joined = Joined(self.curriculum.batches)
        expert = expert_knowledge(self.curriculum.batches[0].mission, job.directories)
        known = expert.with_learned(learned_from(job.folder.learned, "manifest: learned"))
        self.problem = Problem.of(known, whole.goal, self.settings.context)
        self.strategy = self._built(self.settings.strategy, self.problem, self._joined.world_of)
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
        for paid in self._periods():
            self._decisions += self._joined.rows
            self.job.update(completed=self._decisions)
            costs += [end.result.excess_s for end in self._joined.finished]
            if len(paid.rows):
                self._learn_from(paid)
        return {"missions": len(costs), "training_excess_s": float(np.mean(costs)) if costs else None}

    def _periods(self) -> Iterator[Paid]:
        """Let the strategy decide until the next checkpoint; yield what it can learn after each period."""
        settings, period = self.settings.credit, self.curriculum.batches[0].mission.decision_period
        self.curriculum.set_scenarios(self.checkpoint)
        seen, rows = self._joined.reset(), self._joined.rows
        credit = Credit(rows, max(round(settings.horizon / period), 1), len(self._columns), settings.discount**period)
        hold = round(settings.hold / period) or np.iinfo(np.int64).max
        left, options = np.zeros(rows, dtype=np.int64), np.zeros(rows, dtype=np.int64)
        watched = seen[:, self._watched].copy()
        for _ in range(-(-self.config.decisions // rows)):
            changed = (seen[:, self._watched] != watched).any(axis=1)
            watched = seen[:, self._watched].copy()
            deciding = np.flatnonzero(((left <= 0) | changed) & self._joined.working)
            if len(deciding):
                context = seen[deciding][:, self._columns].astype(np.float64)
                options[deciding] = self.strategy.select(context, rows=deciding)
                credit.decide(deciding, options[deciding], context, self.strategy.chance[deciding])
                left[deciding] = hold
            step = self._joined.step(self.goal.actions(options))
            over = (step.terminated | step.truncated)[self._joined.world_of]
            left -= 1
            left[over] = 0
            seen = step.observations
            yield credit.pay(step.rewards, over)

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
