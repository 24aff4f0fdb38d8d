"""Trainings that differ in their seeds only, side by side, each in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from train.running import WITH_PARENT


def trained(words: Sequence[str], folders: Mapping[int, Path], workers: int) -> Iterator[int]:
    """Do or go on with the training of a command for each seed, and yield a seed when its training is done.

    Args:
        words: what follows `clean-swarm`; the seed, and the directory for its results, come behind.
        folders: seed -> this directory.
        workers: largest number of processes.

    Raises:
        SystemExit: a training failed, with its last line. The others end then, as by Ctrl-C, and can go on later.

    """
    running: list[subprocess.Popen[str]] = []

    def train(seed: int) -> int:
        command = [sys.executable, "-m", "clean_swarm_env", *words, "--seed", str(seed), "--output", str(folders[seed])]
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,  # which ends with this process
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, WITH_PARENT: "1"},
        )
        running.append(process)
        assert process.stderr is not None
        said = process.stderr.read()
        if process.wait():
            raise SystemExit(said.strip().rpartition("\n")[2])
        return seed

    with ThreadPoolExecutor(min(len(folders), workers)) as pool:
        try:
            for one in as_completed([pool.submit(train, seed) for seed in folders]):
                yield one.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in running:
                process.terminate()  # nothing, if it has ended
