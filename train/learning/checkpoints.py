"""The directory of a training: its last checkpoint, its history, and the exported result.

A checkpoint is one file that is replaced whole, so that a kill at any moment leaves the old or the new one. Everything
else in the directory is written from the checkpoint and can be written again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from train.running.run_folder import RunFolder

HISTORY_FILE = "history.jsonl"


class TrainingFolder(RunFolder):
    """The directory in which a training keeps everything.

    Args:
        path: the directory.
        identity: what identifies the training.
        resume: whether to go on with the training that the directory holds.

    """

    def __init__(self, path: Path, identity: Mapping[str, Any], *, resume: bool) -> None:
        super().__init__(path, {"identity": identity}, resume=resume)

    def write_history(self, entries: Sequence[Mapping[str, Any]]) -> None:
        """Write one line for each checkpoint."""
        self.write(HISTORY_FILE, "".join(json.dumps(entry) + "\n" for entry in entries))
