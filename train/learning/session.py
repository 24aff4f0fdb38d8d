"""The session of a training: from the user's request to the exported result, with directory and progress bar."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import TextColumn

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import compile_once, run_through
from selector.documents.errors import within
from selector.documents.fields import MOST_LETTERS
from selector.strategies.problem import Problem
from train.learning.config import LEARNERS, load_training
from train.learning.training import Training, TrainingJob, expert_knowledge
from train.learning.yardstick import beside_yardstick
from train.memory import Memory, as_plain
from train.request import Request
from train.running.commands import FINISHED, progress
from train.running.engine import WorkerLost
from train.running.needs import check_needs
from train.running.run_folder import LEARNED_BEFORE, versions


def run_training(
    learner: str,
    request: Request,
    made: Callable[[TrainingJob], Training],
    console: Console,
    ended: Callable[[Training], None] = lambda _: None,
) -> int:
    """Do or continue a training; return the exit code.

    Args:
        learner: one of `LEARNERS`.
        request: the request of the user, whose name is that of a training.
        made: function that makes the training.
        console: prints the figures of each checkpoint; a quiet one shows no progress, and what ends the training is
            raised.
        ended: called with the training when it is finished.

    """
    config = load_training(request.name, learner, request.directories)
    for task in config.tasks:
        with within(f"{request.name}: tasks"):
            largest = task.load(request.directories).largest
            check_needs(largest, task.worlds * request.machine.workers, request.machine, task.worlds)
    identity = {
        "learner": learner,
        "seed": request.seed,
        "configuration": config.model_dump(mode="json"),
        "versions": check_installed(learner),
        "directories": [str(path.resolve()) for path in request.directories],
    }
    source = f"training {config.name} by {learner}, seed {request.seed}"
    known = expert_knowledge(config.tasks[0].load(request.directories).mission, request.directories)
    memory = request.store.memory(known, f"training {config.name}", source)
    if memory is not None and not request.resume:
        memory.check_new()
    before = {} if memory is None else {LEARNED_BEFORE: as_plain(memory.knowledge.learned)}
    stem = f"{Path(request.name).stem[:MOST_LETTERS]}-{learner}-seed{request.seed}"
    directory = request.output or Path("results") / stem
    with request.results(directory, {"identity": identity, **before}) as folder:
        try:
            compile_once(lambda: run_through(Batch()))  # before the bar and the workers
            counted, total = TextColumn("{task.completed:,.0f}"), config.checkpoints * config.decisions
            bar = progress("decisions", total, log=folder.path, counted=counted, quiet=console.quiet)
            with bar as update, request.engine.rounds() as done:
                training = made(TrainingJob(config, request, folder, update, memory, done))
                update(completed=training.decisions, begun=training.decisions)
                while not training.finished:
                    training.advance()
                    line = checkpoint_line(training.history[-1])
                    console.print(line, soft_wrap=True, highlight=False, markup=False)
                    update(more=beside_yardstick(training.validation) if training.validation else "")
            exported = training.export(shlex.join(folder.words))
        except ValueError:  # the configuration is wrong: nothing has been learned
            folder.discard()
            raise
        except (KeyboardInterrupt, WorkerLost) as end:
            if console.quiet:  # a part of another command, which says how to go on
                raise
            return request.ended(end, folder.path)
    for line in changed_scores(memory) if memory is not None and memory.learns else ():
        console.print(line, soft_wrap=True, highlight=False, markup=False)
    ended(training)
    console.print(f"exported to {exported}", soft_wrap=True, highlight=False)
    return FINISHED


def changed_scores(memory: Memory) -> list[str]:
    """Return a line for each goal whose options brought rewards: their scores before and now, and what is taken."""
    lines, known = [], memory.now()
    for goal in known.learned:
        before, now = Problem.of(memory.knowledge, goal), Problem.of(known, goal)
        scores = [
            f"{name} {old:.3g} -> {new:.3g}"
            for name, old, new in zip(now.options, before.scores, now.scores, strict=True)
        ]
        first, then = (one.options[int(one.scores.argmax())] for one in (before, now))
        lines.append(f"{goal}: MaxScore takes {then} (before: {first}); scores {', '.join(scores)}")
    return lines


def check_installed(learner: str) -> dict[str, str]:
    """Return the versions of all packages that a learner needs; DocumentError for a missing package."""
    return versions(LEARNERS[learner], f"training by {learner} needs", "train")


def checkpoint_line(entry: Mapping[str, Any]) -> str:
    """Return the figures of a checkpoint in words; those of each family are of its validation missions."""
    words = [f"checkpoint {entry['checkpoint']}: {entry['decisions']:,} decisions"]
    if entry.get("training_excess_s") is not None:
        words.append(f"excess while training {entry['training_excess_s']:,.0f} s a mission")
    for family in [name.removesuffix("/excess_s") for name in entry if name.endswith("/excess_s")]:
        cost, done = entry[f"{family}/excess_s"], entry[f"{family}/completed"]
        words.append(f"on {family} {cost:,.0f} s, {1.0 - done:.0%} unfinished")
    return ", ".join(words) + ("; the best so far" if entry["best"] else "")
