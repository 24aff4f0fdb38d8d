"""Training of a strategy in many worlds, by the rewards that follow its choices.

Rows decide when their situation changes, or after some time. A decision is credited with the discounted rewards within
a horizon; see `CreditConfig`.

Shapes: R rows, which are the robots of all worlds.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.deciders.decider import DeciderMaker, columns_of
from clean_swarm_env.deciders.strategies import StrategyDecider
from clean_swarm_env.learning.joined import Joined
from selector.documents.arrays import Arrays, check_same_names, load_arrays, save_arrays
from selector.documents.errors import shown, validated, within
from selector.knowledge import learned_from
from selector.strategies.learned_file import save_strategy
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from train.learning.credit import Credit
from train.learning.training import Checkpoint, Training, expert_knowledge

STRATEGY, STATES = "strategy.safetensors", ("best", "now")


class BanditTraining(Training):
    """One training of a strategy, which begins with what a knowledge store knew of the options."""

    CHECKPOINT = "checkpoint.safetensors"

    def _make(self) -> None:
        settings, whole = self.config.bandit, self.goal.problem
        assert settings is not None
        self.settings, self._joined = settings, Joined(self.curriculum.batches)
        self._columns = columns_of(whole, settings.context, "context")
        self._watched = columns_of(whole, settings.credit.until, "until")
        expert = expert_knowledge(self.curriculum.batches[0].mission, self.job.request.directories)
        known = expert.with_learned(learned_from(self.job.folder.learned, "manifest: learned"))
        self.problem = Problem.of(known, whole.goal, settings.context)
        keys = row_keys(np.random.SeedSequence(0), self._joined.rows)  # others for each checkpoint
        self.strategy = settings.strategy.build(self.problem, keys, self._joined.world_of)
        self._best = self.strategy.learned()

    def export(self, command: str) -> Path:
        """Write the best strategy so far and return the file."""
        path = self.job.folder.path / STRATEGY
        save_strategy(path, self._decider(self._best, self.goal.problem, np.zeros(1, dtype=np.int64)).strategy)
        return path

    def _learn(self) -> dict[str, Any]:
        """Let the strategy decide until the next checkpoint, and learn of each decision whose rewards are complete."""
        settings, period = self.settings.credit, self.curriculum.batches[0].mission.decision_period
        seeds, rows = np.random.SeedSequence([self.job.request.seed, self.checkpoint, 2]), self._joined.rows
        self.strategy.reseed(np.arange(rows), row_keys(seeds, rows))
        self.curriculum.set_scenarios(self.checkpoint)
        seen = self._joined.reset()
        credit = Credit(settings, period, rows, len(self._columns))
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
            over, seen = (step.terminated | step.truncated)[self._joined.world_of], step.observations
            left = np.where(over, 0, left - 1)
            paid = credit.pay(step.rewards, over)
            if len(paid.rows):
                self.strategy.update(*paid)
                self._record(self.problem.goal, self.problem.options, paid)
            self._note(self.decisions + rows, [end.result.excess_s for end in self._joined.finished])
        return {"missions": len(self._costs)}

    def _decider_maker(self) -> DeciderMaker:
        return partial(self._decider, self.strategy.learned())

    def _decider(self, learned: Arrays, problem: Problem, teams: Ints) -> StrategyDecider:
        """Return what decides as the first world has learned to."""
        decider = StrategyDecider(self.settings.learned, problem, teams, features=self.settings.context)
        decider.strategy.load_learned({name: array[:1] for name, array in learned.items()})
        return decider

    def _learned(self) -> Arrays:
        return self.strategy.learned()

    def _save(self) -> None:
        arrays = {f"now.{name}": array for name, array in self.strategy.learned().items()}
        arrays |= {f"best.{name}": array for name, array in self._best.items()}
        save_arrays(self.checkpoint_file, arrays, {"history": self.history})

    def _loaded(self) -> Mapping[str, Any]:
        arrays, content = load_arrays(self.checkpoint_file)
        where = shown(self.checkpoint_file)
        validated(Checkpoint, content, where)
        check_same_names(
            where, "arrays", STATES, tuple(sorted({*STATES, *(name.partition(".")[0] for name in arrays)}))
        )
        parts = {
            part: {name[len(part) + 1 :]: array for name, array in arrays.items() if name.startswith(part)}
            for part in STATES
        }
        for part, own in parts.items():
            with within(f"{where}: {part}"):
                self.strategy.load_learned(own)
        self._best = parts["best"]
        return content
