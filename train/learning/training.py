"""The blueprint of all trainings: checkpoints, validation, and when a training is over.

Between two checkpoints everything follows from the number of the checkpoint, the seed and the state saved there. So a
training that was killed and resumed comes to the same bits.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from train.learning.checkpoints import TrainingFolder
from train.learning.config import TrainingConfig
from train.learning.curriculum import Curriculum
from train.learning.validation import CheckpointHistory, measured
from train.running.decided_goal import DecidedGoal
from train.running.pilots import PilotMaker
from train.running.trials import TrialSettings


@dataclass(frozen=True)
class TrainingJob:
    """What a training is to do, and where."""

    config: TrainingConfig
    seed: int
    """Seed of everything random."""
    folder: TrainingFolder
    """Where the training keeps everything; it goes on from the checkpoint there."""
    on_progress: Callable[[int], None]
    """Called again and again with the number of decisions made."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""


class Training(ABC):
    """One training, checkpoint by checkpoint.

    Attributes:
        curriculum: the worlds to train in.
        goal: the goal that is learned.
        history: what the checkpoints have shown.
        checkpoint: number of checkpoints done.

    """

    CHECKPOINT: ClassVar[str]
    """Name of the file with the last checkpoint."""

    def __init__(self, job: TrainingJob) -> None:
        self.job, self.config = job, job.config
        self.curriculum = Curriculum(job.config, job.seed, job.directories)
        self.goal = DecidedGoal(self.curriculum.batches[0], job.config.goal)
        self.trials = TrialSettings(
            self.goal.problem.goal, observation=job.config.observation, directories=job.directories
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
        """Learn up to the next checkpoint, measure what was learned, and save everything."""
        learned = self._learn()
        self.checkpoint += 1
        figures = self._measured()
        entry = {"checkpoint": self.checkpoint, "decisions": self.decisions, **learned}
        if self.history.note(entry, figures):
            self._keep_best()
        self._save({**entry, **figures})
        self.job.folder.write_history(self.history.entries)

    @property
    @abstractmethod
    def decisions(self) -> int:
        """Decisions made so far."""

    @abstractmethod
    def export(self, command: str) -> Path:
        """Write the best result so far and return its path; `command` is the one that did the training."""

    @abstractmethod
    def _learn(self) -> dict[str, Any]:
        """Learn up to the next checkpoint and return figures for the history."""

    @abstractmethod
    def _pilot_maker(self) -> PilotMaker:
        """Return a maker of pilots that choose by what was learned so far."""

    @abstractmethod
    def _keep_best(self) -> None:
        """Keep what was learned so far, which is the best yet, for the export."""

    @abstractmethod
    def _save(self, figures: dict[str, Any]) -> None:
        """Write the checkpoint; `figures` are its entry in the history."""

    def _measured(self) -> dict[str, float]:
        if self.checkpoint % self.config.validation.every and self.checkpoint < self.config.checkpoints:
            return {}
        return measured(self.curriculum.validation, self._pilot_maker(), self.trials)
