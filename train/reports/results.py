"""The content of a directory of results: finished runs of an evaluation, or the history of a training."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.reader import RecordedMission, recordings_in
from selector.documents.reading import json_lines, read_text
from train.learning.training import HISTORY_FILE
from train.learning.yardstick import Validation, validation_in
from train.running.finished_runs import JOURNAL, runs_of
from train.running.needs import most_numbers
from train.running.run_folder import RECORDINGS, read_manifest
from train.running.runs import RunRecord

TABLES = "table.md"


@dataclass(frozen=True)
class HeldResults:
    """The results in a directory."""

    path: Path
    manifest: dict[str, Any]
    records: Sequence[RunRecord]
    """Finished runs of an evaluation."""
    history: Sequence[dict[str, Any]]
    """Checkpoints of a training."""
    tables: str
    """The tables of the evaluation, as Markdown."""
    validation: Validation | None
    """What the best checkpoint of a training lost beside the best fixed options."""
    recordings: Sequence[RecordedMission]
    """Those of an evaluation."""

    @property
    def name(self) -> str:
        """Name of the experiment, the family or the training."""
        configured = self.manifest["identity"].get("configuration")
        own = configured.get("name", self.path.name) if isinstance(configured, dict) else self.path.name
        return self.records[0].experiment if self.records else str(own)


def results_in(path: Path) -> HeldResults:
    """Read a directory of results.

    Raises:
        ConfigurationError: it is none, or a file in it is damaged.

    """
    manifest = read_manifest(path)
    records, history = runs_of(path / JOURNAL), _history(path / HISTORY_FILE)
    if not records and not history:
        raise ConfigurationError(f"{path}: has neither finished runs ({JOURNAL}) nor checkpoints ({HISTORY_FILE})")
    tables = read_text(path / TABLES) if (path / TABLES).exists() else ""
    recordings = list(recordings_in(path / RECORDINGS, ("working", "held/"), most_numbers()))
    return HeldResults(path, manifest, records, history, tables, validation_in(path), recordings)


def _history(path: Path) -> list[dict[str, Any]]:
    entries = []
    for where, entry in json_lines(path):
        if not isinstance(entry, dict):
            raise ConfigurationError(f"{where}: expected the figures of a checkpoint, got {json.dumps(entry)[:40]}")
        entries.append(entry)
    return entries
