"""The golden runner: replays every file of a directory through the public interface and counts."""

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tests.golden.case import Case, SetAside, read_case

Replayer = Callable[[Case], str | None]

REPLAYERS: dict[str, Replayer] = {}


def replays(file: str, replayer: Replayer) -> None:
    """Enter the replayer of one golden file; twice the same file is an error."""
    if file in REPLAYERS:
        raise ValueError(f"golden file {file!r} has a replayer already")
    REPLAYERS[file] = replayer


@dataclass
class Outcome:
    """What came of the cases of one file."""

    passed: int = 0
    failures: list[str] = field(default_factory=list)
    set_aside: Counter[str] = field(default_factory=Counter)  # deviation -> cases

    def add(self, other: "Outcome") -> None:
        """Add another file's counts."""
        self.passed += other.passed
        self.failures += other.failures
        self.set_aside += other.set_aside

    def __str__(self) -> str:
        """Return the counts in words, with the deviations by which cases were set aside."""
        aside = self.set_aside.total()
        reasons = ", ".join(f"{name}: {count}" for name, count in sorted(self.set_aside.items()))
        counts = f"{self.passed} passed, {len(self.failures)} failed, {aside} set aside"
        return f"{counts} ({reasons})" if reasons else counts


def replay_file(path: Path) -> Outcome:
    """Replay every case of one golden file."""
    outcome = Outcome()
    replayer = REPLAYERS[path.name]
    for entry in json.loads(path.read_text()):
        case = read_case(entry)
        try:
            wrong = replayer(case)
        except SetAside as deviation:
            outcome.set_aside[deviation.deviation] += 1
            continue
        except Exception as error:  # a crash is a failure of its case; the others still count
            wrong = f"{type(error).__name__}: {error}"
        if wrong is None:
            outcome.passed += 1
        else:
            outcome.failures.append(f"{case.id} {case.group} ({case.tag}): {wrong}")
    return outcome


def find_files(directory: Path) -> list[Path]:
    """Return the golden files of a directory; none, or one without a replayer, raises ValueError."""
    files = sorted(directory.glob("*.json"))
    if not files:
        raise ValueError(f"no golden files (*.json) in {directory}")
    unknown = [path.name for path in files if path.name not in REPLAYERS]
    if unknown:
        raise ValueError(f"no replayer for {', '.join(unknown)} in {directory}; known: {', '.join(sorted(REPLAYERS))}")
    return files
