"""What a host gives to the configurations that its robots hold: buffers, chance, memory and functions, by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from selector.configurations.acting_network import ActingNetworkSpec
from selector.documents.errors import DocumentError
from selforg.arrays import Ints
from selforg.components import RobotMemory
from selforg.components.actions import Call
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.randomness import DirectionStream
from selforg.registry import unknown
from selforg.space import Euclidean

AnySpec = ActingNetworkSpec[Any, Any, Any]


@dataclass(frozen=True)
class Host:
    """R robots as configurations see them. All options of a team share the buffers, so that they see each other.

    Attributes:
        poses: of the robots.
        buffers: by the names that configurations use, `gradients` being the usual one.
        directions: random directions of mechanisms, one stream a row; without one they are not random.
        generators: (R,) other randomness, one generator a row; the host may replace a row's in this list.
        memory: what each robot knows whatever it holds, under the names that configurations expect.
        calls: functions that behaviours call, by name, with the time and the rows in which they start.

    """

    poses: OwnPoses
    buffers: Mapping[str, SoBuffer]
    directions: DirectionStream | None = None
    generators: Sequence[np.random.Generator] = ()
    memory: RobotMemory = field(default_factory=lambda: RobotMemory(0, {}))
    calls: Mapping[str, Call] = field(default_factory=dict)

    @property
    def rows(self) -> int:
        """Number of robots, R."""
        return self.poses.rows

    def check(self, configuration: AnySpec, where: str) -> None:
        """Raise DocumentError if the host lacks something that the configuration names; `where` starts the line."""
        for name in configuration.buffers:
            if name not in self.buffers:
                raise DocumentError(f"{where}: {unknown('buffer', name, sorted(self.buffers))}")
        for name in configuration.calls:
            if name not in self.calls:
                raise DocumentError(f"{where}: {unknown('call', name, sorted(self.calls))}")
        kinds = self.memory.kinds
        for name, kind in configuration.expects.items():
            if name not in kinds:
                raise DocumentError(f"{where}: expects: {unknown('knowledge', name, sorted(kinds))}")
            if kinds[name] != kind:
                raise DocumentError(f"{where}: expects.{name}: expected a {kind}, but the host knows a {kinds[name]}")


def trial_host(configuration: AnySpec) -> Host:
    """Return a host of one robot that has all that a configuration names, to try whether it can be built."""
    poses = OwnPoses(Euclidean(2), 1)
    buffers = {name: SoBuffer(BufferSettings(), poses.space, poses) for name in configuration.buffers}
    first = {name: False if kind == "fact" else 0.0 for name, kind in configuration.expects.items()}
    calls = dict.fromkeys(configuration.calls, _nothing)
    return Host(poses, buffers, None, [np.random.default_rng(0)], RobotMemory(1, first), calls)


def host_memory(configurations: Iterable[AnySpec], rows: int) -> RobotMemory:
    """Return the memory of `rows` robots with all that some configurations expect, each False or 0 at first."""
    kinds = {name: kind for configuration in configurations for name, kind in configuration.expects.items()}
    return RobotMemory(rows, {name: False if kind == "fact" else 0.0 for name, kind in kinds.items()})


def _nothing(now: float, rows: Ints) -> None:
    """Do nothing."""
