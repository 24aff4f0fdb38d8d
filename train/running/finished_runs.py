"""Finished runs of an evaluation, kept in a directory.

`runs.jsonl` gets one line for each finished run, which is on the disk before the next run is reported, so that no
finished run is lost; `--resume` reads it. At the end it is sorted, and `runs.csv` has the same runs as a table. Apart
from `wall_s`, equal runs then give equal files.
"""

import csv
import io
import json
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import fmean

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import shown
from selector.documents.reading import json_value, read_text
from selector.documents.writing import writing_to
from train.running.run_folder import RunFolder
from train.running.runs import RUN_COLUMNS, RunKey, RunRecord

JOURNAL = "runs.jsonl"


class Results:
    """The finished runs in a directory.

    Args:
        folder: the directory.
        mistake: returns why a run that is read is not of this evaluation, empty if it is.

    Attributes:
        folder: the directory.
        runs: the finished runs.

    Raises:
        ConfigurationError: a line of the journal is no finished run, or one of another evaluation.

    """

    def __init__(self, folder: RunFolder, mistake: Callable[[RunRecord], str] = lambda record: "") -> None:
        self.folder = folder
        kept = runs_of(folder.path / JOURNAL, mistake)
        self.runs: dict[RunKey, RunRecord] = {record.key: record for record in kept}
        self.folder.write(JOURNAL, "".join(map(_line, self.records)))

    @property
    def records(self) -> list[RunRecord]:
        """The finished runs, in the order of the journal."""
        return list(self.runs.values())

    def add(self, record: RunRecord) -> None:
        """Keep a finished run; it is on the disk when the call returns."""
        self.runs[record.key] = record
        path = self.folder.path / JOURNAL
        with writing_to(path), path.open("a", encoding="utf-8") as file:
            file.write(_line(record))
            file.flush()
            os.fsync(file.fileno())

    def close(self) -> None:
        """Sort the finished runs, and write journal and table."""
        records = sorted(self.records, key=lambda record: (natural_order(record.scenario), record.condition))
        self.runs = {record.key: record for record in records}
        self.folder.write(JOURNAL, "".join(map(_line, records)))
        self.folder.write(str(Path(JOURNAL).with_suffix(".csv")), runs_table(records))


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
            mistaken = "is there twice" if record.key in records else mistake(record)
        except (ValueError, TypeError) as error:
            why = str(error).removeprefix(f"{where}: ")
            raise ConfigurationError(f"{where}: expected a finished run: {why}") from error
        if mistaken:
            run = f"scenario {record.scenario}, condition {record.condition}"
            raise ConfigurationError(f"{where}: {run}: {mistaken}; not a run of this evaluation")
        records[record.key] = record
    return list(records.values())


def cheapest_first(records: Sequence[RunRecord]) -> list[str]:
    """Return the conditions of runs, that with the lowest mean cost first."""
    costs: dict[str, list[float]] = {}
    for record in records:
        costs.setdefault(record.condition, []).append(record.result.cost_s)
    return sorted(costs, key=lambda condition: fmean(costs[condition]))


def natural_order(scenario: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts names by their numbers: 2 before 10, case-2 before case-10."""
    parts = (part for part in re.split(r"(\d+)", scenario) if part)
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts)


def runs_table(records: Sequence[RunRecord]) -> str:
    """Return runs as CSV, with a column for each measure, and the collisions at the first distance only."""
    columns = (*RUN_COLUMNS, *(records[0].result.measures if records else ()))
    rows = ({**record.as_mapping(), **record.result.measures} for record in records)
    text = io.StringIO()
    table = [columns, *([_cell(row[column]) for column in columns] for row in rows)]
    csv.writer(text, lineterminator="\n").writerows(table)
    return text.getvalue()


def _line(record: RunRecord) -> str:
    return json.dumps(record.as_mapping(), allow_nan=False) + "\n"


def _cell(value: object) -> object:
    """Return a cell: of several numbers the first, and a quotation mark before a text that looks like a formula."""
    if isinstance(value, tuple):
        return value[0]
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@")) else value
