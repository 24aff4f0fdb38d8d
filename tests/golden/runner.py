"""The golden runner: replays every file of a directory through the public interface and counts."""

import json
import lzma
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.golden import buffer, decisions, gradients, movement, selection
from tests.golden.case import Case, SetAside, read_case
from tests.golden.network import conditions, monitoring, traces

REPLAYERS: dict[str, Callable[[Case], str | None]] = {
    "buffer": buffer.replay,
    "conditions": conditions.replay,
    "decisions": decisions.replay,
    "gradients": gradients.replay,
    "monitoring": monitoring.replay,
    "movement": movement.replay,
    "network": traces.replay,
    "selection": selection.replay,
}
"""Name of a file, without its endings -> what replays a case of it: how ours differs, None if it agrees."""


@dataclass
class Outcome:
    """What came of the cases of one file."""

    agreed: int = 0
    differences: list[str] = field(default_factory=list)
    set_aside: Counter[str] = field(default_factory=Counter)  # deviation -> cases

    def add(self, other: "Outcome") -> None:
        """Add another file's counts."""
        self.agreed += other.agreed
        self.differences += other.differences
        self.set_aside += other.set_aside

    @property
    def counts(self) -> str:
        """The counts in words."""
        return f"{self.agreed:,} agree, {len(self.differences)} differ, {self.set_aside.total()} set aside"

    def __str__(self) -> str:
        """Return the counts in words, with the deviations by which cases were set aside."""
        reasons = ", ".join(f"{name}: {count}" for name, count in sorted(self.set_aside.items()))
        return f"{self.counts} ({reasons})" if reasons else self.counts


def replay_file(path: Path) -> Outcome:
    """Replay every case of one golden file."""
    outcome, replayer = Outcome(), REPLAYERS[subject(path)]
    for entry in entries_of(path):
        case = read_case(entry)
        try:
            wrong = replayer(case)
        except SetAside as deviation:
            outcome.set_aside[deviation.deviation] += 1
            continue
        except Exception as error:  # a crash is a difference of its case; the others still count
            wrong = f"{type(error).__name__}: {error}"
        if wrong is None:
            outcome.agreed += 1
        else:
            outcome.differences.append(f"{case.id} {case.group} ({case.tag}): {wrong}")
    return outcome


def entries_of(path: Path) -> list[dict[str, Any]]:
    """Return the cases in a file as they are written there; one that ends with .xz is unpacked in memory."""
    data = path.read_bytes()
    return json.loads(lzma.decompress(data) if path.suffix == ".xz" else data)


def subject(path: Path) -> str:
    """Return the name of a file without .json or .json.xz."""
    return path.name.partition(".")[0]


def find_files(directory: Path) -> list[Path]:
    """Return the golden files of a directory; none, or one without a replayer, raises ValueError."""
    files = sorted(path for pattern in ("*.json", "*.json.xz") for path in directory.glob(pattern))
    if not files:
        raise ValueError(f"expected golden files (*.json, *.json.xz) in {directory}, got none")
    unknown = [path.name for path in files if subject(path) not in REPLAYERS]
    if unknown:
        raise ValueError(f"{directory}: expected files of {', '.join(REPLAYERS)}, got {', '.join(unknown)}")
    return files
