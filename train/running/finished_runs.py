"""The finished runs of an evaluation, kept in its directory.

`runs.jsonl` and `runs.csv` get one line for each finished run, which is on the disk before the next run is reported, so
that no finished run is lost. `runs.jsonl` has complete records, which `--resume` reads. Both files are sorted at the
end; apart from `wall_s`, equal runs then give equal files.
"""

import csv
import io
import json
import os
import re
from pathlib import Path

from pydantic import ValidationError

from clean_swarm_env.config.errors import ConfigurationError
from train.running.run_folder import RunFolder
from train.running.runs import RUN_COLUMNS, RunRecord

JOURNAL, RUNS = "runs.jsonl", "runs.csv"


class Results:
    """The finished runs in a directory.

    Attributes:
        folder: the directory.
        records: the finished runs.

    """

    def __init__(self, folder: RunFolder) -> None:
        self.folder = folder
        self.records = runs_of(folder.path / JOURNAL)
        self._rewrite()

    def add(self, record: RunRecord) -> None:
        """Keep a finished run; it is on the disk when the call returns."""
        self.records.append(record)
        for name, text in ((JOURNAL, _line(record)), (RUNS, _row(record))):
            with (self.folder.path / name).open("a", encoding="utf-8", newline="") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())

    def close(self) -> None:
        """Sort all finished runs and write them."""
        self.records.sort(key=lambda record: (natural_order(record.scenario), record.condition))
        self._rewrite()

    def _rewrite(self) -> None:
        self.folder.write(JOURNAL, "".join(map(_line, self.records)))
        self.folder.write(RUNS, ",".join(RUN_COLUMNS) + "\n" + "".join(map(_row, self.records)))


def runs_of(path: Path) -> list[RunRecord]:
    """Return the runs of a journal, without a last line that a crash cut off."""
    if not path.exists():
        return []
    records = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(keepends=True), start=1):
        if not line.endswith("\n"):
            break
        try:
            record = RunRecord.of_mapping(json.loads(line))
        except (ValueError, ValidationError) as error:
            raise ConfigurationError(f"{path}: line {number}: expected a finished run") from error
        records[record.key] = record
    return list(records.values())


def natural_order(scenario: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts names by their numbers: 2 before 10, case-2 before case-10."""
    parts = (part for part in re.split(r"(\d+)", scenario) if part)
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts)


def _line(record: RunRecord) -> str:
    return json.dumps(record.as_mapping(), allow_nan=False) + "\n"


def _row(record: RunRecord) -> str:
    """Return the line of `runs.csv`, with the collisions at the first distance only."""
    cells, text = record.as_mapping(), io.StringIO()
    firsts = [value[0] if isinstance(value, tuple) else value for value in cells.values()]
    csv.writer(text, lineterminator="\n").writerow(firsts)
    return text.getvalue()
