"""Shares of an evaluation: commands that each do a part of its runs, beside each other in one directory."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.plain import short
from train.evaluation.base import Evaluation
from train.running.finished_runs import JOURNAL, runs_of
from train.running.run_folder import MANIFEST, SHARE_FOLDERS, Json, RunFolder
from train.running.runs import RunKey, RunRecord

ALL = "all"
"""In place of the number of a share: the results of all shares are gathered."""


@dataclass(frozen=True)
class RunShare:
    """One of `count` parts of the runs of an evaluation, or the gathering of them all."""

    number: int
    """From 1 on; 0 gathers."""
    count: int

    @classmethod
    def of_text(cls, text: str) -> RunShare:
        """Return the share `I/N`, or what gathers, `all/N`."""
        found = re.fullmatch(rf"({ALL}|[1-9]\d{{0,4}})/([1-9]\d{{0,4}})", text)
        number, count = (0 if found[1] == ALL else int(found[1]), int(found[2])) if found else (1, 0)
        if number > count:
            raise ConfigurationError(f"--share: expected I/N with I from 1 to N, got {short(text)}")
        return cls(number, count)

    @property
    def gathers(self) -> bool:
        """Whether this is the gathering of all shares."""
        return self.number == 0

    def __str__(self) -> str:
        return f"{self.number or ALL}/{self.count}"

    def folder(self, directory: Path) -> Path:
        """Return the run folder of this share in the directory of all shares."""
        return directory / SHARE_FOLDERS / f"{self.number}-of-{self.count}"

    def folders(self, directory: Path) -> list[Path]:
        """Return the run folders of all shares."""
        return [replace(self, number=number).folder(directory) for number in range(1, self.count + 1)]

    def part(self, keys: Sequence[RunKey]) -> Sequence[RunKey]:
        """Return every `count`-th of the keys, so that each share has some of every condition."""
        return keys if self.gathers else keys[self.number - 1 :: self.count]

    def command(self, evaluation: Evaluation, directory: Path | None) -> str:
        """Return the command that goes on with this share."""
        return shlex.join([*evaluation.words, "--output", str(directory), "--share", str(self), "--resume"])


def gathered(evaluation: Evaluation, directory: Path, count: int) -> tuple[list[RunRecord], Json]:
    """Return the runs of all shares, and what was known of options when they began.

    Raises:
        ConfigurationError: a share is not there, is not finished, or is one of another evaluation.

    """
    keys, runs, known = evaluation.keys, dict[RunKey, tuple[RunRecord, Path]](), list[Json]()
    shares = [RunShare(number, count) for number in range(1, count + 1)]
    for share in shares:
        path, command = share.folder(directory), share.command(evaluation, directory)
        if not (path / MANIFEST).exists():
            raise ConfigurationError(f"{path}: no such share; expected the results of `{command}`")
        folder = RunFolder(path, evaluation.manifest, resume=True, growing=evaluation.growing)
        with folder.alone():
            for record in runs_of(path / JOURNAL, evaluation.mistake):
                other, first = runs.setdefault(record.key, (record, path))
                if other.result != record.result:
                    run = f"scenario {record.scenario}, condition {record.condition}"
                    raise ConfigurationError(f"{first} and {path}: expected the same figures of {run}, got others")
        known.append(folder.learned)
        if folder.learned != known[0]:
            raise ConfigurationError(f"{path}: began with other learned scores than share 1")
    for share in shares:
        part, path = share.part(keys), share.folder(directory)
        lacking = sum(key not in runs for key in part)
        if lacking:
            command = share.command(evaluation, directory)
            raise ConfigurationError(f"{path}: lacks {lacking} of {len(part)} runs; to go on: `{command}`")
    return [record for record, _ in runs.values()], known[0]


def first_share(directory: Path) -> tuple[RunShare, Path]:
    """Return what gathers the shares in a directory, and the run folder of the first one that is there."""
    names = [path.name for path in sorted((directory / SHARE_FOLDERS).glob("*-of-*"))]
    counts = sorted({name.rpartition("-")[2] for name in names})
    if len(counts) != 1:
        found = f"shares of {' and of '.join(counts)}" if counts else "none"
        raise ConfigurationError(f"{directory / SHARE_FOLDERS}: expected shares of one number, got {found}")
    return RunShare.of_text(f"{ALL}/{counts[0]}"), directory / SHARE_FOLDERS / names[0]
