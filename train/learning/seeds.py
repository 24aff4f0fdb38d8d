"""Trainings with PPO that differ in their seeds only: work for an engine, as missions are."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from rich.console import Console

from train.learning.session import run_training
from train.request import Request
from train.running.needs import Machine
from train.running.runs import RunKey


@dataclass(frozen=True)
class SeedTask:
    """A training with one seed, which goes on where another process has ended; see `Work`."""

    request: Request

    @property
    def key(self) -> RunKey:
        """Its seed, in place of a scenario; the condition is the same for all."""
        return str(self.request.seed), ""

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """That of the one seed."""
        return (self.key,)

    def without(self, done: Collection[RunKey]) -> Self:
        """Return the task: what it lacks is in its folder."""
        return self

    def each(self) -> Iterator[Self]:
        """Do the training, and yield the task when it is done."""
        from train.learning.ppo.training import PpoTraining  # imports torch

        run_training("ppo", self.request, PpoTraining, Console(quiet=True))
        yield self


def trained(request: Request, folders: Mapping[int, Path]) -> Iterator[int]:
    """Do or go on with a training for each seed, and yield the seed when its training is done.

    Args:
        request: that of the training, with the workers that all seeds may have, or a place beyond this machine.
        folders: seed -> directory for its results.

    Raises:
        ValueError: a training cannot be done. The others end then, as by Ctrl-C, and can go on later.

    """
    alone = Machine(forced=request.machine.forced, threads=request.machine.threads)
    again = replace(request, resume=True, machine=alone, words=(*request.words, "--seeds", ""))
    tasks = [
        SeedTask(replace(again, seed=seed, output=folder, words=(*again.words, f"--seed={seed}", f"--output={folder}")))
        for seed, folder in folders.items()
    ]
    with request.engine.rounds() as done:
        for one in done(tasks):
            yield one.request.seed
