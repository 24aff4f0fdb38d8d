"""Runs commands and writes files for a comparison."""

import os
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs.figures.stored import ROOT
from docs.figures.update_results import CLEAN_SWARM
from selector.documents.reading import as_yaml
from selector.documents.writing import write_whole


def run(*words: object) -> float:
    """Run `clean-swarm` with `words`; return its CPU time [s]."""
    command = [*CLEAN_SWARM, *map(str, words)]
    process = subprocess.Popen(command, cwd=ROOT)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return used.ru_utime + used.ru_stime


def written(file: Path, content: Mapping[str, Any]) -> Path:
    """Write a YAML file; return it."""
    write_whole(file, as_yaml(content).encode())
    return file
