"""The session of a training: from the user's request to the exported result, with directory and progress bar."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import TextColumn

from clean_swarm_env.learning.batch import compile_missions
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError, within
from selector.documents.fields import MOST_LETTERS
from train.cluster.bits import WorkerBits, noted_bits, noting
from train.cluster.chosen import chosen_engine
from train.knowledge_store import NO_STORE, Memory, StoreRequest, as_plain
from train.learning.config import TrainingConfig, load_training
from train.learning.training import Training, TrainingJob, expert_knowledge
from train.running.command import command_words
from train.running.engine import WorkerLost
from train.running.exit_codes import FAILED, FINISHED, INTERRUPTED
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.progress import progress
from train.running.provenance import versions
from train.running.run_folder import LEARNED_BEFORE, RECORDINGS, RunFolder

LEARNER_PACKAGES = {"ppo": ("torch", "stable-baselines3"), "bandit": (), "es": (), "design": ()}
"""Packages that a learner needs besides those of all runs."""
TASKS_ELSEWHERE = 16
"""Tasks that missions of members are cut into if workers elsewhere do them."""


@dataclass(frozen=True)
class TrainingRequest:
    """The request of the user."""

    learner: str
    """One of `LEARNERS`."""
    config: str
    """Name of a training, or path to its YAML file."""
    seed: int
    output: Path | None
    """Directory; one below results/ unless given."""
    resume: bool
    store: StoreRequest = NO_STORE
    """The knowledge store."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    record: bool = False
    """Whether the missions of validations are recorded."""
    machine: Machine = ALONE
    """What missions of members may use."""
    bits: WorkerBits = field(default_factory=WorkerBits)
    """The CPUs that take part elsewhere."""

    @property
    def directory(self) -> Path:
        """Directory of the training."""
        stem = Path(self.config).stem[:MOST_LETTERS]
        return self.output or Path("results") / f"{stem}-{self.learner}-seed{self.seed}"

    def command(self, *, resume: bool) -> str:
        """Return the command of this training."""
        words = command_words(
            "train",
            self.learner,
            config=self.config,
            seed=self.seed,
            output=self.output,
            store=self.store.shown,
            learn=self.store.learn,
            configs=self.directories,
            force=self.machine.forced,
            resume=resume,
        )
        return shlex.join(words)


def run_training(request: TrainingRequest, made: Callable[[TrainingJob], Training], console: Console) -> int:
    """Do or continue a training; return the exit code.

    Args:
        request: the request of the user.
        made: function that makes the training.
        console: prints the figures of each checkpoint.

    """
    config = load_training(request.config, request.learner, request.directories)
    for task in config.tasks:
        with within(f"{request.config}: tasks"):
            largest = task.load(request.directories).largest
            check_needs(Workload(largest, task.worlds * request.machine.workers, task.worlds), request.machine)
    identity = {
        "learner": request.learner,
        "seed": request.seed,
        "configuration": config.model_dump(mode="json"),
        "versions": check_installed(request.learner),
        "directories": [str(path.resolve()) for path in request.directories],
    }
    memory = _memory(request, config)
    known = {} if memory is None else {LEARNED_BEFORE: as_plain(memory.knowledge.learned)}
    request.bits.add(noted_bits(request.directory))
    folder = RunFolder(request.directory, {"identity": identity, **known}, resume=request.resume)
    record = RecordSettings(Path(RECORDINGS)) if request.record else None
    job = TrainingJob(config, request.seed, folder, directories=request.directories, record=record, memory=memory)
    try:
        compile_missions()  # before the bar and the workers
        engine = chosen_engine(request.machine, request.bits)
        bar = progress("decisions", TextColumn("{task.completed:,.0f}"), config.checkpoints * config.decisions)
        with noting(folder, request.bits), bar as update, engine.rounds() as done:
            parts = TASKS_ELSEWHERE if request.machine.place else request.machine.workers
            training = made(replace(job, on_progress=lambda now: update(completed=now), parts=parts, done=done))
            update(completed=training.decisions)
            while not training.finished:
                training.advance()
                _print(console, training.history.entries[-1])
    except ValueError:  # the configuration is wrong: nothing has been learned
        folder.discard()
        raise
    except (KeyboardInterrupt, WorkerLost) as end:
        errors = Console(stderr=True, highlight=False, soft_wrap=True)
        errors.print(f"{str(end) or 'interrupted'}; to go on:\n  {request.command(resume=True)}", markup=False)
        return FAILED if isinstance(end, WorkerLost) else INTERRUPTED
    finally:
        if memory is not None:
            memory.close()
    exported = training.export(request.command(resume=False))
    console.print(f"exported to {exported}", soft_wrap=True, highlight=False)
    return FINISHED


def _memory(request: TrainingRequest, config: TrainingConfig) -> Memory | None:
    """Return the memory of a training; StoreError if the store holds already what it would learn."""
    mission = config.tasks[0].load(request.directories).mission
    source = f"training {config.name}, seed {request.seed}"
    memory = request.store.memory(expert_knowledge(mission, request.directories), f"training {config.name}", source)
    if memory is not None and not request.resume:
        memory.check_new()
    return memory


def check_installed(learner: str) -> dict[str, str]:
    """Return the versions of all packages that a learner needs; DocumentError for a missing package."""
    try:
        return versions(LEARNER_PACKAGES[learner])
    except PackageNotFoundError as error:
        install = "pip install -c constraints.txt '.[train]'"
        raise DocumentError(f"training by {learner} needs {error.name}, which is not installed: {install}") from error


def _print(console: Console, entry: dict[str, Any]) -> None:
    """Print the figures of a checkpoint."""
    shown = {name: round(value, 3) if isinstance(value, float) else value for name, value in entry.items()}
    console.print(json.dumps(shown), soft_wrap=True, highlight=False, markup=False)
