"""The base class of all trainings, with checkpoints, validation and the end of a training.

What happens between two checkpoints depends only on the number of the checkpoint, the seed and the saved state. A
training that is killed and resumed therefore gives the same bits (docs/decisions/0016-checkpoints-begin-anew.md).

A checkpoint is one file that is replaced whole, so that a kill at any moment leaves the old or the new file. Everything
else in the directory is made from the checkpoint and can be written again.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.recording.recorder import RecordSettings
from selector.knowledge import Knowledge, load_knowledge
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import DeciderMaker
from train.knowledge_store import Memory
from train.learning.config import TrainingConfig
from train.learning.curriculum import Curriculum
from train.learning.validation import CheckpointDescription, CheckpointHistory, measured
from train.running.engine import Round, in_turn
from train.running.run_folder import RunFolder
from train.running.trials import TrialSettings

HISTORY_FILE = "history.jsonl"


@dataclass(frozen=True)
class TrainingJob:
    """The work of a training, and its directory."""

    config: TrainingConfig
    seed: int
    """Seed of everything random."""
    folder: RunFolder
    """Directory of the training, which continues from the checkpoint there."""
    on_progress: Callable[[int], None] = lambda _: None
    """Called repeatedly with the number of decisions made."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    record: RecordSettings | None = None
    """How the missions of validations are recorded, in a directory below that of the training; they are not unless
    given."""
    memory: Memory | None = None
    """The knowledge store, which gets the rewards if the training learns for it."""
    parts: int = 1
    """Tasks that missions of members are cut into; the training is the same with any number."""
    done: Round = in_turn
    """Does tasks."""


def expert_knowledge(mission: MissionConfig, directories: Sequence[Path]) -> Knowledge:
    """Return what experts say of the options of a mission; what missions taught is on another scale than rewards."""
    return replace(load_knowledge(mission.knowledge, directories), learned={})


class Training(ABC):
    """One training, checkpoint by checkpoint.

    Attributes:
        curriculum: the worlds to train in.
        goal: the goal whose options are learned.
        history: figures of the checkpoints.
        checkpoint: number of checkpoints done.

    """

    CHECKPOINT: ClassVar[str]
    """Name of the file with the last checkpoint."""

    def __init__(self, job: TrainingJob) -> None:
        self.job, self.config = job, job.config
        self.curriculum = Curriculum(job.config, job.seed, job.directories)
        self.goal = DecidedGoal(self.curriculum.batches[0], job.config.goal)
        self.trials = TrialSettings(
            self.goal.problem.goal,
            observation=job.config.observation,
            directories=job.directories,
            action=job.config.action,
        )
        self.history, self.checkpoint = CheckpointHistory(), 0

    @property
    def finished(self) -> bool:
        """Whether all checkpoints are done, or the best score is older than the patience allows."""
        patient = self.history.since < self.config.validation.patience
        return self.checkpoint >= self.config.checkpoints or not patient

    @property
    def checkpoint_file(self) -> Path:
        """The file with the last checkpoint."""
        return self.job.folder.path / self.CHECKPOINT

    def advance(self) -> None:
        """Learn up to the next checkpoint, validate, and save everything."""
        learned = self._learn()
        self.checkpoint += 1
        figures = self._measured()
        entry = {"checkpoint": self.checkpoint, "decisions": self.decisions, **learned}
        if self.history.note(entry, figures):
            self._keep_best()
        self._save({**entry, **figures})
        self.write_history()

    def write_history(self) -> None:
        """Write one line for each checkpoint to the directory."""
        self.job.folder.write(HISTORY_FILE, "".join(json.dumps(entry) + "\n" for entry in self.history.entries))

    def about(self, command: str) -> dict[str, Any]:
        """Return how the best result was trained, for its file."""
        configuration = self.config.model_dump(mode="json")
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

    def _description(self) -> dict[str, Any]:
        """Return the content of `CheckpointDescription`."""
        best = self.history.best if np.isfinite(self.history.best) else None
        counted = {"checkpoint": self.checkpoint, "decisions": self.decisions}
        return {**counted, "history": self.history.entries, "best": best, "since": self.history.since}

    def _go_on(self, description: CheckpointDescription) -> None:
        """Continue after the checkpoint that is described."""
        self.checkpoint = description.checkpoint
        best = float("inf") if description.best is None else description.best
        self.history = CheckpointHistory(list(description.history), best, description.since)
        self.write_history()

    def _measured(self) -> dict[str, float]:
        if self.checkpoint % self.config.validation.every and self.checkpoint < self.config.checkpoints:
            return {}
        return measured(
            self.curriculum.validation, self._decider_maker(), replace(self.trials, record=self._recording())
        )

    def _recording(self) -> RecordSettings | None:
        record, name = self.job.record, f"checkpoint-{self.checkpoint}"
        if record is None:
            return None
        directory = self.job.folder.path / record.directory / name
        return replace(record, directory=directory, about={"experiment": self.config.name, "condition": name})
