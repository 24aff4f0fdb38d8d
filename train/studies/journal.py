"""The journal of a study: the figures of every finished mission.

A study is a function of its seed and of these figures: one that was killed begins anew, finds its missions here, and
comes to the same trials (docs/decisions/0170-studies-replay.md).
"""

from __future__ import annotations

import json
import os
from collections import defaultdict

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import shown
from selector.documents.plain import short
from selector.documents.reading import json_value, read_text
from selector.documents.writing import writing_to
from selforg.arrays import Floats
from train.running.run_folder import RunFolder

MISSIONS = "missions.jsonl"
Figures = tuple[float, ...]


class MissionJournal:
    """The finished missions of a study, by stage, candidate and number of the scenario.

    Raises:
        ConfigurationError: a line of the file is no finished mission.

    """

    def __init__(self, folder: RunFolder, width: int) -> None:
        """Read the missions in `folder`, each with `width` figures; a last line that a crash cut off goes."""
        self._path, self._width = folder.path / MISSIONS, width
        self._known: dict[tuple[str, str], dict[int, Figures]] = defaultdict(dict)
        text = read_text(self._path) if self._path.exists() else ""
        lines = text.split("\n")[:-1]
        for number, line in enumerate(lines, start=1):
            self._read(line, f"{shown(self._path)}: line {number}")
        folder.write(MISSIONS, "".join(line + "\n" for line in lines))

    @property
    def missions(self) -> int:
        """Number of finished missions."""
        return sum(map(len, self._known.values()))

    def add(self, stage: str, candidate: str, number: int, figures: Figures) -> None:
        """Keep the figures of a finished mission; a kill of this process does not lose them."""
        self._known[stage, candidate][number] = figures
        with writing_to(self._path), self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([stage, candidate, number, *figures], allow_nan=False) + "\n")

    def sync(self) -> None:
        """Bring all missions to the disk, where a loss of power does not lose them."""
        with writing_to(self._path), self._path.open("a", encoding="utf-8") as file:
            os.fsync(file.fileno())

    def missing(self, stage: str, candidate: str, count: int) -> tuple[int, ...]:
        """Return the numbers below `count` of the scenarios that a candidate has not done."""
        done = self._known[stage, candidate]
        return tuple(number for number in range(count) if number not in done)

    def figures(self, stage: str, candidate: str, count: int) -> Floats:
        """Return the figures (figures, count) of a candidate on the first scenarios."""
        done = self._known[stage, candidate]
        return np.array([done[number] for number in range(count)]).T

    def _read(self, line: str, where: str) -> None:
        match json_value(line, where):
            case [str(stage), str(candidate), int(number), *figures] if (
                number >= 0
                and len(figures) == self._width
                and all(isinstance(x, int | float) and not isinstance(x, bool) for x in figures)
            ):
                self._known[stage, candidate][number] = tuple(map(float, figures))
            case _:
                expected = f"stage, candidate, scenario and {self._width} figures of a finished mission"
                anew = "studies of other versions cannot go on: begin anew with another --output"
                raise ConfigurationError(f"{where}: expected {expected}, got {short(line)}; {anew}")
