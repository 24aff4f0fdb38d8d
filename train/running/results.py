"""The directory of an evaluation's results: manifest, finished runs, and the files made from them.

`runs.jsonl` and `runs.csv` get one line per finished run, on the disk before the next one is reported, so that nothing
finished is lost. The first has all that is known of a run and is what a later `--resume` reads. Both are sorted in the
end, which makes them equal for equal runs but for `wall_s`. A directory that holds anything else is refused.
"""

import csv
import io
import json
import os
import re
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from clean_swarm_env.config.errors import ConfigurationError
from train.running.runs import RunRecord

MANIFEST, JOURNAL, RUNS = "manifest.json", "runs.jsonl", "runs.csv"
RECORD = TypeAdapter(RunRecord)
COLUMNS = tuple(field.name for field in fields(RunRecord))
"""Columns of `runs.csv`; of the collisions only those at the first distance."""

Json = dict[str, Any]


class Results:
    """An open directory of results; `records` are the finished runs."""

    def __init__(self, directory: Path, manifest: Mapping[str, Any], *, resume: bool, growing: str = "") -> None:
        """Open `directory` for the runs that `manifest["identity"]` describes.

        The mapping `growing` of the identity may have other entries each time; the directory keeps them all.
        Raises ConfigurationError if the directory holds anything, unless to `resume` runs of the same identity.
        """
        self.directory = directory
        self.records: list[RunRecord] = []
        if not directory.exists() or (directory.is_dir() and not any(directory.iterdir())):
            _new(directory, manifest)
        else:
            held = _check_occupied(directory, manifest, growing, resume=resume)
            self.records = _read_journal(directory / JOURNAL)
            if growing:
                whole = {**manifest["identity"], growing: {**held[growing], **manifest["identity"][growing]}}
                self.write(MANIFEST, _text({**manifest, "identity": whole}))
        self._rewrite()

    def add(self, record: RunRecord) -> None:
        """Keep a finished run: it is on the disk when this returns."""
        self.records.append(record)
        for name, text in ((JOURNAL, _line(record)), (RUNS, _row(record))):
            with (self.directory / name).open("a", encoding="utf-8", newline="") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())

    def close(self) -> None:
        """Sort the finished runs and write them all."""
        self.records.sort(key=_order)
        self._rewrite()

    def write(self, name: str, text: str) -> None:
        """Write a further file of results as a whole."""
        self.write_bytes(name, text.encode())

    def write_bytes(self, name: str, content: bytes) -> None:
        """Write a further file of results that is not text."""
        write_atomically(self.directory / name, content)

    def _rewrite(self) -> None:
        self.write(JOURNAL, "".join(map(_line, self.records)))
        self.write(RUNS, ",".join(COLUMNS) + "\n" + "".join(map(_row, self.records)))


def natural_order(scenario: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts names by their numbers: 2 before 10, case-2 before case-10."""
    parts = (part for part in re.split(r"(\d+)", scenario) if part)
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts)


def default_directory(stem: str, *, resume: bool) -> Path:
    """Return results/<stem>, or the first free of <stem>-2, <stem>-3 and so on; to resume, the last taken one."""
    root = Path("results")
    taken, number = None, 1
    while (candidate := root / (stem if number == 1 else f"{stem}-{number}")).exists():
        taken, number = candidate, number + 1
    return taken if resume and taken is not None else candidate


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that at any time, even after a crash, it holds the old content or the new one."""
    part = path.with_name(f".{path.name}.part")
    with part.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def _order(record: RunRecord) -> tuple[tuple[tuple[int, int, str], ...], str]:
    return natural_order(record.scenario), record.condition


def _line(record: RunRecord) -> str:
    return json.dumps(asdict(record), allow_nan=False) + "\n"


def _row(record: RunRecord) -> str:
    row, text = asdict(record), io.StringIO()
    cells = [value[0] if isinstance(value := row[column], tuple) else value for column in COLUMNS]
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _new(directory: Path, manifest: Mapping[str, Any]) -> None:
    try:
        directory.mkdir(parents=True, exist_ok=True)
        write_atomically(directory / MANIFEST, _text(manifest).encode())
    except OSError as error:
        raise ConfigurationError(f"{directory}: cannot be written ({error.strerror})") from error


def _text(manifest: Mapping[str, Any]) -> str:
    return json.dumps(manifest, indent=2, allow_nan=False) + "\n"


def _check_occupied(directory: Path, manifest: Mapping[str, Any], growing: str, *, resume: bool) -> Json:
    """Return the identity of the runs that a directory holds, to go on with them."""
    if not directory.is_dir():
        raise ConfigurationError(f"{directory}: expected a directory for the results, got a file")
    holds = _identity(directory / MANIFEST)
    if holds is None:
        raise ConfigurationError(f"{directory}: holds other files; expected an empty or a new directory")
    wanted = dict(manifest["identity"])
    if growing and isinstance(kept := holds.get(growing), dict):
        wanted[growing] = {name: wanted[growing].get(name, known) for name, known in kept.items()}
    different = _difference(holds, wanted)
    if different:
        raise ConfigurationError(f"{directory}: holds other results: {different}")
    if not resume:
        raise ConfigurationError(
            f"{directory}: holds results of this experiment already; give --resume or another --output"
        )
    return holds


def _identity(path: Path) -> Json | None:
    """Return what the manifest of a directory says about its runs; None if it is not a manifest."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    identity = content.get("identity") if isinstance(content, dict) else None
    return identity if isinstance(identity, dict) else None


def _difference(holds: object, wanted: object, key: str = "") -> str:
    """Return the first difference as `key: expected wanted, got held`; empty without any."""
    if isinstance(holds, dict) and isinstance(wanted, dict):
        for name in sorted(holds.keys() | wanted.keys()):
            found = _difference(holds.get(name), wanted.get(name), f"{key}.{name}" if key else name)
            if found:
                return found
        return ""
    if holds == wanted:
        return ""
    if isinstance(holds, list) or isinstance(wanted, list):
        return f"{key} differ"
    return f"{key}: expected {wanted!r}, got {holds!r}"


def _read_journal(path: Path) -> list[RunRecord]:
    """Return the finished runs; a last line cut off by a crash is left out."""
    if not path.exists():
        return []
    records = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(keepends=True), start=1):
        if not line.endswith("\n"):
            break
        try:
            record = RECORD.validate_json(line)
        except ValidationError as error:
            raise ConfigurationError(f"{path}: line {number}: expected a finished run") from error
        records[record.key] = record
    return list(records.values())
