"""A run that goes step by step, is changed by hand, and is recorded so that it can run again."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, final

from pydantic import TypeAdapter, ValidationError

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.by_hand import ByHand, Change
from clean_swarm_env.recording.file import end_of
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.errors import one_line
from train.running.provenance import fingerprints

_CHANGE: TypeAdapter[Change] = TypeAdapter(ByHand)


class Played(Protocol):
    """What is played."""

    @property
    def name(self) -> str:
        """Name of the mission, the family or the goal."""

    @property
    def robots(self) -> int:
        """Number of robots at the start."""

    def open(self, output: Path, *, minds: bool) -> Session:
        """Return the session, recorded in a file; one that exists is replaced."""


class Session(ABC):
    """One run that is played.

    Subclasses implement `ticks`, `facts`, `strategies`, `present`, `close`, and what begins with an underscore.

    Args:
        beginning: the bytes with which the recording begins.
        period: length of a control period [s].
        by_hand: what was done by hand when this was played before.

    Attributes:
        result: the figures of the run, None while it goes on.

    """

    def __init__(self, beginning: bytes, period: float, by_hand: Sequence[Change]) -> None:
        self.beginning, self.period = beginning, period
        self.result: Mapping[str, Any] | None = None
        self._coming = list(by_hand)
        self._made: list[dict[str, Any]] = []  # since the last frame

    @final
    def tick(self) -> bytes:
        """Run one control period and return it as blocks of a recording; nothing once the run is over."""
        if self.result is not None:
            return b""
        while self._coming and self._coming[0].tick <= self.ticks:
            self._make(self._coming.pop(0))
        frame = self._run_period({"by_hand": self._made, "made": time.time()})
        self._made = []
        self.result = self._ended()
        return frame if self.result is None else frame + end_of(self.result)

    @final
    def do(self, order: Mapping[str, Any]) -> None:
        """Make a change by hand before the next control period; `order` has the keys of a `Change` but its tick.

        ValueError, of one line, says what is impossible.
        """
        try:
            change = _CHANGE.validate_python({**order, "tick": self.ticks})
        except ValidationError as error:
            raise ValueError(one_line(error, "by hand", Change)) from error
        if self.result is not None:
            raise ValueError("the mission is over")
        self._make(change)

    def _make(self, change: Change) -> None:
        self._made.append(self._changed(change).model_dump())

    @property
    @abstractmethod
    def ticks(self) -> int:
        """Control periods that have been run."""

    @abstractmethod
    def facts(self) -> dict[str, Any]:
        """Return what the page shows beside the frames: `strategy`, and the share of messages that get lost, `loss`."""

    @abstractmethod
    def strategies(self) -> list[str]:
        """Return the strategies that fit, for the user to choose from."""

    @abstractmethod
    def present(self) -> bytes:
        """Return the world as it is now, before the next control period, as a block that is part of no recording."""

    @abstractmethod
    def close(self) -> None:
        """End the recording."""

    @abstractmethod
    def _changed(self, change: Change) -> Change:
        """Make a change, and return it as it is to be recorded; ValueError if it is impossible."""

    @abstractmethod
    def _run_period(self, notes: Mapping[str, Any]) -> bytes:
        """Run one control period, record it, and return it as a block with `notes`."""

    @abstractmethod
    def _ended(self) -> Mapping[str, Any] | None:
        """Return the figures of a run that is over, None while it goes on."""


def check_files(recording: RecordedMission, directories: Sequence[Path], held: Mapping[str, str]) -> None:
    """Raise ConfigurationError if files on which the course depends have changed since they were as `held`."""
    if fingerprints(directories) != held:
        raise ConfigurationError(f"{recording.path}: mechanisms, knowledge or robots have changed since it was played")
