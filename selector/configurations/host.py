"""The host of configurations: buffers, randomness, memory and functions that it gives to them, by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from selector.configurations.configuration import DECLARED_BY, ActingNetworkSpec
from selector.documents.errors import DocumentError
from selector.documents.plain import must_know
from selforg.components import FactRule, RobotMemory, SharedFact, Surroundings
from selforg.components.actions import Call
from selforg.components.facts import SHARED_FACTS
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.randomness import DirectionStream
from selforg.space import Euclidean

AnySpec = ActingNetworkSpec[Any, Any]


@dataclass(frozen=True)
class Host:
    """R robots as configurations see them. All options share the buffers, so that robots perceive each other.

    Attributes:
        poses: of the robots.
        buffers: by the names that configurations use; the usual one is `gradients`.
        directions: random directions of mechanisms, one stream for each row; None: directions are not random.
        generators: (R,) other randomness; the host may replace the generator of a row in this list.
        memory: what each robot knows independently of its option, under the names that configurations expect.
        calls: functions by name; behaviours call them with the time [s] and the rows in which they start.
        facts: what robots tell each other, by name.
        surroundings: what rays from the robots meet.

    """

    poses: OwnPoses
    buffers: Mapping[str, SoBuffer]
    directions: DirectionStream | None = None
    generators: Sequence[np.random.Generator] = ()
    memory: RobotMemory = field(default_factory=lambda: RobotMemory(0, {}))
    calls: Mapping[str, Call] = field(default_factory=dict)
    facts: Mapping[str, SharedFact] = field(default_factory=dict)
    surroundings: Surroundings = field(default_factory=Surroundings)

    @property
    def rows(self) -> int:
        """Number of robots, R."""
        return self.poses.rows

    def check(self, configuration: AnySpec, where: str) -> None:
        """Raise DocumentError, which begins with `where`, if the host lacks something that the configuration names."""
        buffers, calls, facts = configuration.buffers, configuration.referred("call"), configuration.referred("fact")
        named = {"buffer": (buffers, self.buffers), "call": (calls, self.calls), "fact": (facts, self.facts)}
        for what, (names, known) in named.items():
            for name in names:
                must_know(what, name, sorted(known), where, DECLARED_BY.get(what, ""))
        kinds = self.memory.kinds
        for name, kind in configuration.expects.items():
            must_know("knowledge", name, sorted(kinds), f"{where}: expects")
            if kinds[name] != kind:
                raise DocumentError(f"{where}: expects.{name}: expected a {kind}, but the host knows a {kinds[name]}")


def trial_host(configuration: AnySpec, facts: Iterable[str] | None = None) -> Host:
    """Return a host of one robot with all that a configuration names, to check that the configuration can be built.

    Args:
        configuration: the configuration.
        facts: names of the facts that the robot knows; all that the configuration names unless given.

    """
    poses = OwnPoses(Euclidean(2), 1)
    buffers = {name: SoBuffer(BufferSettings(), poses.space, poses) for name in configuration.buffers}
    calls: dict[str, Call] = dict.fromkeys(configuration.referred("call"), lambda now, rows: None)
    shared = SoBuffer(SHARED_FACTS, poses.space, poses)
    names = configuration.referred("fact") if facts is None else facts
    known = {name: SharedFact(shared, name, FactRule()) for name in names}
    return Host(poses, buffers, None, [np.random.default_rng(0)], host_memory([configuration], 1), calls, known)


def host_memory(configurations: Iterable[AnySpec], rows: int) -> RobotMemory:
    """Return the memory of `rows` robots for all names that configurations expect; first values are False or 0."""
    kinds = {name: kind for configuration in configurations for name, kind in configuration.expects.items()}
    return RobotMemory(rows, {name: False if kind == "fact" else 0.0 for name, kind in kinds.items()})
