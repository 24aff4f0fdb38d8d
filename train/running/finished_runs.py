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
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import shown
from selector.documents.reading import json_value, read_text
from selector.documents.writing import writing_to
from train.running.run_folder import RunFolder
from train.running.runs import MEASURES, RUN_COLUMNS, TAKEN, RunKey, RunRecord

JOURNAL, RUNS = "runs.jsonl", "runs.csv"


class Results:
    """The finished runs in a directory.

    Attributes:
        folder: the directory.
        records: the finished runs.

    Raises:
        ConfigurationError: a line of the journal is no finished run, or one of another evaluation.

    """

    def __init__(
        self,
        folder: RunFolder,
        mistake: Callable[[RunRecord], str] = lambda record: "",
        known: Sequence[RunRecord] = (),
    ) -> None:
        """Read the runs kept in `folder`, and keep those that are `known` from elsewhere.

        `mistake` returns why a run that is read is not of this evaluation, empty if it is.
        """
        self.folder = folder
        kept = runs_of(folder.path / JOURNAL, mistake)
        self.records = list({record.key: record for record in (*known, *kept)}.values())
        self._rewrite()

    def add(self, record: RunRecord) -> None:
        """Keep a finished run; it is on the disk when the call returns."""
        self.records.append(record)
        if len(self.records) == 1:  # which tells the measures
            self._rewrite()
            return
        for name, text in ((JOURNAL, _line(record)), (RUNS, _row(record))):
            path = self.folder.path / name
            with writing_to(path), path.open("a", encoding="utf-8", newline="") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())

    def close(self) -> None:
        """Sort all finished runs and write them."""
        self.records.sort(key=lambda record: (natural_order(record.scenario), record.condition))
        self._rewrite()

    def _rewrite(self) -> None:
        self.folder.write(JOURNAL, "".join(map(_line, self.records)))
        measures = tuple(self.records[0].result.measures) if self.records else ()
        self.folder.write(RUNS, _cells((*RUN_COLUMNS, *measures)) + "".join(map(_row, self.records)))


def runs_of(path: Path, mistake: Callable[[RunRecord], str] = lambda record: "") -> list[RunRecord]:
    """Return the runs of a journal, without a last line that a crash cut off.

    Args:
        path: the journal; without it there are no runs.
        mistake: returns why a run is not one of the evaluation that is asked for; empty if it is.

    Raises:
        ConfigurationError: a line is no finished run, or one that was not asked for.

    """
    if not path.exists():
        return []
    records: dict[RunKey, RunRecord] = {}
    lines = read_text(path).split("\n")[:-1]  # what follows the last end of a line is nothing, or cut off
    for number, line in enumerate(lines, start=1):
        where = f"{shown(path)}: line {number}"
        try:
            record = RunRecord.of_mapping(json_value(line, where))
        except (ValueError, TypeError) as error:
            why = str(error).removeprefix(f"{where}: ")
            raise ConfigurationError(f"{where}: expected a finished run: {why}") from error
        why = "is there twice" if record.key in records else mistake(record)
        if why:
            run = f"scenario {record.scenario}, condition {record.condition}"
            raise ConfigurationError(f"{where}: {run}: {why}; not a run of this evaluation")
        records[record.key] = record
    return list(records.values())


def natural_order(scenario: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts names by their numbers: 2 before 10, case-2 before case-10."""
    parts = (part for part in re.split(r"(\d+)", scenario) if part)
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts)


def _line(record: RunRecord) -> str:
    return json.dumps(record.as_mapping(), allow_nan=False) + "\n"


def _data(cell: object) -> object:
    """Return a cell that no spreadsheet takes for a formula: a text that begins like one gets a quotation mark."""
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(("=", "+", "-", "@")) else cell


def _row(record: RunRecord) -> str:
    """Return the line of `runs.csv`, with the collisions at the first distance only."""
    cells = {name: value for name, value in record.as_mapping().items() if name not in (MEASURES, TAKEN)}
    return _cells((*cells.values(), *record.result.measures.values()))


def _cells(values: Iterable[object]) -> str:
    """Return a line of a table; of several numbers the first one."""
    text = io.StringIO()
    firsts = [value[0] if isinstance(value, tuple) else value for value in values]
    csv.writer(text, lineterminator="\n").writerow(map(_data, firsts))
    return text.getvalue()
