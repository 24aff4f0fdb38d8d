"""A training from request to exported result: the directory, progress on the terminal, checkpoints, the end."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from selector.documents.errors import DocumentError
from train import knowledge_store as stores
from train.evaluation.plan import versions
from train.learning.checkpoints import TrainingDirectory
from train.learning.config import TrainingConfig, load_training

if TYPE_CHECKING:
    from collections.abc import Callable

    from train.learning.validation import Progress as Course

FINISHED, INTERRUPTED = 0, 130
PACKAGES = {"ppo": ("torch", "stable-baselines3"), "bandit": ()}
"""Packages that a learner needs besides those of all runs."""
DEFAULTS = {"ppo": "general", "bandit": "situations"}
"""Name of the training of each learner, unless told otherwise."""


@dataclass(frozen=True)
class TrainingRequest:
    """What the user asked for."""

    learner: str
    """`ppo` or `bandit`."""
    config: str
    """Name of a training, or path to its YAML file."""
    seed: int
    output: Path | None
    """Directory; one below results/ unless given."""
    resume: bool
    store: str | None = None
    """URL of a knowledge store that learned scores go to; none unless given."""
    directories: tuple[Path, ...] = ()

    @property
    def directory(self) -> Path:
        """Where the training keeps everything."""
        return self.output or Path("results") / f"{Path(self.config).stem}-{self.learner}-seed{self.seed}"

    def command(self, *, resume: bool) -> str:
        """Return the command that does this training."""
        words = ["clean-swarm", "train", self.learner, "--config", self.config, "--seed", str(self.seed)]
        words += ["--output", str(self.output)] if self.output is not None else []
        words += ["--store", self.store] if self.store is not None else []
        words += [word for path in self.directories for word in ("--configs", str(path))]
        return shlex.join([*words, "--resume"] if resume else words)


class Training(Protocol):
    """What the two learners have in common."""

    @property
    def progress(self) -> Course:
        """What the checkpoints have shown."""

    @property
    def finished(self) -> bool:
        """Whether it is over."""

    @property
    def decisions(self) -> int:
        """Decisions made so far."""

    def advance(self) -> None:
        """Learn up to the next checkpoint."""

    def export(self, command: str) -> Path:
        """Write what came out and return where."""


def train(request: TrainingRequest, console: Console) -> int:
    """Run a training, or go on with one; return the exit code. `console` shows what came out."""
    config = load_training(request.config, request.learner)
    identity = {
        "learner": request.learner,
        "seed": request.seed,
        "configuration": config.model_dump(mode="json"),
        "versions": versions() | _needed(request.learner),
        "directories": [str(path.resolve()) for path in request.directories],
    }
    checkpoint = "checkpoint.pt" if request.learner == "ppo" else "checkpoint.safetensors"
    directory = TrainingDirectory(request.directory, identity, checkpoint, resume=request.resume)
    try:
        with _progress(config) as told:
            training = _training(request, config, directory, told)
            told(training.decisions)
            while not training.finished:
                training.advance()
                _tell(console, training.progress.history[-1])
    except KeyboardInterrupt:
        errors = Console(stderr=True, highlight=False, soft_wrap=True)
        errors.print(f"interrupted; to go on:\n  {request.command(resume=True)}", markup=False)
        return INTERRUPTED
    exported = training.export(request.command(resume=False))
    console.print(f"exported to {exported}", soft_wrap=True, highlight=False)
    return FINISHED


def _needed(learner: str) -> dict[str, str]:
    """Return the versions of the packages that a learner needs besides; one that is missing raises DocumentError."""
    try:
        return {name: version(name) for name in PACKAGES[learner]}
    except PackageNotFoundError as error:
        install = "pip install -c constraints.txt '.[train]'"
        raise DocumentError(f"training by {learner} needs {error.name}, which is not installed: {install}") from error


def _training(
    request: TrainingRequest, config: TrainingConfig, directory: TrainingDirectory, told: Callable[[int], None]
) -> Training:
    if request.learner == "ppo":
        from train.learning.ppo import PpoTraining

        return PpoTraining(config, request.seed, directory, told, request.directories)
    from train.learning.bandit import BanditTraining

    store = stores.opened(request.store, create=True) if request.store is not None else None
    return BanditTraining(config, request.seed, directory, told, request.directories, store)


@contextmanager
def _progress(config: TrainingConfig) -> Iterator[Callable[[int], None]]:
    """Show a bar with the time left on the standard error; what it gives takes the number of decisions made."""
    columns = (TextColumn("decisions"), BarColumn(), TextColumn("{task.completed:,.0f}"), TimeElapsedColumn())
    with Progress(*columns, TextColumn("left"), TimeRemainingColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task("decisions", total=config.checkpoints * config.decisions)

        def told(decisions: int) -> None:
            bar.update(task, completed=decisions)

        yield told


def _tell(console: Console, entry: dict[str, Any]) -> None:
    shown = {name: round(value, 3) if isinstance(value, float) else value for name, value in entry.items()}
    console.print(json.dumps(shown), soft_wrap=True, highlight=False, markup=False)
