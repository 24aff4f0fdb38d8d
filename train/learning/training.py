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
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.mission import MissionResult
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Number
from selector.knowledge import Knowledge, load_knowledge
from train.deciders.decided_goal import AskedGoal, DecidedGoal
from train.deciders.decider import DeciderMaker
from train.learning.config import TrainingConfig
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
from train.running.engine import Round, in_turn
from train.running.run_folder import RunFolder
from train.running.trials import TrialSettings

LEAST_EXCESS = 0.01
"""Excess [s] that counts for less: it has to have a logarithm."""


def judged(result: MissionResult) -> float:
    """Return what learners learn from [s]: the excess, by which tables compare."""
    return max(result.excess_s, LEAST_EXCESS)


def figures_of(results: Results) -> dict[str, float]:
    """Return means for each family: cost, excess, share of completed missions, duration [s], collision events [1/s]."""
    names = ("cost_s", "excess_s", "completed", "duration_s", "events_per_s")
    figures = {}
    for family, own in results.items():
        rows = [(r.cost_s, judged(r), r.completed, r.duration_s, r.collision_events_per_s[0]) for r in own]
        for name, values in zip(names, zip(*rows, strict=True), strict=True):
            figures[f"{family}/{name}"] = float(np.mean(values))
    return figures


@dataclass
class CheckpointHistory:
    """Figures of all checkpoints so far."""

    entries: list[dict[str, Any]] = field(default_factory=list)
    """One entry for each checkpoint."""

    @property
    def scores(self) -> list[float]:
        """The scores of all measurements so far."""
        return [entry["score"] for entry in self.entries if entry["score"] is not None]

    def note(self, entry: dict[str, Any], figures: Mapping[str, float]) -> bool:
        """Add a checkpoint's entry and its figures; return whether it is the best so far.

        The score is the mean over families of the logarithm of the excess: families of high costs count no more.
        """
        costs = [value for name, value in figures.items() if name.endswith("/excess_s")]
        score = float(np.mean(np.log(costs))) if costs else None
        better = score is not None and score < min(self.scores, default=float("inf"))
        self.entries.append({**entry, **figures, "score": score, "best": better})
        return better


class CheckpointEntry(BaseModel):
    """What an entry of the history says at least."""

    model_config = ConfigDict(extra="allow", frozen=True)

    decisions: Annotated[int, Field(strict=True, ge=0)]
    """Decisions made so far."""
    score: Number | None
    """Mean logarithm of the excess; None: not measured."""


def _checked(entry: dict[str, Any]) -> dict[str, Any]:
    CheckpointEntry.model_validate(entry)
    return entry  # whose keys keep their order


class Checkpoint(Closed):
    """The entries of a checkpoint beside the learned state."""

    history: Annotated[tuple[Annotated[dict[str, Any], AfterValidator(_checked)], ...], Field(min_length=1)]
    """Figures of the checkpoints so far."""

    @property
    def decisions(self) -> int:
        """Decisions made so far."""
        return int(self.history[-1]["decisions"])


HISTORY_FILE = "history.jsonl"


@dataclass(frozen=True)
class TrainingJob:
    """The work of a training, and its directory."""

    config: TrainingConfig
    seed: int
    """Seed of everything random."""
    folder: RunFolder
    """Directory of the training, which continues from the checkpoint there."""
    update: Callable[..., None] = lambda **_: None
    """Shows what is done; see `progress`."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    memory: Memory | None = None
    """The knowledge store, which gets the rewards if the training learns for it."""
    parts: int = 1
    """Tasks that missions of members are cut into; the training is the same with any number."""
    done: Round = in_turn
    """Does tasks."""
    threads: int = 1
    """Threads that step the worlds; the training is the same with any number."""


def expert_knowledge(mission: MissionConfig, directories: Sequence[Path]) -> Knowledge:
    """Return what experts say of the options of a mission; what missions taught is on another scale than rewards."""
    return replace(load_knowledge(mission.knowledge, directories), learned={})


class Training(ABC):
    """One training, checkpoint by checkpoint.

    Attributes:
        curriculum: the worlds to train in.
        goal: the goal whose options are learned.
        history: figures of the checkpoints.

    """

    CHECKPOINT: ClassVar[str]
    """Name of the file with the last checkpoint."""
    alike: ClassVar[bool] = True
    """Whether all families must have the same options."""

    def __init__(self, job: TrainingJob) -> None:
        self.job, self.config = job, job.config
        self.curriculum = Curriculum(job.config, job.seed, job.directories, job.threads)
        first, *others = self.curriculum.batches
        self.goal = DecidedGoal(first, self.decides)
        for batch in others if self.alike else ():
            if batch.options != first.options:
                expected, got = f"{dict(first.options)} as in the first", dict(batch.options)
                raise DocumentError(f"tasks: {batch.mission.name}: options: expected {expected}, got {got}")
        self.trials = TrialSettings(
            self.decides or self.goal.problem.goal,
            observation=job.config.observation,
            directories=job.directories,
            action=job.config.action,
        )
        self.history = CheckpointHistory()
        self.validation = validation_in(job.folder.path)
        self._validated: Excesses = {}

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
        return len(self.history.entries)

    @property
    def checkpoint_file(self) -> Path:
        """The file with the last checkpoint."""
        return self.job.folder.path / self.CHECKPOINT

    def advance(self) -> None:
        """Learn up to the next checkpoint, validate, and save everything."""
        learned = self._learn()
        number = self.checkpoint + 1
        figures = self._measured(number)
        entry = {"checkpoint": number, "decisions": self.decisions, **learned}
        if self.history.note(entry, figures):
            self._keep_best()
            self._keep_validation()
        self._save({**entry, **figures})
        self.write_history()

    def write_history(self) -> None:
        """Write one line for each checkpoint to the directory."""
        self.job.folder.write(HISTORY_FILE, "".join(json.dumps(entry) + "\n" for entry in self.history.entries))

    def about(self, command: str) -> dict[str, Any]:
        """Return how the best result was trained, for its file."""
        configuration, first = self.config.model_dump(mode="json"), self.curriculum.batches[0]
        configuration["observation"] = first.observer.config.model_dump(mode="json")
        if not isinstance(self.config.reward, str):
            configuration["reward"] = first.rewards.weights
        figures = min(self.history.entries, key=lambda entry: entry["score"] or np.inf, default={})
        return {"command": command, "seed": self.job.seed, "configuration": configuration, "figures": figures}

    @property
    @abstractmethod
    def decisions(self) -> int:
        """Decisions made so far."""

    @abstractmethod
    def export(self, command: str) -> Path:
        """Write the best result so far and return its path; `command` is that of the training."""

    @abstractmethod
    def _learn(self) -> dict[str, Any]:
        """Learn up to the next checkpoint and return figures for the history."""

    @abstractmethod
    def _decider_maker(self) -> DeciderMaker:
        """Return a maker of deciders with the present learned state."""

    @abstractmethod
    def _keep_best(self) -> None:
        """Keep the present state, the best so far, for the export."""

    @abstractmethod
    def _save(self, figures: dict[str, Any]) -> None:
        """Write the checkpoint; `figures` are its entry in the history."""

    def _go_on(self, done: Checkpoint) -> None:
        """Continue after a checkpoint."""
        self.history = CheckpointHistory(list(done.history))
        self.write_history()

    def _measured(self, checkpoint: int) -> dict[str, float]:
        """Return the figures of a checkpoint; none where it is not measured."""
        if checkpoint % self.config.validation.every and checkpoint < self.config.checkpoints:
            return {}
        self.job.update(more="validating")
        results = results_on(self.curriculum.validation, self._decider_maker(), self.trials)
        self._validated = excesses(results)
        return figures_of(results)

    def _keep_validation(self) -> None:
        """Write what the best checkpoint loses on validation beside the best fixed options."""
        if self.validation is None:
            start = self.config.ppo.start.values() if self.config.ppo is not None else ()
            settings = TrialSettings(self.trials.goal, directories=self.job.directories)
            held, yardstick = best_fixed(self.curriculum.validation, self.goal.problem, tuple(start), settings)
        else:
            held, yardstick = self.validation.held, self.validation.yardstick
        self.validation = Validation(learned=self._validated, yardstick=yardstick, held=held)
        self.job.folder.write(VALIDATION_FILE, self.validation.model_dump_json(indent=2) + "\n")
