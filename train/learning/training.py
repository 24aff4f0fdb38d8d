"""The base class of all trainings, with checkpoints, validation and the end of a training.

What happens between two checkpoints depends only on the number of the checkpoint, the seed and the saved state. A
training that is killed and resumed therefore gives the same bits (docs/decisions/0016-checkpoints-begin-anew.md).

A checkpoint is one file that is replaced whole, so that a kill at any moment leaves the old or the new file. Everything
else in the directory is made from the checkpoint and can be written again.

Validation tells what missions cost on scenarios that no training uses.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.deciders.decided_goal import AskedGoal, DecidedGoal
from clean_swarm_env.deciders.decider import DeciderMaker
from clean_swarm_env.world.mission import MissionResult
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Number
from selector.knowledge import Knowledge, load_knowledge
from selector.store import RewardSums
from train.learning.config import TrainingConfig
from train.learning.credit import Paid
from train.learning.curriculum import Curriculum
from train.learning.yardstick import (
    VALIDATION_FILE,
    Excesses,
    Results,
    Validation,
    best_fixed,
    excesses,
    results_on,
    validation_in,
)
from train.memory import Memory
from train.request import Request
from train.running.engine import Round, in_turn
from train.running.run_folder import RunFolder
from train.running.trials import TrialSettings

LEAST_EXCESS = 0.01
"""Excess [s] that counts for less: it has to have a logarithm."""


def judged(result: MissionResult) -> float:
    """Return what learners learn from [s]: the excess, by which tables compare."""
    return max(result.excess_s, LEAST_EXCESS)


FIGURES: dict[str, Callable[[MissionResult], float]] = {
    "cost_s": lambda result: result.cost_s,
    "excess_s": judged,
    "completed": lambda result: result.completed,
    "duration_s": lambda result: result.duration_s,
    "events_per_s": lambda result: result.collision_events_per_s[0],
}
"""Name -> figure of a validation mission."""


def figures_of(results: Results) -> dict[str, float]:
    """Return means for each family: cost, excess, share of completed missions, duration [s], collision events [1/s]."""
    return {
        f"{family}/{name}": float(np.mean([figure(result) for result in own]))
        for family, own in results.items()
        for name, figure in FIGURES.items()
    }


def score_of(figures: Mapping[str, float]) -> float | None:
    """Return the mean over families of the logarithm of the excess: families of high costs count no more."""
    costs = [value for name, value in figures.items() if name.endswith("/excess_s")]
    return float(np.mean(np.log(costs))) if costs else None


class CheckpointEntry(BaseModel):
    """What an entry of the history says at least."""

    model_config = ConfigDict(extra="allow", frozen=True)

    decisions: Annotated[int, Field(strict=True, ge=0)]
    """Decisions made so far."""
    score: Number | None
    """Mean logarithm of the excess; None: not measured."""


class Checkpoint(Closed):
    """The entries of a checkpoint beside the learned state."""

    history: Annotated[tuple[CheckpointEntry, ...], Field(min_length=1)]
    """Figures of the checkpoints so far."""


HISTORY_FILE = "history.jsonl"


@dataclass(frozen=True)
class TrainingJob:
    """The work of a training, and its directory."""

    config: TrainingConfig
    request: Request
    """What was asked for; the training is the same on any machine."""
    folder: RunFolder
    """Directory of the training, which continues from the checkpoint there."""
    update: Callable[..., None] = lambda **_: None
    """Shows what is done; see `progress`."""
    memory: Memory | None = None
    """The knowledge store, which gets the rewards if the training learns for it."""
    done: Round = in_turn
    """Does tasks."""


def expert_knowledge(mission: MissionConfig, directories: Sequence[Path]) -> Knowledge:
    """Return what experts say of the options of a mission; what missions taught is on another scale than rewards."""
    return replace(load_knowledge(mission.knowledge, directories), learned={})


class Training(ABC):
    """One training, checkpoint by checkpoint.

    Args:
        job: the work, and its directory.

    Attributes:
        curriculum: the worlds to train in.
        goal: the goal whose options are learned.
        decisions: number of decisions so far, which a learner counts.
        history: an entry of figures for each checkpoint.
        validation: what the best checkpoint loses on validation; None before the first.

    """

    CHECKPOINT: ClassVar[str]
    """Name of the file with the last checkpoint."""
    alike: ClassVar[bool] = True
    """Whether all families must have the same options."""
    _best: Any

    def __init__(self, job: TrainingJob) -> None:
        self.job, self.config = job, job.config
        request = job.request
        self.curriculum = Curriculum(job.config, request.seed, request.directories, request.machine.threads)
        first, *others = self.curriculum.batches
        self.goal = DecidedGoal(first, self.decides)
        for batch in others if self.alike else ():
            if batch.options != first.options:
                expected, got = f"{dict(first.options)} as in the first", dict(batch.options)
                raise DocumentError(f"tasks: {batch.mission.name}: options: expected {expected}, got {got}")
        self.trials = TrialSettings(
            self.decides or self.goal.problem.goal,
            observation=job.config.observation,
            directories=request.directories,
        )
        self.decisions, self.history = 0, list[dict[str, Any]]()
        self.validation = validation_in(job.folder.path)
        self._costs: list[float] = []  # excess [s] of missions since the last checkpoint
        self._sums: dict[str, RewardSums] = {}
        self.checkpoint_file = job.folder.path / self.CHECKPOINT
        self._make()
        if self.checkpoint_file.is_file():
            self.history = list(self._loaded()["history"])
            self.decisions = int(self.history[-1]["decisions"])
            self._write_history()

    @property
    def decides(self) -> AskedGoal:
        """The goals whose options are learned."""
        return self.config.goal

    @property
    def finished(self) -> bool:
        """Whether all checkpoints are done."""
        return self.checkpoint >= self.config.checkpoints

    @property
    def checkpoint(self) -> int:
        """Number of checkpoints done."""
        return len(self.history)

    def advance(self) -> None:
        """Learn up to the next checkpoint, validate, and save everything."""
        number = self.checkpoint + 1
        self._costs.clear()
        further = self._learn()
        excess = float(np.mean(self._costs)) if self._costs else None
        results = self._validate(number)
        figures = figures_of(results)
        score, scores = score_of(figures), [entry["score"] for entry in self.history if entry["score"] is not None]
        best = score is not None and score < min(scores, default=np.inf)
        entry = {"checkpoint": number, "decisions": self.decisions, **further, "training_excess_s": excess}
        self.history.append({**entry, **figures, "score": score, "best": best})
        if best:
            self._best = self._learned()
            self._keep_validation(excesses(results))
        self._save()
        if self._sums and self.job.memory is not None:
            self.job.memory.give_sums(*self._sums.values())
            self._sums = {}
        self._write_history()

    def about(self, command: str) -> dict[str, Any]:
        """Return how the best result was trained, for its file."""
        configuration, first = self.config.model_dump(mode="json"), self.curriculum.batches[0]
        configuration["observation"] = first.observer.config.model_dump(mode="json")
        if not isinstance(self.config.reward, str):
            configuration["reward"] = first.rewards.weights
        figures = min(self.history, key=lambda entry: entry["score"] or np.inf, default={})
        return {"command": command, "seed": self.job.request.seed, "configuration": configuration, "figures": figures}

    @abstractmethod
    def export(self, command: str) -> Path:
        """Write the best result so far and return its path; `command` is that of the training."""

    @abstractmethod
    def _make(self) -> None:
        """Make what learns, and `_best`, what is exported if nothing was measured."""

    @abstractmethod
    def _learn(self) -> dict[str, Any]:
        """Learn up to the next checkpoint, note `decisions` and `_costs`; return further figures for the history."""

    @abstractmethod
    def _decider_maker(self) -> DeciderMaker:
        """Return a maker of deciders with the present learned state."""

    @abstractmethod
    def _learned(self) -> Any:  # noqa: ANN401  (each learner has a state of its own)
        """Return a copy of the present learned state, which is kept if it is the best so far."""

    @abstractmethod
    def _save(self) -> None:
        """Write the checkpoint."""

    @abstractmethod
    def _loaded(self) -> Mapping[str, Any]:
        """Continue after the checkpoint, and return its content, with the history."""

    def _note(self, decisions: int, costs: Sequence[float] = ()) -> None:
        """Note how many decisions were made so far, and what missions that have just ended cost; show it."""
        self.decisions = decisions
        self._costs += costs
        self.job.update(completed=decisions)

    def _record(self, goal: str, options: Sequence[str], paid: Paid) -> None:
        """Keep what options brought for the knowledge store, which gets it once a checkpoint is saved."""
        if self.job.memory is not None and self.job.memory.learns:
            self._sums.setdefault(goal, RewardSums(goal, options)).record(paid.options, paid.rewards)

    def _write_history(self) -> None:
        """Write one line for each checkpoint to the directory."""
        self.job.folder.write(HISTORY_FILE, "".join(json.dumps(entry) + "\n" for entry in self.history))

    def _validate(self, checkpoint: int) -> Results:
        """Return the results of the validation missions of each family; none where a checkpoint is not measured."""
        if checkpoint % self.config.validation.every and checkpoint < self.config.checkpoints:
            return {}
        self.job.update(more="validating")
        return results_on(self.curriculum.validation, self._decider_maker(), self.trials)

    def _keep_validation(self, learned: Excesses) -> None:
        """Write what the best checkpoint loses on validation beside the best fixed options."""
        start = self.config.ppo.start.values() if self.config.ppo is not None else ()
        settings, known = TrialSettings(self.trials.goal, directories=self.job.request.directories), self.validation
        held, yardstick = (
            (known.held, known.yardstick)
            if known is not None
            else best_fixed(self.curriculum.validation, self.goal.problem, tuple(start), settings)
        )
        self.validation = Validation(learned=learned, yardstick=yardstick, held=held)
        self.job.folder.write(VALIDATION_FILE, self.validation.model_dump_json(indent=2) + "\n")
