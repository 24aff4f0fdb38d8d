"""The directory of a training: what identifies it, its last checkpoint, its history, and what came out.

A checkpoint is one file that is replaced whole, so that a kill at any moment leaves the old or the new one; everything
else in the directory is written from it and can be written again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.arrays import write_whole

MANIFEST, HISTORY = "manifest.json", "history.jsonl"


class TrainingDirectory:
    """The directory in which a training keeps everything."""

    def __init__(self, path: Path, identity: Mapping[str, Any], checkpoint: str, *, resume: bool) -> None:
        """Open `path` for the training that `identity` describes; `checkpoint` names its file.

        Raises ConfigurationError if there is another training, or one that is not to be resumed.
        """
        self.path, self.checkpoint = path, path / checkpoint
        manifest = path / MANIFEST
        if manifest.is_file():
            known = json.loads(manifest.read_text(encoding="utf-8"))
            if not resume:
                raise ConfigurationError(f"{path}: there is a training already; --resume goes on with it")
            given = json.loads(json.dumps(identity))
            for key in sorted(set(known) | set(given)):
                if known.get(key) != given.get(key):
                    raise ConfigurationError(f"{path}: {key}: expected that of the training there, got another one")
        elif path.is_dir() and any(path.iterdir()):
            raise ConfigurationError(f"{path}: expected an empty directory or a training")
        else:
            write_whole(manifest, (json.dumps(identity, indent=2) + "\n").encode())

    @property
    def begun(self) -> bool:
        """Whether there is a checkpoint to go on from."""
        return self.checkpoint.is_file()

    def write_history(self, history: Sequence[Mapping[str, Any]]) -> None:
        """Write one line for each checkpoint."""
        text = "".join(json.dumps(line) + "\n" for line in history)
        write_whole(self.path / HISTORY, text.encode())
